//! Values → the fields of a row in one buffer; rows → lines of CSV.

use std::fmt::{Display, Write};
use std::io;

use csv::StringRecord;

/// The fields of a row, without its number. Numbers have the digits that restore them exactly.
#[derive(Clone, Debug)]
pub struct Fields {
    record: StringRecord,
    /// The text of a field before it is appended; its memory serves all fields.
    text: String,
}

impl Default for Fields {
    /// An empty row, with memory for the fields of most studies.
    fn default() -> Fields {
        Fields { record: StringRecord::with_capacity(512, 32), text: String::with_capacity(32) }
    }
}

impl Fields {
    /// Appends a field.
    pub fn push(&mut self, value: impl Display) {
        self.text.clear();
        write!(self.text, "{value}").expect("a String takes any text");
        self.record.push_field(&self.text);
    }

    /// Appends a field that is empty for `None`.
    pub fn push_option(&mut self, value: Option<impl Display>) {
        match value {
            Some(value) => self.push(value),
            None => self.record.push_field(""),
        }
    }

    /// Returns the field at this position, from 0.
    pub fn get(&self, position: usize) -> Option<&str> {
        self.record.get(position)
    }

    /// Iterates over the fields.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        self.record.iter()
    }
}

impl<T: Display> Extend<T> for Fields {
    fn extend<I: IntoIterator<Item = T>>(&mut self, values: I) {
        values.into_iter().for_each(|value| self.push(value));
    }
}

/// Returns rows as lines of CSV, each with its number in front.
///
/// # Errors
/// Rows of different lengths.
pub fn lines<'a>(first: u64, rows: impl IntoIterator<Item = &'a Fields>) -> io::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (number, row) in (first..).zip(rows) {
        writer.write_field(number.to_string())?;
        writer.write_record(&row.record)?;
    }
    text(writer)
}

/// Returns the names of columns as a line of CSV.
pub(super) fn heading_line<'a>(names: impl Iterator<Item = &'a str>) -> io::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(names)?;
    text(writer)
}

fn text(writer: csv::Writer<Vec<u8>>) -> io::Result<String> {
    let bytes = writer.into_inner().map_err(csv::IntoInnerError::into_error)?;
    String::from_utf8(bytes).map_err(io::Error::other)
}
