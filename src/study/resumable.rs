//! Rows as they are made → a CSV file that an interrupted study goes on with.
//!
//! The file begins with lines that start with `# ` and say what the study is, then the names of the columns, then one line
//! a row. What an interrupted study leaves is a beginning of what it would have become.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufRead, BufReader, Cursor, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::study::place::{Place, PlaceError};

/// Why a table cannot be begun, resumed or written.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// There is one already.
    #[error("{file}: is there already; expected --resume to go on with it, --force to replace it, or another name")]
    Exists {
        /// The file.
        file: String,
    },
    /// What is written into a device or a pipe is not kept there.
    #[error("{file}: cannot be resumed with --resume; expected the file of an interrupted study")]
    NotKept {
        /// The output.
        file: String,
    },
    /// Nothing can be written there.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// It belongs to another study.
    #[error("{file}:{line}: the table is that of another study; found `{found}`, expected `{expected}`")]
    Other {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// What stands there.
        found: String,
        /// What this study would have written.
        expected: String,
    },
    /// It has more rows than the study.
    #[error("{file}: has {found} rows or more; expected at most {expected}")]
    TooLong {
        /// The file.
        file: String,
        /// Complete rows that were counted.
        found: u64,
        /// Rows of the study.
        expected: u64,
    },
    /// A row is not the one that belongs there.
    #[error("{file}:{line}: found `{found}`; expected row {expected} with {columns} columns")]
    Row {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// What stands there.
        found: String,
        /// Number of the row.
        expected: u64,
        /// Number of columns.
        columns: usize,
    },
    /// Another program writes it.
    #[error("{file}: is being written by a study that runs; expected one that was interrupted")]
    Busy {
        /// The file.
        file: String,
    },
    /// The operating system refuses.
    #[error("{file}: cannot be {what}: {error}")]
    Io {
        /// The file.
        file: String,
        /// What was tried.
        what: &'static str,
        /// Its reason.
        error: std::io::Error,
    },
}

/// What stands in a table before its rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    /// What the study is, a line each; all that a result depends on.
    pub study: Vec<String>,
    /// Names of the columns after the first, which is the row's number from 0 and is named `row`.
    pub columns: Vec<String>,
}

impl Head {
    /// The lines as they stand in the file, with their ends.
    fn text(&self) -> std::io::Result<String> {
        let study: String = self.study.iter().map(|line| format!("# {}\n", line.replace(['\n', '\r'], " "))).collect();
        let names = std::iter::once("row".to_string()).chain(self.columns.iter().cloned());
        Ok(study + &csv_line(names)?)
    }
}

/// A table under way.
pub struct ResumableTable {
    name: String,
    sink: Sink,
    rows: u64,
    failures: Failures,
}

/// What the rows are written to; `copy` is what a reader of the table needs who cannot read them from there.
enum Sink {
    File { path: PathBuf, file: File },
    Stream { out: Box<dyn Write>, copy: Option<Vec<u8>> },
}

/// How a table is opened.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Opening {
    /// Resume the table that is there.
    pub resume: bool,
    /// Replace the table that is there.
    pub force: bool,
    /// Let [`ResumableTable::read_back`] read the rows, also those that went into a device, a pipe or standard output.
    pub read_back: bool,
}

/// Rows of runs that failed, which have the word `failed` in a field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Failures {
    /// How many there are.
    pub count: u64,
    /// Number of the first one.
    pub first: u64,
}

impl Failures {
    fn see<'a>(&mut self, row: u64, mut fields: impl Iterator<Item = &'a str>) {
        if fields.any(|field| field == "failed") {
            if self.count == 0 {
                self.first = row;
            }
            self.count += 1;
        }
    }
}

impl ResumableTable {
    /// Begins the table of a study of `rows` rows, or resumes the one that is there. Nothing is changed unless what is
    /// there is the beginning of this very table; the half of a line at its end is removed. A device, a pipe or standard
    /// output is written into and cannot be resumed.
    ///
    /// # Errors
    /// There is a file already, or none that can be resumed; or the operating system refuses.
    pub fn open(path: &Path, head: &Head, rows: u64, opening: Opening) -> Result<ResumableTable, TableError> {
        let Opening { resume, force, read_back } = opening;
        let place = Place::of(path)?;
        let name = place.name(path);
        let io = |what| {
            let file = name.clone();
            move |error| TableError::Io { file, what, error }
        };
        let new = |sink| ResumableTable { name: name.clone(), sink, rows: 0, failures: Failures::default() };
        let Place::File(target) = &place else {
            if resume {
                return Err(TableError::NotKept { file: name });
            }
            let Some(out) = place.open_stream().map_err(io("written"))? else { unreachable!("this is no file") };
            let mut table = new(Sink::Stream { out, copy: read_back.then(Vec::new) });
            table.begin(head)?;
            return Ok(table);
        };
        if target.exists() {
            if !resume && !force {
                return Err(TableError::Exists { file: name });
            }
            let mut file = OpenOptions::new().read(true).write(true).open(target).map_err(io("opened"))?;
            lock(&file, &name)?;
            if force {
                file.set_len(0).map_err(io("written"))?;
            }
            let (length, done, failures) = complete_part(&file, &name, head, rows)?;
            file.set_len(length).map_err(io("written"))?;
            file.seek(SeekFrom::End(0)).map_err(io("written"))?;
            let sink = Sink::File { path: target.clone(), file };
            let mut table = ResumableTable { rows: done, failures, ..new(sink) };
            if length == 0 {
                table.begin(head)?;
            }
            return Ok(table);
        }
        let file = OpenOptions::new().write(true).create_new(true).open(target).map_err(io("written"))?;
        lock(&file, &name)?;
        let mut table = new(Sink::File { path: target.clone(), file });
        table.begin(head)?;
        Ok(table)
    }

    fn begin(&mut self, head: &Head) -> Result<(), TableError> {
        self.write(head.text())
    }

    /// Rows that are complete.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Rows of runs that failed, those that were there before included.
    pub fn failures(&self) -> Failures {
        self.failures
    }

    /// Writes the next row, without its number. It is in the file when this returns.
    pub fn push(&mut self, fields: Vec<String>) -> Result<(), TableError> {
        self.failures.see(self.rows, fields.iter().map(String::as_str));
        self.write(csv_line(std::iter::once(self.rows.to_string()).chain(fields)))?;
        self.rows += 1;
        Ok(())
    }

    /// The text of the table with all rows so far.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read_back(&self) -> Result<Box<dyn Read + '_>, TableError> {
        match &self.sink {
            Sink::File { path, .. } => {
                let opened = File::open(path);
                opened.map(|file| Box::new(file) as Box<dyn Read>).map_err(|error| self.io("read", error))
            }
            Sink::Stream { copy, .. } => Ok(Box::new(Cursor::new(copy.as_deref().unwrap_or_default()))),
        }
    }

    fn write(&mut self, text: std::io::Result<String>) -> Result<(), TableError> {
        let written = text.and_then(|text| match &mut self.sink {
            Sink::File { file, .. } => file.write_all(text.as_bytes()),
            Sink::Stream { out, copy } => {
                let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
                let Some(copy) = copy else { return written };
                copy.extend(text.as_bytes());
                // A pipe that was closed wants no more rows; who reads them back still does.
                written.or_else(|error| if error.kind() == ErrorKind::BrokenPipe { Ok(()) } else { Err(error) })
            }
        });
        written.map_err(|error| self.io("written", error))
    }

    fn io(&self, what: &'static str, error: std::io::Error) -> TableError {
        TableError::Io { file: self.name.clone(), what, error }
    }
}

/// Keeps a second study from writing the file; where files cannot be locked, nobody is kept.
fn lock(file: &File, name: &str) -> Result<(), TableError> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(TableError::Busy { file: name.into() }),
        Err(TryLockError::Error(_)) | Ok(()) => Ok(()),
    }
}

/// Fields as a line of CSV with its end.
fn csv_line(fields: impl Iterator<Item = String>) -> std::io::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(fields.collect::<Vec<_>>())?;
    let bytes = writer.into_inner().map_err(|error| std::io::Error::other(error.to_string()))?;
    String::from_utf8(bytes).map_err(std::io::Error::other)
}

/// Length in bytes of the complete lines of a file that this study began, the number of its rows, and those that failed.
fn complete_part(file: &File, name: &str, head: &Head, rows: u64) -> Result<(u64, u64, Failures), TableError> {
    let failed = |error| TableError::Io { file: name.into(), what: "read", error };
    let mut reader = BufReader::new(file);
    let (mut length, mut done, mut failures) = (0, 0, Failures::default());
    let head_text = head.text().map_err(failed)?;
    let expected: Vec<&str> = head_text.lines().collect();
    let mut line = Vec::new();
    for number in 1.. {
        line.clear();
        // A line of another file may be of any length.
        let longest = 1 << 20;
        (&mut reader).take(longest).read_until(b'\n', &mut line).map_err(failed)?;
        let complete = line.pop_if(|byte| *byte == b'\n').is_some();
        let text = String::from_utf8_lossy(&line);
        let shown = || text.chars().take(120).collect::<String>();
        if let Some(expected) = expected.get(number - 1) {
            let fits = if complete { text == *expected } else { expected.starts_with(&*text) };
            if !fits {
                let expected = expected.to_string();
                return Err(TableError::Other { file: name.into(), line: number, found: shown(), expected });
            }
            if !complete {
                // Nothing was made yet.
                return Ok((0, 0, failures));
            }
        } else {
            if !complete {
                return Ok((length, done, failures));
            }
            if done == rows {
                return Err(TableError::TooLong { file: name.into(), found: rows + 1, expected: rows });
            }
            let columns = head.columns.len() + 1;
            match fields(&line).filter(|fields| fields.len() == columns && fields[0] == done.to_string()) {
                Some(fields) => failures.see(done, fields.iter()),
                None => {
                    let (line, found) = (number, shown());
                    return Err(TableError::Row { file: name.into(), line, found, expected: done, columns });
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
