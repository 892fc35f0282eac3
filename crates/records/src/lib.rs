//! Accelerogram files → evenly spaced ground accelerations in m/s².
//!
//! [`read`] detects the format from the content and returns a [`Record`], a piecewise linear ground acceleration. Missing
//! information (unit, time step) comes from [`ReadOptions`]; the statements of the file must agree with them. A file that
//! cannot be read completely and without doubt is refused with a [`RecordError`] of one line.
//!
//! | module | in → out |
//! | --- | --- |
//! | `unit`, `format` | words → unit, format |
//! | `options` | the caller's knowledge of a file |
//! | `error` | file, line, found, expected → a message of one line |
//! | `processing` | changes to a record, in words |
//! | `record` | samples → accelerations at any time, peak |
//! | `filter` | a record → without its trend, filtered, with another time step |
//! | `text` | bytes → lines and numbers |
//! | `raw` | content of a file in its own unit, options → a record |
//! | `time_axis` | column of times → start and time step |
//! | `channels` | file of several channels → the lines of one |
//! | `table` | lines → separator, header row, first row of numbers |
//! | `peer`, `smc`, `columns`, `cosmos`, `csmip`, `esm` | lines of a format → raw content |
//! | `plausibility` | table without names → a reason for doubt |

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod unit;

mod format;

mod options;

mod error;

mod processing;

mod record;

mod filter;

mod text;

mod raw;

mod time_axis;

mod channels;

mod table;

mod peer;

mod smc;

mod columns;

mod cosmos;

mod csmip;

mod esm;

mod plausibility;

use std::{fs::File, io::Read, path::Path};

pub use error::RecordError;
pub use format::{Format, UnknownFormat};
pub use options::{Column, ReadOptions, Setting};
pub use plausibility::implausibility;
pub use processing::Processing;
pub use record::{Peak, Record};
pub use unit::{Unit, UnknownUnit};

use text::FileText;

/// Largest file that is read (MiB); the longest accelerograms have 10⁶ values, a few tens of MiB.
pub const LARGEST_FILE: u64 = 512;

/// Reads an accelerogram file.
///
/// # Errors
/// [`RecordError::Unreadable`] and [`RecordError::TooLarge`] before the content is examined, then those of [`parse`].
pub fn read(path: &Path, options: &ReadOptions) -> Result<Record, RecordError> {
    parse(&path.display().to_string(), &bytes(path)?, options)
}

/// Reads the bytes of a file, up to one more than [`parse`] accepts.
///
/// # Errors
/// [`RecordError::Unreadable`].
pub fn bytes(path: &Path) -> Result<Vec<u8>, RecordError> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take((LARGEST_FILE << 20) + 1).read_to_end(&mut bytes))
        .map_err(|error| RecordError::Unreadable { file: path.display().to_string(), error })?;
    Ok(bytes)
}

/// Reads an accelerogram from the bytes of its file.
///
/// `name` names the file in errors and replaces a missing title. Text that is not UTF-8 is read as Latin-1, which real headers
/// contain.
///
/// # Errors
/// The file is not an accelerogram, is incomplete, disagrees with `options`, or leaves a choice that `options` does not make.
pub fn parse(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Record, RecordError> {
    if bytes.len() as u64 > LARGEST_FILE << 20 {
        return Err(RecordError::TooLarge { file: name.to_owned(), limit: LARGEST_FILE });
    }
    for (option, value) in [("time step", options.time_step), ("gravity", Some(options.gravity))] {
        if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
            let (file, value) = (name.to_owned(), value.to_string());
            return Err(RecordError::Option { file, option, value, expected: "a finite number above 0" });
        }
    }
    let source = FileText::new(name, bytes)?;
    let format = match options.format {
        Some(format) => format,
        None => detect(&source, options)?,
    };
    let raw = match format {
        Format::Peer => peer::read(&source),
        Format::Smc => smc::read(&source),
        Format::Columns => columns::read(&source, options),
        Format::Cosmos => cosmos::read(&source, &channels::choose(&source, options.channel)?),
        Format::Csmip => csmip::read(&source, &channels::choose(&source, options.channel)?),
        Format::Esm => esm::read(&source),
    }?;
    let record = raw.into_record(&source, options)?;
    options.processing.apply(record).map_err(|message| RecordError::Processing { file: name.to_owned(), message })
}

/// Detects the format by a line that only this format has, otherwise by the layout of the numbers.
fn detect(source: &FileText<'_>, options: &ReadOptions) -> Result<Format, RecordError> {
    let head = source.head();
    let first = head.first().copied().unwrap_or_default();
    let columns_chosen = options.time_column.is_some() || options.acceleration_column.is_some();
    if csmip::is_volume_one(first) {
        return Err(RecordError::NotRead {
            file: source.name.clone(),
            line: 1,
            found: "an uncorrected CSMIP accelerogram (volume 1), not evenly spaced",
            expected: "the corrected record (volume 2)",
        });
    }
    Ok(if smc::is_first_line(first) {
        Format::Smc
    } else if cosmos::is_first_line(first) {
        Format::Cosmos
    } else if head.iter().any(|line| esm::is_header_line(line)) {
        Format::Esm
    } else if head.iter().any(|line| csmip::is_block_line(line)) {
        Format::Csmip
    } else if head.iter().any(|line| peer::has_npts(line)) || !columns_chosen && table::is_block(&head) {
        Format::Peer
    } else {
        Format::Columns
    })
}
