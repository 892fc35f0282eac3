//! Options → the excitation: records and a pulse.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::options::accelerograms::{Accelerograms, MotionFiles};
use crate::options::block::in_options;
use crate::options::checks::check;
use crate::options::explicit::ExplicitOptions;
use crate::options::run::warn;
use crate::output::files::NamedFile;
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::space::SpaceGround;
use rocking_charts::numerals::significant;
use rocking_records::Record;
use rocking_studies::doubts;
use rocking_studies::intensity::pga;
use rocking_studies::space::ground::{ComponentNames, check_azimuth, of_components};
use rocking_studies::spec::PulseSpec;
use rocking_studies::spec::pulse::text;
use rocking_studies::spectrum::statistics::direction;
use rocking_studies::statistics::range;

/// Ground motions: records and a pulse.
#[derive(Args)]
pub struct ExcitationOptions {
    #[command(flatten)]
    pub accelerograms: Accelerograms,
    /// Scale factor on the accelerograms
    #[arg(long, default_value_t = 1.0)]
    pub scale: f64,
    #[command(flatten)]
    pulse: PulseSpec,
}

/// The second horizontal component, and the direction of both.
#[derive(Args)]
pub struct SecondComponentOptions {
    /// Accelerogram of the horizontal ground motion along y, a quarter turn ahead of --record; `-` for standard input
    #[arg(long, value_name = "FILE")]
    record_y: Option<PathBuf>,
    /// Direction of --record and of the pulse, from +x towards +y; it turns --record-y, if any, with them [degrees]
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0)]
    pub azimuth: f64,
}

/// The excitation of a run in space.
pub struct ExcitationInSpace {
    /// Scaled records.
    pub ground: SpaceGround,
    /// Pulse, along the azimuth.
    pub pulse: Pulse,
    /// Both in words, for summaries and pictures.
    pub description: String,
}

/// The excitations of runs.
pub struct Excitation {
    /// Scaled records with their names, at least one; without records an empty one.
    pub motions: Vec<(String, Ground)>,
    /// Pulse, the same for all.
    pub pulse: Pulse,
    /// All in words, for summaries and pictures.
    pub description: String,
}

impl ExcitationOptions {
    /// Returns whether there is a pulse and no record.
    pub fn is_pulse_alone(&self) -> bool {
        self.accelerograms.is_empty() && self.pulse.has_shape()
    }

    /// Reads the records. This gravity (m/s²) converts those in g, and `default` replaces a single horizontal record that is missing.
    pub fn read(
        &self,
        explicit: &ExplicitOptions,
        gravity: f64,
        default: Option<Record>,
    ) -> anyhow::Result<Excitation> {
        let has_record = default.is_some() || !self.accelerograms.is_empty();
        check_scale(explicit, self.scale, has_record)?;
        let mut grounds = self.accelerograms.read(gravity)?;
        if let Some(record) = default {
            grounds[0].horizontal.get_or_insert(record);
        }
        let grounds: Vec<Ground> = grounds.into_iter().map(|ground| ground.scaled(self.scale)).collect();
        let pulse = self.pulse.pulse().map_err(in_options)?;
        warn(doubts::of_pulses([(pulse, gravity)], has_record));
        let files = self.accelerograms.files();
        let names = names(&files);
        let mut parts = match (grounds.as_slice(), files.as_slice()) {
            ([ground], [files]) => describe_records(ground, *files, gravity),
            _ => {
                let pgas = grounds.iter().filter_map(|ground| ground.horizontal.as_ref().or(ground.vertical.as_ref()));
                let [least, greatest] = range(pgas.map(|record| pga(record) / gravity)).unwrap_or_default();
                let names = match names.as_slice() {
                    [first, .., last] if names.len() > 4 => format!("{first} … {last}"),
                    names => names.join(", "),
                };
                let [least, greatest] = [least, greatest].map(|pga| significant(pga, 3));
                vec![format!("{} records ({names}), {least} to {greatest} g", grounds.len())]
            }
        };
        parts.extend(describe_pulse(&pulse));
        if let Some((_, name)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
            anyhow::bail!("--record names {name} twice; expected each record once");
        }
        let motions = names.into_iter().zip(grounds).collect();
        Ok(Excitation { motions, pulse, description: parts.join(" + ") })
    }
}

impl SecondComponentOptions {
    /// Returns the file of the second component with its option.
    pub fn named(&self) -> Option<NamedFile> {
        self.record_y.as_ref().map(|path| NamedFile::new("--record-y", path))
    }

    /// Reads the records of all components. This gravity (m/s²) converts those in g, and `default` replaces a record along x.
    pub fn read(
        &self,
        first: &ExcitationOptions,
        explicit: &ExplicitOptions,
        gravity: f64,
        default: Option<Record>,
    ) -> anyhow::Result<ExcitationInSpace> {
        let has_record = default.is_some() || !first.accelerograms.is_empty();
        check_scale(explicit, first.scale, has_record)?;
        let ground = self.ground(&first.accelerograms, explicit, gravity, default, first.pulse.has_shape())?;
        let ground = ground.scaled_and_shifted(first.scale, 0.0);
        let pulse = first.pulse.pulse().map_err(in_options)?;
        warn(doubts::of_pulses([(pulse, gravity)], has_record));
        let files = first.accelerograms.files()[0];
        let paths = [files.horizontal, self.record_y.as_deref(), files.vertical];
        let mut parts: Vec<String> = Vec::new();
        for ((record, path), direction) in ground.records.iter().zip(paths).zip(["x ", "y ", "vertical "]) {
            parts.extend(record.as_ref().map(|record| describe_record(direction, record, path, gravity)));
        }
        parts.extend(describe_pulse(&pulse));
        if self.azimuth != 0.0 && !parts.is_empty() {
            parts.push(format!("azimuth {}°", self.azimuth));
        }
        Ok(ExcitationInSpace { ground, pulse, description: parts.join(" + ").replacen(" + azimuth", ", azimuth", 1) })
    }

    /// Reads the components and turns them. This gravity (m/s²) converts those in g, and `default` replaces a record along x.
    pub fn ground(
        &self,
        accelerograms: &Accelerograms,
        explicit: &ExplicitOptions,
        gravity: f64,
        default: Option<Record>,
        has_pulse: bool,
    ) -> anyhow::Result<SpaceGround> {
        check("azimuth", self.azimuth, |_| true, "a finite angle")?;
        let has_x = accelerograms.files()[0].horizontal.is_some();
        OPTIONS.check_pair(has_x, self.record_y.is_some()).map_err(anyhow::Error::msg)?;
        let (mut grounds, y) = accelerograms.read_with_y(gravity, self.record_y.as_deref())?;
        let ground = grounds.swap_remove(0);
        let x = ground.horizontal.or(default);
        check_azimuth("--azimuth", explicit.has("azimuth"), x.is_some(), has_pulse).map_err(anyhow::Error::msg)?;
        of_components([x, y, ground.vertical], self.azimuth.to_radians(), OPTIONS).map_err(anyhow::Error::msg)
    }
}

/// The components by their options.
const OPTIONS: ComponentNames = ComponentNames {
    names: ["--record", "--record-y", "--vertical"],
    resample: "--resample gives all components one step",
    cut: "cut the components to the samples that all have",
};

fn check_scale(explicit: &ExplicitOptions, scale: f64, has_record: bool) -> anyhow::Result<()> {
    check("scale", scale, |_| true, "a finite factor")?;
    explicit.refuse_unless(has_record, &["scale"], "without --record or --vertical")
}

/// Describes the records of a ground motion. Their PGA is in units of this gravity (m/s²).
fn describe_records(ground: &Ground, files: MotionFiles, gravity: f64) -> Vec<String> {
    let parts = [("", &ground.horizontal, files.horizontal), ("vertical ", &ground.vertical, files.vertical)];
    let described = parts.into_iter().filter_map(|(direction, record, path)| {
        record.as_ref().map(|record| describe_record(direction, record, path, gravity))
    });
    described.collect()
}

/// Describes a record in a direction.
fn describe_record(direction: &str, record: &Record, path: Option<&Path>, gravity: f64) -> String {
    let processing = if record.processing.is_none() { String::new() } else { format!(", {}", record.processing) };
    format!("{direction}{}{processing}, {} g", title(record, path), significant(pga(record) / gravity, 3))
}

/// Names ground motions. A single one is named by its directions, several by their files, with folders if names repeat.
pub fn names(files: &[MotionFiles]) -> Vec<String> {
    if let [files] = files {
        return vec![direction(files.vertical.is_some()).into()];
    }
    let name = |of: fn(&Path) -> String| {
        let name = |files: &MotionFiles| {
            [files.horizontal, files.vertical].into_iter().flatten().map(of).collect::<Vec<_>>().join(" + ")
        };
        files.iter().map(name).collect::<Vec<_>>()
    };
    let short = name(|path| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into());
    let repeats = short.iter().enumerate().any(|(i, name)| short[..i].contains(name));
    if repeats { name(|path| path.display().to_string()) } else { short }
}

/// Describes a pulse, if it has a shape.
fn describe_pulse(pulse: &Pulse) -> Option<String> {
    (pulse.shape != PulseShape::None).then(|| text(pulse))
}

/// Returns file and title of a record on one line. The path replaces a missing title.
fn title(record: &Record, path: Option<&Path>) -> String {
    let title = record.title.split_whitespace().collect::<Vec<_>>().join(" ");
    let Some(path) = path else { return title };
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    if path.as_os_str() == record.title.as_str() { file.into() } else { format!("{file}: {title}") }
}
