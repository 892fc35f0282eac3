//! A TOML file → its tables with the line of each key and value, and nothing in them that is not asked for.

use std::ops::Range;
use std::str::FromStr;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A study file that says something wrong.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}:{line}: {message}")]
pub struct StudyFileError {
    /// The file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// What was found there and what was expected.
    pub message: String,
}

/// The text of a study file and its name.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// Name of the file.
    pub file: &'a str,
    /// Its content.
    pub text: &'a str,
}

impl<'a> Source<'a> {
    /// An error at a place of the text.
    pub fn wrong(&self, place: &Range<usize>, message: impl Into<String>) -> StudyFileError {
        let before = self.text.get(..place.start).unwrap_or(self.text);
        StudyFileError { file: self.file.into(), line: before.matches('\n').count() + 1, message: message.into() }
    }

    /// Reads the file as one table.
    pub fn parse(&self) -> Result<Spanned<DeTable<'a>>, StudyFileError> {
        DeTable::parse(self.text).map_err(|error| {
            let message = error.message().replace('\n', " ");
            self.wrong(&error.span().unwrap_or(0..0), format!("this is no TOML: {message}"))
        })
    }
}

/// A table of the file of which each key is to be asked for.
pub struct Section<'a> {
    source: Source<'a>,
    name: &'a str,
    place: Range<usize>,
    table: &'a DeTable<'a>,
}

/// A value and its place in the text.
pub type Placed<'a> = &'a Spanned<DeValue<'a>>;

impl<'a> Section<'a> {
    /// A table that has no other keys than these; `name` stands for it in errors.
    pub fn new(
        source: Source<'a>,
        name: &'a str,
        place: Range<usize>,
        table: &'a DeTable<'a>,
        keys: &[&str],
    ) -> Result<Section<'a>, StudyFileError> {
        let unknown = table.keys().filter(|key| !keys.contains(&key.get_ref().as_ref()));
        // The first in the text, not in the alphabet.
        if let Some(key) = unknown.min_by_key(|key| key.span().start) {
            let message = format!("there is no {} in {name}; expected one of {}", key.get_ref(), keys.join(", "));
            return Err(source.wrong(&key.span(), message));
        }
        Ok(Section { source, name, place, table })
    }

    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<Placed<'a>> {
        self.table.get(key)
    }

    /// A table inside this one, with no other keys than these.
    pub fn section(&self, key: &'a str, keys: &[&str]) -> Result<Option<Section<'a>>, StudyFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let table = value.get_ref().as_table();
        let table = table.ok_or_else(|| self.wrong(key, value, "a table"))?;
        Section::new(self.source, key, value.span(), table, keys).map(Some)
    }

    /// An error at the value of a key.
    pub fn wrong(&self, key: &str, value: Placed, expected: &str) -> StudyFileError {
        self.source.wrong(&value.span(), format!("{key} = {}; expected {expected}", self.shown(value)))
    }

    /// An error at the table.
    pub fn lacks(&self, key: &str, expected: &str) -> StudyFileError {
        self.source.wrong(&self.place, format!("{} has no {key}; expected {expected}", self.name))
    }

    fn shown(&self, value: Placed) -> String {
        let text = self.source.text.get(value.span()).unwrap_or_default();
        text.split_whitespace().collect::<Vec<_>>().join(" ").chars().take(60).collect()
    }

    /// A finite number that fits.
    pub fn number(&self, key: &str, fits: impl Fn(f64) -> bool, expected: &str) -> Result<Option<f64>, StudyFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let found = number(value).filter(|&number| number.is_finite() && fits(number));
        found.map(Some).ok_or_else(|| self.wrong(key, value, expected))
    }

    /// A whole number in a range.
    pub fn integer(&self, key: &str, range: Range<u64>) -> Result<Option<u64>, StudyFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let integer = value.get_ref().as_integer();
        let found = integer.and_then(|integer| u64::from_str_radix(integer.as_str(), integer.radix()).ok());
        let expected = || format!("a whole number from {} to {}", range.start, range.end - 1);
        found.filter(|n| range.contains(n)).map(Some).ok_or_else(|| self.wrong(key, value, &expected()))
    }

    /// A text.
    pub fn text(&self, key: &str) -> Result<Option<&'a str>, StudyFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        value.get_ref().as_str().map(Some).ok_or_else(|| self.wrong(key, value, "a text in quotes"))
    }

    /// A word of a choice, in small letters with hyphens, whatever its spelling.
    pub fn word(&self, key: &str) -> Result<Option<String>, StudyFileError> {
        Ok(self.text(key)?.map(|text| text.to_lowercase().replace('_', "-")))
    }

    /// A text that stands for something else.
    pub fn parsed<T: FromStr<Err: ToString>>(&self, key: &str) -> Result<Option<T>, StudyFileError> {
        let (Some(text), Some(value)) = (self.text(key)?, self.get(key)) else { return Ok(None) };
        let parsed = text.parse().map_err(|error: T::Err| self.source.wrong(&value.span(), error.to_string()));
        parsed.map(Some)
    }

    /// A list of finite numbers that fit, not empty.
    pub fn numbers(
        &self,
        key: &str,
        fits: impl Fn(f64) -> bool,
        expected: &str,
    ) -> Result<Option<Vec<f64>>, StudyFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let list = value.get_ref().as_array().filter(|list| !list.is_empty());
        let list = list.ok_or_else(|| self.wrong(key, value, expected))?;
        let numbers = list.iter().map(|value| {
            let found = number(value).filter(|&number| number.is_finite() && fits(number));
            found.ok_or_else(|| self.wrong(key, value, expected))
        });
        numbers.collect::<Result<Vec<_>, _>>().map(Some)
    }
}

/// A value as a number, if it is one.
pub fn number(value: Placed) -> Option<f64> {
    match value.get_ref() {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|integer| integer as f64)
        }
        _ => None,
    }
}
