//! `rocking sweep`: a study file → a table for fragility curves.

use std::path::{Path, PathBuf};

use clap::{Args, Parser};

use crate::options::choices;
use crate::options::input;
use crate::options::run::{StudyOptions, warn};
use crate::output::files::{NamedFile, check_distinct};
use crate::output::formats::check_table;
use crate::output::summary::Summary;
use anyhow::Context;
use rocking_block::simulation::OnSeparation;
use rocking_block::unit::variables::Variable;
use rocking_studies::output::format::TableFormat;
use rocking_studies::output::parts::{self, PartNumber, PartNumbers};
use rocking_studies::output::resumable::{Failures, TableWriteError};
use rocking_studies::output::runner::{Follower, Study, StudySummary};
use rocking_studies::output::table::Table;
use rocking_studies::spec::run::separations;
use rocking_studies::sweep::Sweep;
use rocking_studies::sweep::amplified::GreatestScales;
use rocking_studies::sweep::file::{self as study_file, Checks};
use rocking_studies::sweep::ground_motion::GroundMotion;
use rocking_studies::sweep::parameters::SweptParameter;

/// Options of `rocking sweep`.
#[derive(Parser)]
#[command(mut_arg("csv", |csv| csv.required(false).required_unless_present_any(["part", "dry_run"])))]
pub struct SweepCommand {
    #[command(flatten)]
    sweep: SweepOptions,
    #[command(flatten)]
    part: PartOptions,
}

/// A part of the study instead of its table.
#[derive(Args)]
#[command(next_help_heading = "Parts")]
struct PartOptions {
    /// Make one of several parts, such as 3/100 for the third of a hundred, or some, such as 1-10/100 or 3,17,40/100, unless their
    /// files are complete. Parts can be made at the same time on any machines
    #[arg(long, value_name = "K/N", conflicts_with_all = ["csv", "resume"], requires = "out")]
    part: Option<PartNumbers>,
    /// Folder of the parts, which `rocking fragility` and `rocking rate` read like a table
    #[arg(long, value_name = "FOLDER", requires = "part")]
    out: Option<PathBuf>,
    /// Format of the parts; by default parquet if the program knows it, else csv
    #[arg(long, value_name = "FORMAT", requires = "part", value_parser = choices::table_format())]
    part_format: Option<TableFormat>,
    /// Print the number of rows and the expected CPU time and size, from a sample of the rows, and make no table
    #[arg(long)]
    dry_run: bool,
}

/// A study file and its table.
#[derive(Args)]
pub struct SweepOptions {
    /// Study file in TOML, as examples/fragility.toml; `-` for standard input
    #[arg(value_name = "STUDY.toml")]
    pub file: PathBuf,
    /// Action at complete separation, unless the study names on_separation; by default the block flies on
    #[arg(long, value_parser = separations(), help_heading = "Runs")]
    on_separation: Option<OnSeparation>,
    #[command(flatten)]
    pub study: StudyOptions,
}

impl SweepOptions {
    /// Reads the study with these checks; none of its files may be one of the outputs.
    pub fn read(&self, outputs: &[NamedFile], checks: Checks) -> anyhow::Result<Sweep> {
        let SweepOptions { file, on_separation, .. } = self;
        check_distinct(&[NamedFile::new("the study", file)], outputs)?;
        let (name, text) = input::text(file)?;
        let folder = file.parent().unwrap_or(Path::new(""));
        let mut sweep = study_file::read_for(&name, &text, folder, checks)?;
        if let Some(on_separation) = *on_separation {
            let is_named = |swept: &SweptParameter| swept.parameter.variable() == Some(Variable::OnSeparation);
            let named = sweep.parameters.iter().any(is_named);
            anyhow::ensure!(!named, "--on-separation: {name} names on_separation as well; expected one of the two");
            sweep.on_separation = on_separation;
        }
        let records = sweep.motions.iter().flat_map(GroundMotion::read_files);
        let records = records.map(|name| NamedFile::new("the record", &folder.join(name)));
        let feet = sweep.space.iter().filter_map(|blocks| blocks.feet.as_ref());
        let feet = feet.map(|(name, _)| NamedFile::new("the feet", &folder.join(name)));
        check_distinct(&records.chain(feet).collect::<Vec<_>>(), outputs)?;
        if !sweep.uses_lanes() {
            self.study.refuse_lanes("on blocks in space, which are stepped one by one; expected --threads alone")?;
        }
        Ok(sweep)
    }
}

/// Begins the summary of a study, which says that its blocks are in space.
pub fn model(sweep: &Sweep) -> Summary {
    let mut summary = Summary::default();
    if sweep.space.is_some() {
        summary.item("model", "block in space", "model", "block in space");
    }
    summary
}

/// The parts to make, and the folder and format of their files.
struct Parts<'a> {
    numbers: &'a PartNumbers,
    folder: &'a Path,
    format: TableFormat,
}

impl PartOptions {
    /// The parts, if the study is made in parts. Their format is that of the parts in the folder.
    fn parts(&self) -> anyhow::Result<Option<Parts<'_>>> {
        let PartOptions { part: Some(numbers), out: Some(folder), part_format, .. } = self else { return Ok(None) };
        let names = folder.read_dir().into_iter().flatten().flatten();
        let names = names.map(|entry| entry.file_name().to_string_lossy().into_owned());
        let format = parts::format_in(names, numbers.count(), *part_format);
        let format = format.map_err(|reason| anyhow::anyhow!("{}: {reason}", folder.display()))?;
        format.check().with_context(|| folder.display().to_string())?;
        Ok(Some(Parts { numbers, folder, format }))
    }
}

impl Parts<'_> {
    fn file(&self, part: PartNumber) -> PathBuf {
        self.folder.join(part.file_name(self.format))
    }

    /// Makes the parts, and reports on all of them.
    fn make(&self, study: &StudyOptions, sweep: &Sweep) -> anyhow::Result<()> {
        let numbers = self.numbers.parts();
        let mut scales = sweep.hunted_scales();
        let mut whole = StudySummary { rows: 0, resumed: 0, failures: Failures::default(), reason: None };
        let mut before = 0;
        let is_hunt = scales.is_some();
        let mut take = |rows: Table| take_scales(&mut scales, &rows);
        for part in numbers {
            let follow: Option<Follower> = if is_hunt { Some(&mut take) } else { None };
            let (_, made) = study.run_part(sweep, *part, self.folder, self.format, follow)?;
            before += usize::from(made.resumed > 0);
            whole.rows += made.rows;
            whole.resumed += made.resumed;
            if whole.failures.count == 0 {
                whole.failures.first = made.failures.first;
            }
            whole.failures.count += made.failures.count;
            whole.reason = whole.reason.or(made.reason);
        }
        let mut items = model(sweep);
        let remarks = with_doubts(sweep, scales);
        if let [part] = numbers {
            let complete = if before > 0 { ", complete before" } else { "" };
            items.item("part", [part.number(), part.count()], "part", format!("{part}{complete}"));
            return study.report("sweep", (&self.file(*part), &whole), items, &[], &remarks);
        }
        let complete = if before > 0 { format!(", {before} complete before") } else { String::new() };
        let count = self.numbers.count();
        items.line("parts", format!("{} of {count}{complete}", self.numbers));
        items.entry("parts", [self.numbers.to_string(), count.to_string()]);
        study.report("sweep", (self.folder, &whole), items, &[], &remarks)
    }
}

/// Runs the command.
pub fn run(options: &SweepCommand) -> anyhow::Result<()> {
    let SweepCommand { sweep: options, part: of_parts } = options;
    let (study, dry_run) = (&options.study, of_parts.dry_run);
    let parts = of_parts.parts()?;
    let outputs: Vec<NamedFile> = match &parts {
        Some(parts) if parts.folder.exists() => {
            parts.numbers.parts().iter().map(|part| NamedFile::new("--out", &parts.file(*part))).collect()
        }
        Some(_) => Vec::new(),
        None if dry_run => Vec::new(),
        None => {
            check_table(study.csv())?;
            vec![NamedFile::new("--csv", study.csv())]
        }
    };
    let checks = match &parts {
        Some(parts) if !dry_run => Checks::Parts(parts.numbers.parts()),
        _ => Checks::All,
    };
    let sweep = options.read(&outputs, checks)?;
    warn(&sweep.remarks);
    if dry_run {
        return study.forecast(&sweep, model(&sweep), parts.map_or(1, |parts| parts.numbers.count()));
    }
    if let Some(parts) = parts {
        return parts.make(study, &sweep);
    }
    let mut scales = sweep.hunted_scales();
    let is_hunt = scales.is_some();
    let mut take = |rows: Table| take_scales(&mut scales, &rows);
    // Rows that nothing follows are not read again where a table is resumed.
    let summary = study.run(&sweep, if is_hunt { Some(&mut take) } else { None }, false)?;
    let remarks = with_doubts(&sweep, scales);
    study.report("sweep", (study.csv(), &summary), model(&sweep), &[], &remarks)
}

/// Takes the factors on the records of a hunt.
fn take_scales(scales: &mut Option<GreatestScales>, rows: &Table) -> Result<(), TableWriteError> {
    if let Some(scales) = scales {
        scales.take(rows);
    }
    Ok(())
}

/// Warns of the strong scales of a hunt, and returns all remarks on the study.
fn with_doubts(sweep: &Sweep, scales: Option<GreatestScales>) -> Vec<String> {
    let found = scales.map(|scales| scales.doubts()).unwrap_or_default();
    warn(&found);
    [sweep.remarks.as_slice(), &found].concat()
}
