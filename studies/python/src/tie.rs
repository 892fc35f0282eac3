//! A tie or a damper of Python ↔ one of the engine.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use rocking_block::block::restraints::tie::{LinkNumber, NUMBERS};
use rocking_block::block::restraints::{LinkKind, Tie};
use rocking_studies::spec;

/// Returns the names of the numbers of a tie with their units. A damper has some of them.
#[pyfunction]
pub fn link_numbers() -> Vec<(&'static str, &'static str)> {
    NUMBERS.map(|number| (number.name, number.quantity.unit())).into()
}

/// Returns the name of the class of a kind, and of its argument.
fn names(kind: LinkKind) -> [&'static str; 2] {
    match kind {
        LinkKind::Tie => ["Tie", "ties"],
        LinkKind::Damper => ["Damper", "dampers"],
    }
}

/// Returns the ties or the dampers of an argument.
pub fn one_or_several(kind: LinkKind, links: &Bound<PyAny>) -> PyResult<Vec<Tie>> {
    let [class, argument] = names(kind);
    let class = links.py().import("rocking_block._tie")?.getattr(class)?;
    let wrong = |found: &Bound<PyAny>| -> PyErr {
        let found = found.repr().map_or_else(|_| "an object".into(), |found| found.to_string());
        PyTypeError::new_err(format!("{argument} has {found}; expected {}s", names(kind)[0]))
    };
    if links.is_instance(&class)? {
        return Ok(vec![of_python(kind, links)?]);
    }
    let several = links.try_iter().map_err(|_| wrong(links))?;
    several
        .map(|link| {
            link.and_then(|link| match link.is_instance(&class)? {
                true => of_python(kind, &link),
                false => Err(wrong(&link)),
            })
        })
        .collect()
}

/// Returns the engine's tie of a `rocking_block.Tie` or `rocking_block.Damper`.
fn of_python(kind: LinkKind, link: &Bound<PyAny>) -> PyResult<Tie> {
    let mut found = Tie { kind, ..Tie::default() };
    for LinkNumber { name, .. } in kind.numbers() {
        if let Some(number) = found.number(name) {
            *number = link.getattr(name)?.extract()?;
        }
    }
    spec::tie::check(&found).map_err(PyValueError::new_err)?;
    Ok(found)
}

/// Returns the ties or the dampers among these as objects of Python.
pub fn of_kind<'py>(kind: LinkKind, links: &[Tie], py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
    let class = py.import("rocking_block._tie")?.getattr(names(kind)[0])?;
    let found = links.iter().filter(|link| link.kind == kind).map(|link| {
        let named = PyDict::new(py);
        link.named().try_for_each(|(name, value)| named.set_item(name, value))?;
        class.call((), Some(&named))
    });
    PyTuple::new(py, found.collect::<PyResult<Vec<_>>>()?)
}
