//! Options that say what moves the ground → records and a pulse.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::cli::input;
use crate::excitation::{Pulse, PulseShape};
use crate::records::{ReadOptions, Record, Unit};
use crate::study::ground::Ground;

/// Options that say what moves the ground.
#[derive(Args)]
pub struct Excitation {
    #[command(flatten)]
    pub accelerograms: Accelerograms,
    /// Factor on the accelerograms
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    pub scale: f64,
    /// Pulse, alone or added to the record
    #[arg(long, value_enum, default_value_t = Shape::None)]
    pub pulse: Shape,
    /// Amplitude a_p of the pulse [m/s2]
    #[arg(long, value_name = "A", default_value_t = 0.0, allow_negative_numbers = true)]
    pub amplitude: f64,
    /// Period T_p of the pulse [s]
    #[arg(long, value_name = "S", default_value_t = 1.0)]
    pub period: f64,
    /// Time at which the pulse begins [s]
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    pub start: f64,
}

/// Options that say which records there are.
#[derive(Args)]
pub struct Accelerograms {
    /// Accelerogram of the horizontal ground motion: PEER AT2, USGS SMC, CSV, COSMOS, CSMIP or ESM; `-` for standard input
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Accelerogram of the vertical ground motion; `-` for standard input
    #[arg(long, value_name = "FILE")]
    pub vertical: Option<PathBuf>,
    /// Unit of the accelerograms, where they do not say: g, m/s2 or cm/s2
    #[arg(long)]
    pub unit: Option<Unit>,
    /// Time step of the accelerograms, where they do not say [s]
    #[arg(long, value_name = "S")]
    pub dt: Option<f64>,
}

/// Shapes of pulses.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub enum Shape {
    /// No pulse
    None,
    /// Type A: one sine in acceleration
    OneSine,
    /// Type B: one cosine in acceleration
    OneCosine,
    /// Type C1: one cycle of displacement and back
    C1,
    /// Type C2: two cycles of displacement and back
    C2,
}

/// What moves the ground.
pub struct Motion {
    /// Records, scaled.
    pub ground: Ground,
    /// Pulse.
    pub pulse: Pulse,
    /// Both in words.
    pub source: String,
}

impl Accelerograms {
    /// Whether no record is named.
    pub fn is_empty(&self) -> bool {
        self.record.is_none() && self.vertical.is_none()
    }

    /// Reads the records, with this gravity for those in g (m/s²).
    pub fn read(&self, gravity: f64) -> anyhow::Result<Ground> {
        let options = ReadOptions { unit: self.unit, time_step: self.dt, gravity, ..ReadOptions::default() };
        let load = |path: &Option<PathBuf>| -> anyhow::Result<Option<Record>> {
            Ok(path.as_deref().map(|path| input::record(path, &options)).transpose()?)
        };
        input::check_one_standard([&self.record, &self.vertical])?;
        Ok(Ground { horizontal: load(&self.record)?, vertical: load(&self.vertical)? })
    }
}

impl Excitation {
    /// Whether nothing is asked for.
    pub fn is_empty(&self) -> bool {
        self.accelerograms.is_empty() && self.pulse == Shape::None
    }

    /// Whether there is a pulse and no record.
    pub fn is_pulse_alone(&self) -> bool {
        self.accelerograms.is_empty() && self.pulse != Shape::None
    }

    /// Reads the records, with this gravity for those in g (m/s²); `instead` stands for a horizontal one that is not
    /// named.
    pub fn read(&self, gravity: f64, instead: Option<Record>) -> anyhow::Result<Motion> {
        finite("scale", self.scale, |_| true, "a finite factor")?;
        let Ground { horizontal, vertical } = self.accelerograms.read(gravity)?;
        let horizontal = horizontal.or(instead);
        let pulse = self.pulse()?;
        let mut words = Vec::new();
        let Accelerograms { record: along, vertical: up, .. } = &self.accelerograms;
        for (direction, record, path) in [("", &horizontal, along), ("vertical ", &vertical, up)] {
            if let Some(record) = record {
                let pga = record.peak().acceleration.abs() * self.scale.abs() / gravity;
                words.push(format!("{direction}{}, {pga:.3} g", title(record, path.as_deref())));
            }
        }
        if pulse.shape != PulseShape::None {
            let name = self.pulse.to_possible_value().map(|v| v.get_name().to_string()).unwrap_or_default();
            words.push(format!("{name} pulse, a_p = {} m/s², T_p = {} s", pulse.amplitude, pulse.period));
        }
        let ground = Ground { horizontal, vertical }.scaled(self.scale);
        Ok(Motion { ground, pulse, source: words.join(" + ") })
    }

    fn pulse(&self) -> anyhow::Result<Pulse> {
        let Excitation { pulse, amplitude, period, start, .. } = *self;
        finite("amplitude", amplitude, |_| true, "a finite acceleration")?;
        finite("period", period, |x| x > 0.0, "a time > 0 s")?;
        finite("start", start, |_| true, "a finite time")?;
        anyhow::ensure!(
            pulse == Shape::None || amplitude != 0.0,
            "--amplitude = 0 m/s2 makes no pulse; expected the amplitude a_p"
        );
        Ok(Pulse { shape: pulse.into(), amplitude, period, start })
    }
}

impl From<Shape> for PulseShape {
    fn from(shape: Shape) -> PulseShape {
        match shape {
            Shape::None => PulseShape::None,
            Shape::OneSine => PulseShape::OneSine,
            Shape::OneCosine => PulseShape::OneCosine,
            Shape::C1 => PulseShape::C1,
            Shape::C2 => PulseShape::C2,
        }
    }
}

/// Title of a record on one line; a file without a header has no other title than its path.
fn title(record: &Record, path: Option<&Path>) -> String {
    match path.filter(|path| path.as_os_str() == record.title.as_str()) {
        Some(path) => path.file_name().unwrap_or_default().to_string_lossy().into(),
        None => record.title.split_whitespace().collect::<Vec<_>>().join(" "),
    }
}

/// Refuses a value of an option, with a sentence that names both.
pub fn finite(name: &str, value: f64, fits: impl Fn(f64) -> bool, expected: &str) -> anyhow::Result<()> {
    anyhow::ensure!(value.is_finite() && fits(value), "--{name} = {value}; expected {expected}");
    Ok(())
}
