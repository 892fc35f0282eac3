//! A table → its columns as arrays of NumPy.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyModule;
use rocking_studies::output::parts::PartsError;
use rocking_studies::output::table::{Heading, Kind, Series, Table, Values};
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

pub fn files(path: &Path, partial: bool) -> Result<TableFiles, PartsError> {
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

/// The name, the unit and the values of a column from Python.
pub type GivenColumn<'py> = (String, Option<String>, GivenValues<'py>);

/// The values of a column from Python.
#[derive(FromPyObject)]
pub enum GivenValues<'py> {
    /// Numbers; nan where a row has none.
    Reals(PyReadonlyArray1<'py, f64>),
    /// Whole numbers.
    Integers(PyReadonlyArray1<'py, i64>),
    /// True or false.
    Booleans(PyReadonlyArray1<'py, bool>),
    /// Words, and for each row the position of its word.
    Words(Vec<String>, PyReadonlyArray1<'py, i64>),
}

/// Returns a table with the columns from Python, which have equal lengths.
pub fn table(columns: Vec<GivenColumn>) -> Table {
    let series = |(name, unit, values): GivenColumn| {
        let (kind, values) = match values {
            GivenValues::Reals(values) => (Kind::Real, Values::Real(values.as_array().to_vec())),
            GivenValues::Integers(values) => (Kind::Integer, Values::Integer(values.as_array().to_vec())),
            GivenValues::Booleans(values) => (Kind::Boolean, Values::Boolean(values.as_array().to_vec())),
            GivenValues::Words(words, positions) => {
                let positions = positions.as_array().iter().map(|position| *position as u32).collect();
                (Kind::Choice(words.into()), Values::Choice(positions))
            }
        };
        Series { heading: Heading { name, unit, kind }, values }
    };
    Table::of_series(columns.into_iter().map(series).collect())
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
