//! Options of a fit: the table of a sweep → its rows, the limit, and the method of intervals.

use std::path::Path;

use anyhow::Context;
use clap::Args;

use crate::checks::check;
use crate::choices;
use crate::explicit_options::ExplicitOptions;
use crate::input;
use rocking_block::words::Words;
use rocking_studies::fragility::{Limit, Link, SweepTable, Uncertainty};

/// Rows and method of a fit.
#[derive(Args)]
pub struct FitOptions {
    /// Limit to exceed: overturned, or a number such as 0.5 for |theta|/alpha > 0.5. Counts the probabilities of ensembles if
    /// the table has them, else the outcomes of single runs
    #[arg(long, value_name = "LIMIT", default_value = "overturned")]
    pub limit: Limit,
    /// Use only the rows in which a column has this value; several conditions must all hold
    #[arg(id = "where", long, value_name = "COLUMN=VALUE")]
    conditions: Vec<String>,
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

    /// Reads the rows of a table that meet the conditions, and returns its name with them.
    pub fn table(&self, path: &Path) -> anyhow::Result<(String, SweepTable)> {
        let (name, text) = input::text(path)?;
        let mut table = SweepTable::read(&name, text.as_bytes())?;
        for condition in &self.conditions {
            let (column, value) = condition
                .split_once('=')
                .with_context(|| format!("--where {condition}; expected COLUMN=VALUE, as in foundation=rigid"))?;
            table.keep(column, value)?;
        }
        Ok((name, table))
    }
}
