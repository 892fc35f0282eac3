//! A tie of Python ↔ one of the engine.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rocking_block::block::restraints::Tie;
use rocking_block::block::restraints::tie::NUMBERS;

/// Returns the ties of an argument.
pub fn one_or_several(ties: &Bound<PyAny>) -> PyResult<Vec<Tie>> {
    let wrong = |found: &Bound<PyAny>| -> PyErr {
        let found = found.repr().map_or_else(|_| "an object".into(), |found| found.to_string());
        PyTypeError::new_err(format!("ties has {found}; expected Ties"))
    };
    if let Ok(tie) = of_python(ties) {
        return Ok(vec![tie]);
    }
    let several = ties.try_iter().map_err(|_| wrong(ties))?;
    several.map(|tie| tie.and_then(|tie| of_python(&tie).map_err(|_| wrong(&tie)))).collect()
}

/// Returns the engine's tie of a `rocking_block.Tie`.
fn of_python(tie: &Bound<PyAny>) -> PyResult<Tie> {
    let mut found = Tie::default();
    for ((name, _), number) in NUMBERS.into_iter().zip(found.numbers()) {
        *number = tie.getattr(name)?.extract()?;
    }
    Ok(found)
}

/// Returns the arguments of the Python class.
pub fn named<'py>(tie: &Tie, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
    let named = PyDict::new(py);
    for (name, value) in tie.named() {
        named.set_item(name, value)?;
    }
    Ok(named)
}
