//! `rocking spectrum`: options → peak rotations of blocks of all sizes → a table and a picture.

use std::path::PathBuf;

use clap::{Args, Parser, ValueEnum};

use crate::block::Common;
use crate::cli::accelerograms::Files;
use crate::cli::excitation::{Excitations, Motions, finite, names};
use crate::cli::formats::{PictureOptions, check_table};
use crate::cli::given::Given;
use crate::cli::output::{Named, Pending, check_distinct};
use crate::cli::report::is_standard_output;
use crate::cli::run_options::{RunOptions, SizeOptions, StudyOptions, warn_of_soft_supports};
use crate::excitation::PulseShape;
use crate::records::ground::Ground;
use crate::study::records_plot;
use crate::study::spectrum::{Base, Sizes, Spectrum};
use crate::study::spectrum_plot::{self, Abscissa};
use crate::study::spectrum_statistics::Statistics;

/// Options of `rocking spectrum`.
#[derive(Parser)]
pub struct Options {
    #[command(flatten, next_help_heading = "Excitation")]
    excitation: Excitations,
    /// With --vertical: the horizontal motion alone as well, in curves of its own
    #[arg(long, help_heading = "Excitation")]
    also_horizontal: bool,
    #[command(flatten)]
    blocks: Blocks,
    #[command(flatten)]
    run: RunOptions,
    /// Coefficient of friction: adds a column of the longest time for which |H|/(N_L + N_R) exceeds it, looked at each ms
    #[arg(long, value_name = "MU", help_heading = "Results")]
    friction: Option<f64>,
    #[command(flatten)]
    study: StudyOptions,
    #[command(flatten)]
    picture: PictureOptions,
    /// What the sizes are drawn over; without it omega_p/p for a pulse, 2pi/p for a record
    #[arg(long, value_enum, help_heading = "Results")]
    over: Option<Over>,
    /// With several records: table of the statistics over them, for each foundation and size
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    statistics: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Over {
    /// 2 pi/p in seconds
    #[value(name = "2pi/p")]
    TwoPiOverP,
    /// Frequency ratio of pulse and block
    #[value(name = "omega_p/p")]
    PulseRatio,
}

#[derive(Args)]
#[command(next_help_heading = "Blocks")]
struct Blocks {
    /// Slenderness angle alpha [rad]; or --width and --height, whose ratio alone counts, since p is the size
    #[arg(long, value_name = "RAD", default_value_t = 0.25)]
    alpha: f64,
    #[command(flatten)]
    size: SizeOptions,
    /// Foundation as ETA,XI_V,EPSILON, or `rigid` (`rigid,EPSILON` for Housner's e of another epsilon than 0,
    /// `rigid,EPSILON,FACTOR` for a restitution that is FACTOR times that); once for each curve
    #[arg(long, value_name = "BASE", allow_hyphen_values = true, default_values = ["40,0.1,0", "rigid"])]
    foundation: Vec<String>,
    /// Least frequency parameter p, of the largest block [rad/s]
    #[arg(long, value_name = "RAD/S", default_value_t = 0.5)]
    p_min: f64,
    /// Greatest frequency parameter p, of the smallest block [rad/s]
    #[arg(long, value_name = "RAD/S", default_value_t = 8.0)]
    p_max: f64,
    /// Blocks on each foundation, evenly spaced in 1/p
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u64).range(2..=1_000_000_000))]
    points: u64,
    /// Mass M [kg]
    #[arg(long, value_name = "KG", default_value_t = Common::default().mass)]
    mass: f64,
    /// Shape factor gamma = M R0²/I0
    #[arg(long, default_value_t = Common::default().gamma)]
    gamma: f64,
    /// Gravity, also for records in g [m/s2]
    #[arg(long, value_name = "M/S2", default_value_t = Common::default().gravity)]
    g: f64,
}

/// A foundation from its option.
fn base(text: &str) -> anyhow::Result<Base> {
    let lower = text.to_lowercase();
    let (rigid, numbers) = match lower.strip_prefix("rigid") {
        Some("") => return Ok(Base::HOUSNER),
        Some(rest) => (true, rest.strip_prefix(',').unwrap_or(rest)),
        None => (false, lower.as_str()),
    };
    let numbers: Result<Vec<f64>, _> = numbers.split(',').map(|number| number.trim().parse::<f64>()).collect();
    match (rigid, numbers.unwrap_or_default().as_slice()) {
        (true, &[epsilon]) => Ok(Base::Rigid { epsilon, restitution_factor: 1.0 }),
        (true, &[epsilon, restitution_factor]) => Ok(Base::Rigid { epsilon, restitution_factor }),
        (false, &[eta, xi_v, epsilon]) => Ok(Base::Viscoelastic { eta, xi_v, epsilon }),
        _ => anyhow::bail!(
            "--foundation {text}; expected ETA,XI_V,EPSILON, as in 40,0.1,0, or rigid, rigid,EPSILON or rigid,EPSILON,FACTOR"
        ),
    }
}

/// Does what the options say.
pub fn run(options: &Options, given: &Given) -> anyhow::Result<()> {
    given.only_if(options.picture.plot.is_some(), &["over", "plot-format"], "without --plot")?;
    given.only_if(given.has("vertical"), &["also-horizontal"], "without --vertical")?;
    let (csv, plot) = (&options.study.csv, options.picture.plot.as_deref());
    let statistics_path = options.statistics.as_deref();
    check_table(csv)?;
    statistics_path.map_or(Ok(()), check_table)?;
    let format = options.picture.format()?;
    let outputs = [("--csv", Some(csv.as_path())), ("--plot", plot), ("--statistics", statistics_path)];
    let outputs: Vec<Named> = outputs.iter().filter_map(|(option, path)| Some(Named::new(option, (*path)?))).collect();
    let files = options.excitation.accelerograms.files();
    check_distinct(&files.iter().flat_map(Files::named).collect::<Vec<_>>(), &outputs)?;
    given.only_if(files.len() > 1, &["statistics"], "without several records")?;
    let (spectrum, source) = options.spectrum(given)?;
    let over = match options.over {
        Some(Over::TwoPiOverP) => Abscissa::TwoPiOverP,
        Some(Over::PulseRatio) => Abscissa::PulseRatio,
        None if spectrum.pulse.shape != PulseShape::None && options.excitation.is_pulse_alone() => Abscissa::PulseRatio,
        None => Abscissa::TwoPiOverP,
    };
    let without_pulse = over == Abscissa::PulseRatio && spectrum.pulse.shape == PulseShape::None;
    anyhow::ensure!(!without_pulse, "--over omega_p/p without a pulse; expected --pulse or --over 2pi/p");
    let picture = plot.map(Pending::new).transpose()?;
    let statistics_file = statistics_path.map(Pending::new).transpose()?;
    // A reader of standard output who has seen enough ends the work, unless something else is made of the rows.
    let read_back = picture.is_some() || statistics_file.is_some() || !is_standard_output(csv);
    let (made, table) = options.study.run(&spectrum, read_back)?;
    let statistics = if read_back { Statistics::of(&spectrum, table.read_back()?) } else { Ok(Statistics::default()) };
    let statistics = statistics.map_err(|error| anyhow::anyhow!("{}: {error}", csv.display()))?;
    let mut written = Vec::new();
    if let (Some(file), Some(format)) = (picture, format) {
        let svg = match files.len() {
            1 => spectrum_plot::spectrum(&spectrum, table.read_back()?, over, &source)?,
            _ => records_plot::spectrum(&spectrum, &statistics, table.read_back()?, over, &source)?,
        };
        written.push((file, format.encode(&svg)?));
    }
    if let Some(file) = statistics_file {
        written.push((file, statistics.table(&spectrum)?));
    }
    Pending::write(written)?;
    let others = [("statistics", statistics_path), ("plot", plot)];
    options.study.report("spectrum", &made, Some(&source), &statistics.curves, &others)
}

impl Options {
    /// The spectrum, and what excites it.
    fn spectrum(&self, given: &Given) -> anyhow::Result<(Spectrum, String)> {
        let Blocks { alpha, ref size, ref foundation, p_min, p_max, points, mass, gamma, g } = self.blocks;
        let alpha = match size.read(given, &["alpha"])? {
            Some([width, height]) => libm::atan2(width, height),
            None => alpha,
        };
        let Motions { grounds, pulse, source } = self.excitation.read(given, g)?;
        let nothing = self.excitation.accelerograms.is_empty() && pulse.shape == PulseShape::None;
        anyhow::ensure!(!nothing, "nothing moves the ground; expected --record, --vertical or --pulse");
        self.friction.map_or(Ok(()), |friction| finite("friction", friction, |x| x > 0.0, "a coefficient > 0"))?;
        finite("p-min", p_min, |x| x >= 0.001, "a frequency of at least 0.001 rad/s")?;
        finite("p-max", p_max, |x| x > p_min, "a frequency above --p-min")?;
        let mut motions = Vec::new();
        if self.also_horizontal {
            let files = self.excitation.accelerograms.files();
            let along = files.iter().map(|files| Files { up: None, ..*files }).collect::<Vec<_>>();
            let alone = grounds.iter().map(|(_, ground)| Ground { vertical: None, ..ground.clone() });
            motions.extend(names(&along).into_iter().zip(alone));
        }
        motions.extend(grounds);
        let bases = foundation.iter().map(|text| base(text)).collect::<anyhow::Result<Vec<_>>>()?;
        let spectrum = Spectrum {
            alpha,
            common: Common { mass, gamma, gravity: g, ..Common::default() },
            bases,
            sizes: Sizes { least: p_min, greatest: p_max, count: points },
            motions,
            pulse,
            settings: self.run.settings()?,
            duration: self.run.duration()?,
            step: self.run.step()?,
            friction: self.friction,
        };
        spectrum.check()?;
        // The sizes of a foundation have the same eta, and thus fall over together.
        for &base in &spectrum.bases {
            warn_of_soft_supports(&spectrum.block(base, p_max)?);
        }
        Ok((spectrum, source))
    }
}
