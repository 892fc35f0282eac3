//! Items → lines of text for a person, and JSON for a program.

use std::fmt::{Display, Write};
use std::ops::Range;

use serde::{Serialize, Serializer};
use serde_json::value::{RawValue, to_raw_value};

/// The summary of a command, item by item.
#[derive(Default)]
pub struct Summary {
    /// A line for each item that a person reads.
    pub text: String,
    /// The numbers in SI units and full precision.
    pub json: Object,
}

impl Summary {
    /// Adds a line.
    pub fn line(&mut self, name: &str, text: impl Display) {
        // Writing to a String never fails.
        let _ = writeln!(self.text, "{name:13} {text}");
    }

    /// Adds an entry.
    pub fn entry(&mut self, key: &str, value: impl Serialize) {
        self.json.push(key, value);
    }

    /// Adds an entry and its line.
    pub fn item(&mut self, key: &str, value: impl Serialize, name: &str, text: impl Display) {
        self.entry(key, value);
        self.line(name, text);
    }
}

/// A JSON object whose keys keep their order.
#[derive(Clone, Default)]
pub struct Object(Vec<(String, Box<RawValue>)>);

impl Object {
    /// Adds an entry.
    pub fn push(&mut self, key: &str, value: impl Serialize) {
        self.0.push((key.into(), to_raw_value(&value).expect("the keys of all maps are text")));
    }

    /// Adds an entry if there is a value.
    #[must_use]
    pub fn with_some(mut self, key: &str, value: Option<impl Serialize>) -> Object {
        value.into_iter().for_each(|value| self.push(key, value));
        self
    }

    /// Adds an entry.
    #[must_use]
    pub fn with(self, key: &str, value: impl Serialize) -> Object {
        self.with_some(key, Some(value))
    }
}

/// An object of values of one type.
impl<K: AsRef<str>, V: Serialize> FromIterator<(K, V)> for Object {
    fn from_iter<I: IntoIterator<Item = (K, V)>>(entries: I) -> Object {
        entries.into_iter().fold(Object::default(), |object, (key, value)| object.with(key.as_ref(), value))
    }
}

impl<V: Serialize, const N: usize> From<[(&str, V); N]> for Object {
    fn from(entries: [(&str, V); N]) -> Object {
        entries.into_iter().collect()
    }
}

impl Serialize for Object {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

/// A text table: two spaces between the columns, those in `right` aligned to the right.
pub fn aligned(rows: &[Vec<String>], right: Range<usize>) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows.first().map_or(0, Vec::len)).map(width).collect();
    let line = |row: &Vec<String>| {
        let cell = |(column, &width): (usize, &usize)| match right.contains(&column) {
            true => format!("{:>width$}", row[column]),
            false => format!("{:width$}", row[column]),
        };
        let cells: Vec<String> = widths.iter().enumerate().map(cell).collect();
        cells.join("  ").trim_end().to_string() + "\n"
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_lines_and_entries_in_their_order() {
        let mut summary = Summary::default();
        summary.item("z", 1.5, "length", "1.5 m");
        summary.line("remark", "none");
        summary.entry("a", Object::from([("y", f64::NAN), ("b", 2.0)]).with_some("x", None::<f64>));
        assert_eq!(summary.text, "length        1.5 m\nremark        none\n");
        assert_eq!(serde_json::to_string(&summary.json).unwrap(), r#"{"z":1.5,"a":{"y":null,"b":2.0}}"#);
    }

    #[test]
    fn columns_are_aligned_without_blanks_at_the_end() {
        let row = |cells: [&str; 3]| cells.map(String::from).to_vec();
        let rows = [row(["motion", "count", "peak"]), row(["α", "7", "-"])];
        assert_eq!(aligned(&rows, 1..2), "motion  count  peak\nα           7  -\n");
    }
}
