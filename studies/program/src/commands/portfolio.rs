//! `rocking portfolio`: study files with an object each → their pages, and one that ranks them.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;
use serde::Serialize;

use crate::commands::assess;
use crate::options::run::{ProcessorOptions, warn};
use crate::output::files::Pending;
use crate::output::progress::Progress;
use crate::output::report::{ReportOptions, WrittenFiles};
use rocking_report::{PAGE, PORTFOLIO_PAGE};
use rocking_studies::assess::Results;
use rocking_studies::portfolio::{Kept, ObjectStudy, Portfolio, Studies, assess_all};

/// Options of `rocking portfolio`.
#[derive(Parser)]
pub struct PortfolioCommand {
    /// Study files in TOML with an [assess] table, as `rocking assess` takes, or folders with such files. One object each
    #[arg(value_name = "STUDY.toml|FOLDER", required = true)]
    studies: Vec<PathBuf>,
    /// Folder for the page, its table, and a folder with the report on each object
    #[arg(long, value_name = "FOLDER", default_value = "portfolio", help_heading = "Results")]
    out: PathBuf,
    /// Replace the pages in the folder; rows kept there are used in any case
    #[arg(long, help_heading = "Results")]
    force: bool,
    #[command(flatten)]
    processor: ProcessorOptions,
    #[command(flatten)]
    report: ReportOptions,
}

/// The portfolio with the names of its files.
#[derive(Serialize)]
struct PortfolioResult<'a> {
    #[serde(flatten)]
    portfolio: &'a Portfolio,
    files: Vec<&'a str>,
}

/// Runs the command.
pub fn run(options: &PortfolioCommand) -> anyhow::Result<()> {
    let PortfolioCommand { studies, out, force, processor, report } = options;
    let studies = Studies::read(studies)?;
    for study in &studies.valid {
        warn(named(study, &study.plan.sweep.remarks));
        assess::make_folder(&out.join(&study.name), PAGE, *force)?;
    }
    let page = assess::make_folder(out, PORTFOLIO_PAGE, *force)?;
    let program = std::env::current_exe().context("the program's own file cannot be found")?;
    let keep = Kept { folder: out, program: &program };
    let pool = processor.threads.pool()?;
    let bar = Progress::new(0, 0);
    let show = |step: &str, done, all| bar.show_step(step, done, all);
    let mut warnings = Vec::new();
    // Each report is written as soon as it is made: an interrupted call has those of the objects before.
    let each = |study: &ObjectStudy, results: &Results| {
        let folder = out.join(&study.name);
        let files = rocking_report::files(&study.plan, results)?;
        let pending = assess::pending(&study.file, &study.plan, &folder, &files)?;
        warnings.extend(named(study, &[&study.plan.sweep.remarks[..], &results.report.remarks].concat()));
        Pending::write(pending.into_iter().zip(files.into_iter().map(|(_, content)| content)).collect())
    };
    let portfolio = assess_all(&studies, &pool, processor.width(), Some(keep), &show, each)?;
    bar.clear();
    warn(portfolio.refused.iter().map(|refused| refused.reason.clone()));
    write(&portfolio, out, &page, &warnings, report)?;
    let count = portfolio.refused.len();
    anyhow::ensure!(
        count == 0,
        "{count} of {} studies could not be assessed: {}",
        count + portfolio.objects.len(),
        portfolio.refused.iter().map(|refused| refused.study.as_str()).collect::<Vec<_>>().join(", ")
    );
    Ok(())
}

/// Writes the page and the table, and prints the summary.
fn write(
    portfolio: &Portfolio,
    out: &Path,
    page: &Path,
    warnings: &[String],
    report: &ReportOptions,
) -> anyhow::Result<()> {
    let files = rocking_report::portfolio_files(portfolio)?;
    let pending = files.iter().map(|(name, _)| Pending::new(&out.join(name))).collect::<anyhow::Result<Vec<_>>>()?;
    let result = PortfolioResult { portfolio, files: files.iter().map(|(name, _)| name.as_str()).collect() };
    Pending::write(pending.into_iter().zip(files.iter().map(|(_, content)| content.clone())).collect())?;
    let written = WrittenFiles::new([("out", Some(page))]);
    let text = rocking_report::portfolio_text(portfolio) + &written.lines();
    report.print("portfolio", &written, warnings, &text, &result)
}

/// Remarks with the name of their object.
fn named(study: &ObjectStudy, remarks: &[String]) -> Vec<String> {
    remarks.iter().map(|remark| format!("{}: {remark}", study.name)).collect()
}
