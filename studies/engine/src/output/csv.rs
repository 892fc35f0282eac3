//! Tables → lines of CSV, and back.

use std::io::{self, Read};
use std::ops::Range;

use csv::{ReaderBuilder, Writer};

use crate::output::table::{Heading, Kind, Table};

/// Returns rows as lines of CSV. Numbers have the digits that restore them exactly.
///
/// # Errors
/// None in practice: the lines are written to memory.
pub fn lines(table: &Table) -> io::Result<String> {
    lines_of(table, 0..table.rows())
}

/// Returns some of the rows as [`lines`] does.
pub(super) fn lines_of(table: &Table, rows: Range<usize>) -> io::Result<String> {
    let mut writer = Writer::from_writer(Vec::with_capacity(256 * rows.len()));
    let mut field = String::with_capacity(32);
    for row in rows {
        for column in table.columns() {
            field.clear();
            column.write(row, &mut field);
            writer.write_field(&field)?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    text(writer)
}

/// Returns lines on a table as comments above its headings.
pub(super) fn comments(lines: &[String]) -> String {
    lines.iter().map(|line| format!("# {}\n", line.replace(['\n', '\r'], " "))).collect()
}

/// Returns the names of columns, with their units, as a line of CSV.
pub(super) fn heading_line(headings: &[Heading]) -> io::Result<String> {
    record_line(&headings.iter().map(Heading::to_string).collect::<Vec<_>>())
}

/// Returns fields as a line of CSV.
pub(super) fn record_line(fields: &[String]) -> io::Result<String> {
    let mut writer = Writer::from_writer(Vec::new());
    writer.write_record(fields)?;
    text(writer)
}

/// Returns a table with its headings as CSV.
///
/// # Errors
/// None in practice: the text is written to memory.
pub fn with_headings(table: &Table) -> io::Result<String> {
    Ok(heading_line(&table.headings())? + &lines(table)?)
}

fn text(writer: Writer<Vec<u8>>) -> io::Result<String> {
    let bytes = writer.into_inner().map_err(csv::IntoInnerError::into_error)?;
    String::from_utf8(bytes).map_err(io::Error::other)
}

/// Rows in a batch that is read.
const BATCH: usize = 4096;

/// Reads the rows of a table with these columns in batches.
///
/// # Errors
/// Those of `take`, and a field that is no value of its column, in words.
pub fn read_batches<E: From<String>>(
    headings: &[Heading],
    content: impl Read,
    mut take: impl FnMut(Table) -> Result<(), E>,
) -> Result<(), E> {
    let empty = Table::new(headings.to_vec());
    let mut table = empty.clone();
    for (row, record) in ReaderBuilder::new().comment(Some(b'#')).from_reader(content).into_records().enumerate() {
        let record = record.map_err(|error| error.to_string())?;
        table.push_texts(record.iter()).map_err(|column| {
            let expected = match &headings[column].kind {
                Kind::Real => "a number".to_string(),
                Kind::Integer => "a whole number".to_string(),
                Kind::Boolean => "true or false".to_string(),
                Kind::Choice(words) => format!("one of {}", words.join(", ")),
                Kind::Text => unreachable!("any text is one"),
            };
            format!("row {row} has {} = {}; expected {expected}", headings[column], &record[column])
        })?;
        if table.rows() == BATCH {
            take(std::mem::replace(&mut table, empty.clone()))?;
        }
    }
    if table.rows() > 0 { take(table) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::table::samples;

    fn table() -> Table {
        samples::table(&[(7, 0.1 + 0.2, "a\"b"), (8, -1e300, ""), (9, f64::INFINITY, "c")])
    }

    #[test]
    fn lines_restore_the_values_of_all_types() {
        let text = with_headings(&table()).unwrap();
        let large = format!("-1{}", "0".repeat(300));
        let expected = [
            "row,x [m/s2],root [1],length [1],is_short,sign,name",
            "7,0.30000000000000004,0.5477225575051662,3,false,\"plus, or none\",\"a\"\"b\"",
            &format!("8,{large},,0,true,minus,"),
            "9,inf,inf,1,true,\"plus, or none\",c\n",
        ];
        assert_eq!(text, expected.join("\n"));
        let mut found = Table::default();
        read_batches(&table().headings(), text.as_bytes(), |batch| {
            found.append(batch);
            Ok::<(), String>(())
        })
        .unwrap();
        // A missing number is no number, and thus equals none.
        assert_eq!((found.rows(), format!("{found:?}")), (3, format!("{:?}", table())));
    }

    #[test]
    fn a_field_that_is_no_value_of_its_column_is_named() {
        let text = with_headings(&table()).unwrap();
        let headings = table().headings();
        let refused = |from: &str, to: &str| {
            read_batches(&headings, text.replacen(from, to, 1).as_bytes(), |_| Ok::<(), String>(())).unwrap_err()
        };
        assert_eq!(refused(",inf,inf,", ",inf,much,"), "row 2 has root [1] = much; expected a number");
        assert_eq!(refused(",inf,inf,", ",inf,NaN,"), "row 2 has root [1] = NaN; expected a number");
        assert_eq!(refused(",0,true", ",0.5,true"), "row 1 has length [1] = 0.5; expected a whole number");
        assert_eq!(refused("0,true", "0,yes"), "row 1 has is_short = yes; expected true or false");
        assert_eq!(refused(",minus,", ",none,"), "row 1 has sign = none; expected one of minus, plus, or none");
    }
}
