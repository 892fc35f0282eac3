//! `rocking assess`: a study file with an object → a page, pictures and tables.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;
use serde::Serialize;

use crate::options::input;
use crate::options::run::{ProcessorOptions, warn};
use crate::output::files::{NamedFile, Pending, check_distinct};
use crate::output::progress::Progress;
use crate::output::report::{ReportOptions, WrittenFiles};
use rocking_report::PAGE;
use rocking_studies::assess::{Cache, Plan, Report, Step, assess};
use rocking_studies::input::study_file::StudyFileError;

/// Options of `rocking assess`.
#[derive(Parser)]
pub struct AssessCommand {
    /// Study file in TOML with an [assess] table, as examples/assess/statue.toml; `-` for standard input
    #[arg(value_name = "STUDY.toml")]
    file: PathBuf,
    /// Folder for the page, its pictures and tables
    #[arg(long, value_name = "FOLDER", default_value = "report", help_heading = "Results")]
    out: PathBuf,
    /// Replace the report in the folder; rows kept there are used in any case
    #[arg(long, help_heading = "Results")]
    force: bool,
    #[command(flatten)]
    processor: ProcessorOptions,
    #[command(flatten)]
    report: ReportOptions,
}

/// The report with the names of its files.
#[derive(Serialize)]
struct AssessResult<'a> {
    #[serde(flatten)]
    report: &'a Report,
    steps: &'a [Step],
    files: Vec<&'a str>,
}

/// Opens the files of a report in its folder, after checking that none is an input of the study.
pub fn pending(study: &Path, plan: &Plan, out: &Path, files: &[(String, Vec<u8>)]) -> anyhow::Result<Vec<Pending>> {
    let folder = study.parent().unwrap_or(Path::new(""));
    let records = plan.inputs.iter().skip(1).map(|input| NamedFile::new("the input", &folder.join(&input.file)));
    let inputs: Vec<_> = std::iter::once(NamedFile::new("the study", study)).chain(records).collect();
    let outputs: Vec<_> = files.iter().map(|(name, _)| NamedFile::new("--out", &out.join(name))).collect();
    check_distinct(&inputs, &outputs)?;
    files.iter().map(|(name, _)| Pending::new(&out.join(name))).collect()
}

/// Makes the folder of a report. A report that is there stays, unless the user asks to replace it.
pub fn make_folder(out: &Path, page: &str, force: bool) -> anyhow::Result<PathBuf> {
    let page = out.join(page);
    anyhow::ensure!(
        force || !page.exists(),
        "{}: exists already; expected --force to replace it, or another folder for --out",
        page.display()
    );
    std::fs::create_dir_all(out).with_context(|| format!("{}: cannot be created", out.display()))?;
    Pending::new(&page)?;
    Ok(page)
}

/// Runs the command.
pub fn run(options: &AssessCommand) -> anyhow::Result<()> {
    let AssessCommand { file, out, force, processor, report } = options;
    let (name, text) = input::text(file)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    // The page names the file without its folder, so that its bytes do not depend on where the study lies.
    let short = file.file_name().map_or(name.clone(), |name| name.to_string_lossy().into_owned());
    let plan = Plan::read(&short, &text, folder).map_err(|error| StudyFileError { file: name.clone(), ..error })?;
    warn(&plan.sweep.remarks);
    let page = make_folder(out, PAGE, *force)?;

    // An interrupted call, or one with another title, finds the rows there.
    let kept = out.join("kept");
    std::fs::create_dir_all(&kept).with_context(|| format!("{}: cannot be created", kept.display()))?;
    let program = std::env::current_exe().context("the program's own file cannot be found")?;
    let keep = Cache { folder: &kept, program: &program };
    let pool = processor.threads.pool()?;
    let bar = Progress::new(0, 0);
    let show = |step: &str, done, all| bar.show_step(step, done, all);
    let found = assess(&plan, &pool, processor.width(), Some(keep), &show);
    let found = found.map_err(|error| anyhow::anyhow!("{name}: {error}"))?;
    bar.clear();
    let files = rocking_report::files(&plan, &found)?;
    let pending = pending(file, &plan, out, &files)?;
    let names = files.iter().map(|(name, _)| name.as_str()).collect();
    let result = AssessResult { report: &found.report, steps: &found.steps, files: names };
    let text = rocking_report::text(&found);
    let written = WrittenFiles::new([("out", Some(page.as_path()))]);
    let contents = files.iter().map(|(_, content)| content.clone());
    Pending::write(pending.into_iter().zip(contents).collect())?;
    warn(&found.report.remarks);
    let warnings = [&plan.sweep.remarks[..], &found.report.remarks].concat();
    report.print("assess", &written, &warnings, &(text + &written.lines()), &result)
}
