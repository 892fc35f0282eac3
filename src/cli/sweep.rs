//! `rocking sweep`: a study file → a table for fragility curves.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;

use crate::cli::run_options::{AtSeparation, StudyOptions};
use crate::fmi2::variables::Variable;
use crate::study::sweep_file;

/// Options of `rocking sweep`.
#[derive(Parser)]
pub struct Options {
    /// The study: TOML, see the README
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
    let name = options.file.display().to_string();
    let text = std::fs::read_to_string(&options.file).with_context(|| format!("{name}: cannot be read"))?;
    let folder = options.file.parent().unwrap_or(Path::new(""));
    let mut sweep = sweep_file::read(&name, &text, folder)?;
    if let Some(on_separation) = options.on_separation {
        let named = sweep.factors.iter().any(|factor| factor.parameter.metadata.variable == Variable::OnSeparation);
        anyhow::ensure!(!named, "--on-separation: {name} names on_separation as well; expected one of the two");
        sweep.on_separation = on_separation.into();
    }
    options.study.run(&sweep)?.tell(&options.study.csv, None)
}
