//! Files or arrays of samples → the records of an FMU, of any block.

use std::path::Path;

use crate::unit::attributes::Fmi3Attributes;
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

/// Whether arrays of samples hold a record: not all are zero.
pub(super) fn hold_record(arrays: &[Vec<f64>]) -> bool {
    arrays.iter().flatten().any(|&a| a != 0.0)
}

/// Whether arrays of samples are finite and equal in number, which `count` admits.
pub(super) fn are_valid<V>(arrays: &[Vec<f64>], count: &Fmi3Attributes<V>) -> bool {
    let number = arrays.first().map_or(0, Vec::len);
    arrays.iter().all(|samples| samples.len() == number && samples.iter().all(|a| a.is_finite()))
        && count.admits(number as f64).is_ok()
}

/// A source of records: its variables, and whether they give any.
pub(super) struct RecordSource {
    pub variables: &'static str,
    pub gives: bool,
}

/// Returns the records of the arrays or of the files.
///
/// # Errors
/// One line: both are given, or the fault of the one.
pub(super) fn from_one<G>(
    [arrays, files]: [RecordSource; 2],
    of_arrays: impl FnOnce() -> Result<G, String>,
    of_files: impl FnOnce() -> Result<G, String>,
) -> Result<G, String> {
    match (arrays.gives, files.gives) {
        (false, _) => of_files(),
        (true, false) => of_arrays(),
        (true, true) => {
            Err(format!("{} holds a record, and {} names one; expected one of both", arrays.variables, files.variables))
        }
    }
}

/// Returns the records in arrays of samples (m/s²), each with the name of its variable; none of zeros. An error is one line.
pub(super) fn of_arrays<const N: usize>(
    arrays: [(&'static str, &[f64]); N],
    (name, time_step): (&'static str, f64),
) -> Result<[Option<Record>; N], String> {
    if time_step <= 0.0 {
        return Err(format!("{name} = {time_step} s with samples; expected a time step above 0 s"));
    }
    Ok(arrays.map(|(title, acceleration)| {
        acceleration.iter().any(|&a| a != 0.0).then(|| Record {
            title: title.to_string(),
            format: Format::Columns,
            unit: rocking_records::Unit::MetrePerSecondSquared,
            start_time: 0.0,
            time_step,
            acceleration: acceleration.into(),
            processing: rocking_records::Processing::default(),
        })
    }))
}
