//! The caller's knowledge of a file: settings that replace or confirm the statements of its header.

use std::{convert::Infallible, fmt, str::FromStr};

use super::format::Format;
use super::processing::Processing;
use super::unit::Unit;

/// A column of a table, chosen by the caller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Column {
    /// Number, from 1.
    Number(usize),
    /// Name in the header row, in any case, with or without the unit in brackets.
    Name(String),
}

impl FromStr for Column {
    type Err = Infallible;

    /// Reads a whole number as a number and everything else as a name.
    fn from_str(text: &str) -> Result<Column, Infallible> {
        Ok(text.parse().map_or_else(|_| Column::Name(text.to_owned()), Column::Number))
    }
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Column::Number(number) => write!(f, "column {number}"),
            Column::Name(name) => write!(f, "{name:?}"),
        }
    }
}

/// Settings for reading a file.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadOptions {
    /// Format; `None` detects it from the content.
    pub format: Option<Format>,
    /// Unit of the values; required if the file states none, otherwise it must agree.
    pub unit: Option<Unit>,
    /// Time step (s); required if the file states none, otherwise it must agree.
    pub time_step: Option<f64>,
    /// Value of `g` for records in g [m/s²]: that of the block, so that records and `g tan α` stay comparable.
    pub gravity: f64,
    /// Column of the times, for [`Format::Columns`].
    pub time_column: Option<Column>,
    /// Column of the accelerations, for [`Format::Columns`].
    pub acceleration_column: Option<Column>,
    /// Channel of a COSMOS or CSMIP file with several, from 1.
    pub channel: Option<usize>,
    /// Changes to the record.
    pub processing: Processing,
}

impl Default for ReadOptions {
    /// Takes everything from the file, with g = 9.81 m/s².
    fn default() -> ReadOptions {
        ReadOptions {
            format: None,
            unit: None,
            time_step: None,
            gravity: 9.81,
            time_column: None,
            acceleration_column: None,
            channel: None,
            processing: Processing::default(),
        }
    }
}

impl ReadOptions {
    /// Fills the missing settings from `others`; the gravity is always that of `others`.
    #[must_use]
    pub fn or(&self, others: &ReadOptions) -> ReadOptions {
        ReadOptions {
            format: self.format.or(others.format),
            unit: self.unit.or(others.unit),
            time_step: self.time_step.or(others.time_step),
            gravity: others.gravity,
            time_column: self.time_column.clone().or_else(|| others.time_column.clone()),
            acceleration_column: self.acceleration_column.clone().or_else(|| others.acceleration_column.clone()),
            channel: self.channel.or(others.channel),
            processing: if self.processing.is_none() { others.processing } else { self.processing },
        }
    }

    /// Lists the settings with a value.
    pub fn settings(&self) -> impl Iterator<Item = Setting> + use<> {
        let ReadOptions { format, unit, time_step, gravity: _, time_column, acceleration_column, channel, processing } =
            self;
        [
            (Setting::Format, format.is_some()),
            (Setting::Unit, unit.is_some()),
            (Setting::TimeStep, time_step.is_some()),
            (Setting::Channel, channel.is_some()),
            (Setting::TimeColumn, time_column.is_some()),
            (Setting::AccelerationColumn, acceleration_column.is_some()),
            (Setting::Baseline, processing.baseline),
            (Setting::BandPass, processing.band_pass.is_some()),
            (Setting::Resample, processing.resample.is_some()),
        ]
        .into_iter()
        .filter_map(|(setting, given)| given.then_some(setting))
    }
}

/// A setting of [`ReadOptions`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Setting {
    /// Format of the file.
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
    /// Removal of the linear trend.
    Baseline,
    /// Band-pass filter.
    BandPass,
    /// New time step.
    Resample,
}

impl Setting {
    /// Lists the formats that use this setting.
    #[must_use]
    pub fn formats(self) -> &'static [Format] {
        match self {
            Setting::Format
            | Setting::Unit
            | Setting::TimeStep
            | Setting::Baseline
            | Setting::BandPass
            | Setting::Resample => &Format::ALL,
            Setting::Channel => &[Format::Cosmos, Format::Csmip],
            Setting::TimeColumn | Setting::AccelerationColumn => &[Format::Columns],
        }
    }
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
            Setting::Baseline => "baseline",
            Setting::BandPass => "band-pass",
            Setting::Resample => "resample",
        })
    }
}
