//! `rocking sweep`: a study file → a table for fragility curves.

use std::path::{Path, PathBuf};

use clap::{Args, Parser};

use crate::options::input;
use crate::options::run::{StudyOptions, warn};
use crate::output::files::{NamedFile, check_distinct};
use crate::output::formats::{check_table, knows_parquet};
use crate::output::summary::Summary;
use rocking_block::simulation::OnSeparation;
use rocking_block::unit::variables::Variable;
use rocking_studies::output::parts::{self, PartNumber};
use rocking_studies::output::runner::Study;
use rocking_studies::spec::run::separations;
use rocking_studies::sweep::Sweep;
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
    /// Make one of several parts, such as 3/100 for the third of a hundred, unless its file is complete. Parts can be made at the same
    /// time on any machines
    #[arg(long, value_name = "K/N", conflicts_with_all = ["csv", "resume"], requires = "out")]
    part: Option<PartNumber>,
    /// Folder of the parts, which `rocking fragility` and `rocking rate` read like a table
    #[arg(long, value_name = "FOLDER", requires = "part")]
    out: Option<PathBuf>,
    /// Format of the parts; by default parquet if the program knows it, else csv
    #[arg(long, value_name = "FORMAT", requires = "part", value_parser = ["csv", "parquet"])]
    part_format: Option<String>,
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

/// Runs the command.
pub fn run(options: &SweepCommand) -> anyhow::Result<()> {
    let SweepCommand { sweep: options, part: PartOptions { part, out, part_format, dry_run } } = options;
    let study = &options.study;
    let part = part.zip(out.as_deref()).map(|(number, folder)| {
        let names = folder.read_dir().into_iter().flatten().flatten();
        let names = names.map(|entry| entry.file_name().to_string_lossy().into_owned());
        let format = parts::format_in(names, number.count(), part_format.as_deref());
        let format = format.map_err(|reason| anyhow::anyhow!("{}: {reason}", folder.display()))?;
        let extension = format.unwrap_or(parts::FORMATS[0].into());
        let file = folder.join(number.file_name(&extension));
        anyhow::Ok((number, folder, extension, file))
    });
    let part = part.transpose()?;
    let table = match &part {
        Some((_, folder, _, file)) => {
            knows_parquet(file)?;
            folder.exists().then(|| NamedFile::new("--out", file))
        }
        None if *dry_run => None,
        None => {
            check_table(study.csv())?;
            Some(NamedFile::new("--csv", study.csv()))
        }
    };
    let checks = match &part {
        Some((number, ..)) if !dry_run => Checks::Part(*number),
        _ => Checks::All,
    };
    let sweep = options.read(table.as_slice(), checks)?;
    warn(&sweep.remarks);
    if *dry_run {
        return study.forecast(&sweep, model(&sweep), part.map_or(1, |(number, ..)| number.count()));
    }
    let Some((number, folder, extension, _)) = part else {
        let summary = study.run(&sweep, None)?;
        return study.report("sweep", (study.csv(), &summary), model(&sweep), &[], &sweep.remarks);
    };
    let (file, summary) = study.run_part(&sweep, number, folder, &extension)?;
    let before = if summary.resumed > 0 { ", complete before" } else { "" };
    let mut items = model(&sweep);
    items.item("part", [number.number(), number.count()], "part", format!("{number}{before}"));
    study.report("sweep", (&file, &summary), items, &[], &sweep.remarks)
}
