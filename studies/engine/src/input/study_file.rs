//! A TOML file → its tables, with the line of each key and value. Unknown keys are refused.

use std::borrow::Cow;
use std::ops::{Deref, Range};
use std::str::FromStr;

use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde_json::Value as Json;
use toml::Spanned;
use toml::Value as Toml;
use toml::de::{DeTable, DeValue};

use crate::spec::limits::{admits, expected, schema_of, words};

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
    /// Returns a part of the text on one line, at most 60 characters.
    fn shown(&self, range: &Range<usize>) -> String {
        let text = self.text.get(range.clone()).unwrap_or_default();
        text.split_whitespace().collect::<Vec<_>>().join(" ").chars().take(60).collect()
    }

    /// An error at a range of bytes of the text.
    pub fn wrong(&self, range: &Range<usize>, message: impl Into<String>) -> StudyFileError {
        let before = self.text.get(..range.start).unwrap_or(self.text);
        StudyFileError { file: self.file.into(), line: before.matches('\n').count() + 1, message: message.into() }
    }

    /// Returns an error at a value of a key that says the expected one.
    pub fn unexpected(&self, key: &str, value: SpannedValue, expected: &str) -> StudyFileError {
        let range = value.span();
        self.wrong(&range, format!("{key} = {}; expected {expected}", self.shown(&range)))
    }

    /// Returns the values of a table that agrees with a schema. Those with a schema by reference are read apart.
    fn table(
        &self,
        name: &str,
        range: &Range<usize>,
        table: &DeTable,
        schema: &Json,
    ) -> Result<toml::Table, StudyFileError> {
        let properties = &schema["properties"];
        let known = properties.as_object().into_iter().flatten();
        let has_further =
            schema["additionalProperties"] != false || known.clone().any(|(_, of)| of["$ref"].is_string());
        let mut entries: Vec<_> = table.iter().collect();
        // Errors are those of the first line, not of the alphabet.
        entries.sort_by_key(|(key, _)| key.span().start);
        let unknown = |key: &str| !has_further && properties[key].is_null();
        if let Some((key, _)) = entries.iter().find(|(key, _)| unknown(key.get_ref())) {
            let known: Vec<&str> = known.map(|(key, _)| key.as_str()).collect();
            let message = format!("there is no {} in {name}; expected one of {}", key.get_ref(), known.join(", "));
            return Err(self.wrong(&key.span(), message));
        }
        let required = schema["required"].as_array().into_iter().flatten().filter_map(Json::as_str);
        if let Some(missing) = required.clone().find(|key| table.get(*key).is_none()) {
            let expected = expected(&properties[missing]);
            return Err(self.wrong(range, format!("{name} has no {missing}; expected {expected}")));
        }
        let entry = |(key, value): (&Spanned<Cow<str>>, SpannedValue)| {
            let key = key.get_ref();
            let name = match (value.get_ref().is_array(), name) {
                (false, _) => key.to_string(),
                (true, THE_FILE) => format!("[[{key}]]"),
                (true, _) => format!("[[{name}.{key}]]"),
            };
            Ok((key.to_string(), self.value(&name, key, value, &properties[&**key])?))
        };
        entries.into_iter().map(entry).collect()
    }

    /// Returns the value of a key that agrees with a schema. Words are those of the schema, and `name` is that of its tables.
    fn value(&self, name: &str, key: &str, value: SpannedValue, schema: &Json) -> Result<Toml, StudyFileError> {
        let unexpected = || self.unexpected(key, value, &expected(schema));
        if let Some(forms) = schema["anyOf"].as_array() {
            return forms.iter().find_map(|form| self.value(name, key, value, form).ok()).ok_or_else(unexpected);
        }
        let found = match (schema["type"].as_str(), value.get_ref()) {
            (_, DeValue::String(text)) if words(schema).next().is_some() => {
                let found = text.to_lowercase().replace('_', "-");
                words(schema).find(|word| *word == found).map(|word| Toml::String(word.into()))
            }
            (Some("string"), DeValue::String(text)) => Some(Toml::String(text.to_string())),
            (Some("boolean"), DeValue::Boolean(truth)) => Some(Toml::Boolean(*truth)),
            (Some("integer"), DeValue::Integer(integer)) => {
                let integer = i64::from_str_radix(integer.as_str(), integer.radix()).ok();
                integer.filter(|integer| admits(schema, *integer as f64)).map(Toml::Integer)
            }
            (Some("number"), _) => number(value).filter(|number| admits(schema, *number)).map(Toml::Float),
            (Some("array"), DeValue::Array(list)) => {
                let limit = |key: &str, default| schema[key].as_u64().map_or(default, |limit| limit as usize);
                if !(limit("minItems", 0)..=limit("maxItems", usize::MAX)).contains(&list.len()) {
                    return Err(unexpected());
                }
                let mut items = schema["items"].clone();
                if items["type"] == "number" {
                    items["description"] = schema["description"].clone();
                }
                let list = list.iter().map(|value| self.value(name, key, value, &items));
                return list.collect::<Result<_, _>>().map(Toml::Array);
            }
            (Some("object"), DeValue::Table(table)) => {
                return self.table(name, &value.span(), table, schema).map(Toml::Table);
            }
            // By reference: read apart.
            (None, _) if words(schema).next().is_none() => Some(Toml::Table(toml::Table::new())),
            _ => None,
        };
        found.ok_or_else(unexpected)
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

/// Name of the whole file in errors.
pub const THE_FILE: &str = "the file";

/// A value and its range in the text.
pub type SpannedValue<'a> = &'a Spanned<DeValue<'a>>;

/// A table of the file: its values and their places. The places are found by paths such as `study.levels.im` or `tests.0.data`.
pub struct Section<'a, T> {
    /// The text.
    pub source: StudyText<'a>,
    range: Range<usize>,
    table: &'a DeTable<'a>,
    values: T,
}

impl<T> Deref for Section<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.values
    }
}

impl<'a, T: DeserializeOwned + JsonSchema> Section<'a, T> {
    /// Reads a table that agrees with the JSON Schema of `T`. `name` is its name in errors.
    ///
    /// # Errors
    /// The first key or value that the schema does not accept, with the accepted ones.
    pub fn read(
        source: StudyText<'a>,
        name: &str,
        range: Range<usize>,
        table: &'a DeTable<'a>,
    ) -> Result<Section<'a, T>, StudyFileError> {
        let values = source.table(name, &range, table, schema_of::<T>().as_value())?;
        let values = T::deserialize(values).map_err(|error| source.wrong(&range, error.message()))?;
        Ok(Section { source, range, table, values })
    }
}

impl<'a, T> Section<'a, T> {
    /// Returns the value at a path.
    pub fn get(&self, path: &str) -> Option<SpannedValue<'a>> {
        let mut names = path.split('.');
        let first = self.table.get(names.next()?)?;
        names.try_fold(first, |value, name| match value.get_ref() {
            DeValue::Array(list) => list.get(name.parse::<usize>().ok()?),
            value => value.as_table()?.get(name),
        })
    }

    /// Parses the text at a path.
    ///
    /// # Errors
    /// The error of its type, at the text.
    pub fn parsed<P: FromStr<Err: ToString>>(&self, path: &str, text: &str) -> Result<P, StudyFileError> {
        text.parse().map_err(|error: P::Err| self.refused(path, error.to_string()))
    }

    /// Returns an error at a path that says the expected value.
    pub fn wrong(&self, path: &str, expected: &str) -> StudyFileError {
        let key = path.rsplit('.').find(|name| name.parse::<usize>().is_err()).unwrap_or(path);
        match self.get(path) {
            Some(value) => self.source.unexpected(key, value, expected),
            None => self.refused(path, format!("expected {key}, {expected}")),
        }
    }

    /// Returns an error at a path, or at its innermost table in the file.
    pub fn refused(&self, path: &str, message: impl Into<String>) -> StudyFileError {
        let mut outwards = std::iter::successors(Some(path), |path| Some(path.rsplit_once('.')?.0));
        let place = outwards.find_map(|path| Some(self.get(path)?.span()));
        self.source.wrong(&place.unwrap_or_else(|| self.range.clone()), message)
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
