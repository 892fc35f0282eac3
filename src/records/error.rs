//! What can be wrong with an accelerogram file: each error is one line that names the file, the line, what was found
//! and what was expected.

use super::{Format, Unit};

/// Why a file was refused. Every message fits on one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The operating system refused to give the file's content.
    #[error("{file}: cannot be read: {source}")]
    Unreadable {
        /// Name of the file.
        file: String,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The file is larger than any accelerogram.
    #[error("{file}: more than {limit} MiB, expected one accelerogram")]
    TooLarge {
        /// Name of the file.
        file: String,
        /// Largest size that is read (MiB).
        limit: u64,
    },
    /// An option of the caller makes no sense, whatever the file.
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
    /// Neither the file nor the caller gives the unit.
    #[error("{file}: no unit in the file and none given, expected one of g, m/s2, cm/s2")]
    UnitMissing {
        /// Name of the file.
        file: String,
    },
    /// The file and the caller give different units.
    #[error("{file}, line {line}: the file is in {found} but {given} was given")]
    UnitContradicted {
        /// Name of the file.
        file: String,
        /// Line of the unit, from 1.
        line: usize,
        /// Unit of the file.
        found: Unit,
        /// Unit of the caller.
        given: Unit,
    },
    /// Neither the file nor the caller gives the time step.
    #[error("{file}: no time step in the file and none given, expected one [s]")]
    TimeStepMissing {
        /// Name of the file.
        file: String,
    },
    /// The file and the caller give different time steps.
    #[error("{file}, line {line}: the file has a time step of {found} s but {given} s was given")]
    TimeStepContradicted {
        /// Name of the file.
        file: String,
        /// Line of the time step, from 1.
        line: usize,
        /// Time step of the file (s).
        found: f64,
        /// Time step of the caller (s).
        given: f64,
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
    /// It is not clear which column is which.
    #[error("{file}, line {line}: found {found}, expected {expected}")]
    Columns {
        /// Name of the file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// The columns at hand.
        found: String,
        /// What to choose.
        expected: String,
    },
    /// It is not clear which of several channels is wanted.
    #[error("{file}: found {found}, expected a choice of one channel from 1 to {count}")]
    Channel {
        /// Name of the file.
        file: String,
        /// The channels at hand.
        found: String,
        /// How many there are.
        count: usize,
    },
    /// No ground has shaken so strongly: the unit is wrong.
    #[error(
        "{file}: the peak would be {peak:.3e} g at {time} s if the values were in {unit}; check the unit, expected at most {limit} g"
    )]
    Absurd {
        /// Name of the file.
        file: String,
        /// Peak ground acceleration in units of the caller's gravity.
        peak: f64,
        /// Its time (s).
        time: f64,
        /// Unit that was assumed.
        unit: Unit,
        /// Largest peak that is believed, in the same unit.
        limit: f64,
    },
}

/// A word that is none of the units of [`Unit`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("found unit {0:?}, expected one of g, m/s2, cm/s2, gal")]
pub struct UnknownUnit(pub String);

/// A word that is none of the formats of [`Format`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("found format {0:?}, expected one of {list}", list = Format::NAMES)]
pub struct UnknownFormat(pub String);
