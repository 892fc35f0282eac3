//! A tie of Python ↔ one of the engine.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rocking_block::block::restraints as engine;

/// The attributes of a `rocking_block.Tie`.
#[derive(FromPyObject)]
pub struct Tie {
    block_x: f64,
    block_z: f64,
    ground_x: f64,
    ground_z: f64,
    stiffness: f64,
    pretension: f64,
    slack: f64,
    damping: f64,
    strength: f64,
}

impl Tie {
    /// Returns the ties of an argument.
    pub fn one_or_several(ties: &Bound<PyAny>) -> PyResult<Vec<Tie>> {
        let wrong = |found: &Bound<PyAny>| -> PyErr {
            let found = found.repr().map_or_else(|_| "an object".into(), |found| found.to_string());
            PyTypeError::new_err(format!("ties has {found}; expected Ties"))
        };
        if let Ok(tie) = ties.extract() {
            return Ok(vec![tie]);
        }
        let several = ties.try_iter().map_err(|_| wrong(ties))?;
        several.map(|tie| tie.and_then(|tie| tie.extract().map_err(|_| wrong(&tie)))).collect()
    }

    /// Returns it for the engine.
    pub fn of_engine(&self) -> engine::Tie {
        let Tie { block_x, block_z, ground_x, ground_z, stiffness, pretension, slack, damping, strength } = *self;
        let (block, ground) = ([block_x, block_z], [ground_x, ground_z]);
        engine::Tie { block, ground, stiffness, pretension, slack, damping, strength }
    }

    /// Returns the attributes of one of the engine.
    pub fn of_python(tie: &engine::Tie) -> Tie {
        let engine::Tie { block, ground, stiffness, pretension, slack, damping, strength } = *tie;
        let ([block_x, block_z], [ground_x, ground_z]) = (block, ground);
        Tie { block_x, block_z, ground_x, ground_z, stiffness, pretension, slack, damping, strength }
    }

    /// Returns the arguments of the Python class.
    pub fn named<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let named = PyDict::new(py);
        for (name, value) in [
            ("block_x", self.block_x),
            ("block_z", self.block_z),
            ("ground_x", self.ground_x),
            ("ground_z", self.ground_z),
            ("stiffness", self.stiffness),
            ("pretension", self.pretension),
            ("slack", self.slack),
            ("damping", self.damping),
            ("strength", self.strength),
        ] {
            named.set_item(name, value)?;
        }
        Ok(named)
    }
}
