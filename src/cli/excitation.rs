//! Options that say what moves the ground → records and a pulse.

use std::path::Path;

use clap::{Args, ValueEnum};

use crate::cli::accelerograms::Accelerograms;
use crate::cli::given::Given;
use crate::excitation::{Pulse, PulseShape};
use crate::records::Record;
use crate::study::ground::Ground;

/// Options that say what moves the ground.
#[derive(Args)]
pub struct Excitation {
    #[command(flatten)]
    pub accelerograms: Accelerograms,
    /// Factor on the accelerograms
    #[arg(long, default_value_t = 1.0)]
    pub scale: f64,
    #[command(flatten)]
    pub pulse: PulseOptions,
}

/// Options of a pulse.
#[derive(Args)]
pub struct PulseOptions {
    /// Pulse, alone or added to the record
    #[arg(id = "pulse", long = "pulse", value_name = "SHAPE", value_enum, default_value_t = Shape::None)]
    shape: Shape,
    /// Amplitude a_p of the pulse [m/s2]
    #[arg(long, value_name = "A", default_value_t = 0.0)]
    amplitude: f64,
    /// Period T_p of the pulse [s]
    #[arg(long, value_name = "S", default_value_t = 1.0)]
    period: f64,
    /// Time at which the pulse begins [s]
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    start: f64,
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

impl Excitation {
    /// Whether there is a pulse and no record.
    pub fn is_pulse_alone(&self) -> bool {
        self.accelerograms.is_empty() && self.pulse.shape != Shape::None
    }

    /// Reads the records, with this gravity for those in g (m/s²); `instead` stands for a horizontal one that is not
    /// named.
    pub fn read(&self, given: &Given, gravity: f64, instead: Option<Record>) -> anyhow::Result<Motion> {
        finite("scale", self.scale, |_| true, "a finite factor")?;
        let has_record = instead.is_some() || !self.accelerograms.is_empty();
        given.only_if(has_record, &["scale"], "without --record or --vertical")?;
        let Ground { horizontal, vertical } = self.accelerograms.read(gravity)?;
        let horizontal = horizontal.or(instead);
        let pulse = self.pulse.read(given)?;
        let mut words = Vec::new();
        let Accelerograms { record: along, vertical: up, .. } = &self.accelerograms;
        for (direction, record, path) in [("", &horizontal, along), ("vertical ", &vertical, up)] {
            if let Some(record) = record {
                let pga = record.peak().acceleration.abs() * self.scale.abs() / gravity;
                words.push(format!("{direction}{}, {pga:.3} g", title(record, path.as_deref())));
            }
        }
        if pulse.shape != PulseShape::None {
            let name = self.pulse.shape.to_possible_value().map(|v| v.get_name().to_string()).unwrap_or_default();
            words.push(format!("{name} pulse, a_p = {} m/s², T_p = {} s", pulse.amplitude, pulse.period));
        }
        let ground = Ground { horizontal, vertical }.scaled(self.scale);
        Ok(Motion { ground, pulse, source: words.join(" + ") })
    }
}

impl PulseOptions {
    /// The pulse, which may be none.
    fn read(&self, given: &Given) -> anyhow::Result<Pulse> {
        let PulseOptions { shape, amplitude, period, start } = *self;
        given.only_if(shape != Shape::None, &["amplitude", "period", "start"], "without --pulse")?;
        finite("amplitude", amplitude, |_| true, "a finite acceleration")?;
        finite("period", period, |x| x > 0.0, "a time > 0 s")?;
        finite("start", start, |_| true, "a finite time")?;
        anyhow::ensure!(
            shape == Shape::None || amplitude != 0.0,
            "--amplitude = 0 m/s2 makes no pulse; expected the amplitude a_p"
        );
        Ok(Pulse { shape: shape.into(), amplitude, period, start })
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
