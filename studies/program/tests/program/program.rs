//! The program, its output and its tables, as the tests need them.

use std::path::Path;
use std::process::{Command, Output};

/// A record in the public domain, in USGS SMC format.
pub const RECORD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/records/np01002p_4225a_a.smc");

/// The command that runs the program in a folder, with its arguments in parts.
pub fn program(folder: &Path, arguments: &[&[&str]]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rocking"));
    command.args(arguments.concat()).current_dir(folder);
    command
}

/// Runs the program.
pub fn rocking(folder: &Path, arguments: &[&str]) -> Output {
    program(folder, &[arguments]).output().unwrap()
}

/// Runs a command that must succeed; returns its standard output and standard error.
#[track_caller]
pub fn succeeds(command: &mut Command) -> (String, String) {
    let Output { status, stdout, stderr } = command.output().unwrap();
    assert!(status.success(), "{command:?}: {}", text(&stderr));
    (text(&stdout), text(&stderr))
}

/// Runs the program, which must succeed; returns its standard output.
#[track_caller]
pub fn stdout(folder: &Path, arguments: &[&str]) -> String {
    succeeds(&mut program(folder, &[arguments])).0
}

/// Runs a command that must fail with status 1 and one line; returns the line without the name of the program.
#[track_caller]
pub fn fails(command: &mut Command) -> String {
    let Output { status, stdout, stderr } = command.output().unwrap();
    let line = text(&stderr);
    assert_eq!(status.code(), Some(1), "{command:?}: {status}: {line}");
    assert_eq!(line.lines().count(), 1, "{command:?}: {line}");
    // The names of temporary files are no use to a user.
    assert!(!line.contains(".tmp"), "{line}");
    assert_eq!(text(&stdout), "");
    line.strip_prefix("rocking: ").unwrap().trim_end().to_string()
}

/// Runs the program, which must fail; returns its message.
#[track_caller]
pub fn refusal(folder: &Path, arguments: &[&str]) -> String {
    fails(&mut program(folder, &[arguments]))
}

/// Runs a command that must fail with all of these words in its message.
#[track_caller]
pub fn fails_with(command: &mut Command, words: &[&str]) {
    let line = fails(command);
    for word in words {
        assert!(line.contains(word), "{command:?}: `{word}` is not in: {line}");
    }
}

/// Runs the program, which must fail with all of these words in its message.
#[track_caller]
pub fn refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    fails_with(&mut program(folder, &[arguments]), words);
}

/// UTF-8 output as text.
#[track_caller]
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A table without its comment lines.
pub struct Table {
    /// Column headings.
    pub headers: csv::StringRecord,
    /// Rows.
    pub rows: Vec<csv::StringRecord>,
}

impl Table {
    /// Reads a CSV file.
    pub fn read(path: &Path) -> Table {
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).unwrap();
        let headers = reader.headers().unwrap().clone();
        Table { headers, rows: reader.records().map(Result::unwrap).collect() }
    }

    /// Field in a row, by the heading of its column with or without the unit.
    #[track_caller]
    pub fn get(&self, row: usize, column: &str) -> &str {
        let is_named = |header: &str| header == column || header.split(" [").next() == Some(column);
        let place = self.headers.iter().position(is_named);
        &self.rows[row][place.unwrap_or_else(|| panic!("no column {column} in {:?}", self.headers))]
    }

    /// Number in a row and a column.
    #[track_caller]
    pub fn number(&self, row: usize, column: &str) -> f64 {
        let text = self.get(row, column);
        text.parse().unwrap_or_else(|_| panic!("{column} = {text} in row {row}"))
    }

    /// All numbers of a column.
    #[track_caller]
    pub fn column(&self, name: &str) -> Vec<f64> {
        (0..self.rows.len()).map(|row| self.number(row, name)).collect()
    }
}

/// Names of the files in a folder, sorted.
pub fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
