//! `rocking sweep`: a study file → a table for fragility curves.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;

use crate::cli::run_options::StudyOptions;
use crate::study::sweep_file;

/// Options of `rocking sweep`.
#[derive(Parser)]
pub struct Options {
    /// The study: TOML, see the README
    #[arg(value_name = "STUDY.toml")]
    file: PathBuf,
    #[command(flatten)]
    study: StudyOptions,
}

/// Does what the options say.
pub fn run(options: &Options) -> anyhow::Result<()> {
    let name = options.file.display().to_string();
    let text = std::fs::read_to_string(&options.file).with_context(|| format!("{name}: cannot be read"))?;
    let folder = options.file.parent().unwrap_or(Path::new(""));
    let sweep = sweep_file::read(&name, &text, folder)?;
    options.study.run(&sweep)?.tell(&options.study.csv, None)
}
