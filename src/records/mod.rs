//! Accelerogram files → evenly spaced ground accelerations in m/s².
//!
//! [`read`] tells the format from the content and returns a [`Record`], which stands for a piecewise linear ground
//! acceleration. What a file does not say (unit, time step) comes from [`ReadOptions`]; what it does say must agree
//! with them. A file that is not read completely and without doubt is refused with a [`RecordError`] of one line.

mod channels;
mod columns;
mod cosmos;
mod csmip;
mod error;
mod esm;
pub mod ground;
mod peer;
mod raw;
mod smc;
mod table;
mod text;
mod time_axis;
mod unit;

use std::{fmt, fs::File, io::Read, path::Path, str::FromStr};

use serde::{Deserialize, Serialize};

pub use columns::Column;
pub use error::{RecordError, Setting, UnknownFormat, UnknownUnit};
pub use unit::Unit;

use text::Source;

/// Larger files are refused (MiB): the longest accelerograms have 10⁶ values, a few tens of MiB.
pub(crate) const LARGEST_FILE: u64 = 512;

/// A ground acceleration that is linear between evenly spaced samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Earthquake, station and component as far as the header gives them, otherwise the file's name.
    pub title: String,
    /// Format of the file.
    pub format: Format,
    /// Unit of the values in the file.
    pub unit: Unit,
    /// Time of the first sample (s).
    pub start_time: f64,
    /// Time between two samples (s), above zero.
    pub time_step: f64,
    /// Ground accelerations [m/s²], finite, at least two; the sign is the file's.
    pub acceleration: Vec<f64>,
}

/// The sample of largest magnitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Its acceleration with its sign [m/s²]; the peak ground acceleration is its magnitude.
    pub acceleration: f64,
    /// Its time (s), on the record's own axis.
    pub time: f64,
}

impl Record {
    /// Time from the first to the last sample (s).
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.acceleration.len().saturating_sub(1) as f64 * self.time_step
    }

    /// The first sample of largest magnitude.
    #[must_use]
    pub fn peak(&self) -> Peak {
        let mut peak = Peak { acceleration: 0.0, time: self.start_time };
        for (index, &acceleration) in self.acceleration.iter().enumerate() {
            if acceleration.abs() > peak.acceleration.abs() {
                peak = Peak { acceleration, time: self.start_time + index as f64 * self.time_step };
            }
        }
        peak
    }

    /// Ground acceleration at time `t` (s) on the record's own axis [m/s²]: linear between samples, zero before the
    /// first and after the last one.
    #[must_use]
    pub fn at(&self, t: f64) -> f64 {
        let end = self.start_time + self.duration();
        if !(self.start_time..=end).contains(&t) {
            return 0.0;
        }
        let position = (t - self.start_time) / self.time_step;
        let index = position as usize;
        match self.acceleration.get(index..) {
            Some([left, right, ..]) => left + (position - index as f64) * (right - left),
            // The last sample, or just beyond it by rounding.
            _ => self.acceleration.last().copied().unwrap_or(0.0),
        }
    }

    /// Whether this can be a record: what a file says of itself is not enough.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let Record { start_time, time_step, acceleration, .. } = self;
        acceleration.len() >= 2
            && *time_step > 0.0
            && [start_time, time_step].into_iter().chain(acceleration).all(|x| x.is_finite())
    }

    /// The same record with all accelerations multiplied by `factor`, a pure number.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Record {
        self.acceleration.iter_mut().for_each(|a| *a *= factor);
        self
    }
}

/// Format of an accelerogram file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Format {
    /// PEER AT2, with or without header; values in reading order.
    Peer,
    /// SMC of the U.S. Geological Survey.
    Smc,
    /// Delimited or blank-separated columns: acceleration alone or with time.
    Columns,
    /// COSMOS volumes 1 and 2.
    Cosmos,
    /// CSMIP (DMG) volume 2.
    Csmip,
    /// ASC of the European ESM and ITACA databases.
    Esm,
}

impl Format {
    const ALL: [Format; 6] = [Format::Peer, Format::Smc, Format::Columns, Format::Cosmos, Format::Csmip, Format::Esm];

    /// What [`Format::from_str`] reads, for messages.
    pub const NAMES: &'static str = "peer, smc, columns, cosmos, csmip, esm";

    /// Tells the format from the content: by the line that only this format has, otherwise by the shape of the numbers.
    fn of(source: &Source<'_>, options: &ReadOptions) -> Result<Format, RecordError> {
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
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Format::Peer => "PEER AT2",
            Format::Smc => "SMC",
            Format::Columns => "columns",
            Format::Cosmos => "COSMOS",
            Format::Csmip => "CSMIP",
            Format::Esm => "ESM ASC",
        })
    }
}

impl FromStr for Format {
    type Err = UnknownFormat;

    fn from_str(text: &str) -> Result<Format, UnknownFormat> {
        match text.to_ascii_lowercase().as_str() {
            "peer" | "at2" => Ok(Format::Peer),
            "smc" => Ok(Format::Smc),
            "columns" | "csv" | "txt" => Ok(Format::Columns),
            "cosmos" => Ok(Format::Cosmos),
            "csmip" | "dmg" => Ok(Format::Csmip),
            "esm" | "asc" => Ok(Format::Esm),
            _ => Err(UnknownFormat(text.to_owned())),
        }
    }
}

/// What the caller knows about a file.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadOptions {
    /// Format; told from the content if `None`.
    pub format: Option<Format>,
    /// Unit of the values, needed where the file gives none; must agree with the file otherwise.
    pub unit: Option<Unit>,
    /// Time step (s), needed where the file gives none; must agree with the file otherwise.
    pub time_step: Option<f64>,
    /// Value of `g` for records in g [m/s²]; the block's own `g`, so that slenderness times `g` stays comparable.
    pub gravity: f64,
    /// Column of the times, for [`Format::Columns`].
    pub time_column: Option<Column>,
    /// Column of the accelerations, for [`Format::Columns`].
    pub acceleration_column: Option<Column>,
    /// Channel, from 1, for COSMOS and CSMIP files of several channels.
    pub channel: Option<usize>,
}

impl Default for ReadOptions {
    /// Everything is taken from the file, and g = 9.81 m/s².
    fn default() -> ReadOptions {
        ReadOptions {
            format: None,
            unit: None,
            time_step: None,
            gravity: 9.81,
            time_column: None,
            acceleration_column: None,
            channel: None,
        }
    }
}

impl Setting {
    /// The formats that make use of it.
    #[must_use]
    pub fn formats(self) -> &'static [Format] {
        match self {
            Setting::Format | Setting::Unit | Setting::TimeStep => &Format::ALL,
            Setting::Channel => &[Format::Cosmos, Format::Csmip],
            Setting::TimeColumn | Setting::AccelerationColumn => &[Format::Columns],
        }
    }
}

impl ReadOptions {
    /// These options, and from `others` what they leave open; the gravity is that of `others`.
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
        }
    }

    /// What is given of them.
    pub fn given(&self) -> impl Iterator<Item = Setting> + use<> {
        let ReadOptions { format, unit, time_step, gravity: _, time_column, acceleration_column, channel } = self;
        [
            (Setting::Format, format.is_some()),
            (Setting::Unit, unit.is_some()),
            (Setting::TimeStep, time_step.is_some()),
            (Setting::Channel, channel.is_some()),
            (Setting::TimeColumn, time_column.is_some()),
            (Setting::AccelerationColumn, acceleration_column.is_some()),
        ]
        .into_iter()
        .filter_map(|(setting, given)| given.then_some(setting))
    }
}

/// Reads an accelerogram file.
///
/// # Errors
/// [`RecordError::Unreadable`] and [`RecordError::TooLarge`] before the content is looked at, then those of [`parse`].
pub fn read(path: &Path, options: &ReadOptions) -> Result<Record, RecordError> {
    parse(&path.display().to_string(), &bytes(path)?, options)
}

/// The content of a file, up to one byte more than the largest that [`parse`] takes.
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

/// Why the numbers of a table without names can hardly be accelerations, if they cannot: nothing in such a file says that
/// they are.
#[must_use]
pub fn doubt(bytes: &[u8], record: &Record) -> Option<String> {
    /// No ground motion that was ever recorded had more (m/s²); the greatest had 4.4 g.
    const GREATEST: f64 = 60.0;
    /// Least mean frequency (Hz), √(∫ȧ² dt/∫a² dt)/2π: that of 36 accelerograms is 1.2 to 7.7 Hz, that of their velocities
    /// 0.5 to 4 Hz.
    const LEAST_FREQUENCY: f64 = 1.15;
    /// Shorter tables are made by hand.
    const FEWEST: usize = 200;
    let text = String::from_utf8_lossy(bytes.get(..4096).unwrap_or(bytes));
    let first = text.lines().map(str::trim).find(|line| !line.is_empty())?;
    let mut fields = first.split([' ', '\t', ',', ';']).filter(|field| !field.is_empty());
    if record.format != Format::Columns || !fields.all(|field| text::number(field).is_some()) {
        return None;
    }
    let peak = record.peak().acceleration.abs();
    if peak > GREATEST {
        return Some(format!("the greatest is {peak:.3e} m/s², more than of any earthquake"));
    }
    let values = &record.acceleration;
    let squares: f64 = values.iter().map(|a| a * a).sum();
    let changes: f64 = values.iter().zip(values.iter().skip(1)).map(|(a, b)| (b - a) * (b - a)).sum();
    let frequency = (changes / squares).sqrt() / record.time_step / std::f64::consts::TAU;
    (values.len() >= FEWEST && frequency < LEAST_FREQUENCY)
        .then(|| format!("they change as slowly as velocities, at {frequency:.2} Hz in the mean"))
}

/// Reads an accelerogram from the bytes of its file; `name` stands for the file in errors and, where the file has no
/// title, in [`Record::title`]. Text that is not UTF-8 is taken for Latin-1, which real headers hold.
///
/// # Errors
/// The file is not an accelerogram, is incomplete, does not agree with `options`, or leaves a choice open that
/// `options` does not settle.
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
    let source = Source::new(name, bytes)?;
    let format = match options.format {
        Some(format) => format,
        None => Format::of(&source, options)?,
    };
    let raw = match format {
        Format::Peer => peer::read(&source),
        Format::Smc => smc::read(&source),
        Format::Columns => columns::read(&source, options),
        Format::Cosmos => cosmos::read(&source, &channels::choose(&source, options.channel)?),
        Format::Csmip => csmip::read(&source, &channels::choose(&source, options.channel)?),
        Format::Esm => esm::read(&source),
    }?;
    raw.into_record(&source, options)
}
