//! Text of input fields → numbers and choices; an error for each field.

use std::collections::BTreeMap;
use std::str::FromStr;

use rocking_studies::spec::limits;
use rocking_studies::spec::words::Words;
use serde::Serialize;

/// A message and its field.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldError {
    /// Name of the field.
    pub field: String,
    /// The fault and the expected value, on one line.
    pub message: String,
}

impl FieldError {
    /// Creates a message for a field.
    pub fn new(field: impl Into<String>, message: impl Into<String>) -> FieldError {
        FieldError { field: field.into(), message: message.into() }
    }
}

/// The fields of the page as typed by the user, and the errors found so far.
#[derive(Debug)]
pub struct Fields<'a> {
    texts: &'a BTreeMap<String, String>,
    errors: Vec<FieldError>,
}

impl<'a> Fields<'a> {
    /// Begins to read these fields.
    pub fn new(texts: &'a BTreeMap<String, String>) -> Fields<'a> {
        Fields { texts, errors: Vec::new() }
    }

    /// Text of a field without surrounding blanks; empty if there is none.
    pub fn text(&self, field: &str) -> &'a str {
        self.texts.get(field).map_or("", |text| text.trim())
    }

    /// Records an error.
    pub fn refuse(&mut self, error: FieldError) {
        self.errors.push(error);
    }

    /// Records that the text of a field is not the expected one.
    fn refuse_text(&mut self, field: &str, expected: &str) {
        let found = Some(self.text(field)).filter(|text| !text.is_empty()).unwrap_or("nothing");
        self.refuse(FieldError::new(field, format!("found {found}; expected {expected}")));
    }

    /// A number that passes `fits`. An error yields NaN, which is never used.
    pub fn number(&mut self, field: &str, fits: impl Fn(f64) -> bool, expected: &str) -> f64 {
        let text = self.text(field);
        // The decimal comma of many countries.
        let number = text.replace(',', ".").parse().ok().filter(|&number: &f64| number.is_finite() && fits(number));
        number.unwrap_or_else(|| {
            self.refuse_text(field, expected);
            f64::NAN
        })
    }

    /// A number within the limits of its schema.
    pub fn required(&mut self, field: &str, schema: &serde_json::Value) -> f64 {
        self.number(field, |number| limits::admits(schema, number), &limits::expected(schema))
    }

    /// A number within the limits of its schema; `None` for an empty field.
    pub fn limited(&mut self, field: &str, schema: &serde_json::Value) -> Option<f64> {
        (!self.text(field).is_empty()).then(|| self.required(field, schema))
    }

    /// A whole number in a range.
    pub fn integer(&mut self, field: &str, least: u64, greatest: u64) -> u64 {
        let text = self.text(field);
        let number = text.parse().ok().filter(|number| (least..=greatest).contains(number));
        number.unwrap_or_else(|| {
            self.refuse_text(field, &format!("a whole number from {least} to {greatest}"));
            least
        })
    }

    /// A choice by its word.
    pub fn choice<T: Words>(&mut self, field: &str) -> T {
        T::named(self.text(field)).unwrap_or_else(|| {
            let known: Vec<&str> = T::WORDS.iter().map(|(word, _)| *word).collect();
            self.refuse_text(field, &format!("one of {}", known.join(", ")));
            T::WORDS[0].1
        })
    }

    /// One of these words; an error yields the first.
    pub fn one_of(&mut self, field: &str, known: &[&'static str]) -> &'static str {
        let text = self.text(field);
        known.iter().find(|word| **word == text).unwrap_or_else(|| {
            self.refuse_text(field, &format!("one of {}", known.join(", ")));
            &known[0]
        })
    }

    /// A value read by the parser of its type; `None` for an empty field.
    pub fn parsed<T: FromStr<Err: ToString>>(&mut self, field: &str) -> Option<T> {
        let text = self.text(field);
        if text.is_empty() {
            return None;
        }
        text.parse().map_err(|error: T::Err| self.refuse(FieldError::new(field, error.to_string()))).ok()
    }

    /// The value, unless an error was found.
    ///
    /// # Errors
    /// All errors found, in the order of reading.
    pub fn finish<T>(self, value: T) -> Result<T, Vec<FieldError>> {
        if self.errors.is_empty() { Ok(value) } else { Err(self.errors) }
    }

    /// Whether an error was found.
    pub fn has_errors(&self) -> bool {
        !self.errors.is_empty()
    }

    /// The errors found.
    pub fn into_errors(self) -> Vec<FieldError> {
        self.errors
    }
}
