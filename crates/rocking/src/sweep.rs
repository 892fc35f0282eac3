//! `rocking sweep`: a study file → a table for fragility curves.

use std::path::{Path, PathBuf};

use clap::Parser;

use crate::choices;
use crate::formats::check_table;
use crate::input;
use crate::output::{NamedFile, check_distinct};
use crate::run_options::StudyOptions;
use rocking_block::simulation::OnSeparation;
use rocking_block::unit::variables::Variable;
use rocking_studies::sweep::file as study_file;

/// Options of `rocking sweep`.
#[derive(Parser)]
pub struct Options {
    /// Study file in TOML, as examples/fragility.toml; `-` for standard input
    #[arg(value_name = "STUDY.toml")]
    file: PathBuf,
    /// Action at complete separation, unless the study names on_separation; by default the block flies on
    #[arg(long, value_parser = choices::on_separation(), help_heading = "Runs")]
    on_separation: Option<OnSeparation>,
    #[command(flatten)]
    study: StudyOptions,
}

/// Runs the command.
pub fn run(options: &Options) -> anyhow::Result<()> {
    let Options { file, study, .. } = options;
    let table = [NamedFile::new("--csv", &study.csv)];
    check_table(&study.csv)?;
    check_distinct(&[NamedFile::new("the study", file)], &table)?;
    let (name, text) = input::text(file)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let mut sweep = study_file::read(&name, &text, folder)?;
    if let Some(on_separation) = options.on_separation {
        let named = sweep.parameters.iter().any(|swept| swept.parameter.metadata.variable == Variable::OnSeparation);
        anyhow::ensure!(!named, "--on-separation: {name} names on_separation as well; expected one of the two");
        sweep.on_separation = on_separation;
    }
    let records = sweep.motions.iter().flat_map(|motion| &motion.names).filter(|name| !name.is_empty());
    let records: Vec<_> = records.map(|name| NamedFile::new("the record", &folder.join(name))).collect();
    check_distinct(&records, &table)?;
    let (summary, _) = study.run(&sweep, false)?;
    study.report("sweep", &summary, None, &[], &[])
}
