//! `rocking schema`: kind of study file → its JSON Schema.

use clap::{Parser, ValueEnum};

use crate::output::report;
use rocking_studies::spec::fit::FitFile;
use rocking_studies::spec::limits;
use rocking_studies::spec::study::StudyFile;

/// Options of `rocking schema`.
#[derive(Parser)]
pub struct SchemaCommand {
    /// Kind of file, as in `rocking schema study > study.schema.json`
    #[arg(value_enum, default_value_t = Kind::Study)]
    kind: Kind,
}

#[derive(Clone, Copy, ValueEnum)]
enum Kind {
    /// Study for sweep, ida and assess
    Study,
    /// Tests for fit
    Fit,
}

/// Runs the command.
pub fn run(options: &SchemaCommand) -> anyhow::Result<()> {
    let schema = match options.kind {
        Kind::Study => limits::schema_of::<StudyFile>(),
        Kind::Fit => limits::schema_of::<FitFile>(),
    };
    report::print(&(serde_json::to_string_pretty(&schema)? + "\n"), false)
}
