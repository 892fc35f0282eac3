//! The caller's knowledge of a file: settings that replace or confirm the statements of its header.

use std::{convert::Infallible, fmt, str::FromStr};

use serde::Deserialize;

use super::fixed_layout::FixedLayout;
use super::format::{FORMATS, Format};
use super::processing::Processing;
use super::unit::Unit;

/// A column of a table or a channel of a file, chosen by the caller.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(untagged)]
pub enum Choice {
    /// Number, from 1.
    Number(usize),
    /// Name in the header, in any case. The unit in brackets may be left out.
    Name(String),
}

impl Choice {
    /// Describes the choice, as `column 3` for `noun` "column", or as the quoted name.
    pub(super) fn described(&self, noun: &str) -> String {
        match self {
            Choice::Number(number) => format!("{noun} {number}"),
            Choice::Name(name) => format!("{name:?}"),
        }
    }
}

impl FromStr for Choice {
    type Err = Infallible;

    /// Reads a whole number as a number and everything else as a name.
    fn from_str(text: &str) -> Result<Choice, Infallible> {
        Ok(text.parse().map_or_else(|_| Choice::Name(text.to_owned()), Choice::Number))
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Choice::Number(number) => write!(f, "{number}"),
            Choice::Name(name) => f.pad(name),
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
    /// Value of `g` for records in g [m/s²]. It is that of the block, so that records and `g tan α` stay comparable.
    pub gravity: f64,
    /// Layout of a line, for [`Format::Fixed`], which it chooses.
    pub layout: Option<FixedLayout>,
    /// Number of lines before the first line of numbers, for [`Format::Fixed`].
    pub skip: Option<usize>,
    /// Number of values to read, for [`Format::Fixed`]; all lines to the end without it.
    pub npts: Option<usize>,
    /// Value of a printed 1, in the unit of the values, for [`Format::Fixed`] and [`Format::Columns`].
    pub value_scale: Option<f64>,
    /// Column of the times, for [`Format::Columns`] and [`Format::Fixed`].
    pub time_column: Option<Choice>,
    /// Column of the accelerations, for [`Format::Columns`] and [`Format::Fixed`].
    pub acceleration_column: Option<Choice>,
    /// Channel of a file with several.
    pub channel: Option<Choice>,
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
            layout: None,
            skip: None,
            npts: None,
            value_scale: None,
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
            layout: self.layout.or(others.layout),
            skip: self.skip.or(others.skip),
            npts: self.npts.or(others.npts),
            value_scale: self.value_scale.or(others.value_scale),
            time_column: self.time_column.clone().or_else(|| others.time_column.clone()),
            acceleration_column: self.acceleration_column.clone().or_else(|| others.acceleration_column.clone()),
            channel: self.channel.clone().or_else(|| others.channel.clone()),
            processing: if self.processing.is_none() { others.processing } else { self.processing },
        }
    }

    /// Describes the record that the caller chooses from several in a file, such as `channel 2`.
    pub fn choice(&self) -> Option<String> {
        let channel = self.channel.as_ref().map(|channel| format!("channel {channel}"));
        channel.or_else(|| self.acceleration_column.as_ref().map(|column| format!("column {column}")))
    }

    /// Lists the settings with a value.
    pub fn settings(&self) -> impl Iterator<Item = Setting> + use<> {
        let ReadOptions {
            format,
            unit,
            time_step,
            gravity: _,
            layout,
            skip,
            npts,
            value_scale,
            time_column,
            acceleration_column,
            channel,
            processing,
        } = self;
        [
            (Setting::Format, format.is_some()),
            (Setting::Unit, unit.is_some()),
            (Setting::TimeStep, time_step.is_some()),
            (Setting::Channel, channel.is_some()),
            (Setting::Layout, layout.is_some()),
            (Setting::Skip, skip.is_some()),
            (Setting::Npts, npts.is_some()),
            (Setting::ValueScale, value_scale.is_some()),
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
    /// Layout of a line.
    Layout,
    /// Number of lines before the numbers.
    Skip,
    /// Number of values.
    Npts,
    /// Value of a printed 1.
    ValueScale,
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
    pub fn formats(self) -> Vec<Format> {
        let uses = |format: &Format| match self {
            Setting::Format | Setting::Unit | Setting::TimeStep => true,
            Setting::Baseline | Setting::BandPass | Setting::Resample => true,
            Setting::Channel => format.has_channels(),
            Setting::Layout | Setting::Skip | Setting::Npts => *format == Format::Fixed,
            Setting::ValueScale | Setting::TimeColumn | Setting::AccelerationColumn => {
                matches!(format, Format::Columns | Format::Fixed)
            }
        };
        FORMATS.iter().map(|(format, ..)| *format).filter(uses).collect()
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Setting::Format => "format",
            Setting::Unit => "unit",
            Setting::TimeStep => "time step",
            Setting::Channel => "channel",
            Setting::Layout => "layout",
            Setting::Skip => "skip",
            Setting::Npts => "npts",
            Setting::ValueScale => "value scale",
            Setting::TimeColumn => "time column",
            Setting::AccelerationColumn => "acceleration column",
            Setting::Baseline => "baseline",
            Setting::BandPass => "band-pass",
            Setting::Resample => "resample",
        })
    }
}
