//! `rocking spectrum`: options → peak rotations of blocks of all sizes → a table and a picture.

use std::path::PathBuf;

use clap::{Args, Parser};

use crate::options::accelerograms::MotionFiles;
use crate::options::block::in_options;
use crate::options::checks::check;
use crate::options::choices;
use crate::options::excitation::{Excitation, ExcitationOptions, names};
use crate::options::explicit::ExplicitOptions;
use crate::options::run::{SizeOptions, StudyOptions, warn};
use crate::output::files::{NamedFile, Outputs, check_distinct};
use crate::output::formats::{PictureOptions, check_table};
use crate::output::report::is_standard_output;
use crate::output::summary::{Summary, aligned};
use rocking_block::block::Common;
use rocking_block::block::restraints::Tie;
use rocking_block::excitation::PulseShape;
use rocking_block::excitation::records::Ground;
use rocking_charts::spectrum::{Abscissa, Curves};
use rocking_studies::doubts;
use rocking_studies::output::format::DescribedTable;
use rocking_studies::output::resumable::TableWriteError;
use rocking_studies::output::runner::Study;
use rocking_studies::output::table::Table;
use rocking_studies::spec::words::friction;
use rocking_studies::spec::{BlockSpec, RunSpec, damper, tie};
use rocking_studies::spectrum::statistics::{BlockOutcome, CurveSummary, EndCounts, Greatest, Statistics};
use rocking_studies::spectrum::{CheckedSpectrum, ScaledFeatures, Sizes, Spectrum};

/// Options of `rocking spectrum`.
#[derive(Parser)]
pub struct SpectrumCommand {
    #[command(flatten, next_help_heading = "Excitation")]
    excitation: ExcitationOptions,
    /// With --vertical: also draw curves of the horizontal motion alone
    #[arg(long, help_heading = "Excitation")]
    also_horizontal: bool,
    #[command(flatten)]
    blocks: BlockOptions,
    #[command(flatten)]
    run: RunSpec,
    #[command(flatten)]
    study: StudyOptions,
    #[command(flatten)]
    picture: PictureOptions,
    /// Horizontal axis of the picture; by default omega_p/p for a pulse, 2pi/p for a record
    #[arg(long, value_parser = choices::abscissa(), help_heading = "Results")]
    over: Option<Abscissa>,
    /// Table of statistics over several records, for each foundation and size
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    statistics: Option<PathBuf>,
}

#[derive(Args)]
#[command(next_help_heading = "Blocks")]
struct BlockOptions {
    /// Slenderness angle alpha [rad]; or --width and --height, only for their ratio, since p sets the size
    #[arg(long, value_name = "RAD", default_value_t = BlockSpec::defaults().alpha.unwrap_or_default())]
    alpha: f64,
    #[command(flatten)]
    size: SizeOptions,
    /// Foundation of a curve: ETA,XI_V,EPSILON or `rigid`, `rigid,EPSILON`, `rigid,EPSILON,FACTOR` with a factor on Housner's
    /// restitution e for this epsilon, which is 0 by default; one option per curve
    #[arg(long, value_name = "BASE", allow_hyphen_values = true, default_values = ["40,0.1,0", "rigid"])]
    foundation: Vec<String>,
    /// Smallest frequency parameter p, of the largest block [rad/s]
    #[arg(long, value_name = "RAD/S", default_value_t = 0.5)]
    p_min: f64,
    /// Largest frequency parameter p, of the smallest block [rad/s]
    #[arg(long, value_name = "RAD/S", default_value_t = 8.0)]
    p_max: f64,
    /// Number of blocks on each foundation, evenly spaced in 1/p
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u64).range(2..=1_000_000_000))]
    points: u64,
    /// Mass M [kg]
    #[arg(long, value_name = "KG", default_value_t = Common::default().mass)]
    mass: f64,
    /// Shape factor gamma = M R0²/I0
    #[arg(long, default_value_t = Common::default().gamma)]
    gamma: f64,
    /// Gravitational acceleration, also for records in g [m/s2]
    #[arg(long, value_name = "M/S2", default_value_t = Common::default().gravity)]
    g: f64,
    /// Coulomb's coefficient of friction of the feet; without a limit they do not slide
    #[arg(long, value_name = "MU", value_parser = friction::parse, default_value = friction::NONE)]
    friction: f64,
    /// Distance of the centre of mass from the middle of the base over half the width, e_x/b: the same for all sizes
    #[arg(long, value_name = "RATIO", default_value_t = 0.0, allow_hyphen_values = true)]
    eccentricity_ratio: f64,
    /// A tie that grows with the block: the keys of `rocking simulate --tie`, but with places and slack in R0, stiffness in M g/R0,
    /// pretension, strength and yield force in M g, and damping in M p. One option per tie
    #[arg(long, value_name = "KEY=NUMBER,...", value_parser = tie, allow_hyphen_values = true)]
    tie_ratio: Vec<Tie>,
    /// A damper that grows with the block: the keys of `rocking simulate --damper` in the units of --tie-ratio, the yield force in M g.
    /// One option per damper
    #[arg(long, value_name = "KEY=NUMBER,...", value_parser = damper, allow_hyphen_values = true)]
    damper_ratio: Vec<Tie>,
}

/// Runs the command.
pub fn run(options: &SpectrumCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    explicit.refuse_unless(options.picture.plot.is_some(), &["over"], "without --plot")?;
    explicit.refuse_unless(explicit.has("vertical"), &["also-horizontal"], "without --vertical")?;
    let (csv, plot) = (options.study.csv(), options.picture.plot.as_deref());
    let statistics_path = options.statistics.as_deref();
    check_table(csv)?;
    statistics_path.map_or(Ok(()), check_table)?;
    let format = options.picture.format()?;
    let outputs = [("csv", Some(csv)), ("plot", plot), ("statistics", statistics_path)];
    let files = options.excitation.accelerograms.files();
    check_distinct(&options.excitation.accelerograms.named(), &NamedFile::of_options(outputs))?;
    explicit.refuse_unless(files.len() > 1, &["statistics"], "without several records")?;
    let (spectrum, excitation) = options.spectrum(explicit)?;
    let over = match options.over {
        Some(over) => over,
        None if spectrum.pulse.shape != PulseShape::None && options.excitation.is_pulse_alone() => Abscissa::PulseRatio,
        None => Abscissa::TwoPiOverP,
    };
    let without_pulse = over == Abscissa::PulseRatio && spectrum.pulse.shape == PulseShape::None;
    anyhow::ensure!(!without_pulse, "--over omega_p/p without a pulse; expected --pulse or --over 2pi/p");
    let others = [("statistics", statistics_path), ("plot", plot)];
    let mut made = Outputs::open(others)?;
    let (mut statistics, mut curves) = (Statistics::new(&spectrum), Curves::new(&spectrum, over));
    let mut follow = |rows: Table| {
        let refused = |reason| TableWriteError::Refused(format!("{}: {reason}", csv.display()));
        let outcomes = BlockOutcome::all(&rows).map_err(refused)?;
        statistics.add(&spectrum, &outcomes);
        curves.add(&spectrum, &outcomes);
        Ok(())
    };
    let is_followed = plot.is_some() || statistics_path.is_some() || !is_standard_output(csv);
    let summary = options.study.run(&spectrum, is_followed.then_some(&mut follow), is_followed)?;
    made.fill("plot", || {
        let svg = match files.len() {
            1 => rocking_charts::spectrum::spectrum(&spectrum, &curves, &excitation),
            _ => rocking_charts::record_spectra::spectrum(&spectrum, &statistics, &curves, &excitation),
        }?;
        Ok(format.encode(&svg)?)
    })?;
    made.fill_table("statistics", || {
        Ok(DescribedTable { study: spectrum.header().study, table: statistics.table(&spectrum) })
    })?;
    made.write()?;
    let mut items = Summary::default();
    items.item("excitation", &excitation, "excitation", &excitation);
    if !statistics.curves.is_empty() {
        items.entry("curves", &statistics.curves);
        items.text += &table_of_curves(&statistics.curves);
    }
    options.study.report("spectrum", (csv, &summary), items, &others, &[])
}

/// A text table of the outcomes of each curve.
fn table_of_curves(curves: &[CurveSummary]) -> String {
    let head =
        ["foundation", "motion", "completed", "overturned", "separated", "undecided", "failed", "flew", "flights"];
    let head = head.into_iter().chain(["greatest |θ|/α of those that completed"]).map(String::from).collect();
    let row = |curve: &CurveSummary| {
        let EndCounts { completed, overturned, separated, undecided, failed } = curve.ends;
        let CurveSummary { flew, flights, .. } = *curve;
        let counts =
            [completed, overturned, separated, undecided, failed, flew, flights].map(|count| count.to_string());
        let greatest = curve.greatest.map(|Greatest { peak, p }| format!("{peak:.4} at p = {p:.4} rad/s"));
        let names = [curve.foundation.clone(), curve.motion.clone()];
        names.into_iter().chain(counts).chain([greatest.unwrap_or_else(|| "none".into())]).collect()
    };
    aligned(&std::iter::once(head).chain(curves.iter().map(row)).collect::<Vec<_>>(), 2..9)
}

impl SpectrumCommand {
    /// Returns the spectrum and a description of its excitation.
    fn spectrum(&self, explicit: &ExplicitOptions) -> anyhow::Result<(CheckedSpectrum, String)> {
        let BlockOptions { alpha, ref size, ref foundation, p_min, p_max, points, mass, gamma, g, friction, .. } =
            self.blocks;
        let alpha = match size.read(explicit, &["alpha"])? {
            Some([width, height]) => libm::atan2(width, height),
            None => alpha,
        };
        let Excitation { motions: grounds, pulse, description } = self.excitation.read(explicit, g, None)?;
        let none = self.excitation.accelerograms.is_empty() && pulse.shape == PulseShape::None;
        anyhow::ensure!(!none, "no excitation; expected --record, --vertical or --pulse");
        check("p-min", p_min, |x| x >= 0.001, "a frequency of at least 0.001 rad/s")?;
        check("p-max", p_max, |x| x > p_min, "a frequency above --p-min")?;
        let mut motions = Vec::new();
        if self.also_horizontal {
            let files = self.excitation.accelerograms.files();
            let horizontal = files.iter().map(|files| MotionFiles { vertical: None, ..*files }).collect::<Vec<_>>();
            let alone = grounds.iter().map(|(_, ground)| Ground { vertical: None, ..ground.clone() });
            motions.extend(names(&horizontal).into_iter().zip(alone));
        }
        motions.extend(grounds);
        let bases = foundation
            .iter()
            .map(|text| text.parse().map_err(|message| anyhow::anyhow!("--foundation {text}; {message}")));
        let bases = bases.collect::<anyhow::Result<Vec<_>>>()?;
        let spectrum = Spectrum {
            alpha,
            common: Common { mass, gamma, gravity: g, friction, ..Common::default() },
            in_proportion: ScaledFeatures {
                eccentricity: self.blocks.eccentricity_ratio,
                ties: [&self.blocks.tie_ratio[..], &self.blocks.damper_ratio].concat(),
            },
            bases,
            sizes: Sizes { least: p_min, greatest: p_max, count: points },
            motions,
            pulse,
            settings: self.run.settings().map_err(in_options)?,
            duration: self.run.duration,
            step: self.run.step,
            friction_demand: self.run.friction_demand,
        };
        check("eccentricity-ratio", self.blocks.eccentricity_ratio, |x| x.abs() < 1.0, "a ratio between -1 and 1")?;
        let spectrum = spectrum.checked()?;
        let ends = spectrum.bases.iter().flat_map(|&base| [p_min, p_max].map(|p| spectrum.block(base, p)));
        warn(doubts::of_blocks(ends.collect::<Result<Vec<_>, _>>()?));
        Ok((spectrum, description))
    }
}
