//! Options, accelerogram files → records of ground motions.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::options::checks::checked;
use crate::options::input;
use crate::output::files::NamedFile;
use rocking_block::excitation::records::Ground;
use rocking_records::{Choice, FixedLayout, Format, Processing, ReadOptions, Unit};
use rocking_studies::input::ground_files::{RecordOption, RecordOptions};

/// Records of one ground motion.
#[derive(Args)]
pub struct Accelerograms {
    /// Accelerogram of the horizontal ground motion, in any format of docs/records.md; `-` for standard input
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Accelerogram of the vertical ground motion; `-` for standard input
    #[arg(long, value_name = "FILE")]
    pub vertical: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingOptions,
    #[command(flatten)]
    vertical_reading: VerticalReadingOptions,
}

/// Records of several ground motions.
#[derive(Args)]
pub struct ManyAccelerograms {
    /// Accelerograms of horizontal ground motions, one or more, in any format of docs/records.md; `-` for standard input
    #[arg(long, value_name = "FILE", num_args = 1..)]
    record: Vec<PathBuf>,
    /// Accelerograms of the vertical ground motions, in the same order; `-` for standard input
    #[arg(long, value_name = "FILE", num_args = 1..)]
    vertical: Vec<PathBuf>,
    #[command(flatten)]
    reading: ReadingOptions,
    #[command(flatten)]
    vertical_reading: VerticalReadingOptions,
}

/// Files of one ground motion.
#[derive(Clone, Copy)]
pub struct MotionFiles<'a> {
    /// Horizontal record.
    pub horizontal: Option<&'a Path>,
    /// Vertical record.
    pub vertical: Option<&'a Path>,
}

/// Information missing from the files.
#[derive(Args)]
pub struct ReadingOptions {
    /// Unit of accelerograms that do not state it: g, m/s2, cm/s2, mm/s2 or g/10
    #[arg(long)]
    unit: Option<Unit>,
    /// Time step of accelerograms that do not state it [s]
    #[arg(long, value_name = "S")]
    dt: Option<f64>,
    /// Format, if the content leaves it open: peer, smc, columns, cosmos, csmip, esm, knet, geonet, nsmn, unam, renadic, bhrc, usc, jma or cwb
    #[arg(long)]
    format: Option<Format>,
    /// Channel of a file with several, by name or by number from 1
    #[arg(long, value_name = "CHANNEL")]
    channel: Option<Choice>,
    /// Columns of fixed width in a line, as an edit descriptor of Fortran: 10F8.2, 5E15.7, 8(1PE10.4E1)
    #[arg(long, value_name = "LAYOUT")]
    layout: Option<FixedLayout>,
    /// Lines before the first line of --layout
    #[arg(long, value_name = "LINES")]
    skip: Option<usize>,
    /// Value of a printed 1 in the unit of the file, for --layout and tables
    #[arg(long, value_name = "FACTOR")]
    value_scale: Option<f64>,
    /// Column of the accelerations in a table, by name or by number from 1
    #[arg(long, value_name = "COLUMN")]
    acceleration_column: Option<Choice>,
    /// Column of the times in a table, by name or by number from 1
    #[arg(long, value_name = "COLUMN")]
    time_column: Option<Choice>,
    /// Subtract from each record the line that fits its accelerations best
    #[arg(long)]
    baseline: bool,
    /// Filter each record by a Butterworth band-pass of order 4 without phase, with these corner frequencies [Hz]
    #[arg(long, value_name = "LOW,HIGH", value_delimiter = ',')]
    band_pass: Option<Vec<f64>>,
    /// Change the time step of each record, with accelerations linear between the samples [s]
    #[arg(long, value_name = "S")]
    resample: Option<f64>,
}

/// Information missing from vertical files.
#[derive(Args)]
pub struct VerticalReadingOptions {
    /// Unit of the vertical accelerogram, instead of --unit
    #[arg(long, value_name = "UNIT")]
    vertical_unit: Option<Unit>,
    /// Time step of the vertical accelerogram, instead of --dt [s]
    #[arg(long, value_name = "S")]
    vertical_dt: Option<f64>,
    /// Format of the vertical accelerogram, instead of --format
    #[arg(long, value_name = "FORMAT")]
    vertical_format: Option<Format>,
    /// Channel of the vertical accelerogram, instead of --channel
    #[arg(long, value_name = "CHANNEL")]
    vertical_channel: Option<Choice>,
    /// Layout of the vertical accelerogram, instead of --layout
    #[arg(long, value_name = "LAYOUT")]
    vertical_layout: Option<FixedLayout>,
    /// Lines before the first line of the vertical layout, instead of --skip
    #[arg(long, value_name = "LINES")]
    vertical_skip: Option<usize>,
    /// Value of a printed 1 in the vertical accelerogram, instead of --value-scale
    #[arg(long, value_name = "FACTOR")]
    vertical_value_scale: Option<f64>,
    /// Column of the vertical accelerations, instead of --acceleration-column
    #[arg(long, value_name = "COLUMN")]
    vertical_acceleration_column: Option<Choice>,
    /// Column of the vertical times, instead of --time-column
    #[arg(long, value_name = "COLUMN")]
    vertical_time_column: Option<Choice>,
}

impl MotionFiles<'_> {
    /// Returns the files with the options that name them.
    pub fn named(&self) -> Vec<NamedFile> {
        NamedFile::of_options([("record", self.horizontal), ("vertical", self.vertical)])
    }
}

impl Accelerograms {
    /// Returns whether no record is named.
    pub fn is_empty(&self) -> bool {
        self.record.is_none() && self.vertical.is_none()
    }

    /// Returns the files.
    pub fn files(&self) -> MotionFiles<'_> {
        MotionFiles { horizontal: self.record.as_deref(), vertical: self.vertical.as_deref() }
    }

    /// Reads the records, those in g with this gravity (m/s²).
    pub fn read(&self, gravity: f64) -> anyhow::Result<Ground> {
        let grounds = read(&[self.files()], &self.reading, &self.vertical_reading, gravity)?;
        Ok(grounds.into_iter().next().unwrap_or_default())
    }
}

impl ManyAccelerograms {
    /// Returns whether no record is named.
    pub fn is_empty(&self) -> bool {
        self.record.is_empty() && self.vertical.is_empty()
    }

    /// Returns the files of each ground motion; without records, one motion without files.
    pub fn files(&self) -> Vec<MotionFiles<'_>> {
        let count = self.record.len().max(self.vertical.len()).max(1);
        let files = |i| MotionFiles {
            horizontal: self.record.get(i).map(PathBuf::as_path),
            vertical: self.vertical.get(i).map(PathBuf::as_path),
        };
        (0..count).map(files).collect()
    }

    /// Reads the records of each ground motion, those in g with this gravity (m/s²).
    pub fn read(&self, gravity: f64) -> anyhow::Result<Vec<Ground>> {
        let (horizontal, vertical) = (self.record.len(), self.vertical.len());
        anyhow::ensure!(
            horizontal == 0 || vertical == 0 || horizontal == vertical,
            "--record names {horizontal} files and --vertical {vertical}; expected equal numbers, in the same order"
        );
        read(&self.files(), &self.reading, &self.vertical_reading, gravity)
    }
}

fn read(
    files: &[MotionFiles],
    reading: &ReadingOptions,
    vertical_reading: &VerticalReadingOptions,
    gravity: f64,
) -> anyhow::Result<Vec<Ground>> {
    let record_options =
        RecordOptions { both: reading.read_options(gravity)?, vertical: vertical_reading.read_options()? };
    let named = files.iter().flat_map(|files| [("--record", files.horizontal), ("--vertical", files.vertical)]);
    input::check_one_standard(named.filter_map(|(option, path)| Some((option, path?))))?;
    let read = |path: Option<&Path>, is_vertical| {
        let read =
            |path| record_options.read(is_vertical, RecordOption::option, |options| input::record(path, options));
        path.map(read).transpose().map_err(anyhow::Error::msg)
    };
    let ground = |files: &MotionFiles| {
        Ok(Ground { horizontal: read(files.horizontal, false)?, vertical: read(files.vertical, true)? })
    };
    let grounds = files.iter().map(ground).collect::<anyhow::Result<Vec<_>>>()?;
    refuse_without_effect(&record_options, &grounds)?;
    Ok(grounds)
}

/// Refuses options that none of the files needed.
pub fn refuse_without_effect(record_options: &RecordOptions, grounds: &[Ground]) -> anyhow::Result<()> {
    match record_options.unread(grounds) {
        Some((name, needed)) => anyhow::bail!("{} has no effect without {needed}", name.option()),
        None => Ok(()),
    }
}

impl ReadingOptions {
    /// Returns the options of the reader, with this gravity for records in g (m/s²).
    pub fn read_options(&self, gravity: f64) -> anyhow::Result<ReadOptions> {
        Ok(ReadOptions {
            format: self.format,
            unit: self.unit,
            time_step: time_step("dt", self.dt)?,
            gravity,
            layout: self.layout,
            skip: self.skip,
            value_scale: self.value_scale,
            time_column: self.time_column.clone(),
            acceleration_column: self.acceleration_column.clone(),
            channel: self.channel.clone(),
            processing: self.processing()?,
        })
    }

    fn processing(&self) -> anyhow::Result<Processing> {
        let band_pass = match self.band_pass.as_deref() {
            Some(&[low, high]) => Some([low, high]),
            Some(corners) => anyhow::bail!("--band-pass has {} numbers; expected two, as in 0.1,25", corners.len()),
            None => None,
        };
        Ok(Processing { baseline: self.baseline, band_pass, resample: time_step("resample", self.resample)? })
    }
}

impl VerticalReadingOptions {
    fn read_options(&self) -> anyhow::Result<ReadOptions> {
        Ok(ReadOptions {
            format: self.vertical_format,
            unit: self.vertical_unit,
            time_step: time_step("vertical-dt", self.vertical_dt)?,
            layout: self.vertical_layout,
            skip: self.vertical_skip,
            value_scale: self.vertical_value_scale,
            time_column: self.vertical_time_column.clone(),
            acceleration_column: self.vertical_acceleration_column.clone(),
            channel: self.vertical_channel.clone(),
            ..ReadOptions::default()
        })
    }
}

fn time_step(option: &str, value: Option<f64>) -> anyhow::Result<Option<f64>> {
    checked(option, value, |x| x > 0.0, "a time > 0 s")
}
