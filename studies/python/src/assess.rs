//! Study files with an object each → the numbers and the files of reports, and their order.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rocking_block::numerics::wide::VectorWidth;
use rocking_studies::assess::{Cache, Plan, Results, assess as assessed};
use rocking_studies::portfolio::{Kept, ObjectStudy, Studies, assess_all};

use crate::options::{invalid, pool};
use crate::work::wait;

/// An assessment for Python. It has the numbers as JSON, the result in a few sentences, and the names and contents of the files.
type Report<'py> = (String, String, Vec<(String, Bound<'py, PyBytes>)>);

/// Returns the report on the object of a study; its paths are relative to the folder. Rows are kept in the folder of `keep`, for further
/// calls of the library that is its file.
#[pyfunction]
pub fn assess<'py>(
    py: Python<'py>,
    name: &str,
    study: &str,
    folder: PathBuf,
    threads: Option<i64>,
    keep: Option<(PathBuf, PathBuf)>,
    tick: &Bound<'py, PyAny>,
) -> PyResult<Report<'py>> {
    let plan = Plan::read(name, study, &folder).map_err(invalid)?;
    let pool = pool(threads)?;
    let (numbers, text, files) = wait(py, tick, move |progress| {
        let show = |_: &str, done, total| progress.advance(done, total);
        let keep = keep.as_ref().map(|(folder, program)| Cache { folder, program });
        let found = assessed(&plan, &pool, VectorWidth::widest(), keep, &show).map_err(|error| error.to_string())?;
        written(&plan, &found)
    })?
    .map_err(invalid)?;
    Ok((numbers, text, bytes(py, files)))
}

/// The numbers as JSON, the sentences, and the files with their names.
type Written = (String, String, Vec<(String, Vec<u8>)>);

/// Writes a report to memory.
fn written(plan: &Plan, found: &Results) -> Result<Written, String> {
    let files = rocking_report::files(plan, found).map_err(|error| error.to_string())?;
    let numbers = serde_json::to_string(&found.report).map_err(|error| error.to_string())?;
    Ok((numbers, rocking_report::text(found), files))
}

fn bytes(py: Python<'_>, files: Vec<(String, Vec<u8>)>) -> Vec<(String, Bound<'_, PyBytes>)> {
    files.into_iter().map(|(name, content)| (name, PyBytes::new(py, &content))).collect()
}

/// Returns the order of the objects of several studies, and the report on each by its name. Rows are kept as for one object, in a folder for
/// each object.
#[pyfunction]
pub fn portfolio<'py>(
    py: Python<'py>,
    studies: Vec<PathBuf>,
    threads: Option<i64>,
    keep: Option<(PathBuf, PathBuf)>,
    tick: &Bound<'py, PyAny>,
) -> PyResult<(Report<'py>, Vec<(String, Report<'py>)>)> {
    let studies = Studies::read(&studies).map_err(invalid)?;
    let pool = pool(threads)?;
    let ((numbers, text, files), reports) = wait(py, tick, move |progress| {
        // Objects have totals of their own: the bar counts objects in thousandths.
        const OBJECT: u64 = 1000;
        let (all, done) = (studies.valid.len() as u64, AtomicU64::new(0));
        let show = |_: &str, runs: u64, total: u64| {
            let of_object = OBJECT * runs / total.max(1);
            progress.advance(OBJECT * done.load(Ordering::Relaxed) + of_object, OBJECT * all);
        };
        let keep = keep.as_ref().map(|(folder, program)| Kept { folder, program });
        let mut reports: Vec<(String, Written)> = Vec::new();
        let each = |study: &ObjectStudy, results: &Results| {
            reports.push((study.name.clone(), written(&study.plan, results)?));
            done.fetch_add(1, Ordering::Relaxed);
            Ok::<(), String>(())
        };
        let found = assess_all(&studies, &pool, VectorWidth::widest(), keep, &show, each)?;
        let files = rocking_report::portfolio_files(&found).map_err(|error| error.to_string())?;
        let numbers = serde_json::to_string(&found).map_err(|error| error.to_string())?;
        Ok::<_, String>(((numbers, rocking_report::portfolio_text(&found), files), reports))
    })?
    .map_err(invalid)?;
    let reports = reports.into_iter().map(|(name, (numbers, text, files))| (name, (numbers, text, bytes(py, files))));
    Ok(((numbers, text, bytes(py, files)), reports.collect()))
}
