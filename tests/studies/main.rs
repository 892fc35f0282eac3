//! Studies of many blocks, as a user runs them: spectra, sweeps, searches.

#![cfg(feature = "program")]

mod coming_down;
mod figures;
mod findings;
mod fragility;
mod friction;
mod lanes;
mod search;
#[path = "../common/skipped.rs"]
mod skipped;
mod spectrum;
mod strengths;
mod sweep;

use std::path::Path;
use std::process::{Command, Output};

/// A pulse under which some blocks separate, some fall over, and some do neither.
pub const PULSE: [&str; 6] = ["--pulse", "one-sine", "--amplitude", "6.2622", "--period", "1.2566370614359172"];

/// Runs the program.
pub fn rocking(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rocking")).args(arguments).current_dir(folder).output().unwrap()
}

/// Runs what must succeed.
#[track_caller]
pub fn made(folder: &Path, arguments: &[&str]) -> String {
    let output = rocking(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs what must be refused: one line with these words, status 1, nothing on standard output.
#[track_caller]
pub fn refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    let output = rocking(folder, arguments);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {told}");
    assert_eq!(told.lines().count(), 1, "{told}");
    for word in words {
        assert!(told.contains(word), "`{word}` is not in: {told}");
    }
    assert!(output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stdout));
}

/// A table without the lines that say what it is: rows by the names of their columns.
pub struct Table {
    /// Names of its columns.
    pub headers: csv::StringRecord,
    /// Its rows.
    pub rows: Vec<csv::StringRecord>,
}

impl Table {
    /// Reads it.
    pub fn read(path: &Path) -> Table {
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).unwrap();
        let headers = reader.headers().unwrap().clone();
        Table { headers, rows: reader.records().map(Result::unwrap).collect() }
    }

    /// What stands in a row and a column.
    #[track_caller]
    pub fn get(&self, row: usize, column: &str) -> &str {
        let place = self.headers.iter().position(|header| header == column);
        &self.rows[row][place.unwrap_or_else(|| panic!("no column {column} in {:?}", self.headers))]
    }

    /// The number that stands there.
    #[track_caller]
    pub fn number(&self, row: usize, column: &str) -> f64 {
        let text = self.get(row, column);
        text.parse().unwrap_or_else(|_| panic!("{column} = {text} in row {row}"))
    }
}

/// Names of the files of a folder.
pub fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// A study that was interrupted at any byte and goes on ends in the same bytes.
#[track_caller]
pub fn resumes_to_the_same_bytes(folder: &Path, arguments: &[&str], whole: &str) {
    let bytes = std::fs::read(folder.join(whole)).unwrap();
    let text = String::from_utf8(bytes.clone()).unwrap();
    let line_ends: Vec<usize> = text.match_indices('\n').map(|(i, _)| i + 1).collect();
    let first_row = line_ends[text.lines().position(|line| line.starts_with("row,")).unwrap()];
    let (middle, last) = (line_ends[line_ends.len() - 4], text.len());
    let half = (middle + line_ends[line_ends.len() - 3]) / 2;
    // Nothing, half of the head, no row, whole rows, the number of a row alone, half a row, all but the last line's end.
    for length in [0, 30, first_row, middle, middle + 1, half, last - 1, last] {
        std::fs::write(folder.join("cut.csv"), &bytes[..length]).unwrap();
        let told = made(folder, &[arguments, &["--csv", "cut.csv", "--resume"]].concat());
        assert!(std::fs::read(folder.join("cut.csv")).unwrap() == bytes, "cut at byte {length} of {last}");
        let there = line_ends.iter().filter(|end| **end <= length && **end > first_row).count();
        assert!(told.contains(&format!("of which {there} were there")), "cut at byte {length}: {told}");
    }
}

/// The labels of a drawing, subscripts in line with the rest.
pub fn labels(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let texts = document.descendants().filter(|node| node.has_tag_name("text"));
    texts
        .map(|node| {
            let parts = node.descendants().filter(|part| part.is_text()).filter_map(|part| part.text());
            parts.collect::<String>().trim().to_string()
        })
        .collect()
}
