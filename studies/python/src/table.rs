//! A table → its columns as arrays of NumPy.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyModule;
use rocking_studies::fragility;
use rocking_studies::output::parts::PartsError;
use rocking_studies::output::table::{Kind, Series, Table, Values};
use rocking_studies::output::table_files::{TableFile, TableFiles};

use crate::options::invalid;

/// The name, the unit and the values of a column.
pub type Column<'py> = (String, Option<String>, Bound<'py, PyAny>);

/// Returns the columns of a table, numbers without copying them.
pub fn columns<'py>(py: Python<'py>, table: Table) -> PyResult<Vec<Column<'py>>> {
    let rows = table.rows();
    table.into_columns().into_iter().map(|column| shown(py, column, rows)).collect()
}

/// A file of a table. It has the path, the keys in the names of its folders with their values, and the part, such as "3 of 10".
type FileOfTable = (OsString, Vec<(String, String)>, Option<String>);

/// Returns the files of a folder or of a pattern. The second value says whether they are the parts of one study.
#[pyfunction]
pub fn table_files(path: PathBuf, partial: bool) -> PyResult<(Vec<FileOfTable>, bool)> {
    let files = files(&path, partial).map_err(invalid)?;
    let part = |file: &TableFile| file.part.map(|part| part.to_string());
    let file = |file: &TableFile| (file.path.as_os_str().to_owned(), file.keys.clone(), part(file));
    Ok((files.files().iter().map(file).collect(), files.are_numbered()))
}

fn files(path: &Path, partial: bool) -> Result<TableFiles, PartsError> {
    let files = TableFiles::of(path)?;
    if !partial {
        files.check_complete(Some("partial=True"))?;
    }
    Ok(files)
}

/// Reads a table in CSV, or a folder or a pattern of such files.
#[pyfunction]
pub fn read_table<'py>(py: Python<'py>, path: PathBuf, partial: bool) -> PyResult<Vec<Column<'py>>> {
    let read = py.detach(|| files(&path, partial)?.read(&|_| true));
    let (table, _) = read.map_err(invalid)?;
    columns(py, table)
}

/// Whether a fit over the named columns needs a column.
#[pyfunction]
pub fn is_needed(column: &str, named: Vec<String>) -> bool {
    fragility::is_needed(column, &named.iter().map(String::as_str).collect::<Vec<_>>())
}

/// Passes the columns that a fit needs to a function, in batches of rows.
#[pyfunction]
pub fn read_batches(py: Python, path: PathBuf, partial: bool, named: Vec<String>, each: &Bound<PyAny>) -> PyResult<()> {
    let is_wanted = |column: &str| is_needed(column, named.clone());
    let mut pass = |table: Table, _: &[String]| -> Result<(), Ended> {
        py.check_signals()?;
        each.call1((columns(py, table)?,))?;
        Ok(())
    };
    let files = files(&path, partial).map_err(invalid)?;
    files.read_batches(&is_wanted, &mut pass).map_err(|Ended(error)| error)
}

/// The exception that ends the reading of a table.
struct Ended(PyErr);

impl From<PyErr> for Ended {
    fn from(error: PyErr) -> Ended {
        Ended(error)
    }
}

impl From<PartsError> for Ended {
    fn from(error: PartsError) -> Ended {
        Ended(invalid(error))
    }
}

fn shown<'py>(py: Python<'py>, Series { heading, mut values }: Series, rows: usize) -> PyResult<Column<'py>> {
    let numpy = PyModule::import(py, "numpy")?;
    let array = |list: Bound<'py, PyAny>| numpy.call_method1("asarray", (list,));
    // NumPy repeats a single value without memory.
    let is_repeated = match &mut values {
        Values::Real(values) => keep_first(values, |one, other| one.to_bits() == other.to_bits()),
        Values::Integer(values) => keep_first(values, PartialEq::eq),
        Values::Boolean(values) => keep_first(values, PartialEq::eq),
        Values::Choice(positions) => keep_first(positions, PartialEq::eq),
        Values::Text(_) => false,
    };
    let values = match (values, &heading.kind) {
        (Values::Real(values), _) => PyArray1::from_vec(py, values).into_any(),
        (Values::Integer(values), _) => PyArray1::from_vec(py, values).into_any(),
        (Values::Boolean(values), _) => PyArray1::from_vec(py, values).into_any(),
        (Values::Choice(positions), Kind::Choice(words)) => array(words.to_vec().into_pyobject(py)?.into_any())?
            .call_method1("take", (PyArray1::from_vec(py, positions),))?,
        (Values::Choice(_), _) => unreachable!("positions without words"),
        (Values::Text(texts), _) => array(texts.into_pyobject(py)?.into_any())?,
    };
    let values = if is_repeated { numpy.call_method1("broadcast_to", (values, rows))? } else { values };
    Ok((heading.name, heading.unit, values))
}

/// Keeps only the first of several values if all are the same; returns whether they are.
fn keep_first<T>(values: &mut Vec<T>, same: fn(&T, &T) -> bool) -> bool {
    let are_same = values.len() > 1 && values.iter().all(|value| same(value, &values[0]));
    if are_same {
        values.truncate(1);
        values.shrink_to_fit();
    }
    are_same
}
