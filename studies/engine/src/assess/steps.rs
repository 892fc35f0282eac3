//! The studies of an assessment → their tables, step by step, kept for further calls.

use std::convert::Infallible;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rayon::ThreadPool;
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::fragility::SweepTable;
use crate::output::resumable::{ResumableTable, TableHeader, TableOptions, TableWriteError};
use crate::output::runner::{self, Study, StudyRows};
use crate::output::table::Table;
use crate::sweep::Sweep;
use rocking_block::numerics::wide::VectorWidth;

/// The reason why an assessment ends without results.
pub type AssessError = Box<dyn std::error::Error + Send + Sync>;

/// A step of an assessment.
#[derive(Clone, Debug, Serialize)]
pub struct Step {
    /// Its name.
    pub name: String,
    /// Number of runs.
    pub runs: u64,
    /// Runs of these kept from an earlier call.
    pub kept: u64,
    /// Duration (s).
    pub seconds: f64,
}

/// Work in progress.
pub(super) struct Work<'a> {
    pool: &'a ThreadPool,
    width: Option<VectorWidth>,
    /// The folder that keeps tables, and the program's checksum.
    keep: Option<(&'a Path, String)>,
    done: AtomicU64,
    all: AtomicU64,
    progress: &'a (dyn Fn(&str, u64, u64) + Sync),
    pub steps: Vec<Step>,
}

impl<'a> Work<'a> {
    /// Begins work of this number of runs, as far as known.
    pub fn new(
        pool: &'a ThreadPool,
        width: Option<VectorWidth>,
        keep: Option<Cache<'a>>,
        all: u64,
        progress: &'a (dyn Fn(&str, u64, u64) + Sync),
    ) -> Work<'a> {
        let keep = keep.and_then(|kept| Some((kept.folder, checksum_of(kept.program)?)));
        Work { pool, width, keep, done: AtomicU64::new(0), all: AtomicU64::new(all), progress, steps: Vec::new() }
    }

    fn count(&self, step: &str, runs: u64) {
        let done = self.done.fetch_add(runs, Ordering::Relaxed) + runs;
        (self.progress)(step, done, self.all.fetch_max(done, Ordering::Relaxed).max(done));
    }

    /// Makes a table, or reads its rows kept by an earlier call. The study had this identity.
    ///
    /// # Errors
    /// Rows that cannot be read or written.
    pub fn table(&mut self, name: &str, study: &impl Study, identity: &[String]) -> Result<Table, AssessError> {
        let since = Instant::now();
        let (table, kept) = match &self.keep {
            Some((folder, program)) => {
                self.kept_rows(name, folder, study, [std::slice::from_ref(program), identity].concat())?
            }
            None => {
                let mut rows = StudyRows::default();
                let make = |numbers| study.make_range(numbers, self.width);
                let completed = runner::in_batches(self.pool, 0..study.rows(), self.width, 1, make, |batch| {
                    self.count(name, batch.table.rows() as u64);
                    rows.append(batch);
                    Ok::<(), Infallible>(())
                });
                completed.map_or_else(|never| match never {}, |()| (rows.table, 0))
            }
        };
        self.steps.push(Step { name: name.into(), runs: study.rows(), kept, seconds: since.elapsed().as_secs_f64() });
        Ok(table)
    }

    /// Completes the kept rows of a study. Returns all rows and the number of those that were there.
    fn kept_rows(
        &self,
        name: &str,
        folder: &Path,
        study: &impl Study,
        identity: Vec<String>,
    ) -> Result<(Table, u64), AssessError> {
        let header = TableHeader { study: identity, columns: study.header().columns };
        // The file is named after the description of the table.
        let path = folder.join(hexadecimal(&Sha256::digest(header.study.join("\n").as_bytes())) + ".csv");
        let mut file = open(&path, &header, study.rows())?;
        let (mut before, mut table) = (0, Table::default());
        let mut follow = |rows| {
            table.append(rows);
            Ok(())
        };
        let summary = runner::run(study, self.pool, self.width, &mut file, Some(&mut follow), |_, rows| {
            self.count(name, rows - before);
            before = rows;
        })?;
        Ok((table, summary.resumed))
    }

    /// Makes the table of a sweep.
    ///
    /// # Errors
    /// Rows that cannot be read or written.
    pub fn sweep(&mut self, name: &str, sweep: &Sweep) -> Result<SweepTable, AssessError> {
        Ok(SweepTable::new("runs.csv", self.table(name, sweep, &sweep.identity())?))
    }

    /// Makes searches on the pool; their function is called after each run.
    pub fn search<T: Send>(&mut self, name: &str, search: impl FnOnce(&(dyn Fn() + Sync)) -> T + Send) -> T {
        let (since, before) = (Instant::now(), self.done.load(Ordering::Relaxed));
        let found = self.pool.install(|| search(&|| self.count(name, 1)));
        let runs = self.done.load(Ordering::Relaxed) - before;
        self.steps.push(Step { name: name.into(), runs, kept: 0, seconds: since.elapsed().as_secs_f64() });
        found
    }
}

/// A folder that keeps the rows of an assessment for later calls of this build.
#[derive(Clone, Copy, Debug)]
pub struct Cache<'a> {
    /// The folder, which exists.
    pub folder: &'a Path,
    /// The program or library that computes: another build may step otherwise.
    pub program: &'a Path,
}

/// The first line of kept tables, with the checksum of the program. `None` if it cannot be read.
fn checksum_of(program: &Path) -> Option<String> {
    let program = std::fs::read(program).ok()?;
    Some(format!(
        "rocking-block {}, program {}, kept rows",
        env!("CARGO_PKG_VERSION"),
        hexadecimal(&Sha256::digest(program))
    ))
}

/// The first 16 digits of a checksum.
fn hexadecimal(sum: &[u8]) -> String {
    sum.iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}

/// Opens a kept table; one that is damaged is replaced.
fn open(path: &Path, header: &TableHeader, rows: u64) -> Result<ResumableTable, TableWriteError> {
    let resume = TableOptions { resume: true, ..TableOptions::default() };
    match ResumableTable::open(path, header, rows, resume) {
        Err(TableWriteError::OtherRows(_)) => {
            ResumableTable::open(path, header, rows, TableOptions { force: true, ..TableOptions::default() })
        }
        opened => opened,
    }
}
