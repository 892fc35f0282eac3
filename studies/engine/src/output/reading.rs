//! Tables whose columns are not known → typed columns, one file after the other.

use std::collections::HashMap;
use std::fmt::Display;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use crate::output::format::TableFormat;
use crate::output::parquet::{GroupReader, Groups};
use crate::output::table::{Heading, Kind, Series, Table, Values, is_count, split_heading};
use csv::{ReaderBuilder, StringRecord};

/// The reason why a table cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum TableReadError {
    /// The file cannot be opened, or its table is not one of those that are read.
    #[error("{file}: {reason}")]
    Refused {
        /// The table.
        file: String,
        /// The fault, and what was expected.
        reason: String,
    },
    /// The content is no table, or not a whole one.
    #[error("{file}: {reason}")]
    Damaged {
        /// The table.
        file: String,
        /// What was found, and what was expected.
        reason: String,
    },
}

impl TableReadError {
    fn refused(file: &str, reason: String) -> TableReadError {
        TableReadError::Refused { file: file.into(), reason }
    }

    fn damaged(file: &str, reason: String) -> TableReadError {
        TableReadError::Damaged { file: file.into(), reason }
    }
}

/// A table that is read row by row. Columns without words are of numbers, those of counts of whole ones, those of true and false of such
/// values, and others, and the names of records, of words.
pub struct TableReader<'a> {
    /// Whether a column of this name is kept.
    is_wanted: &'a dyn Fn(&str) -> bool,
    /// Headings of all columns, as in the file; none before the first file.
    headings: Vec<String>,
    columns: Vec<Option<ColumnBuilder>>,
    /// The last columns: the keys in the names of the file's folders, with their values.
    keys: Vec<(String, String)>,
    rows: u64,
}

/// The values of a column so far.
enum ColumnBuilder {
    /// Numbers, or whole numbers.
    Numbers(Series),
    Words(Words),
}

/// Words by their positions in the order of their first row.
#[derive(Default)]
struct Words {
    known: HashMap<String, u32>,
    /// The words; a copy that is made anew for new words.
    list: Arc<[String]>,
    positions: Vec<u32>,
}

impl Words {
    fn position(&mut self, word: &str) -> u32 {
        let next = self.known.len() as u32;
        self.known.get(word).copied().unwrap_or_else(|| {
            self.known.insert(word.into(), next);
            next
        })
    }

    fn push(&mut self, word: &str) {
        let position = self.position(word);
        self.positions.push(position);
    }

    fn list(&mut self) -> Arc<[String]> {
        if self.list.len() < self.known.len() {
            let mut list = vec![String::new(); self.known.len()];
            self.known.iter().for_each(|(word, position)| list[*position as usize].clone_from(word));
            self.list = list.into();
        }
        Arc::clone(&self.list)
    }
}

impl ColumnBuilder {
    /// Begins a column of CSV.
    fn of(heading: &str) -> ColumnBuilder {
        match split_heading(heading).0 {
            name if is_count(name) => ColumnBuilder::of_kind(Kind::Integer),
            // The name of a file may be a number.
            name if NAMES.contains(&name) => ColumnBuilder::of_kind(Kind::Text),
            _ => ColumnBuilder::of_kind(Kind::Real),
        }
    }

    /// Begins a column of numbers, or of words for other values.
    fn of_kind(kind: Kind) -> ColumnBuilder {
        match kind {
            Kind::Real | Kind::Integer => {
                ColumnBuilder::Numbers(Series::new(Heading { name: String::new(), unit: None, kind }))
            }
            Kind::Boolean | Kind::Choice(_) | Kind::Text => ColumnBuilder::Words(Words::default()),
        }
    }

    fn push_text(&mut self, text: &str) {
        let is_number = match self {
            ColumnBuilder::Numbers(series) => series.push_text(text) || series.push_as_real(text),
            ColumnBuilder::Words(_) => false,
        };
        if !is_number {
            self.push_word(text);
        }
    }

    /// Makes the column one of words, and appends a word.
    fn push_word(&mut self, text: &str) {
        if let ColumnBuilder::Numbers(earlier) = self {
            let mut words = Words::default();
            (0..earlier.values.len()).for_each(|row| words.push(&earlier.text(row)));
            *self = ColumnBuilder::Words(words);
        }
        let ColumnBuilder::Words(words) = self else { unreachable!("made one above") };
        words.push(text);
    }

    /// Moves the values into a column with this heading. The words stay.
    fn take(&mut self, heading: &str) -> Series {
        let (kind, values) = match self {
            ColumnBuilder::Numbers(series) => {
                let empty = Series::new(series.heading.clone());
                let Series { heading, values } = std::mem::replace(series, empty);
                (heading.kind, values)
            }
            ColumnBuilder::Words(words) => {
                let (list, positions) = (words.list(), std::mem::take(&mut words.positions));
                let is_boolean = list.iter().all(|word| word == "true" || word == "false");
                match is_boolean && !list.is_empty() && !NAMES.contains(&heading) {
                    true => {
                        let is_true = |position: u32| list[position as usize] == "true";
                        (Kind::Boolean, Values::Boolean(positions.into_iter().map(is_true).collect()))
                    }
                    false => (Kind::Choice(list), Values::Choice(positions)),
                }
            }
        };
        let (name, unit) = split_heading(heading);
        Series { heading: Heading { name: name.into(), unit: unit.map(String::from), kind }, values }
    }

    /// Appends the values of a typed column.
    fn append(&mut self, more: Series) {
        match (&mut *self, &more.values, &more.heading.kind) {
            (ColumnBuilder::Numbers(series), _, kind) if series.heading.kind == *kind => series.append(more),
            (ColumnBuilder::Words(words), Values::Choice(more), Kind::Choice(list)) => {
                let known: Vec<u32> = list.iter().map(|word| words.position(word)).collect();
                words.positions.extend(more.iter().map(|position| known[*position as usize]));
            }
            _ => (0..more.values.len()).for_each(|row| self.push_word(&more.text(row))),
        }
    }
}

/// The rows of a file that are still to be read.
pub(super) struct FileRows<'c> {
    file: String,
    /// Number of rows of the files before.
    before: u64,
    content: Content<'c>,
}

enum Content<'c> {
    Csv { reader: Box<csv::Reader<Box<dyn Read + 'c>>>, header: StringRecord, is_over: bool },
    Parquet { groups: Groups, next: usize, group: Option<GroupReader> },
}

/// Columns with the names of files and motions.
const NAMES: [&str; 4] = ["record", "record_y", "vertical", "motion"];

/// Column of the numbers of rows.
pub(super) const ROW: &str = "row";

/// Rows of a batch.
const BATCH: u64 = 1 << 16;

impl<'a> TableReader<'a> {
    /// Keeps the columns with wanted names.
    pub fn new(is_wanted: &'a dyn Fn(&str) -> bool) -> TableReader<'a> {
        TableReader { is_wanted, headings: Vec::new(), columns: Vec::new(), keys: Vec::new(), rows: 0 }
    }

    /// Gives the rows of the next file a column for each key that it lacks.
    pub(super) fn set_keys(&mut self, keys: &[(String, String)]) {
        self.keys = keys.to_vec();
    }

    /// Number of rows so far.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Checks the headings of a further file. The first gives the headings, with columns of these kinds.
    fn begin(
        &mut self,
        file: &str,
        mut headings: Vec<String>,
        column: impl Fn(usize, &str) -> ColumnBuilder,
    ) -> Result<(), TableReadError> {
        self.keys.retain(|(name, _)| headings.iter().all(|heading| split_heading(heading).0 != name));
        let of_file = headings.len();
        headings.extend(self.keys.iter().map(|(name, _)| name.clone()));
        if self.headings.is_empty() {
            let column = |number, heading: &str| {
                if number < of_file { column(number, heading) } else { ColumnBuilder::of(heading) }
            };
            let kept = |(number, heading): (usize, &String)| {
                (self.is_wanted)(split_heading(heading).0).then(|| column(number, heading))
            };
            self.columns = headings.iter().enumerate().map(kept).collect();
            self.headings = headings;
        } else if self.headings != headings {
            let [found, expected] = [headings, self.headings.clone()].map(|headings| headings.join(", "));
            let reason = format!("has the columns {found}; expected those of the first table, {expected}");
            return Err(TableReadError::refused(file, reason));
        }
        Ok(())
    }

    /// Records rows whose fields are already in the columns, and gives them their keys.
    fn end_rows(&mut self, rows: usize) {
        let of_file = self.columns.len() - self.keys.len();
        for (column, (_, value)) in self.columns[of_file..].iter_mut().zip(&self.keys) {
            if let Some(column) = column {
                (0..rows).for_each(|_| column.push_text(value));
            }
        }
        self.rows += rows as u64;
    }

    /// Appends the rows of a table in CSV.
    ///
    /// # Errors
    /// A row with the wrong number of fields or with the headings, invalid UTF-8, or other columns than before.
    pub fn read_csv(&mut self, file: &str, content: impl Read) -> Result<(), TableReadError> {
        let mut rows = self.begin_csv(file, content)?;
        while self.next_batch(&mut rows)? {}
        Ok(())
    }

    /// Begins a file, in CSV or Parquet by its name.
    ///
    /// # Errors
    /// The file cannot be read, or has other columns than before.
    pub(super) fn begin_file(&mut self, path: &Path) -> Result<FileRows<'static>, TableReadError> {
        let file = path.display().to_string();
        let content =
            File::open(path).map_err(|error| TableReadError::refused(&file, format!("cannot be read: {error}")))?;
        match TableFormat::of(path) {
            TableFormat::Csv => self.begin_csv(&file, content),
            TableFormat::Parquet => self.begin_parquet(&file, content),
        }
    }

    fn begin_csv<'c>(&mut self, file: &str, content: impl Read + 'c) -> Result<FileRows<'c>, TableReadError> {
        let content: Box<dyn Read + 'c> = Box::new(content);
        let mut reader = Box::new(ReaderBuilder::new().comment(Some(b'#')).from_reader(content));
        let header = reader.headers().map_err(|error| damaged_csv(file, &error))?.clone();
        if header.is_empty() {
            let reason = "found no lines; expected a table of `rocking sweep`".into();
            return Err(TableReadError::damaged(file, reason));
        }
        self.begin(file, header.iter().map(String::from).collect(), |_, heading| ColumnBuilder::of(heading))?;
        Ok(FileRows { file: file.into(), before: self.rows, content: Content::Csv { reader, header, is_over: false } })
    }

    fn begin_parquet(&mut self, file: &str, content: File) -> Result<FileRows<'static>, TableReadError> {
        let groups = Groups::new(content).map_err(|error| not_parquet(file, error))?;
        let headings = groups.headings.iter().map(Heading::to_string).collect();
        self.begin(file, headings, |number, _| ColumnBuilder::of_kind(groups.headings[number].kind.clone()))?;
        let content = Content::Parquet { groups, next: 0, group: None };
        Ok(FileRows { file: file.into(), before: self.rows, content })
    }

    /// Appends the next rows of a file; returns whether there were any, or the end of a table in CSV.
    ///
    /// # Errors
    /// The content is damaged.
    pub(super) fn next_batch(
        &mut self,
        FileRows { file, before, content }: &mut FileRows,
    ) -> Result<bool, TableReadError> {
        match content {
            Content::Csv { is_over: true, .. } => Ok(false),
            Content::Csv { reader, header, is_over } => {
                let mut record = StringRecord::new();
                while reader.read_record(&mut record).map_err(|error| damaged_csv(file, &error))? {
                    if record == *header {
                        let rows = self.rows - *before;
                        return Err(TableReadError::damaged(
                            file,
                            format!(
                                "repeats its headings after {rows} rows, as in tables joined by cat; expected one table"
                            ),
                        ));
                    }
                    for (column, text) in self.columns.iter_mut().zip(&record) {
                        if let Some(column) = column {
                            column.push_text(text);
                        }
                    }
                    self.end_rows(1);
                    if (self.rows - *before).is_multiple_of(BATCH) {
                        return Ok(true);
                    }
                }
                *is_over = true;
                Ok(true)
            }
            Content::Parquet { groups, next, group } => loop {
                let read = group.as_mut().map(|group| group.next(BATCH as usize)).transpose();
                if let Some((rows, columns)) = read.map_err(|error| not_parquet(file, error))?.flatten() {
                    self.columns.iter_mut().flatten().zip(columns).for_each(|(column, more)| column.append(more));
                    self.end_rows(rows);
                    return Ok(true);
                }
                if *next == groups.count() {
                    return Ok(false);
                }
                let is_wanted: Vec<bool> = self.columns.iter().map(Option::is_some).collect();
                *group = Some(groups.group(*next, &is_wanted).map_err(|error| not_parquet(file, error))?);
                *next += 1;
            },
        }
    }

    /// The values of the column `row` in the last rows, if it is one of whole numbers.
    pub(super) fn last_numbers(&self, rows: u64) -> Option<&[i64]> {
        let number = self.headings.iter().position(|heading| heading == ROW)?;
        match self.columns.get(number)? {
            Some(ColumnBuilder::Numbers(Series { values: Values::Integer(values), .. })) => {
                values.get(values.len().checked_sub(rows as usize)?..)
            }
            _ => None,
        }
    }

    /// Headings of all columns.
    pub fn headings(&self) -> &[String] {
        &self.headings
    }

    /// Returns the table of the wanted columns.
    pub fn table(mut self) -> Table {
        self.take()
    }

    /// Takes the rows since the last call. All tables share the words of their columns.
    pub(super) fn take(&mut self) -> Table {
        let columns = self.headings.iter().zip(&mut self.columns);
        Table::of_series(columns.filter_map(|(heading, column)| Some(column.as_mut()?.take(heading))).collect())
    }
}

/// The error of a table in CSV.
fn damaged_csv(file: &str, error: &csv::Error) -> TableReadError {
    let reason = match *error.kind() {
        csv::ErrorKind::UnequalLengths { ref pos, expected_len: expected, len: found } => {
            let row = pos.as_ref().map_or(0, |place| place.record().saturating_sub(1));
            format!("row {row} has {found} fields; expected {expected}, as in the heading")
        }
        csv::ErrorKind::Utf8 { .. } => "found no text; expected a table of `rocking sweep`, as CSV or Parquet".into(),
        _ => format!("cannot be read as CSV: {error}"),
    };
    TableReadError::damaged(file, reason)
}

/// Returns the description in a Parquet file, line by line.
pub(super) fn parquet_description(file: &str, content: File) -> Result<Vec<String>, TableReadError> {
    Ok(Groups::new(content).map_err(|error| not_parquet(file, error))?.study())
}

fn not_parquet(file: &str, error: impl Display) -> TableReadError {
    match TableFormat::Parquet.check() {
        Ok(()) => TableReadError::damaged(file, format!("cannot be read as Parquet: {error}")),
        Err(unknown) => TableReadError::refused(file, format!("cannot be read: {unknown}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# a study\nrow,x,record,ranges [m/s]\n0,1.5,1,0.25\n1,,2,0.1 to 0.2\n2,-3,1,\n";

    fn read(files: &[&str], is_wanted: &dyn Fn(&str) -> bool) -> Result<Table, TableReadError> {
        let mut reader = TableReader::new(is_wanted);
        files.iter().try_for_each(|text| reader.read_csv("t.csv", text.as_bytes()))?;
        Ok(reader.table())
    }

    #[test]
    fn columns_are_of_numbers_where_there_are_no_words() {
        let table = read(&[TEXT], &|_| true).unwrap();
        let words = |words: &[&str]| Kind::Choice(words.iter().map(ToString::to_string).collect());
        let kinds: Vec<Kind> = table.columns().iter().map(|column| column.heading.kind.clone()).collect();
        assert_eq!(kinds, [Kind::Integer, Kind::Real, words(&["1", "2"]), words(&["0.25", "0.1 to 0.2", ""])]);
        let Values::Real(x) = &table.columns()[1].values else { panic!("{table:?}") };
        assert!(x[0] == 1.5 && x[1].is_nan() && x[2] == -3.0);
        let shown: Vec<String> = (0..3).map(|row| table.columns()[3].text(row)).collect();
        assert_eq!(shown, ["0.25", "0.1 to 0.2", ""]);
    }

    #[test]
    fn further_files_append_rows_and_unwanted_columns_are_dropped() {
        let table = read(&[TEXT, TEXT], &|name| name != "record").unwrap();
        assert_eq!((table.rows(), table.columns().len()), (6, 3));
        assert_eq!(table.column("ranges").unwrap().text(4), "0.1 to 0.2");
    }

    /// The same types as in the study that made the table. A count that is missing makes its column one of numbers.
    #[test]
    fn counts_and_true_and_false_have_their_types() {
        let kinds = |text: &str| {
            let table = read(&[text], &|_| true).unwrap();
            table.columns().iter().map(|column| (column.heading.kind.clone(), column.text(1))).collect::<Vec<_>>()
        };
        let found = kinds("events.impacts [1],separated,record,flights [1]\n3,true,true,\n4,false,false,2\n");
        let record = Kind::Choice(["true".into(), "false".into()].into());
        let expected = [(Kind::Integer, "4"), (Kind::Boolean, "false"), (record, "false"), (Kind::Real, "2")];
        assert_eq!(found, expected.map(|(kind, text)| (kind, text.to_string())));
    }

    #[test]
    fn what_is_not_one_table_is_refused() {
        let message = |files: &[&str]| read(files, &|_| true).unwrap_err().to_string();
        assert_eq!(
            message(&[&TEXT.repeat(2)]),
            "t.csv: repeats its headings after 3 rows, as in tables joined by cat; expected one table"
        );
        let other = message(&[TEXT, "row,y [m]\n0,1\n"]);
        assert!(
            other.starts_with("t.csv: has the columns row, y [m]; expected those of the first table, row, x, record")
        );
        assert_eq!(message(&["a,b\n1,2\n1\n"]), "t.csv: row 1 has 1 fields; expected 2, as in the heading");
        assert!(message(&["# a study\n"]).starts_with("t.csv: found no lines"));
    }
}
