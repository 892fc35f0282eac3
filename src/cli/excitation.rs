//! Options that say what moves the ground → records and a pulse.

use std::path::Path;

use clap::{Args, ValueEnum};

use crate::cli::accelerograms::{Accelerograms, Files, ManyAccelerograms};
use crate::cli::given::Given;
use crate::excitation::{Pulse, PulseShape};
use crate::records::Record;
use crate::records::ground::Ground;
use crate::study::intensity::pga;
use crate::study::numerals::significant;
use crate::study::spectrum_statistics::direction;

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

/// Options that say what moves the ground, in one way or in several.
#[derive(Args)]
pub struct Excitations {
    #[command(flatten)]
    pub accelerograms: ManyAccelerograms,
    /// Factor on the accelerograms
    #[arg(long, default_value_t = 1.0)]
    scale: f64,
    #[command(flatten)]
    pulse: PulseOptions,
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

/// What moves the ground in each of several ways.
pub struct Motions {
    /// Records, scaled, with their names; at least one, which may be none.
    pub grounds: Vec<(String, Ground)>,
    /// Pulse, the same for all.
    pub pulse: Pulse,
    /// All in words.
    pub source: String,
}

impl Excitation {
    /// Reads the records, with this gravity for those in g (m/s²); `instead` stands for a horizontal one that is not
    /// named.
    pub fn read(&self, given: &Given, gravity: f64, instead: Option<Record>) -> anyhow::Result<Motion> {
        let has_record = instead.is_some() || !self.accelerograms.is_empty();
        check_scale(given, self.scale, has_record)?;
        let Ground { horizontal, vertical } = self.accelerograms.read(gravity)?;
        let ground = Ground { horizontal: horizontal.or(instead), vertical }.scaled(self.scale);
        let pulse = self.pulse.read(given)?;
        let mut words = words(&ground, self.accelerograms.files(), gravity);
        words.extend(self.pulse.words(&pulse));
        Ok(Motion { ground, pulse, source: words.join(" + ") })
    }
}

impl Excitations {
    /// Whether there is a pulse and no record.
    pub fn is_pulse_alone(&self) -> bool {
        self.accelerograms.is_empty() && self.pulse.shape != Shape::None
    }

    /// Reads the records, with this gravity for those in g (m/s²).
    pub fn read(&self, given: &Given, gravity: f64) -> anyhow::Result<Motions> {
        check_scale(given, self.scale, !self.accelerograms.is_empty())?;
        let grounds = self.accelerograms.read(gravity)?;
        let grounds: Vec<Ground> = grounds.into_iter().map(|ground| ground.scaled(self.scale)).collect();
        let pulse = self.pulse.read(given)?;
        let files = self.accelerograms.files();
        let mut words = match (grounds.as_slice(), files.as_slice()) {
            ([ground], [files]) => words(ground, *files, gravity),
            _ => {
                let pgas = grounds.iter().filter_map(|ground| ground.horizontal.as_ref().or(ground.vertical.as_ref()));
                let pgas: Vec<f64> = pgas.map(|record| pga(record) / gravity).collect();
                let [least, greatest] = [f64::min, f64::max].map(|of| pgas.iter().copied().reduce(of).unwrap_or(0.0));
                let names = names(&files);
                let names = match names.as_slice() {
                    [first, .., last] if names.len() > 4 => format!("{first} … {last}"),
                    names => names.join(", "),
                };
                let [least, greatest] = [least, greatest].map(|pga| significant(pga, 3));
                vec![format!("{} records ({names}), {least} to {greatest} g", grounds.len())]
            }
        };
        words.extend(self.pulse.words(&pulse));
        let names = names(&files);
        if let Some((_, name)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
            anyhow::bail!("--record names {name} twice; expected each record once");
        }
        let grounds = names.into_iter().zip(grounds).collect();
        Ok(Motions { grounds, pulse, source: words.join(" + ") })
    }
}

fn check_scale(given: &Given, scale: f64, has_record: bool) -> anyhow::Result<()> {
    finite("scale", scale, |_| true, "a finite factor")?;
    given.only_if(has_record, &["scale"], "without --record or --vertical")
}

/// What the records of a ground motion are, and their PGA in units of this gravity (m/s²).
fn words(ground: &Ground, files: Files, gravity: f64) -> Vec<String> {
    let parts = [("", &ground.horizontal, files.along), ("vertical ", &ground.vertical, files.up)];
    let parts = parts.into_iter().filter_map(|(direction, record, path)| {
        let record = record.as_ref()?;
        Some(format!("{direction}{}, {} g", title(record, path), significant(pga(record) / gravity, 3)))
    });
    parts.collect()
}

/// Names of ground motions: that of a single one says which directions it has, others have those of their files, with
/// folders if two would be called the same.
pub fn names(files: &[Files]) -> Vec<String> {
    if let [files] = files {
        return vec![direction(files.up.is_some()).into()];
    }
    let name = |of: fn(&Path) -> String| {
        let name =
            |files: &Files| [files.along, files.up].into_iter().flatten().map(of).collect::<Vec<_>>().join(" + ");
        files.iter().map(name).collect::<Vec<_>>()
    };
    let short = name(|path| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into());
    let is_twice = short.iter().enumerate().any(|(i, name)| short[..i].contains(name));
    if is_twice { name(|path| path.display().to_string()) } else { short }
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
            "--amplitude = 0 m/s2 is not a pulse; expected the amplitude a_p"
        );
        Ok(Pulse { shape: shape.into(), amplitude, period, start })
    }
}

impl PulseOptions {
    /// The pulse in words, if it is one.
    fn words(&self, pulse: &Pulse) -> Option<String> {
        let name = self.shape.to_possible_value().map(|v| v.get_name().to_string()).unwrap_or_default();
        let Pulse { shape, amplitude, period, .. } = pulse;
        (*shape != PulseShape::None).then(|| format!("{name} pulse, a_p = {amplitude} m/s², T_p = {period} s"))
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

/// File and title of a record on one line; a file without a header has no other title than its path.
fn title(record: &Record, path: Option<&Path>) -> String {
    let title = record.title.split_whitespace().collect::<Vec<_>>().join(" ");
    let Some(path) = path else { return title };
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    if path.as_os_str() == record.title.as_str() { file.into() } else { format!("{file}: {title}") }
}

/// Refuses a value of an option, with a sentence that names both.
pub fn finite(name: &str, value: f64, fits: impl Fn(f64) -> bool, expected: &str) -> anyhow::Result<()> {
    anyhow::ensure!(value.is_finite() && fits(value), "--{name} = {value}; expected {expected}");
    Ok(())
}
