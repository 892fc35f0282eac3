//! Rows → a table that an interrupted study can resume, or that is written whole. The former is CSV, the latter CSV or Parquet.
//!
//! The file begins with lines that start with `# ` and describe the study, followed by the names of the columns and one line per
//! row. An interrupted study leaves a prefix of the complete file.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::output::csv::{comments, heading_line, read_batches};
use crate::output::format::TableFormat;
use crate::output::output_target::{OutputTarget, OutputTargetError};
use crate::output::parquet::ParquetWriter;
use crate::output::seal::SealingWriter;
use crate::output::table::{Heading, Table};

/// The reason why a table cannot be created, resumed or written.
#[derive(Debug, thiserror::Error)]
pub enum TableWriteError {
    /// The file holds other rows than those of this study.
    #[error("{0}")]
    OtherRows(String),
    /// The table cannot be used as requested: the file, the fault, and what was expected.
    #[error("{0}")]
    Refused(String),
    /// The output has no valid target.
    #[error(transparent)]
    Target(#[from] OutputTargetError),
    /// The operating system refuses.
    #[error("{file}: cannot be {what}: {error}")]
    Io {
        /// The file.
        file: String,
        /// The attempted action.
        what: &'static str,
        /// The reason given by the operating system.
        error: std::io::Error,
    },
}

/// The description and the columns of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct TableHeader {
    /// Description of the study, line by line, with everything that affects the results.
    pub study: Vec<String>,
    /// The columns; the first is the number of the row, from 0.
    pub columns: Vec<Heading>,
}

impl TableHeader {
    /// The first lines of the file, with their ends.
    ///
    /// # Errors
    /// A name of a column that CSV cannot write.
    pub fn text(&self) -> std::io::Result<String> {
        Ok(comments(&self.study) + &heading_line(&self.columns)?)
    }
}

/// A table in progress.
pub struct ResumableTable {
    name: String,
    sink: Sink,
    rows: u64,
    failures: Failures,
}

/// The destination of the rows.
enum Sink {
    File { path: PathBuf, file: File },
    Stream { out: Box<dyn Write + Send>, outlives_reader: bool },
    Part(SealingWriter<Box<dyn Write + Send>>),
    Parquet(Box<ParquetWriter<Box<dyn Write + Send>>>),
}

/// How a table is opened.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TableOptions {
    /// Resume an existing table.
    pub resume: bool,
    /// Replace an existing table.
    pub force: bool,
    /// Whether rows are made for other receivers after the reader of a pipe closed it.
    pub outlives_reader: bool,
}

/// Rows of failed runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Failures {
    /// Number of rows.
    pub count: u64,
    /// Index of the first.
    pub first: u64,
}

/// The column that tells failed runs, and its word for them.
const OUTCOME: (&str, &str) = ("outcome", "failed");

impl Failures {
    fn count_row(&mut self, row: u64, outcome: Option<&str>) {
        if outcome == Some(OUTCOME.1) {
            if self.count == 0 {
                self.first = row;
            }
            self.count += 1;
        }
    }
}

impl ResumableTable {
    /// Creates the table of a study of `rows` rows, or resumes an existing one.
    ///
    /// An existing file is changed only if it is a prefix of this table; an incomplete last line is removed. A device, a pipe or
    /// standard output cannot be resumed.
    ///
    /// # Errors
    /// The file exists, or cannot be resumed, or the operating system refuses.
    pub fn open(
        path: &Path,
        header: &TableHeader,
        rows: u64,
        options: TableOptions,
    ) -> Result<ResumableTable, TableWriteError> {
        let TableOptions { resume, force, outlives_reader } = options;
        let target = OutputTarget::of(path)?;
        let name = target.name(path);
        let io = |what| {
            let file = name.clone();
            move |error| TableWriteError::Io { file, what, error }
        };
        let OutputTarget::File(file_path) = &target else {
            if resume {
                return Err(TableWriteError::Refused(format!(
                    "{name}: cannot be resumed with --resume; expected the file of an interrupted study"
                )));
            }
            let Some(out) = target.open_stream().map_err(io("written"))? else { unreachable!("not a file") };
            return ResumableTable::begun(name, header, Sink::Stream { out, outlives_reader });
        };
        let exists = file_path.exists();
        if exists && !resume && !force {
            return Err(TableWriteError::Refused(format!(
                "{name}: exists already; expected --resume to continue it, --force to replace it, or another name"
            )));
        }
        let opened = OpenOptions::new().read(true).write(true).create_new(!exists).open(file_path);
        let mut file = opened.map_err(io(if exists { "opened" } else { "written" }))?;
        lock(&file, &name)?;
        if force {
            file.set_len(0).map_err(io("written"))?;
        }
        let (length, rows, failures) = complete_rows(&file, &name, header, rows)?;
        file.set_len(length).map_err(io("written"))?;
        file.seek(SeekFrom::End(0)).map_err(io("written"))?;
        let sink = Sink::File { path: file_path.clone(), file };
        let mut table = ResumableTable { name, sink, rows, failures };
        if length == 0 {
            table.write(header.text())?;
        }
        Ok(table)
    }

    /// Begins a table that is complete or absent, in a format. `name` is its name in errors.
    ///
    /// # Errors
    /// `out` takes no bytes, or the program does not know the format.
    pub fn whole(
        name: &str,
        header: &TableHeader,
        out: Box<dyn Write + Send>,
        format: TableFormat,
    ) -> Result<ResumableTable, TableWriteError> {
        match format {
            TableFormat::Csv => ResumableTable::begun(name.into(), header, Sink::Part(SealingWriter::new(out))),
            TableFormat::Parquet => {
                let writer = ParquetWriter::new(out, &header.study, &header.columns)
                    .map_err(|error| TableWriteError::Refused(format!("{name}: {error}")))?;
                let sink = Sink::Parquet(Box::new(writer));
                Ok(ResumableTable { name: name.into(), sink, rows: 0, failures: Failures::default() })
            }
        }
    }

    fn begun(name: String, header: &TableHeader, sink: Sink) -> Result<ResumableTable, TableWriteError> {
        let mut table = ResumableTable { name, sink, rows: 0, failures: Failures::default() };
        table.write(header.text())?;
        Ok(table)
    }

    /// Writes the end of a table: that of a whole one has a checksum.
    ///
    /// # Errors
    /// The output takes no bytes.
    pub fn finish(self) -> Result<(), TableWriteError> {
        match self.sink {
            Sink::File { .. } | Sink::Stream { .. } => Ok(()),
            Sink::Part(out) => {
                let failed = |error| TableWriteError::Io { file: self.name, what: "written", error };
                out.finish_text().map(|_| ()).map_err(failed)
            }
            Sink::Parquet(writer) => {
                let ended = writer.finish().map(|_| ());
                ended.map_err(|error| TableWriteError::Refused(format!("{}: {error}", self.name)))
            }
        }
    }

    /// Whether it takes rows as lines of text.
    pub(super) fn is_text(&self) -> bool {
        match self.sink {
            Sink::File { .. } | Sink::Stream { .. } | Sink::Part(_) => true,
            Sink::Parquet(_) => false,
        }
    }

    /// Number of complete rows.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Rows of failed runs, including resumed ones.
    pub fn failures(&self) -> Failures {
        self.failures
    }

    /// Passes on the rows that the file had when it was opened, in batches.
    ///
    /// # Errors
    /// Those of `take`; the file cannot be read, or a field is no value of its column.
    pub fn read_resumed(
        &self,
        header: &TableHeader,
        mut take: impl FnMut(Table) -> Result<(), TableWriteError>,
    ) -> Result<(), TableWriteError> {
        let Sink::File { path, .. } = &self.sink else { return Ok(()) };
        let file = File::open(path).map_err(|error| self.io("read", error))?;
        let mut refused = None;
        let read = read_batches(&header.columns, file, |rows| {
            take(rows).map_err(|error| {
                refused = Some(error);
                String::new()
            })
        });
        match (refused, read) {
            (Some(error), _) => Err(error),
            (None, read) => read.map_err(|reason| TableWriteError::Refused(format!("{}: {reason}", self.name))),
        }
    }

    /// Writes the next rows, whose lines these are; on return, they are in the file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn push(&mut self, lines: std::io::Result<String>, rows: &Table) -> Result<(), TableWriteError> {
        match &mut self.sink {
            Sink::File { .. } | Sink::Stream { .. } | Sink::Part(_) => self.write(lines)?,
            Sink::Parquet(writer) => writer
                .push(rows.clone())
                .map_err(|error| TableWriteError::Refused(format!("{}: {error}", self.name)))?,
        }
        let outcome = rows.column(OUTCOME.0);
        for row in 0..rows.rows() {
            self.failures.count_row(self.rows, outcome.and_then(|outcome| outcome.word(row)));
            self.rows += 1;
        }
        Ok(())
    }

    fn write(&mut self, text: std::io::Result<String>) -> Result<(), TableWriteError> {
        let written = text.and_then(|text| match &mut self.sink {
            Sink::File { file, .. } => file.write_all(text.as_bytes()),
            Sink::Part(out) => out.write_all(text.as_bytes()),
            Sink::Stream { out, outlives_reader } => {
                let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
                written.or_else(|error| match error.kind() {
                    ErrorKind::BrokenPipe if *outlives_reader => Ok(()),
                    _ => Err(error),
                })
            }
            Sink::Parquet(_) => unreachable!("a Parquet file takes no text"),
        });
        written.map_err(|error| self.io("written", error))
    }

    fn io(&self, what: &'static str, error: std::io::Error) -> TableWriteError {
        TableWriteError::Io { file: self.name.clone(), what, error }
    }
}

/// Locks the file against a second study; does nothing where files cannot be locked.
fn lock(file: &File, name: &str) -> Result<(), TableWriteError> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(TableWriteError::Refused(format!(
            "{name}: is being written by a running study; expected the file of an interrupted one"
        ))),
        Err(TryLockError::Error(_)) | Ok(()) => Ok(()),
    }
}

/// Length (bytes) of the complete lines of a file begun by this study. The number of its rows and the failed ones follow.
fn complete_rows(
    file: &File,
    name: &str,
    header: &TableHeader,
    rows: u64,
) -> Result<(u64, u64, Failures), TableWriteError> {
    let failed = |error| TableWriteError::Io { file: name.into(), what: "read", error };
    let mut reader = BufReader::new(file);
    let (mut length, mut done, mut failures) = (0, 0, Failures::default());
    let header_text = header.text().map_err(failed)?;
    let expected: Vec<&str> = header_text.lines().collect();
    let outcome = header.columns.iter().position(|heading| heading.name == OUTCOME.0);
    let mut line = Vec::new();
    for number in 1.. {
        line.clear();
        // A line of an unrelated file may have any length.
        let longest = 1 << 20;
        (&mut reader).take(longest).read_until(b'\n', &mut line).map_err(failed)?;
        let complete = line.pop_if(|byte| *byte == b'\n').is_some();
        let text = String::from_utf8_lossy(&line);
        let shown = || text.chars().take(120).collect::<String>();
        if let Some(expected) = expected.get(number - 1) {
            let fits = if complete { text == *expected } else { expected.starts_with(&*text) };
            if !fits {
                let found = shown();
                return Err(TableWriteError::OtherRows(format!(
                    "{name}:{number}: the table is that of another study; found `{found}`, expected `{expected}`"
                )));
            }
            if !complete {
                // The interruption came before the first row.
                return Ok((0, 0, failures));
            }
        } else {
            if !complete {
                return Ok((length, done, failures));
            }
            if done == rows {
                let found = rows + 1;
                let message = format!("{name}: has {found} rows or more; expected at most {rows}");
                return Err(TableWriteError::OtherRows(message));
            }
            let columns = header.columns.len();
            match fields(&line).filter(|fields| fields.len() == columns && fields[0] == done.to_string()) {
                Some(fields) => failures.count_row(done, outcome.and_then(|column| fields.get(column))),
                None => {
                    let found = shown();
                    return Err(TableWriteError::OtherRows(format!(
                        "{name}:{number}: found `{found}`; expected row {done} with {columns} columns"
                    )));
                }
            }
            done += 1;
        }
        length += line.len() as u64 + 1;
    }
    Ok((length, done, failures))
}

fn fields(line: &[u8]) -> Option<csv::StringRecord> {
    csv::ReaderBuilder::new().has_headers(false).from_reader(line).records().next()?.ok()
}
