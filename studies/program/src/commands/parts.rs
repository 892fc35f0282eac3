//! `rocking parts`: a folder of parts → their counts, and the parts to make.

use std::path::PathBuf;

use clap::Parser;

use crate::output::progress::Progress;
use crate::output::report::{ReportOptions, WrittenFiles};
use crate::output::summary::{Object, Summary};
use rocking_studies::output::parts::ranges;
use rocking_studies::output::table_files::{PartsState, TableFiles};

/// Options of `rocking parts`.
#[derive(Parser)]
pub struct PartsCommand {
    /// Folder of the parts
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    #[command(flatten)]
    report: ReportOptions,
}

/// Runs the command. Parts that are not complete are an error.
pub fn run(options: &PartsCommand) -> anyhow::Result<()> {
    let files = TableFiles::of(&options.folder)?;
    let bar = Progress::new(files.files().len() as u64, 0);
    let found = files.state(|done| bar.show(done))?;
    bar.clear();
    let warnings: Vec<String> = found.faults.iter().map(|(_, fault)| fault.to_string()).collect();
    let summary = summary(&found);
    options.report.print("parts", &WrittenFiles::new([]), &warnings, &summary.text, &summary.json)?;
    let lacks = [(found.missing.len(), "missing"), (found.faults.len(), "damaged or of another study")];
    let lacks = lacks.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}"));
    let lacks = lacks.collect::<Vec<_>>().join(", ");
    let folder = options.folder.display();
    anyhow::ensure!(lacks.is_empty(), "{folder}: of {} parts, {lacks}", found.count);
    Ok(())
}

fn summary(found: &PartsState) -> Summary {
    let PartsState { count, missing, faults, rows, rows_of_study } = found;
    let complete = count - (missing.len() + faults.len()) as u64;
    let to_make = found.to_make();
    let mut summary = Summary::default();
    summary.item("complete", complete, "parts", format!("{complete} of {count} complete"));
    summary.entry("parts", count);
    let of = rows_of_study.map_or(String::new(), |of| format!(" of {of}, {:.1} %", percent(*rows, of)));
    summary.item("rows", rows, "rows", format!("{rows}{of}"));
    summary.entry("rows_of_study", rows_of_study);
    summary.entry("missing", missing);
    if !missing.is_empty() {
        summary.line("missing", format!("{}: {}", missing.len(), ranges(missing.iter().copied())));
    }
    for (_, fault) in faults {
        summary.line("faulty", fault);
    }
    let faulty =
        faults.iter().map(|(part, fault)| Object::default().with("part", part).with("fault", fault.to_string()));
    summary.entry("faulty", faulty.collect::<Vec<_>>());
    let array = ranges(to_make.iter().copied());
    if !to_make.is_empty() {
        summary.line("to make", format!("--array={array}"));
    }
    summary.entry("array", array);
    summary
}

/// Part of the rows in per cent, less than 100 unless all are there.
fn percent(rows: u64, of: u64) -> f64 {
    (1000.0 * rows as f64 / of.max(1) as f64).floor() / 10.0
}
