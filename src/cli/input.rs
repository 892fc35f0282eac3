//! Names of inputs → their content, `-` for that of standard input.

use std::io::Read;
use std::path::Path;

use anyhow::Context;

use crate::records::{self, LARGEST_FILE, ReadOptions, Record, RecordError};
use crate::study::place::STANDARD;

/// What standard input is called in messages.
pub const STANDARD_INPUT: &str = "standard input";

/// Reads a record. A table without names whose numbers can hardly be accelerations gets a warning on standard error.
pub fn record(path: &Path, options: &ReadOptions) -> Result<Record, RecordError> {
    let (name, bytes) = match path == Path::new(STANDARD) {
        true => (STANDARD_INPUT.into(), standard_input()?),
        false => (path.display().to_string(), records::bytes(path)?),
    };
    let record = records::parse(&name, &bytes, options)?;
    if let Some(why) = records::doubt(&bytes, &record) {
        eprintln!("rocking: warning: {name}: nothing names its numbers, and {why}; expected accelerations");
    }
    Ok(record)
}

fn standard_input() -> Result<Vec<u8>, RecordError> {
    let mut bytes = Vec::new();
    let read = std::io::stdin().lock().take((LARGEST_FILE << 20) + 1).read_to_end(&mut bytes);
    read.map_err(|error| RecordError::Unreadable { file: STANDARD_INPUT.into(), error })?;
    Ok(bytes)
}

/// Reads a text, and tells its name in messages.
pub fn text(path: &Path) -> anyhow::Result<(String, String)> {
    let (name, text) = if path == Path::new(STANDARD) {
        (STANDARD_INPUT.into(), std::io::read_to_string(std::io::stdin()))
    } else {
        (path.display().to_string(), std::fs::read_to_string(path))
    };
    let text = text.with_context(|| format!("{name}: cannot be read"))?;
    Ok((name, text))
}

/// Refuses records, with the options that name them, of which more than one is read from standard input.
pub fn check_one_standard<'a>(records: impl Iterator<Item = (&'static str, &'a Path)>) -> anyhow::Result<()> {
    let standard = records.filter(|(_, path)| *path == Path::new(STANDARD));
    let options: Vec<String> = standard.map(|(option, _)| format!("{option} -")).collect();
    anyhow::ensure!(
        options.len() < 2,
        "{}: {STANDARD_INPUT} holds one record; expected files for the others",
        options.join(" and ")
    );
    Ok(())
}
