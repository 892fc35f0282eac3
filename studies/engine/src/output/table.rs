//! Columns with their units and types → tables of typed values.
//!
//! A [`TableColumn`] declares all that a table says about a value: its name, its unit, its type, and the function that takes it from a row.

use std::fmt::{Display, Write};
use std::sync::Arc;

use serde::ser::{Serialize, SerializeMap, Serializer};

/// The type of the values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// Numbers; NaN where a row has none.
    Real,
    /// Whole numbers.
    Integer,
    /// True or false.
    Boolean,
    /// One of these words.
    Choice(Arc<[String]>),
    /// Any text.
    Text,
}

/// The name, the unit and the type of a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Heading {
    /// The name.
    pub name: String,
    /// The unit of numbers, `1` for pure ones.
    pub unit: Option<String>,
    /// The type of the values.
    pub kind: Kind,
}

/// Splits a heading such as `PGV [m/s]` into its name and unit.
pub fn split_heading(heading: &str) -> (&str, Option<&str>) {
    match heading.strip_suffix(']').and_then(|text| text.split_once(" [")) {
        Some((name, unit)) => (name, Some(unit)),
        None => (heading, None),
    }
}

/// The name with the unit: `p [rad/s]`.
impl Display for Heading {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name)?;
        self.unit.as_ref().map_or(Ok(()), |unit| write!(f, " [{unit}]"))
    }
}

/// Whether a column of a study's table has whole numbers, by its name.
pub fn is_count(name: &str) -> bool {
    ["row", "flights", "ties.broken", "overturning_ranges"].contains(&name)
        || ["events.", "ensemble.", "half_cycles>"].iter().any(|prefix| name.starts_with(prefix))
}

/// The number of a field. It is NaN for an empty field, and `None` for one that is no number.
fn number(field: &str) -> Option<f64> {
    if field.is_empty() { Some(f64::NAN) } else { field.parse().ok().filter(|number: &f64| !number.is_nan()) }
}

/// A column of rows of this type: its heading, and its value in a row.
pub struct TableColumn<'c, R> {
    heading: Heading,
    value: Value<'c, R>,
}

type Of<'c, R, T> = Box<dyn Fn(&R) -> T + Sync + 'c>;

enum Value<'c, R> {
    Real(Of<'c, R, f64>),
    Integer(Of<'c, R, i64>),
    Boolean(Of<'c, R, bool>),
    Choice(Of<'c, R, usize>),
    Text(Of<'c, R, String>),
}

impl<'c, R> TableColumn<'c, R> {
    fn new(name: impl Into<String>, unit: Option<&str>, kind: Kind, value: Value<'c, R>) -> TableColumn<'c, R> {
        TableColumn { heading: Heading { name: name.into(), unit: unit.map(String::from), kind }, value }
    }

    /// A column of numbers with a unit.
    pub fn real(name: impl Into<String>, unit: &str, value: impl Fn(&R) -> f64 + Sync + 'c) -> TableColumn<'c, R> {
        TableColumn::new(name, Some(unit), Kind::Real, Value::Real(Box::new(value)))
    }

    /// A column of numbers with a unit, which some rows lack.
    pub fn optional(
        name: impl Into<String>,
        unit: &str,
        value: impl Fn(&R) -> Option<f64> + Sync + 'c,
    ) -> TableColumn<'c, R> {
        TableColumn::real(name, unit, move |row| value(row).unwrap_or(f64::NAN))
    }

    /// A column of counts.
    pub fn count<N: TryInto<i64>>(name: impl Into<String>, value: impl Fn(&R) -> N + Sync + 'c) -> TableColumn<'c, R> {
        // No run counts further.
        let value = move |row: &R| value(row).try_into().unwrap_or(i64::MAX);
        TableColumn::new(name, Some("1"), Kind::Integer, Value::Integer(Box::new(value)))
    }

    /// The first column of a study's table: the number of the row, from 0.
    pub fn row(value: impl Fn(&R) -> u64 + Sync + 'c) -> TableColumn<'c, R> {
        TableColumn::count("row", value).with_unit(None)
    }

    /// A column of true and false.
    pub fn boolean(name: impl Into<String>, value: impl Fn(&R) -> bool + Sync + 'c) -> TableColumn<'c, R> {
        TableColumn::new(name, None, Kind::Boolean, Value::Boolean(Box::new(value)))
    }

    /// A column of words; the value is the position of the word in the list.
    pub fn choice<W: Into<String>>(
        name: impl Into<String>,
        words: impl IntoIterator<Item = W>,
        value: impl Fn(&R) -> usize + Sync + 'c,
    ) -> TableColumn<'c, R> {
        let words = words.into_iter().map(Into::into).collect();
        TableColumn::new(name, None, Kind::Choice(words), Value::Choice(Box::new(value)))
    }

    /// A column of text.
    pub fn text(name: impl Into<String>, value: impl Fn(&R) -> String + Sync + 'c) -> TableColumn<'c, R> {
        TableColumn::new(name, None, Kind::Text, Value::Text(Box::new(value)))
    }

    /// Gives the column another unit, or none.
    #[must_use]
    pub fn with_unit(mut self, unit: Option<&str>) -> TableColumn<'c, R> {
        self.heading.unit = unit.map(String::from);
        self
    }

    /// The name, the unit and the type.
    pub fn heading(&self) -> &Heading {
        &self.heading
    }

    /// The values of rows, under the heading of the column.
    pub fn series(&self, rows: &[R]) -> Series {
        Series { heading: self.heading.clone(), values: self.values(rows) }
    }

    /// The number in a row; NaN in a column of another type.
    pub fn number(&self, row: &R) -> f64 {
        match &self.value {
            Value::Real(value) => value(row),
            Value::Integer(value) => value(row) as f64,
            Value::Boolean(_) | Value::Choice(_) | Value::Text(_) => f64::NAN,
        }
    }

    fn values(&self, rows: &[R]) -> Values {
        match &self.value {
            Value::Real(value) => Values::Real(rows.iter().map(value).collect()),
            Value::Integer(value) => Values::Integer(rows.iter().map(value).collect()),
            Value::Boolean(value) => Values::Boolean(rows.iter().map(value).collect()),
            Value::Choice(value) => Values::Choice(rows.iter().map(|row| value(row) as u32).collect()),
            Value::Text(value) => Values::Text(rows.iter().map(value).collect()),
        }
    }
}

/// The headings of columns.
pub fn headings<R>(columns: &[TableColumn<'_, R>]) -> Vec<Heading> {
    columns.iter().map(|column| column.heading.clone()).collect()
}

/// The values of a column, of the type of its heading.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers; NaN where a row has none.
    Real(Vec<f64>),
    /// Whole numbers.
    Integer(Vec<i64>),
    /// True or false.
    Boolean(Vec<bool>),
    /// Positions in the list of words.
    Choice(Vec<u32>),
    /// Texts.
    Text(Vec<String>),
}

impl Values {
    /// Number of values.
    pub(super) fn len(&self) -> usize {
        match self {
            Values::Real(values) => values.len(),
            Values::Integer(values) => values.len(),
            Values::Boolean(values) => values.len(),
            Values::Choice(values) => values.len(),
            Values::Text(values) => values.len(),
        }
    }
}

/// A column with its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// The name, the unit and the type.
    pub heading: Heading,
    /// The values.
    pub values: Values,
}

impl Series {
    pub(super) fn new(heading: Heading) -> Series {
        let values = match heading.kind {
            Kind::Real => Values::Real(Vec::new()),
            Kind::Integer => Values::Integer(Vec::new()),
            Kind::Boolean => Values::Boolean(Vec::new()),
            Kind::Choice(_) => Values::Choice(Vec::new()),
            Kind::Text => Values::Text(Vec::new()),
        };
        Series { heading, values }
    }

    /// Appends the value in a row to a line of text. Digits restore a number exactly, and a missing number is empty.
    pub fn write(&self, row: usize, text: &mut String) {
        let written = match &self.values {
            Values::Real(values) if values[row].is_nan() => Ok(()),
            Values::Real(values) => write!(text, "{}", values[row]),
            Values::Integer(values) => write!(text, "{}", values[row]),
            Values::Boolean(values) => write!(text, "{}", values[row]),
            Values::Choice(_) | Values::Text(_) => text.write_str(self.word(row).unwrap_or_default()),
        };
        written.expect("a String takes any text");
    }

    /// The value in a row as text.
    pub fn text(&self, row: usize) -> String {
        let mut text = String::new();
        self.write(row, &mut text);
        text
    }

    /// The number in a row. `None` where it is missing, and in a column of another type.
    pub fn number(&self, row: usize) -> Option<f64> {
        match &self.values {
            Values::Real(values) => Some(values[row]).filter(|value| !value.is_nan()),
            Values::Integer(values) => Some(values[row] as f64),
            Values::Boolean(_) | Values::Choice(_) | Values::Text(_) => None,
        }
    }

    /// The word or text in a row; `None` in a column of another type.
    pub fn word(&self, row: usize) -> Option<&str> {
        match (&self.values, &self.heading.kind) {
            (Values::Choice(values), Kind::Choice(words)) => words.get(values[row] as usize).map(String::as_str),
            (Values::Text(values), _) => Some(&values[row]),
            _ => None,
        }
    }

    pub(super) fn append(&mut self, more: Series) {
        match (&mut self.values, more.values) {
            (Values::Real(values), Values::Real(more)) => values.extend(more),
            (Values::Integer(values), Values::Integer(more)) => values.extend(more),
            (Values::Boolean(values), Values::Boolean(more)) => values.extend(more),
            (Values::Choice(values), Values::Choice(more)) => values.extend(more),
            (Values::Text(values), Values::Text(more)) => values.extend(more),
            (values, more) => unreachable!("{more:?} after {values:?}"),
        }
    }

    /// Appends the number of this text to a column of whole numbers, which becomes one of numbers, or returns false if it is none.
    #[must_use]
    pub(super) fn push_as_real(&mut self, text: &str) -> bool {
        let (Values::Integer(values), Some(value)) = (&self.values, number(text)) else { return false };
        self.values = Values::Real(values.iter().map(|value| *value as f64).chain([value]).collect());
        self.heading.kind = Kind::Real;
        true
    }

    /// Appends the value of this text, or returns false if it has none.
    #[must_use]
    pub(super) fn push_text(&mut self, text: &str) -> bool {
        fn push<T>(values: &mut Vec<T>, value: Option<T>) -> bool {
            let is_value = value.is_some();
            values.extend(value);
            is_value
        }
        match (&mut self.values, &self.heading.kind) {
            (Values::Real(values), _) => push(values, number(text)),
            // Other texts of the same number, such as 007, are words.
            (Values::Integer(values), _) => {
                push(values, text.parse().ok().filter(|value: &i64| value.to_string() == text))
            }
            (Values::Boolean(values), _) => push(values, text.parse().ok()),
            (Values::Choice(values), Kind::Choice(words)) => {
                push(values, words.iter().position(|word| word == text).map(|position| position as u32))
            }
            (Values::Text(values), _) => push(values, Some(text.into())),
            (Values::Choice(_), _) => false,
        }
    }
}

/// A table, or a batch of its rows: columns of equal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    columns: Vec<Series>,
    rows: usize,
}

impl Table {
    /// Takes the values of all columns from rows.
    pub fn of<R>(columns: &[TableColumn<R>], rows: &[R]) -> Table {
        Table { columns: columns.iter().map(|column| column.series(rows)).collect(), rows: rows.len() }
    }

    /// A table without rows.
    pub fn new(headings: Vec<Heading>) -> Table {
        Table { columns: headings.into_iter().map(Series::new).collect(), rows: 0 }
    }

    /// A table of columns of equal length.
    pub fn of_series(columns: Vec<Series>) -> Table {
        let rows = columns.first().map_or(0, |column| column.values.len());
        Table { columns, rows }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The columns.
    pub fn columns(&self) -> &[Series] {
        &self.columns
    }

    /// The headings of the columns.
    pub fn headings(&self) -> Vec<Heading> {
        self.columns.iter().map(|column| column.heading.clone()).collect()
    }

    /// The columns, without copying their values.
    pub fn into_columns(self) -> Vec<Series> {
        self.columns
    }

    /// The column with this name.
    pub fn column(&self, name: &str) -> Option<&Series> {
        self.columns.iter().find(|column| column.heading.name == name)
    }

    /// Appends the rows of another batch of this table. A table without columns takes its columns too.
    pub fn append(&mut self, more: Table) {
        if self.columns.is_empty() {
            *self = more;
            return;
        }
        self.rows += more.rows;
        self.columns.iter_mut().zip(more.columns).for_each(|(column, more)| column.append(more));
    }

    /// Takes the rows from this one on out of the table.
    #[cfg(feature = "parquet")]
    pub(super) fn split_off(&mut self, row: usize) -> Table {
        let rows = self.rows - row;
        self.rows = row;
        let columns = self.columns.iter_mut().map(|Series { heading, values }| {
            let values = match values {
                Values::Real(values) => Values::Real(values.split_off(row)),
                Values::Integer(values) => Values::Integer(values.split_off(row)),
                Values::Boolean(values) => Values::Boolean(values.split_off(row)),
                Values::Choice(values) => Values::Choice(values.split_off(row)),
                Values::Text(values) => Values::Text(values.split_off(row)),
            };
            Series { heading: heading.clone(), values }
        });
        Table { columns: columns.collect(), rows }
    }

    /// Puts rows into this order: `order` has the positions of those that are kept.
    pub(super) fn reorder(&mut self, order: &[usize]) {
        fn reorder<T: Clone>(values: &mut Vec<T>, order: &[usize]) {
            *values = order.iter().map(|&row| values[row].clone()).collect();
        }
        self.rows = order.len();
        for column in &mut self.columns {
            match &mut column.values {
                Values::Real(values) => reorder(values, order),
                Values::Integer(values) => reorder(values, order),
                Values::Boolean(values) => reorder(values, order),
                Values::Choice(values) => reorder(values, order),
                Values::Text(values) => reorder(values, order),
            }
        }
    }

    /// Keeps only some of the rows.
    pub fn retain(&mut self, is_kept: &[bool]) {
        let kept: Vec<usize> = (0..self.rows).filter(|&row| is_kept[row]).collect();
        self.reorder(&kept);
    }

    /// Appends a row of texts. On an error the table has lost its last row.
    ///
    /// # Errors
    /// The number of the first field that is no value of its column.
    pub(super) fn push_texts<'a>(&mut self, texts: impl Iterator<Item = &'a str>) -> Result<(), usize> {
        for (number, (column, text)) in self.columns.iter_mut().zip(texts).enumerate() {
            if !column.push_text(text) {
                return Err(number);
            }
        }
        self.rows += 1;
        Ok(())
    }
}

/// Lists of values by the names of the columns. Missing and infinite numbers are null.
impl Serialize for Table {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.columns.len()))?;
        for column in &self.columns {
            let name = &column.heading.name;
            match &column.values {
                Values::Real(values) => map.serialize_entry(name, values)?,
                Values::Integer(values) => map.serialize_entry(name, values)?,
                Values::Boolean(values) => map.serialize_entry(name, values)?,
                Values::Choice(_) | Values::Text(_) => {
                    let words: Vec<Option<&str>> = (0..self.rows).map(|row| column.word(row)).collect();
                    map.serialize_entry(name, &words)?;
                }
            }
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(numbers: &[f64]) -> Table {
        type Of<'c> = TableColumn<'c, f64>;
        let sign = Of::choice("sign", ["minus", "plus"], |number| usize::from(*number > 0.0));
        Table::of(&[Of::real("x", "m", |number| *number), sign, Of::boolean("is_whole", |x| x.fract() == 0.0)], numbers)
    }

    #[test]
    fn batches_append_and_rows_are_kept() {
        let mut all = Table::default();
        all.append(table(&[1.0, -2.5]));
        all.append(table(&[3.0]));
        assert_eq!(all, table(&[1.0, -2.5, 3.0]));
        all.retain(&[false, true, true]);
        assert_eq!(all, table(&[-2.5, 3.0]));
        let sign = all.column("sign").unwrap();
        assert_eq!([0, 1].map(|row| sign.word(row)), [Some("minus"), Some("plus")]);
        assert_eq!((sign.number(0), all.column("x").unwrap().number(0)), (None, Some(-2.5)));
    }

    #[test]
    fn a_table_is_lists_by_names_in_json() {
        let json = serde_json::to_value(table(&[0.5, f64::NAN, -2.0])).unwrap();
        let expected = serde_json::json!({
            "x": [0.5, null, -2.0], "sign": ["plus", "minus", "minus"], "is_whole": [false, false, true]
        });
        assert_eq!(json, expected);
    }
}

#[cfg(test)]
pub(super) mod samples {
    use super::*;

    /// A number, a value and a word.
    pub type Row = (u64, f64, &'static str);

    /// A table with columns of all types.
    pub fn table(rows: &[Row]) -> Table {
        type Of<'c> = TableColumn<'c, Row>;
        let columns = [
            Of::row(|row| row.0),
            Of::real("x", "m/s2", |row| row.1),
            Of::optional("root", "1", |row| (row.1 >= 0.0).then(|| row.1.sqrt())),
            Of::count("length", |row| row.2.len()),
            Of::boolean("is_short", |row| row.2.len() < 3),
            Of::choice("sign", ["minus", "plus, or none"], |row| usize::from(row.1 >= 0.0)),
            Of::text("name", |row| row.2.into()),
        ];
        Table::of(&columns, rows)
    }
}
