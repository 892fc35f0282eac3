//! Options of a fit: a table → its rows, the limit, and the method of intervals.

use std::path::Path;

use anyhow::Context;
use clap::Args;

use crate::options::checks::check;
use crate::options::choices;
use crate::options::explicit::ExplicitOptions;
use crate::options::input;
use rocking_studies::fragility::{ChosenRows, Limit, Link, SweepTable, Uncertainty, is_needed};
use rocking_studies::output::output_target::STANDARD;
use rocking_studies::output::table::Table;
use rocking_studies::output::table_files::TableFiles;
use rocking_studies::spec::words::Words;

/// The rows of a table, their clusters, and the level of confidence.
#[derive(Args)]
pub struct RowOptions {
    /// Use only the rows in which a column has this value; several conditions must all hold
    #[arg(id = "where", long, value_name = "COLUMN=VALUE")]
    conditions: Vec<String>,
    /// Evaluate the parts of a folder although some are missing
    #[arg(long)]
    partial: bool,
    /// Confidence level of the intervals and bands
    #[arg(long, value_name = "LEVEL", default_value_t = 0.95)]
    pub ci: f64,
    /// Cluster rows by the values of this column, not by the ground motions that they share (event and station, as far as the names
    /// and titles of the records tell)
    #[arg(long, value_name = "COLUMN")]
    pub cluster: Option<String>,
}

/// Rows and method of a fit.
#[derive(Args)]
pub struct FitOptions {
    /// Limit to exceed: overturned, balance (the rotation that puts the centre of mass over the corner), a number such as 0.5 for
    /// |theta|/alpha > 0.5, in metres a slip such as slip:0.1 or a plastic elongation of a tie or damper such as plastic:0.02, or a
    /// number of half cycles of the latter such as half_cycles:20, or breaks for a tie or damper that breaks; of blocks in space a number is the tilt over that of the balance in
    /// the direction of the lean, balance is 1 of it, and there are twist:0.1 in rad and drift:0.1 in metres. By default overturned, or balance for blocks with ties. Counts the probabilities of ensembles if the table has them, else the
    /// outcomes of runs
    #[arg(long, value_name = "LIMIT")]
    pub limit: Option<Limit>,
    #[command(flatten)]
    pub rows: RowOptions,
    /// Distribution behind the curve
    #[arg(long, value_parser = choices::link(), default_value = Link::Probit.word())]
    pub link: Link,
    /// Compute intervals from this many bootstrap samples of the motions, not from the profile likelihood (clustered by motion
    /// if rows share motions)
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
        self.rows.check()
    }

    /// Returns the method of the intervals.
    pub fn uncertainty(&self) -> Uncertainty {
        self.bootstrap.map_or(Uncertainty::Profile, |samples| Uncertainty::Bootstrap(samples, self.seed))
    }
}

impl RowOptions {
    /// Refuses an impossible confidence level.
    pub fn check(&self) -> anyhow::Result<()> {
        check("ci", self.ci, |x| x > 0.0 && x < 1.0, "a number above 0 and below 1")
    }

    /// Passes the rows that meet the conditions on in batches; returns the table's name. Each batch comes with whether its rows are those
    /// of a part. Columns that are neither named nor needed by any fit are left out.
    pub fn read_batches(
        &self,
        path: &Path,
        named: &[&str],
        each: &mut dyn FnMut(&SweepTable, bool) -> anyhow::Result<()>,
    ) -> anyhow::Result<String> {
        let mut rows = self.rows()?;
        let more: Vec<String> = rows.columns().chain(self.cluster.as_deref()).map(String::from).collect();
        let named: Vec<&str> = named.iter().copied().chain(more.iter().map(String::as_str)).collect();
        let is_wanted = |column: &str| is_needed(column, &named);
        let mut take = |mut batch: SweepTable, is_part| -> anyhow::Result<()> {
            rows.keep(&mut batch)?;
            each(&batch, is_part)
        };
        let name = match self.files(path)? {
            Some(files) => {
                let (name, is_part) = (path.display().to_string(), files.are_numbered());
                let mut before = 0;
                files.read_batches(&is_wanted, &mut |table: Table, headings| {
                    let first = before;
                    before += table.rows();
                    take(SweepTable::batch(&name, table, headings.to_vec(), first)?, is_part)
                })?;
                name
            }
            None => {
                let (name, text) = input::text(path)?;
                take(SweepTable::read(&name, text.as_bytes())?, false)?;
                name
            }
        };
        rows.check(&name)?;
        Ok(name)
    }

    /// Reads all columns of the rows that meet the conditions.
    pub fn table(&self, path: &Path) -> anyhow::Result<SweepTable> {
        let mut table = match self.files(path)? {
            Some(files) => {
                let (table, headings) = files.read(&|_| true)?;
                SweepTable::batch(&path.display().to_string(), table, headings, 0)?
            }
            None => {
                let (name, text) = input::text(path)?;
                SweepTable::read(&name, text.as_bytes())?
            }
        };
        let mut rows = self.rows()?;
        rows.keep(&mut table)?;
        rows.check(&table.file)?;
        Ok(table)
    }

    /// Returns the conditions on rows.
    fn rows(&self) -> anyhow::Result<ChosenRows> {
        let split = self.conditions.iter().map(|condition| {
            let split = condition.split_once('=').map(|(column, value)| (column.into(), value.into()));
            split.with_context(|| format!("--where {condition}; expected COLUMN=VALUE, as in foundation=rigid"))
        });
        Ok(ChosenRows::new(split.collect::<anyhow::Result<Vec<_>>>()?))
    }

    /// Lists the files of a table; `None` for standard input.
    fn files(&self, path: &Path) -> anyhow::Result<Option<TableFiles>> {
        anyhow::ensure!(
            !self.partial || TableFiles::are_at(path),
            "--partial has no effect without a folder of parts; found {}",
            path.display()
        );
        if path == Path::new(STANDARD) {
            return Ok(None);
        }
        let files = TableFiles::of(path)?;
        if !self.partial {
            files.check_complete(Some("--partial"))?;
        }
        Ok(Some(files))
    }
}
