//! A TOML file → its tables, with known keys only and the line of each key and value.

use std::ops::Range;
use std::str::FromStr;

use serde::de::{DeserializeOwned, Deserializer, Error, Visitor};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// An error in a study file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}:{line}: {message}")]
pub struct StudyFileError {
    /// The file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// The found and the expected content.
    pub message: String,
}

/// The text of a study file and its name.
#[derive(Clone, Copy)]
pub struct StudyText<'a> {
    /// Name of the file.
    pub file: &'a str,
    /// Its content.
    pub text: &'a str,
}

impl<'a> StudyText<'a> {
    /// An error at a range of bytes of the text.
    pub fn wrong(&self, range: &Range<usize>, message: impl Into<String>) -> StudyFileError {
        let before = self.text.get(..range.start).unwrap_or(self.text);
        StudyFileError { file: self.file.into(), line: before.matches('\n').count() + 1, message: message.into() }
    }

    /// Reads the file as one table.
    ///
    /// # Errors
    /// The first fault of TOML's syntax.
    pub fn parse(&self) -> Result<Spanned<DeTable<'a>>, StudyFileError> {
        DeTable::parse(self.text).map_err(|error| {
            let message = error.message().replace('\n', " ");
            self.wrong(&error.span().unwrap_or(0..0), format!("invalid TOML: {message}"))
        })
    }
}

/// A table of the file with known keys.
pub struct Section<'a> {
    source: StudyText<'a>,
    name: &'a str,
    range: Range<usize>,
    table: &'a DeTable<'a>,
}

/// A value and its range in the text.
pub type SpannedValue<'a> = &'a Spanned<DeValue<'a>>;

impl<'a> Section<'a> {
    /// Checks that a table has only the keys of `T`. `name` is its name in errors.
    ///
    /// # Errors
    /// The first unknown key.
    pub fn of<T: DeserializeOwned>(
        source: StudyText<'a>,
        name: &'a str,
        range: Range<usize>,
        table: &'a DeTable<'a>,
    ) -> Result<Section<'a>, StudyFileError> {
        Section::new(source, name, range, table, keys::<T>())
    }

    /// Checks that a table has only these keys; `name` is its name in errors.
    ///
    /// # Errors
    /// The first unknown key.
    pub fn new(
        source: StudyText<'a>,
        name: &'a str,
        range: Range<usize>,
        table: &'a DeTable<'a>,
        keys: &[&str],
    ) -> Result<Section<'a>, StudyFileError> {
        let unknown = table.keys().filter(|key| !keys.contains(&key.get_ref().as_ref()));
        // The first in the text, not the alphabet.
        if let Some(key) = unknown.min_by_key(|key| key.span().start) {
            let message = format!("there is no {} in {name}; expected one of {}", key.get_ref(), keys.join(", "));
            return Err(source.wrong(&key.span(), message));
        }
        Ok(Section { source, name, range, table })
    }

    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<SpannedValue<'a>> {
        self.table.get(key)
    }

    /// A nested table with no other keys than those of `T`.
    ///
    /// # Errors
    /// A value that is no table, or a table with an unknown key.
    pub fn section<T: DeserializeOwned>(&self, key: &'a str) -> Result<Option<Section<'a>>, StudyFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let table = value.get_ref().as_table();
        let table = table.ok_or_else(|| self.wrong(key, value, "a table"))?;
        Section::of::<T>(self.source, key, value.span(), table).map(Some)
    }

    /// An error at the value of a key.
    pub fn wrong(&self, key: &str, value: SpannedValue, expected: &str) -> StudyFileError {
        self.source.wrong(&value.span(), format!("{key} = {}; expected {expected}", self.shown(value)))
    }

    /// An error at a value, in words that name it.
    pub fn refused(&self, value: SpannedValue, message: String) -> StudyFileError {
        self.source.wrong(&value.span(), message)
    }

    /// An error for a missing key, at the table.
    pub fn lacks(&self, key: &str, expected: &str) -> StudyFileError {
        self.source.wrong(&self.range, format!("{} has no {key}; expected {expected}", self.name))
    }

    fn shown(&self, value: SpannedValue) -> String {
        let text = self.source.text.get(value.span()).unwrap_or_default();
        text.split_whitespace().collect::<Vec<_>>().join(" ").chars().take(60).collect()
    }

    /// A finite number that passes `fits`.
    ///
    /// # Errors
    /// The value, with the expected one.
    pub fn number(&self, key: &str, fits: impl Fn(f64) -> bool, expected: &str) -> Result<Option<f64>, StudyFileError> {
        self.get(key).map(|value| self.fitting(key, value, &fits, expected)).transpose()
    }

    fn fitting(
        &self,
        key: &str,
        value: SpannedValue,
        fits: impl Fn(f64) -> bool,
        expected: &str,
    ) -> Result<f64, StudyFileError> {
        let found = number(value).filter(|&number| number.is_finite() && fits(number));
        found.ok_or_else(|| self.wrong(key, value, expected))
    }

    /// A whole number in a range.
    ///
    /// # Errors
    /// The value, with the expected range.
    pub fn integer(&self, key: &str, range: Range<u64>) -> Result<Option<u64>, StudyFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let integer = value.get_ref().as_integer();
        let found = integer.and_then(|integer| u64::from_str_radix(integer.as_str(), integer.radix()).ok());
        let expected = || format!("a whole number from {} to {}", range.start, range.end - 1);
        found.filter(|n| range.contains(n)).map(Some).ok_or_else(|| self.wrong(key, value, &expected()))
    }

    /// True or false.
    ///
    /// # Errors
    /// A value that is neither true nor false.
    pub fn flag(&self, key: &str) -> Result<Option<bool>, StudyFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        value.get_ref().as_bool().map(Some).ok_or_else(|| self.wrong(key, value, "true or false"))
    }

    /// A string.
    ///
    /// # Errors
    /// A value that is no string.
    pub fn text(&self, key: &str) -> Result<Option<&'a str>, StudyFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        value.get_ref().as_str().map(Some).ok_or_else(|| self.wrong(key, value, "a text in quotes"))
    }

    /// A choice by its word, in any case, with hyphens or underscores.
    ///
    /// # Errors
    /// An unknown word.
    pub fn choice<T: Copy>(&self, key: &str, words: &[(&str, T)], expected: &str) -> Result<Option<T>, StudyFileError> {
        let (Some(text), Some(value)) = (self.text(key)?, self.get(key)) else { return Ok(None) };
        let found = text.to_lowercase().replace('_', "-");
        let choice = words.iter().find(|(word, _)| *word == found);
        choice.map(|(_, choice)| Some(*choice)).ok_or_else(|| self.wrong(key, value, expected))
    }

    /// A string, parsed.
    ///
    /// # Errors
    /// A value that is no string, or the error of its type.
    pub fn parsed<T: FromStr<Err: ToString>>(&self, key: &str) -> Result<Option<T>, StudyFileError> {
        let (Some(text), Some(value)) = (self.text(key)?, self.get(key)) else { return Ok(None) };
        let parsed = text.parse().map_err(|error: T::Err| self.source.wrong(&value.span(), error.to_string()));
        parsed.map(Some)
    }

    /// A non-empty list of finite numbers that pass `fits`.
    ///
    /// # Errors
    /// The first wrong number, an empty list, or a value that is no list.
    pub fn numbers(
        &self,
        key: &str,
        fits: impl Fn(f64) -> bool,
        expected: &str,
    ) -> Result<Option<Vec<f64>>, StudyFileError> {
        self.get(key).map(|value| self.list(key, value, &fits, expected)).transpose()
    }

    fn list(
        &self,
        key: &str,
        value: SpannedValue,
        fits: &impl Fn(f64) -> bool,
        expected: &str,
    ) -> Result<Vec<f64>, StudyFileError> {
        let list = value.get_ref().as_array().filter(|list| !list.is_empty());
        let list = list.ok_or_else(|| self.wrong(key, value, expected))?;
        list.iter().map(|value| self.fitting(key, value, fits, expected)).collect()
    }

    /// A required list of lists of finite numbers.
    ///
    /// # Errors
    /// The key is missing, or a value that is no list of lists of finite numbers.
    pub fn lists(&self, key: &str, expected: &str) -> Result<Vec<Vec<f64>>, StudyFileError> {
        let value = self.get(key).ok_or_else(|| self.lacks(key, expected))?;
        let lists = value.get_ref().as_array().ok_or_else(|| self.wrong(key, value, expected))?;
        lists.iter().map(|list| self.list(key, list, &|_| true, expected)).collect()
    }
}

/// A value as a number; `None` for other values.
pub fn number(value: SpannedValue) -> Option<f64> {
    match value.get_ref() {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|integer| integer as f64)
        }
        _ => None,
    }
}

/// Returns the keys of a table in the order of its fields.
pub fn keys<T: DeserializeOwned>() -> &'static [&'static str] {
    let mut keys: &'static [&'static str] = &[];
    // A table gives its fields before it asks for a value, and gets none.
    let _ = T::deserialize(FieldNames(&mut keys));
    keys
}

/// Takes down the fields of a struct that is to be read, and fails.
struct FieldNames<'a>(&'a mut &'static [&'static str]);

impl<'de> Deserializer<'de> for FieldNames<'_> {
    type Error = serde::de::value::Error;

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Self::Error> {
        *self.0 = fields;
        Err(Error::custom("only the names of the fields are asked for"))
    }

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Self::Error> {
        Err(Error::custom("expected a struct"))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}
