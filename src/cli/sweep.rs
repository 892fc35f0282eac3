//! `rocking sweep`: a study file → a table for fragility curves.

use std::path::{Path, PathBuf};

use clap::Parser;

use crate::cli::formats::check_table;
use crate::cli::input;
use crate::cli::output::{Named, check_distinct};
use crate::cli::run_options::{AtSeparation, StudyOptions};
use crate::model::variables::Variable;
use crate::study::sweep_file;

/// Options of `rocking sweep`.
#[derive(Parser)]
pub struct Options {
    /// The study: TOML, see the README; `-` for standard input
    #[arg(value_name = "STUDY.toml")]
    file: PathBuf,
    /// What happens at complete separation, where the study does not name on_separation; without it the block flies on
    #[arg(long, value_enum, help_heading = "Runs")]
    on_separation: Option<AtSeparation>,
    #[command(flatten)]
    study: StudyOptions,
}

/// Does what the options say.
pub fn run(options: &Options) -> anyhow::Result<()> {
    let Options { file, study, .. } = options;
    let table = [Named::new("--csv", &study.csv)];
    check_table(&study.csv)?;
    check_distinct(&[Named::new("the study", file)], &table)?;
    let (name, text) = input::text(file)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let mut sweep = sweep_file::read(&name, &text, folder)?;
    if let Some(on_separation) = options.on_separation {
        let named = sweep.factors.iter().any(|factor| factor.parameter.metadata.variable == Variable::OnSeparation);
        anyhow::ensure!(!named, "--on-separation: {name} names on_separation as well; expected one of the two");
        sweep.on_separation = on_separation.into();
    }
    let records = sweep.motions.iter().flat_map(|motion| &motion.names).filter(|name| !name.is_empty());
    let records: Vec<_> = records.map(|name| Named::new("the record", &folder.join(name))).collect();
    check_distinct(&records, &table)?;
    let (made, _) = study.run(&sweep, false)?;
    study.report("sweep", &made, None, &[], &[])
}
