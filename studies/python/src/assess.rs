//! A study file with an object → the numbers and the files of a report.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rocking_block::numerics::wide::VectorWidth;
use rocking_studies::assess::{Cache, Plan, assess as assessed};

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
        let files = rocking_report::files(&plan, &found).map_err(|error| error.to_string())?;
        let text = rocking_report::text(&found);
        let numbers = serde_json::to_string(&found.report).map_err(|error| error.to_string())?;
        Ok::<_, String>((numbers, text, files))
    })?
    .map_err(invalid)?;
    let files = files.into_iter().map(|(name, content)| (name, PyBytes::new(py, &content)));
    Ok((numbers, text, files.collect()))
}
