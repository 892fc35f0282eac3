//! Options shared by several commands → settings of the solver, a table of many runs.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use crate::checks::{check, check_tolerance, checked};
use crate::choices;
use crate::explicit_options::ExplicitOptions;
use crate::progress::Progress;
use crate::report::{ReportOptions, WrittenFiles, is_standard_output};
use rocking_block::block::Block;
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::{OnSeparation, Settings};
use rocking_block::words::Words;
use rocking_studies::output::resumable::{Failures, ResumableTable, TableOptions};
use rocking_studies::output::runner::{self, Study, StudySummary};
use rocking_studies::run::{MAX_DURATION, MIN_STEP};
use rocking_studies::spectrum::statistics::CurveSummary;

/// Width and height of a block, instead of dimensionless parameters.
#[derive(Args)]
pub struct SizeOptions {
    /// Width of the base, with --height [m]
    #[arg(long, value_name = "M")]
    width: Option<f64>,
    /// Twice the height of the centre of mass above the base [m]
    #[arg(long, value_name = "M")]
    height: Option<f64>,
}

impl SizeOptions {
    /// Returns width and height (m), if set; refuses the options that they replace.
    pub fn read(&self, explicit: &ExplicitOptions, replaced: &[&str]) -> anyhow::Result<Option<[f64; 2]>> {
        match (self.width, self.height) {
            (None, None) => Ok(None),
            (Some(width), Some(height)) => {
                explicit.refuse_unless(false, replaced, "with --width")?;
                for (name, size) in [("width", width), ("height", height)] {
                    check(name, size, |x| x > 0.0, "a length > 0 m")?;
                }
                Ok(Some([width, height]))
            }
            (Some(_), None) => anyhow::bail!("--width without --height; expected both"),
            (None, Some(_)) => anyhow::bail!("--height without --width; expected both"),
        }
    }
}

/// Prints the warning about supports too soft to keep the block upright, if they are.
pub fn warn_of_soft_supports(block: &Block) {
    if let Some(warning) = block.soft_supports() {
        eprintln!("rocking: warning: {warning}");
    }
}

/// Settings of each run of a study.
#[derive(Args)]
#[command(next_help_heading = "Runs")]
pub struct RunOptions {
    /// Relative tolerance of the integration; the default suffices for outcomes and peaks, not for the last digits of reactions
    #[arg(long, default_value_t = Settings::OF_STUDIES, value_name = "TOL")]
    tolerance: f64,
    /// Action at complete separation
    #[arg(long, value_parser = choices::on_separation(), default_value = OnSeparation::Fly.word())]
    on_separation: OnSeparation,
    /// Duration; by default each run lasts until the ground has come to rest and the block has come down [s]
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    /// Longest time between two stops of a run; by default runs stop only at a record's samples and a pulse's ends [s]
    #[arg(long, value_name = "S")]
    step: Option<f64>,
}

impl RunOptions {
    /// Returns the settings of the solver.
    pub fn settings(&self) -> anyhow::Result<Settings> {
        check_tolerance(self.tolerance)?;
        Ok(Settings { tolerance: self.tolerance, on_separation: self.on_separation, ..Settings::default() })
    }

    /// Returns the duration (s), if set.
    pub fn duration(&self) -> anyhow::Result<Option<f64>> {
        checked("duration", self.duration, |x| x > 0.0 && x <= MAX_DURATION, "a time > 0 s, at most 1e6 s")
    }

    /// Returns the longest time between two stops (s), if set.
    pub fn step(&self) -> anyhow::Result<Option<f64>> {
        checked("step", self.step, |x| x >= MIN_STEP, "a time of at least 1e-6 s")
    }
}

/// Threads of a command.
#[derive(Args)]
pub struct ThreadOptions {
    /// Number of threads; by default one per core
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl ThreadOptions {
    /// Starts the threads.
    pub fn pool(&self) -> Result<rayon::ThreadPool, rayon::ThreadPoolBuildError> {
        runner::pool(self.threads.map(usize::from))
    }
}

/// Threads, and vector lanes of each thread.
#[derive(Args)]
pub struct ProcessorOptions {
    #[command(flatten)]
    pub threads: ThreadOptions,
    /// Maximum number of blocks that a thread steps at once in vector lanes: 1, 2, 4 or 8; by default all lanes of the
    /// processor. The results are the same to the byte
    #[arg(long, value_name = "N", value_parser = lanes)]
    lanes: Option<usize>,
}

impl ProcessorOptions {
    /// Returns the width of the vectors, or none if each block is stepped alone.
    pub fn width(&self) -> Option<VectorWidth> {
        self.lanes.map_or_else(VectorWidth::widest, VectorWidth::at_most)
    }
}

/// Options of a study of many runs.
#[derive(Args)]
#[command(next_help_heading = "Results")]
pub struct StudyOptions {
    /// Table of results, written row by row; `-` for standard output
    #[arg(long, value_name = "FILE.csv")]
    pub csv: PathBuf,
    /// Continue the table of an interrupted study
    #[arg(long)]
    resume: bool,
    /// Replace an existing table
    #[arg(long, conflicts_with = "resume")]
    force: bool,
    #[command(flatten)]
    processor: ProcessorOptions,
    #[command(flatten)]
    report: ReportOptions,
}

impl StudyOptions {
    /// Computes the missing rows of a study; with `read_back` its table can be read afterwards, for a picture.
    pub fn run(&self, study: &impl Study, read_back: bool) -> anyhow::Result<(StudySummary, ResumableTable)> {
        let pool = self.processor.threads.pool()?;
        let mut table = study.open(&self.csv, TableOptions { resume: self.resume, force: self.force, read_back })?;
        // A progress bar and rows on the same terminal would overwrite each other.
        let rows_on_terminal = is_standard_output(&self.csv) && std::io::stdout().is_terminal();
        let mut bar = None;
        let summary = runner::run(study, &pool, self.processor.width(), &mut table, |before, done| {
            if !rows_on_terminal {
                bar.get_or_insert_with(|| Progress::new(study.rows(), before)).show(done);
            }
        });
        if let Some(bar) = bar {
            bar.clear();
        }
        Ok((summary?, table))
    }

    /// Prints the summary of a study; failed runs are an error.
    ///
    /// `excitation` describes the ground motion if all rows share it, `curves` are those of a spectrum, `others` are the other
    /// files written.
    pub fn report(
        &self,
        command: &str,
        summary: &StudySummary,
        excitation: Option<&str>,
        curves: &[CurveSummary],
        others: &[(&'static str, Option<&Path>)],
    ) -> anyhow::Result<()> {
        let StudySummary { rows, resumed: before, failures: Failures { count, first }, ref reason } = *summary;
        let written = WrittenFiles::new([("csv", Some(self.csv.as_path()))].into_iter().chain(others.iter().copied()));
        let excitation_line = excitation.map(|words| format!("excitation    {words}\n")).unwrap_or_default();
        let curve_lines = CurveSummary::lines(curves);
        let rows_line = format!("rows          {rows}, {before} resumed\n");
        let text = format!("{excitation_line}{curve_lines}{rows_line}{}", written.lines());
        let why = reason.as_ref().map(|reason| format!(": {reason}")).unwrap_or_default();
        let failed = (count > 0).then(|| format!("{count} of {rows} runs failed, the first in row {first}{why}"));
        let result = StudyResult { excitation, curves, rows, rows_before: before, failed: count };
        self.report.print(command, &written, failed.as_slice(), &text, &result)?;
        failed.map_or(Ok(()), |failed| anyhow::bail!(failed))
    }
}

/// Parses a number of lanes.
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
