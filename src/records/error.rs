//! What can be wrong with an accelerogram file: each error is one line that names the file, the line, what was found
//! and what was expected.

use std::fmt;

use super::{Format, Unit};

/// Why a file was refused. Every message fits on one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The operating system refused to give the file's content.
    #[error("{file}: cannot be read: {error}")]
    Unreadable {
        /// Name of the file.
        file: String,
        /// What the operating system said. Not called `source`: it stands in the message, and a chain of causes would
        /// repeat it.
        error: std::io::Error,
    },
    /// The file is larger than any accelerogram.
    #[error("{file}: more than {limit} MiB, expected one accelerogram")]
    TooLarge {
        /// Name of the file.
        file: String,
        /// Largest size that is read (MiB).
        limit: u64,
    },
    /// An option of the caller is not valid for any file.
    #[error("{file}: {option} = {value} was asked for, expected {expected}")]
    Option {
        /// Name of the file.
        file: String,
        /// The option.
        option: &'static str,
        /// Its value.
        value: String,
        /// What it may be.
        expected: &'static str,
    },
    /// Nothing but blanks.
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
        /// What the bytes look like.
        found: &'static str,
    },
    /// A velocity, a displacement, a spectrum, instrument counts.
    #[error("{file}, line {line}: found {found}, expected an acceleration time history")]
    NotAcceleration {
        /// Name of the file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// What the line announces.
        found: String,
    },
    /// A known kind of accelerogram that is not read.
    #[error("{file}, line {line}: found {found}, which is not read; expected {expected}")]
    NotRead {
        /// Name of the file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// The kind of file.
        found: &'static str,
        /// The kind to export instead.
        expected: &'static str,
    },
    /// A header line does not hold what its format puts there.
    #[error("{file}, line {line}: found {found}, expected {expected}")]
    Header {
        /// Name of the file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// What is there.
        found: String,
        /// What the format puts there.
        expected: String,
    },
    /// Something that is not a finite number stands among the values.
    #[error("{file}, line {line}: found {found}, expected a finite number")]
    Number {
        /// Name of the file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// What is there.
        found: String,
    },
    /// The last number of the file has fewer digits than all others: the file was cut.
    #[error(
        "{file}, line {line}: the file ends within the number {found}, expected {expected} as in all numbers before"
    )]
    Truncated {
        /// Name of the file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// The cut number.
        found: String,
        /// What every other number has.
        expected: String,
    },
    /// The header's count is not that of the values.
    #[error("{file}, line {line}: header says {key}= {stated} but the file has {counted} values")]
    Count {
        /// Name of the file.
        file: String,
        /// Line of the count, from 1.
        line: usize,
        /// The header's name for the count.
        key: &'static str,
        /// What the header says.
        stated: usize,
        /// What was counted.
        counted: usize,
    },
    /// Fewer values than a time history has.
    #[error("{file}: found {counted} values, expected at least 2")]
    TooFew {
        /// Name of the file.
        file: String,
        /// What was counted.
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
        /// Time that an even spacing gives (s).
        expected: f64,
        /// Mean step (s).
        time_step: f64,
    },
    /// The file leaves something open, or says something else than the caller.
    #[error("{}", open(.file, *.line, .found, .setting, .expected))]
    Open {
        /// Name of the file.
        file: String,
        /// Line number, from 1, if one line is to blame.
        line: Option<usize>,
        /// What is there.
        found: String,
        /// What settles it.
        setting: Setting,
        /// What it may be.
        expected: String,
    },
    /// No ground has shaken so strongly: the file's unit is wrong.
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
        /// Its time (s).
        time: f64,
        /// Unit of the file.
        unit: Unit,
        /// Largest peak that is believed, in the same unit.
        limit: f64,
    },
}

/// What [`ReadOptions`](super::ReadOptions) say of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Setting {
    /// Its format.
    Format,
    /// Unit of the accelerations.
    Unit,
    /// Time step.
    TimeStep,
    /// Channel.
    Channel,
    /// Column of the times.
    TimeColumn,
    /// Column of the accelerations.
    AccelerationColumn,
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Setting::Format => "format",
            Setting::Unit => "unit",
            Setting::TimeStep => "time step",
            Setting::Channel => "channel",
            Setting::TimeColumn => "time column",
            Setting::AccelerationColumn => "acceleration column",
        })
    }
}

impl RecordError {
    /// The message with the caller's own name for what settles it, such as `--unit` for [`Setting::Unit`].
    pub fn naming(&self, name: impl FnOnce(Setting) -> String) -> String {
        let RecordError::Open { file, line, found, setting, expected } = self else { return self.to_string() };
        open(file, *line, found, &name(*setting), expected)
    }
}

fn open(file: &str, line: Option<usize>, found: &str, setting: &dyn fmt::Display, expected: &str) -> String {
    let line = line.map_or(String::new(), |line| format!(", line {line}"));
    format!("{file}{line}: {found}; expected {setting} {expected}")
}

/// A word that is none of the units of [`Unit`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("found unit {0:?}, expected one of g, m/s2, cm/s2, gal")]
pub struct UnknownUnit(pub String);

/// A word that is none of the formats of [`Format`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("found format {0:?}, expected one of {list}", list = Format::NAMES)]
pub struct UnknownFormat(pub String);
