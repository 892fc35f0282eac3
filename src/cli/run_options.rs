//! Options that several commands share.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::block::{Block, Foundation};
use crate::cli::excitation::finite;
use crate::cli::given::Given;
use crate::cli::progress::Progress;
use crate::cli::report::{ReportOptions, Written, is_standard_output};
use crate::numerics::wide::Width;
use crate::simulation::{OnSeparation, Settings};
use crate::study::history::{LONGEST, SHORTEST};
use crate::study::resumable::{Failures, Opening, ResumableTable};
use crate::study::runner::{self, Made, Study};
use crate::study::spectrum_statistics::CurveSummary;

/// What happens at complete separation.
#[derive(Clone, Copy, ValueEnum)]
pub enum AtSeparation {
    /// The run ends, as in the paper's analysis
    Terminate,
    /// The block flies, lands and goes on
    Fly,
}

impl From<AtSeparation> for OnSeparation {
    fn from(separation: AtSeparation) -> OnSeparation {
        match separation {
            AtSeparation::Terminate => OnSeparation::Terminate,
            AtSeparation::Fly => OnSeparation::Fly,
        }
    }
}

/// What a block stands on.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub enum Base {
    /// A spring and a dashpot under each corner
    Viscoelastic,
    /// Housner's rigid base
    Rigid,
}

impl From<Base> for Foundation {
    fn from(base: Base) -> Foundation {
        match base {
            Base::Viscoelastic => Foundation::Viscoelastic,
            Base::Rigid => Foundation::Rigid,
        }
    }
}

/// Sizes of a block in place of dimensionless parameters.
#[derive(Args)]
pub struct SizeOptions {
    /// Width of the base, with --height [m]
    #[arg(long, value_name = "M")]
    width: Option<f64>,
    /// Twice the height of the centre of mass over the base [m]
    #[arg(long, value_name = "M")]
    height: Option<f64>,
}

impl SizeOptions {
    /// Width and height (m), if they are given, without the options that they stand for.
    pub fn read(&self, given: &Given, instead_of: &[&str]) -> anyhow::Result<Option<[f64; 2]>> {
        match (self.width, self.height) {
            (None, None) => Ok(None),
            (Some(width), Some(height)) => {
                given.only_if(false, instead_of, "with --width")?;
                for (name, size) in [("width", width), ("height", height)] {
                    finite(name, size, |x| x > 0.0, "a length > 0 m")?;
                }
                Ok(Some([width, height]))
            }
            (Some(_), None) => anyhow::bail!("--width without --height; expected both"),
            (None, Some(_)) => anyhow::bail!("--height without --width; expected both"),
        }
    }
}

/// Warns of a block that falls over by itself: the moment of its supports per radian, 2 K b², is at most that of its weight, M g h.
pub fn warn_of_soft_supports(block: &Block) {
    let least = block.mass * block.gravity * block.h / (2.0 * block.b * block.b);
    if block.foundation == Foundation::Viscoelastic && block.stiffness <= least {
        let (eta, stiffness) = (block.eta(), block.stiffness);
        let least_eta = eta * (least / stiffness).sqrt();
        eprintln!(
            "rocking: warning: the block falls over by itself on supports of eta = {eta:.4}, K = {stiffness:.4e} N/m; expected \
             eta > {least_eta:.4}, K > {least:.4e} N/m"
        );
    }
}

/// Refuses a tolerance at which no digit of a result would be left.
pub fn check_tolerance(tolerance: f64) -> anyhow::Result<()> {
    finite("tolerance", tolerance, Settings::admits_tolerance, Settings::EXPECTED_TOLERANCE)
}

/// How each run of a study is made.
#[derive(Args)]
#[command(next_help_heading = "Runs")]
pub struct RunOptions {
    /// Relative tolerance of the integration; the default suffices for outcomes and peaks, not for the last digits of reactions
    #[arg(long, default_value_t = Settings::OF_STUDIES, value_name = "TOL")]
    tolerance: f64,
    /// What happens at complete separation
    #[arg(long, value_enum, default_value_t = AtSeparation::Fly)]
    on_separation: AtSeparation,
    /// Duration; without it each run goes on until the ground has come to rest and the block has come down [s]
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    /// Longest time between two stops of a run; without it only a record's samples and a pulse's ends are [s]
    #[arg(long, value_name = "S")]
    step: Option<f64>,
}

impl RunOptions {
    /// Settings of the solver.
    pub fn settings(&self) -> anyhow::Result<Settings> {
        check_tolerance(self.tolerance)?;
        Ok(Settings { tolerance: self.tolerance, on_separation: self.on_separation.into(), ..Settings::default() })
    }

    /// Duration (s), if it is given.
    pub fn duration(&self) -> anyhow::Result<Option<f64>> {
        self.duration.map_or(Ok(()), |time| {
            finite("duration", time, |x| x > 0.0 && x <= LONGEST, "a time > 0 s, at most 1e6 s")
        })?;
        Ok(self.duration)
    }

    /// Longest time between two stops (s), if it is given.
    pub fn step(&self) -> anyhow::Result<Option<f64>> {
        self.step.map_or(Ok(()), |time| finite("step", time, |x| x >= SHORTEST, "a time of at least 1e-6 s"))?;
        Ok(self.step)
    }
}

/// What of the processor runs are made on.
#[derive(Args)]
pub struct ProcessorOptions {
    /// Threads; without it one for each core
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Blocks that a thread steps at once in the lanes of the processor's vectors, at most: 1, 2, 4 or 8. Results are the same
    /// bytes; without it as many as the processor has lanes
    #[arg(long, value_name = "N", value_parser = lanes)]
    lanes: Option<usize>,
}

impl ProcessorOptions {
    /// The threads.
    pub fn pool(&self) -> Result<rayon::ThreadPool, rayon::ThreadPoolBuildError> {
        runner::pool(self.threads.map(usize::from))
    }

    /// The vectors in which a thread steps several blocks; none where each is stepped by itself.
    pub fn width(&self) -> Option<Width> {
        self.lanes.map_or_else(Width::widest, Width::at_most)
    }
}

/// Options of a study of many runs.
#[derive(Args)]
#[command(next_help_heading = "Results")]
pub struct StudyOptions {
    /// Table of the results, written row by row; `-` for standard output
    #[arg(long, value_name = "FILE.csv")]
    pub csv: PathBuf,
    /// Resume the table of an interrupted study
    #[arg(long)]
    resume: bool,
    /// Replace the table that is there
    #[arg(long, conflicts_with = "resume")]
    force: bool,
    #[command(flatten)]
    processor: ProcessorOptions,
    #[command(flatten)]
    report: ReportOptions,
}

impl StudyOptions {
    /// Makes the rows of a study that are not there yet; its table is there to be read back if a picture is to be made
    /// of it.
    pub fn run(&self, study: &impl Study, read_back: bool) -> anyhow::Result<(Made, ResumableTable)> {
        let pool = self.processor.pool()?;
        let mut table = study.open(&self.csv, Opening { resume: self.resume, force: self.force, read_back })?;
        // A bar between the rows would spoil both.
        let rows_on_terminal = is_standard_output(&self.csv) && std::io::stdout().is_terminal();
        let mut bar = None;
        let made = runner::run(study, &pool, self.processor.width(), &mut table, |before, done| {
            if !rows_on_terminal {
                bar.get_or_insert_with(|| Progress::new(study.rows(), before)).show(done);
            }
        });
        if let Some(bar) = bar {
            bar.clear();
        }
        Ok((made?, table))
    }

    /// Reports what was made; runs that failed are an error. `source` says what excites the blocks, where one says it for
    /// all; `curves` are those of a spectrum, `others` what was written besides the table.
    pub fn report(
        &self,
        command: &str,
        made: &Made,
        source: Option<&str>,
        curves: &[CurveSummary],
        others: &[(&'static str, Option<&Path>)],
    ) -> anyhow::Result<()> {
        let Made { rows, before, failures: Failures { count, first }, ref reason } = *made;
        let written = Written::new([("csv", Some(self.csv.as_path()))].into_iter().chain(others.iter().copied()));
        let excitation = source.map(|source| format!("excitation    {source}\n")).unwrap_or_default();
        let curve_lines = CurveSummary::lines(curves);
        let rows_line = format!("rows          {rows}, of which {before} were there\n");
        let text = format!("{excitation}{curve_lines}{rows_line}{}", written.lines());
        let why = reason.as_ref().map(|reason| format!(": {reason}")).unwrap_or_default();
        let failed = (count > 0).then(|| format!("{count} of {rows} runs failed, the first in row {first}{why}"));
        let result = StudyResult { excitation: source, curves, rows, rows_before: before, failed: count };
        self.report.print(command, &written, failed.as_slice(), &text, &result)?;
        failed.map_or(Ok(()), |failed| anyhow::bail!(failed))
    }
}

/// A number of lanes from its option.
fn lanes(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|lanes| [1, 2, 4, 8].contains(lanes)).ok_or_else(|| "expected 1, 2, 4 or 8".into())
}

#[derive(Serialize)]
struct StudyResult<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    excitation: Option<&'a str>,
    #[serde(skip_serializing_if = "<[CurveSummary]>::is_empty")]
    curves: &'a [CurveSummary],
    rows: u64,
    rows_before: u64,
    failed: u64,
}
