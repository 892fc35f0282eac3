//! Files or arrays of samples → the FMU's own ground motion, and the parameters calculated from it.

use std::path::Path;

use crate::excitation::records::Ground;
use crate::unit::values::Values;
use crate::unit::variables::{Fmi3Variable, Text, Variable};
use rocking_records::{Choice, Format, LARGEST_FILE, ReadOptions, Record, Setting, local_path};

/// A file with a record, and the options of its reading. Each has the name of its variable.
pub(super) struct RecordFile<'a> {
    /// Its path; empty for none.
    pub path: (&'static str, &'a str),
    /// The unit of its values; empty for that of the file.
    pub unit: (&'static str, &'a str),
    /// Its channel; 0 for the only one.
    pub channel: (&'static str, f64),
    /// Its time step (s); 0 for that of the file.
    pub time_step: (&'static str, f64),
    /// Gravity (m/s²).
    pub gravity: f64,
}

impl Values {
    /// Returns the FMU's own records, from arrays or files.
    ///
    /// # Errors
    /// One line: both arrays and files, or the first fault of a file.
    pub fn ground(&self) -> Result<Ground, String> {
        let ground = self.unscaled_ground()?;
        Ok(ground.scaled(self[Variable::RecordScale]).shifted(self[Variable::RecordStart]))
    }

    /// Returns the records without scale and shift.
    pub(super) fn unscaled_ground(&self) -> Result<Ground, String> {
        match (self.fmi3.has_record(), self.has_file()) {
            (false, _) => self.ground_of_files(),
            (true, false) => self.ground_of_arrays(),
            (true, true) => Err("record.horizontal_samples or record.vertical_samples holds a record, and \
                                 record.horizontal or record.vertical names one; expected one of both"
                .into()),
        }
    }

    /// Whether the FMU has a record of its own.
    pub(super) fn has_record(&self) -> bool {
        self.has_file() || self.fmi3.has_record()
    }

    /// Whether a parameter names a record file.
    pub(super) fn has_file(&self) -> bool {
        !(self[Text::RecordHorizontal].is_empty() && self[Text::RecordVertical].is_empty())
    }

    /// Whether [`Values::ground`] reads this variable.
    pub fn is_of_ground(variable: Variable) -> bool {
        variable == Variable::G || variable.name().starts_with("record.")
    }

    /// Returns the record in the arrays. An error is one line.
    fn ground_of_arrays(&self) -> Result<Ground, String> {
        let time_step = self[Variable::RecordDt];
        let [horizontal, vertical] =
            [Fmi3Variable::RecordHorizontalSamples, Fmi3Variable::RecordVerticalSamples].map(|samples| {
                let acceleration = self.fmi3.of(samples);
                acceleration.iter().any(|&a| a != 0.0).then(|| Record {
                    title: samples.name().to_string(),
                    format: Format::Columns,
                    unit: rocking_records::Unit::MetrePerSecondSquared,
                    start_time: 0.0,
                    time_step,
                    acceleration: acceleration.into(),
                    processing: rocking_records::Processing::default(),
                })
            });
        if time_step > 0.0 {
            return Ok(Ground { horizontal, vertical });
        }
        Err(format!("{} = {time_step} s with samples; expected a time step above 0 s", Variable::RecordDt.name()))
    }

    /// Reads the files that the parameters name. An error is one line and names settings by their variables.
    pub(super) fn ground_of_files(&self) -> Result<Ground, String> {
        let unit = |texts: &[Text]| texts.iter().copied().find(|&text| !self[text].is_empty());
        let record = |path: Text, unit: Text, channel: Variable| {
            let text = |text: Text| (text.variable().name(), self[text].as_str());
            let number = |variable: Variable| (variable.name(), self[variable]);
            let (channel, time_step) = (number(channel), number(Variable::RecordDt));
            RecordFile { path: text(path), unit: text(unit), channel, time_step, gravity: self[Variable::G] }.read()
        };
        let horizontal_unit = unit(&[Text::RecordHorizontalUnit]).unwrap_or(Text::RecordHorizontalUnit);
        let vertical_unit =
            unit(&[Text::RecordVerticalUnit, Text::RecordHorizontalUnit]).unwrap_or(Text::RecordVerticalUnit);
        Ok(Ground {
            horizontal: record(Text::RecordHorizontal, horizontal_unit, Variable::RecordHorizontalChannel)?,
            vertical: record(Text::RecordVertical, vertical_unit, Variable::RecordVerticalChannel)?,
        })
    }
}

impl RecordFile<'_> {
    /// Reads the record, if a path is given. An error is one line and names settings by their variables.
    pub(super) fn read(&self) -> Result<Option<Record>, String> {
        let &RecordFile { path: (path_name, path), unit: (unit_name, unit), channel, time_step, gravity } = self;
        if path.is_empty() {
            return Ok(None);
        }
        // Opening a pipe waits for a writer, and a device may never end.
        let found = local_path(Path::new(path)).and_then(std::fs::metadata);
        if found.is_ok_and(|found| !found.is_file() && !found.is_dir()) {
            return Err(format!(
                "{path_name}: {path} is a pipe or a device; expected a file of at most {LARGEST_FILE} MiB"
            ));
        }
        let unit_choice = (!unit.is_empty()).then(|| unit.parse());
        let options = ReadOptions {
            unit: unit_choice.transpose().map_err(|error| format!("{unit_name}: {error}"))?,
            time_step: (time_step.1 != 0.0).then_some(time_step.1),
            gravity,
            channel: (channel.1 != 0.0).then_some(Choice::Number(channel.1 as usize)),
            ..ReadOptions::default()
        };
        let name = |setting: Setting| match setting {
            Setting::Unit => unit_name.to_string(),
            Setting::TimeStep => time_step.0.to_string(),
            Setting::Channel => channel.0.to_string(),
            Setting::Format => "a format".to_string(),
            Setting::TimeColumn | Setting::AccelerationColumn => {
                "a file with one column of accelerations, here one of columns".to_string()
            }
            // The FMU has no parameters for these.
            Setting::Layout
            | Setting::Skip
            | Setting::Npts
            | Setting::ValueScale
            | Setting::Baseline
            | Setting::BandPass
            | Setting::Resample => setting.to_string(),
        };
        let read = rocking_records::read(Path::new(path), &options);
        let record = read.map_err(|error| format!("{path_name}: {}", error.naming(name)))?;
        match options.channel {
            Some(Choice::Number(given)) if given > 1 && !Setting::Channel.formats().contains(&record.format) => {
                Err(format!(
                    "{} = {given}; expected 0 or 1, since {path} is a file of format {} and has one channel",
                    channel.0, record.format
                ))
            }
            Some(_) | None => Ok(Some(record)),
        }
    }
}
