//! Errors of accelerogram files: one line with file, line, found and expected content.

use std::fmt;

use super::options::Setting;

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
    /// The file as a whole, an option, or the requested processing is at fault.
    #[error("{file}: {message}")]
    File {
        /// Name of the file.
        file: String,
        /// Found and expected content.
        message: String,
    },
    /// A line violates the format, contradicts the rest of the file, or announces something else than accelerations.
    #[error("{file}, line {line}: {message}")]
    Line {
        /// Name of the file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// Found and expected content.
        message: String,
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
