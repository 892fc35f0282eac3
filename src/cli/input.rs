//! Names of inputs → their content, `-` for that of standard input.

use std::io::Read;
use std::path::{Path, PathBuf};

use anyhow::Context;

use crate::cli::accelerograms::Accelerograms;
use crate::cli::output::Named;
use crate::records::{self, LARGEST_FILE, ReadOptions, Record, RecordError};
use crate::study::place::STANDARD;

/// What standard input is called in messages.
pub const STANDARD_INPUT: &str = "standard input";

/// Reads a record.
pub fn record(path: &Path, options: &ReadOptions) -> Result<Record, RecordError> {
    if path != Path::new(STANDARD) {
        return records::read(path, options);
    }
    let mut bytes = Vec::new();
    let read = std::io::stdin().lock().take((LARGEST_FILE << 20) + 1).read_to_end(&mut bytes);
    read.map_err(|error| RecordError::Unreadable { file: STANDARD_INPUT.into(), error })?;
    records::parse(STANDARD_INPUT, &bytes, options)
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

/// Refuses two records that are both read from standard input.
pub fn check_one_standard(paths: [&Option<PathBuf>; 2]) -> anyhow::Result<()> {
    let both = paths.iter().all(|path| path.as_deref() == Some(Path::new(STANDARD)));
    anyhow::ensure!(!both, "--record - and --vertical - both read standard input; expected a file for one of them");
    Ok(())
}

/// The records of a command as its inputs.
pub fn of_records(accelerograms: &Accelerograms) -> Vec<Named> {
    let Accelerograms { record, vertical, .. } = accelerograms;
    let records = [("--record", record), ("--vertical", vertical)];
    records.into_iter().filter_map(|(option, path)| Some(Named::new(option, path.as_deref()?))).collect()
}
