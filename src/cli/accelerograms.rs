//! Options that name accelerograms, and say of them what their files do not → ground motions.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::excitation::finite;
use crate::cli::input;
use crate::cli::output::Named;
use crate::records::ground::Ground;
use crate::records::{Column, Format, ReadOptions, Unit};
use crate::study::ground_files::{Name, Said};

/// Options that name the records of one ground motion.
#[derive(Args)]
pub struct Accelerograms {
    /// Accelerogram of the horizontal ground motion: PEER AT2, USGS SMC, CSV, COSMOS, CSMIP or ESM; `-` for standard input
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Accelerogram of the vertical ground motion; `-` for standard input
    #[arg(long, value_name = "FILE")]
    pub vertical: Option<PathBuf>,
    #[command(flatten)]
    of_both: OfBoth,
    #[command(flatten)]
    of_vertical: OfVertical,
}

/// Options that name the records of several ground motions.
#[derive(Args)]
pub struct ManyAccelerograms {
    /// Accelerograms of horizontal ground motions, one or several: PEER AT2, USGS SMC, CSV, COSMOS, CSMIP or ESM; `-` for
    /// standard input
    #[arg(long, value_name = "FILE", num_args = 1..)]
    record: Vec<PathBuf>,
    /// Accelerograms of their vertical ground motions, in the same order; `-` for standard input
    #[arg(long, value_name = "FILE", num_args = 1..)]
    vertical: Vec<PathBuf>,
    #[command(flatten)]
    of_both: OfBoth,
    #[command(flatten)]
    of_vertical: OfVertical,
}

/// The files of one ground motion.
#[derive(Clone, Copy)]
pub struct Files<'a> {
    /// That of the horizontal one.
    pub along: Option<&'a Path>,
    /// That of the vertical one.
    pub up: Option<&'a Path>,
}

/// What the files do not say.
#[derive(Args)]
pub struct OfBoth {
    /// Unit of the accelerograms, where they do not say: g, m/s2 or cm/s2
    #[arg(long)]
    unit: Option<Unit>,
    /// Time step of the accelerograms, where they do not say [s]
    #[arg(long, value_name = "S")]
    dt: Option<f64>,
    /// Format, where the content does not tell: peer, smc, columns, cosmos, csmip or esm
    #[arg(long)]
    format: Option<Format>,
    /// Channel of COSMOS and CSMIP files that have several, from 1
    #[arg(long, value_name = "N")]
    channel: Option<usize>,
    /// Column of the accelerations in a table: its name, or its number from 1
    #[arg(long, value_name = "COLUMN")]
    acceleration_column: Option<Column>,
    /// Column of the times in a table: its name, or its number from 1
    #[arg(long, value_name = "COLUMN")]
    time_column: Option<Column>,
}

/// What vertical files do not say.
#[derive(Args)]
pub struct OfVertical {
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
    #[arg(long, value_name = "N")]
    vertical_channel: Option<usize>,
    /// Column of the vertical accelerations, instead of --acceleration-column
    #[arg(long, value_name = "COLUMN")]
    vertical_acceleration_column: Option<Column>,
    /// Column of the vertical accelerogram's times, instead of --time-column
    #[arg(long, value_name = "COLUMN")]
    vertical_time_column: Option<Column>,
}

impl Files<'_> {
    /// The files by the options that name them.
    pub fn named(&self) -> Vec<Named> {
        let files = [("--record", self.along), ("--vertical", self.up)];
        files.into_iter().filter_map(|(option, path)| Some(Named::new(option, path?))).collect()
    }
}

impl Accelerograms {
    /// Whether no record is named.
    pub fn is_empty(&self) -> bool {
        self.record.is_none() && self.vertical.is_none()
    }

    /// The files.
    pub fn files(&self) -> Files<'_> {
        Files { along: self.record.as_deref(), up: self.vertical.as_deref() }
    }

    /// Reads the records, with this gravity for those in g (m/s²).
    pub fn read(&self, gravity: f64) -> anyhow::Result<Ground> {
        let grounds = read(&[self.files()], &self.of_both, &self.of_vertical, gravity)?;
        Ok(grounds.into_iter().next().unwrap_or_default())
    }
}

impl ManyAccelerograms {
    /// Whether no record is named.
    pub fn is_empty(&self) -> bool {
        self.record.is_empty() && self.vertical.is_empty()
    }

    /// The files, at least those of one ground motion, which may be none.
    pub fn files(&self) -> Vec<Files<'_>> {
        let count = self.record.len().max(self.vertical.len()).max(1);
        let files = |i| Files {
            along: self.record.get(i).map(PathBuf::as_path),
            up: self.vertical.get(i).map(PathBuf::as_path),
        };
        (0..count).map(files).collect()
    }

    /// Reads the records of each ground motion, with this gravity for those in g (m/s²).
    pub fn read(&self, gravity: f64) -> anyhow::Result<Vec<Ground>> {
        let (along, up) = (self.record.len(), self.vertical.len());
        anyhow::ensure!(
            along == 0 || up == 0 || along == up,
            "--record names {along} files and --vertical {up}; expected as many, in the same order"
        );
        read(&self.files(), &self.of_both, &self.of_vertical, gravity)
    }
}

fn read(files: &[Files], of_both: &OfBoth, of_vertical: &OfVertical, gravity: f64) -> anyhow::Result<Vec<Ground>> {
    let said = Said { of_both: of_both.options(gravity)?, of_vertical: of_vertical.options()? };
    let named = files.iter().flat_map(|files| [("--record", files.along), ("--vertical", files.up)]);
    input::check_one_standard(named.filter_map(|(option, path)| Some((option, path?))))?;
    let read = |path: Option<&Path>, is_vertical| {
        let read = |path| said.read(is_vertical, Name::option, |options| input::record(path, options));
        path.map(read).transpose().map_err(anyhow::Error::msg)
    };
    let ground = |files: &Files| Ok(Ground { horizontal: read(files.along, false)?, vertical: read(files.up, true)? });
    let grounds = files.iter().map(ground).collect::<anyhow::Result<Vec<_>>>()?;
    all_read(&said, &grounds)?;
    Ok(grounds)
}

/// Refuses options on files that no file has read.
pub fn all_read(said: &Said, grounds: &[Ground]) -> anyhow::Result<()> {
    match said.unread(grounds) {
        Some((name, needed)) => anyhow::bail!("{} has no effect without {needed}", name.option()),
        None => Ok(()),
    }
}

impl OfBoth {
    /// What is said, with this gravity for records in g (m/s²).
    pub fn options(&self, gravity: f64) -> anyhow::Result<ReadOptions> {
        Ok(ReadOptions {
            format: self.format,
            unit: self.unit,
            time_step: time_step("dt", self.dt)?,
            gravity,
            time_column: self.time_column.clone(),
            acceleration_column: self.acceleration_column.clone(),
            channel: self.channel,
        })
    }
}

impl OfVertical {
    fn options(&self) -> anyhow::Result<ReadOptions> {
        Ok(ReadOptions {
            format: self.vertical_format,
            unit: self.vertical_unit,
            time_step: time_step("vertical-dt", self.vertical_dt)?,
            time_column: self.vertical_time_column.clone(),
            acceleration_column: self.vertical_acceleration_column.clone(),
            channel: self.vertical_channel,
            ..ReadOptions::default()
        })
    }
}

fn time_step(option: &str, value: Option<f64>) -> anyhow::Result<Option<f64>> {
    value.map_or(Ok(()), |value| finite(option, value, |x| x > 0.0, "a time > 0 s"))?;
    Ok(value)
}
