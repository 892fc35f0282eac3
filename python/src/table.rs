//! A table → its columns as arrays of NumPy.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyModule;
use rocking_studies::output::parts::{Parts, PartsError};
use rocking_studies::output::reading::TableReader;
use rocking_studies::output::table::{Kind, Series, Table, Values};

use crate::options::invalid;

/// The name, the unit and the values of a column.
pub type Column<'py> = (String, Option<String>, Bound<'py, PyAny>);

/// Returns the columns of a table, numbers without copying them.
pub fn columns<'py>(py: Python<'py>, table: Table) -> PyResult<Vec<Column<'py>>> {
    table.into_columns().into_iter().map(|column| shown(py, column)).collect()
}

/// Returns the files of the parts in a folder.
#[pyfunction]
pub fn part_files(path: PathBuf, partial: bool) -> PyResult<Vec<OsString>> {
    Ok(parts(&path, partial).map_err(invalid)?.files().map(|file| file.as_os_str().to_owned()).collect())
}

fn parts(path: &Path, partial: bool) -> Result<Parts, PartsError> {
    let parts = Parts::of(path)?;
    if !partial {
        parts.check_complete("partial=True")?;
    }
    Ok(parts)
}

/// Reads a table in CSV, or a folder of parts.
#[pyfunction]
pub fn read_table<'py>(py: Python<'py>, path: PathBuf, partial: bool) -> PyResult<Vec<Column<'py>>> {
    let table = py.detach(|| {
        if path.is_dir() {
            return Ok(parts(&path, partial)?.read(&|_| true)?.0);
        }
        let mut reader = TableReader::new(&|_| true);
        reader.read_file(&path)?;
        Ok::<Table, PartsError>(reader.table())
    });
    columns(py, table.map_err(invalid)?)
}

fn shown<'py>(py: Python<'py>, Series { heading, values }: Series) -> PyResult<Column<'py>> {
    let array = |list: Bound<'py, PyAny>| PyModule::import(py, "numpy")?.call_method1("asarray", (list,));
    let values = match (values, &heading.kind) {
        (Values::Real(values), _) => PyArray1::from_vec(py, values).into_any(),
        (Values::Integer(values), _) => PyArray1::from_vec(py, values).into_any(),
        (Values::Boolean(values), _) => PyArray1::from_vec(py, values).into_any(),
        (Values::Choice(positions), Kind::Choice(words)) => array(words.to_vec().into_pyobject(py)?.into_any())?
            .call_method1("take", (PyArray1::from_vec(py, positions),))?,
        (Values::Choice(_), _) => unreachable!("positions without words"),
        (Values::Text(texts), _) => array(texts.into_pyobject(py)?.into_any())?,
    };
    Ok((heading.name, heading.unit, values))
}
