//! Options shared by several commands → settings of the solver, a table of many runs.

use std::fmt::Display;
use std::fs;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::Context;
use clap::Args;

use crate::options::checks::check;
use crate::options::explicit::ExplicitOptions;
use crate::output::files::StreamedFile;
use crate::output::formats::table_format;
use crate::output::interrupt::print_continuation;
use crate::output::progress::Progress;
use crate::output::report::{ReportOptions, WrittenFiles, is_standard_output};
use crate::output::summary::Summary;
use rocking_block::numerics::wide::VectorWidth;
use rocking_charts::numerals::significant;
use rocking_studies::output::forecast::Forecast;
use rocking_studies::output::format::TableFormat;
use rocking_studies::output::parts::{self, Part, PartNumber, PartState};
use rocking_studies::output::resumable::{Failures, ResumableTable, TableOptions};
use rocking_studies::output::runner::{self, Follower, Study, StudySummary};

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

/// Prints warnings on standard error.
pub fn warn(warnings: impl IntoIterator<Item: Display>) {
    for warning in warnings {
        eprintln!("rocking: warning: {warning}");
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
    /// Refuses a number of lanes for runs that are not stepped in lanes.
    pub fn refuse_lanes(&self, why: &str) -> anyhow::Result<()> {
        anyhow::ensure!(self.lanes.is_none(), "--lanes has no effect {why}");
        Ok(())
    }

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
    #[arg(long, value_name = "FILE.csv", required = true)]
    csv: Option<PathBuf>,
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
    /// Refuses a number of lanes for a study whose runs are not stepped in lanes.
    pub fn refuse_lanes(&self, why: &str) -> anyhow::Result<()> {
        self.processor.refuse_lanes(why)
    }

    /// The file of the table, which every study but one in parts has.
    pub fn csv(&self) -> &Path {
        self.csv.as_deref().unwrap_or_else(|| unreachable!("required by the command line"))
    }

    /// Computes the missing rows of a study and writes them; `follow` receives all rows. If it `needs_all`, they are also made after the
    /// reader of a pipe has closed it.
    pub fn run(&self, study: &impl Study, follow: Option<Follower>, needs_all: bool) -> anyhow::Result<StudySummary> {
        let csv = self.csv();
        if TableFormat::of(csv) == TableFormat::Parquet {
            let name = csv.display();
            anyhow::ensure!(
                !self.resume,
                "{name}: a Parquet table is written whole; expected a table in .csv for --resume"
            );
            anyhow::ensure!(
                self.force || !csv.exists(),
                "{name}: exists already; expected --force to replace it, or another name"
            );
            return self.run_whole(csv, study, follow);
        }
        let options = TableOptions { resume: self.resume, force: self.force, outlives_reader: needs_all };
        let mut table = study.open(csv, options)?;
        print_continuation(csv)?;
        self.fill(study, &mut table, follow)
    }

    /// Computes the rows of a study for a file that is complete or absent. Its name tells the format.
    fn run_whole(&self, path: &Path, study: &impl Study, follow: Option<Follower>) -> anyhow::Result<StudySummary> {
        let file = StreamedFile::new(path)?;
        let (name, header) = (path.display().to_string(), study.header());
        let mut table = ResumableTable::whole(&name, &header, file.writer()?, table_format(path)?)?;
        let summary = self.fill(study, &mut table, follow)?;
        table.finish()?;
        file.complete()?;
        Ok(summary)
    }

    fn fill(
        &self,
        study: &impl Study,
        table: &mut ResumableTable,
        follow: Option<Follower>,
    ) -> anyhow::Result<StudySummary> {
        let pool = self.processor.threads.pool()?;
        // A progress bar and rows on the same terminal would overwrite each other.
        let rows_on_terminal = self.csv.as_deref().is_some_and(is_standard_output) && std::io::stdout().is_terminal();
        let mut bar = None;
        let summary = runner::run(study, &pool, self.processor.width(), table, follow, |before, done| {
            if !rows_on_terminal {
                bar.get_or_insert_with(|| Progress::new(study.rows(), before)).show(done);
            }
        });
        if let Some(bar) = bar {
            bar.clear();
        }
        Ok(summary?)
    }

    /// Makes a part of a study in a folder and returns its file; `follow` receives its rows. A part that is there stays.
    pub fn run_part<S: Study>(
        &self,
        study: &S,
        number: PartNumber,
        folder: &Path,
        format: TableFormat,
        follow: Option<Follower>,
    ) -> anyhow::Result<(PathBuf, StudySummary)> {
        fs::create_dir_all(folder).with_context(|| format!("{}: cannot be created", folder.display()))?;
        let path = folder.join(number.file_name(format));
        let part = Part::new(study, number);
        let rows = part.rows();
        let state = if self.force { PartState::Broken } else { parts::state(&path, &part.header())? };
        let summary = match state {
            PartState::Complete => StudySummary { rows, resumed: rows, failures: Failures::default(), reason: None },
            PartState::Absent | PartState::Broken => self.run_whole(&path, &part, follow)?,
        };
        // Rows of a part have their numbers in the study.
        let first = if summary.failures.count > 0 { part.plan().row(summary.failures.first) } else { 0 };
        let failures = Failures { first, ..summary.failures };
        Ok((path, StudySummary { failures, ..summary }))
    }

    /// Prints the expected cost of a study, from a sample of its rows, after its own items.
    pub fn forecast(&self, study: &impl Study, items: Summary, parts: u64) -> anyhow::Result<()> {
        let summary = forecast_summary(&Forecast::of(study, self.processor.width(), thread_time)?, items, parts);
        self.report.print("sweep", &WrittenFiles::new([]), &[], &summary.text, &summary.json)
    }

    /// Prints the summary of a study, with its own items first. Failed runs are an error.
    ///
    /// `others` are the other files written, and `remarks` join the warnings of the JSON.
    pub fn report(
        &self,
        command: &str,
        (file, made): (&Path, &StudySummary),
        mut summary: Summary,
        others: &[(&'static str, Option<&Path>)],
        remarks: &[String],
    ) -> anyhow::Result<()> {
        let StudySummary { rows, resumed, failures: Failures { count, first }, ref reason } = *made;
        let written = WrittenFiles::new([("csv", Some(file))].into_iter().chain(others.iter().copied()));
        let why = reason.as_ref().map(|reason| format!(": {reason}")).unwrap_or_default();
        let failed = (count > 0).then(|| format!("{count} of {rows} runs failed, the first in row {first}{why}"));
        summary.item("rows", rows, "rows", format!("{rows}, {resumed} resumed"));
        summary.entry("rows_before", resumed);
        summary.entry("failed", count);
        let warnings = [remarks, failed.as_slice()].concat();
        self.report.print(command, &written, &warnings, &(summary.text + &written.lines()), &summary.json)?;
        failed.map_or(Ok(()), |failed| anyhow::bail!(failed))
    }
}

/// CPU time of this thread: the wall clock also counts the time for which other programs have its core.
#[cfg(unix)]
fn thread_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// The wall clock, where the CPU time of a thread cannot be asked for.
#[cfg(not(unix))]
fn thread_time() -> Duration {
    static BEGIN: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
    BEGIN.elapsed()
}

fn forecast_summary(forecast: &Forecast, mut summary: Summary, parts: u64) -> Summary {
    let Forecast { rows, seconds, uncertainty, bytes, tried } = *forecast;
    let time = match seconds {
        seconds if seconds < 120.0 => format!("{} s", significant(seconds, 2)),
        seconds if seconds < 7200.0 => format!("{} min", significant(seconds / 60.0, 2)),
        seconds => format!("{} h", significant(seconds / 3600.0, 2)),
    };
    let size = match bytes {
        bytes if bytes < 1e6 => format!("{} kB", significant(bytes / 1e3, 2)),
        bytes if bytes < 1e9 => format!("{} MB", significant(bytes / 1e6, 2)),
        bytes => format!("{} GB", significant(bytes / 1e9, 2)),
    };
    let error = significant(100.0 * uncertainty, 1);
    summary.item("rows", rows, "rows", rows);
    if parts > 1 {
        summary.line("parts", format!("{parts}, of some {} rows", rows.div_ceil(parts)));
    }
    summary.item("seconds", seconds, "CPU time", format!("{time} of one core, ±{error} %, from {tried} rows"));
    summary.entry("uncertainty", uncertainty);
    summary.item("bytes", bytes, "table", format!("{size} as CSV"));
    summary.entry("tried", tried);
    summary
}

/// Parses a number of lanes.
fn lanes(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|lanes| [1, 2, 4, 8].contains(lanes)).ok_or_else(|| "expected 1, 2, 4 or 8".into())
}
