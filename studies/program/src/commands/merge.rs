//! `rocking merge`: a folder of parts → the table of one run.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{ArgGroup, Parser};

use crate::output::files::{NamedFile, StreamedFile, check_distinct};
use crate::output::formats::{check_table, table_format};
use crate::output::progress::Progress;
use crate::output::report::{ReportOptions, WrittenFiles};
use crate::output::summary::Summary;
use rocking_studies::output::format::TableFormat;
use rocking_studies::output::merging;
use rocking_studies::output::merging::{MergeError, MergedParts};
use rocking_studies::output::output_target::OutputTarget;
use rocking_studies::output::table_files::TableFiles;

/// Options of `rocking merge`.
#[derive(Parser)]
#[command(group(ArgGroup::new("table").required(true).args(["csv", "parquet"])))]
pub struct MergeCommand {
    /// Folder of the parts, all of one study
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// Table in CSV, as `rocking sweep` writes it in one run; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    csv: Option<PathBuf>,
    /// Table in Parquet, from parts in Parquet
    #[arg(long, value_name = "FILE.parquet", help_heading = "Results")]
    parquet: Option<PathBuf>,
    /// Replace an existing table
    #[arg(long, help_heading = "Results")]
    force: bool,
    #[command(flatten)]
    report: ReportOptions,
}

/// Runs the command.
pub fn run(options: &MergeCommand) -> anyhow::Result<()> {
    let MergeCommand { folder, csv, parquet, force, report } = options;
    let (option, path) = match (csv, parquet) {
        (Some(path), _) => ("csv", path),
        (None, Some(path)) => ("parquet", path),
        (None, None) => unreachable!("required by the command line"),
    };
    check_name(option, path)?;
    let files = TableFiles::of(folder)?;
    let columns = if option == "parquet" { merging::types(&files)? } else { Vec::new() };
    let parts: Vec<_> = files.files().iter().map(|file| NamedFile::new("the part", &file.path)).collect();
    check_distinct(&parts, &[NamedFile::new(&format!("--{option}"), path)])?;
    let target = OutputTarget::of(path)?;
    let name = target.name(path);
    if let OutputTarget::File(path) = &target {
        anyhow::ensure!(
            *force || !path.exists(),
            "{name}: exists already; expected --force to replace it, or another name"
        );
    }
    // The output is known to be writable before the parts are read.
    let stream = target.open_stream().with_context(|| format!("{name}: cannot be written"))?;
    let file = if stream.is_some() { None } else { Some(StreamedFile::new(path)?) };
    let out = match (stream, &file) {
        (Some(stream), _) => stream,
        (None, Some(file)) => file.writer()?,
        (None, None) => unreachable!("an output is a stream or a file"),
    };

    let mut bar = None;
    let mut merged =
        MergedParts::read(&files, |done, rows| bar.get_or_insert_with(|| Progress::new(rows, 0)).show(done))?;
    if let Some(bar) = bar {
        bar.clear();
    }
    let written = match option {
        "parquet" => merged.write_parquet(&columns, out).map(|_| ()),
        _ => merged.write_csv(out).map(|_| ()),
    };
    match written {
        // A reader such as `head` may close its pipe early.
        Err(MergeError::Output(error)) if error.kind() == ErrorKind::BrokenPipe => (),
        Err(error @ MergeError::Output(_)) => return Err(error).with_context(|| name),
        written => written?,
    }
    if let Some(file) = file {
        file.complete()?;
    }
    let mut summary = Summary::default();
    summary.item("parts", parts.len(), "parts", parts.len());
    summary.item("rows", merged.rows(), "rows", merged.rows());
    let written = WrittenFiles::new([(option, Some(path.as_path()))]);
    report.print("merge", &written, &[], &(summary.text + &written.lines()), &summary.json)
}

/// Refuses a name of the other format.
fn check_name(option: &str, path: &Path) -> anyhow::Result<()> {
    let name = path.display();
    match option {
        "csv" => {
            anyhow::ensure!(
                TableFormat::of(path) != TableFormat::Parquet,
                "--csv {name}: found a name in .parquet; expected --parquet {name}"
            );
            check_table(path)
        }
        _ => {
            anyhow::ensure!(
                TableFormat::of(path) == TableFormat::Parquet,
                "--parquet {name}: expected a name in .parquet"
            );
            table_format(path).map(drop)
        }
    }
}
