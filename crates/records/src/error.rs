//! Errors of accelerogram files: one line with file, line, found and expected content.

use std::fmt;

use super::options::Setting;
use super::unit::Unit;

/// Reason for refusing a file. Every message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The operating system cannot read the file.
    #[error("{file}: cannot be read: {error}")]
    Unreadable {
        /// Name of the file.
        file: String,
        /// Error of the operating system, part of the message; as a `source` it would appear twice.
        error: std::io::Error,
    },
    /// The file is larger than any accelerogram.
    #[error("{file}: more than {limit} MiB, expected one accelerogram")]
    TooLarge {
        /// Name of the file.
        file: String,
        /// Largest accepted size (MiB).
        limit: u64,
    },
    /// An option is invalid for any file.
    #[error("{file}: {option} = {value}; expected {expected}")]
    Option {
        /// Name of the file.
        file: String,
        /// Name of the option.
        option: &'static str,
        /// Value of the option.
        value: String,
        /// Valid values.
        expected: &'static str,
    },
    /// The record cannot be processed as requested.
    #[error("{file}: {message}")]
    Processing {
        /// Name of the file.
        file: String,
        /// Found and expected value.
        message: String,
    },
    /// The file has only blanks.
    #[error("{file}: the file is empty, expected an accelerogram")]
    Empty {
        /// Name of the file.
        file: String,
    },
    /// The file is not text.
    #[error("{file}: found {found}, expected an accelerogram as ASCII, Latin-1 or UTF-8 text")]
    NotText {
        /// Name of the file.
        file: String,
        /// Apparent content.
        found: &'static str,
    },
    /// The file has velocities, displacements, a spectrum or instrument counts.
    #[error("{file}, line {line}: found {found}, expected an acceleration time history")]
    NotAcceleration {
        /// Name of the file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// Content that the line announces.
        found: String,
    },
    /// The file is a known kind of accelerogram that is not supported.
    #[error("{file}, line {line}: found {found}, which is not supported; expected {expected}")]
    NotRead {
        /// Name of the file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// Kind of file.
        found: String,
        /// Kind to export instead.
        expected: &'static str,
    },
    /// A header line violates its format.
    #[error("{file}, line {line}: found {found}, expected {expected}")]
    Header {
        /// Name of the file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// Content of the line.
        found: String,
        /// Content that the format requires.
        expected: String,
    },
    /// A value is not a finite number.
    #[error("{file}, line {line}: found {found}, expected a finite number")]
    Number {
        /// Name of the file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// Content of the line.
        found: String,
    },
    /// The last number has fewer digits than all others: the file was cut off.
    #[error(
        "{file}, line {line}: the file ends within the number {found}, expected {expected} as in all numbers before"
    )]
    Truncated {
        /// Name of the file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// Number that was cut off.
        found: String,
        /// Digits of all other numbers.
        expected: String,
    },
    /// The count of the header differs from the number of values.
    #[error("{file}, line {line}: found {counted} values in the file, expected {stated}, the header's {key}")]
    Count {
        /// Name of the file.
        file: String,
        /// Line of the count, from 1.
        line: usize,
        /// Name of the count in the header.
        key: &'static str,
        /// Count in the header.
        stated: usize,
        /// Number of values.
        counted: usize,
    },
    /// The file has fewer than two values.
    #[error("{file}: found {counted} values, expected at least 2")]
    TooFew {
        /// Name of the file.
        file: String,
        /// Number of values.
        counted: usize,
    },
    /// The time column is not evenly spaced.
    #[error("{file}, line {line}: found time {found} s, expected {expected} s (even steps of {time_step} s)")]
    UnevenTime {
        /// Name of the file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// Time of the line (s).
        found: f64,
        /// Time at even spacing (s).
        expected: f64,
        /// Mean step (s).
        time_step: f64,
    },
    /// The file lacks information that a setting supplies, or contradicts a setting.
    #[error("{}", needs_setting(.file, *.line, .found, .setting, .expected))]
    NeedsSetting {
        /// Name of the file.
        file: String,
        /// Line number, from 1, if the fault is in one line.
        line: Option<usize>,
        /// Content of the file.
        found: String,
        /// Setting that resolves the error.
        setting: Setting,
        /// Values of the setting.
        expected: String,
    },
    /// The peak exceeds that of any earthquake: the unit of the file is wrong.
    #[error(
        "{file}, line {line}: the peak is {peak:.3e} g at {time} s in the file's unit, {unit}; expected at most {limit} g"
    )]
    Absurd {
        /// Name of the file.
        file: String,
        /// Line of the unit, from 1.
        line: usize,
        /// Peak ground acceleration in units of the caller's gravity.
        peak: f64,
        /// Time of the peak (s).
        time: f64,
        /// Unit of the file.
        unit: Unit,
        /// Largest accepted peak, in the same unit.
        limit: f64,
    },
}

impl RecordError {
    /// Returns the message with the caller's name for the setting, such as `--unit` for [`Setting::Unit`].
    pub fn naming(&self, name: impl FnOnce(Setting) -> String) -> String {
        let RecordError::NeedsSetting { file, line, found, setting, expected } = self else { return self.to_string() };
        needs_setting(file, *line, found, &name(*setting), expected)
    }
}

fn needs_setting(file: &str, line: Option<usize>, found: &str, setting: &dyn fmt::Display, expected: &str) -> String {
    let line = line.map_or(String::new(), |line| format!(", line {line}"));
    format!("{file}{line}: {found}; expected {setting} {expected}")
}
