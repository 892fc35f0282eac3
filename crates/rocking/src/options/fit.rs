//! Options of a fit: the table of a sweep → its rows, the limit, and the method of intervals.

use std::path::Path;

use anyhow::Context;
use clap::Args;

use crate::options::checks::check;
use crate::options::choices;
use crate::options::explicit::ExplicitOptions;
use crate::options::input;
use rocking_studies::fragility::{Limit, Link, SweepTable, Uncertainty, is_needed};
use rocking_studies::output::output_target::STANDARD;
use rocking_studies::output::parts::Parts;
use rocking_studies::output::reading::TableReader;
use rocking_studies::spec::words::Words;

/// Rows and method of a fit.
#[derive(Args)]
pub struct FitOptions {
    /// Limit to exceed: overturned, balance (the rotation that puts the centre of mass over the corner), a number such as 0.5 for
    /// |theta|/alpha > 0.5, or a slip such as slip:0.1 in metres. By default overturned, or balance for blocks with ties. Counts the
    /// probabilities of ensembles if the table has them, else the outcomes of runs
    #[arg(long, value_name = "LIMIT")]
    limit: Option<Limit>,
    /// Use only the rows in which a column has this value; several conditions must all hold
    #[arg(id = "where", long, value_name = "COLUMN=VALUE")]
    conditions: Vec<String>,
    /// Evaluate the parts of a folder although some are missing
    #[arg(long)]
    partial: bool,
    /// Distribution behind the curve
    #[arg(long, value_parser = choices::link(), default_value = Link::Probit.word())]
    pub link: Link,
    /// Confidence level of the intervals and of the band
    #[arg(long, value_name = "LEVEL", default_value_t = 0.95)]
    pub ci: f64,
    /// Compute intervals from this many bootstrap samples of the records, not from the profile likelihood (clustered by record
    /// if rows share records)
    #[arg(long, value_name = "SAMPLES", value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    bootstrap: Option<u32>,
    /// Seed of the bootstrap samples
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

impl FitOptions {
    /// Refuses a seed without effect and an impossible confidence level.
    pub fn check(&self, explicit: &ExplicitOptions) -> anyhow::Result<()> {
        explicit.refuse_unless(self.bootstrap.is_some(), &["seed"], "without --bootstrap")?;
        check("ci", self.ci, |x| x > 0.0 && x < 1.0, "a number above 0 and below 1")
    }

    /// Returns the method of the intervals.
    pub fn uncertainty(&self) -> Uncertainty {
        self.bootstrap.map_or(Uncertainty::Profile, |samples| Uncertainty::Bootstrap(samples, self.seed))
    }

    /// Returns the limit, or the usual one of a table.
    pub fn limit(&self, table: &SweepTable) -> Limit {
        self.limit.unwrap_or_else(|| table.usual_limit())
    }

    /// Reads the rows of a table that meet the conditions, and returns its name with them. Columns that are neither named nor needed by
    /// any fit are left out; without `named` all are read.
    pub fn table(&self, path: &Path, named: Option<&[&str]>) -> anyhow::Result<(String, SweepTable)> {
        let of_conditions = self.conditions.iter().filter_map(|condition| Some(condition.split_once('=')?.0));
        let named = named.map(|named| named.iter().copied().chain(of_conditions).collect::<Vec<_>>());
        let is_wanted = |column: &str| named.as_ref().is_none_or(|named| is_needed(column, named));
        let (name, mut table) = read(path, self.partial, &is_wanted)?;
        for condition in &self.conditions {
            let (column, value) = condition
                .split_once('=')
                .with_context(|| format!("--where {condition}; expected COLUMN=VALUE, as in foundation=rigid"))?;
            table.keep(column, value)?;
        }
        Ok((name, table))
    }
}

/// Reads a table, as CSV or Parquet by its name, or a folder of parts, and returns its name in messages with it.
fn read(path: &Path, is_partial: bool, is_wanted: &dyn Fn(&str) -> bool) -> anyhow::Result<(String, SweepTable)> {
    anyhow::ensure!(
        !is_partial || path.is_dir(),
        "--partial has no effect without a folder of parts; found {}",
        path.display()
    );
    if path == Path::new(STANDARD) {
        let (name, text) = input::text(path)?;
        let table = SweepTable::read(&name, text.as_bytes())?;
        return Ok((name, table));
    }
    let name = path.display().to_string();
    let (table, headings) = if path.is_dir() {
        let parts = Parts::of(path)?;
        if !is_partial {
            parts.check_complete("--partial")?;
        }
        parts.read(is_wanted)?
    } else {
        let mut reader = TableReader::new(is_wanted);
        reader.read_file(path)?;
        let headings = reader.headings().to_vec();
        (reader.table(), headings)
    };
    let table = SweepTable::of_columns(&name, table, headings);
    Ok((name, table))
}
