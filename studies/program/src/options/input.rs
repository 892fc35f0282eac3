//! Path, or `-` for standard input → content.

use std::io::Read;
use std::path::Path;

use anyhow::Context;

use rocking_records::{LARGEST_FILE, ReadOptions, Record, RecordError};
use rocking_studies::output::output_target::STANDARD;

/// Name of standard input in messages.
pub const STANDARD_INPUT: &str = "standard input";

/// Reads a record, and warns on standard error if its content is doubtful.
pub fn record(path: &Path, options: &ReadOptions) -> Result<Record, RecordError> {
    let (name, bytes) = match path == Path::new(STANDARD) {
        true => (STANDARD_INPUT.into(), standard_input()?),
        false => (path.display().to_string(), rocking_records::bytes(path)?),
    };
    let (record, doubt) = rocking_records::parse_with_doubt(&name, &bytes, options)?;
    if let Some(why) = doubt {
        eprintln!("rocking: warning: {name}: {why}");
    }
    Ok(record)
}

fn standard_input() -> Result<Vec<u8>, RecordError> {
    let mut bytes = Vec::new();
    let read = std::io::stdin().lock().take((LARGEST_FILE << 20) + 1).read_to_end(&mut bytes);
    read.map_err(|error| RecordError::Unreadable { file: STANDARD_INPUT.into(), error })?;
    Ok(bytes)
}

/// Reads a text; returns its name in messages, and its content.
pub fn text(path: &Path) -> anyhow::Result<(String, String)> {
    let (name, text) = if path == Path::new(STANDARD) {
        (STANDARD_INPUT.into(), std::io::read_to_string(std::io::stdin()))
    } else {
        (path.display().to_string(), std::fs::read_to_string(path))
    };
    let text = text.with_context(|| format!("{name}: cannot be read"))?;
    Ok((name, text))
}

/// Refuses to read more than one record from standard input. The records come with the options that name them.
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
