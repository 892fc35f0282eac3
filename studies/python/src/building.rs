//! Floor masses and storey stiffnesses, or modes → a building, and a record → the motions of its floors.

use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rocking_studies::building::{self as engine, Damping, FloorMotion, Mode};

use crate::options::{invalid, warn};
use crate::record::Record;

/// A ratio for all modes, or one for each.
#[derive(FromPyObject)]
pub enum DampingOption {
    All(f64),
    Each(Vec<f64>),
}

/// A floor, its samples (m/s²), PFA (m/s²) and PFV (m/s).
type Floor<'py> = (usize, Bound<'py, PyArray1<f64>>, f64, f64);

/// A building; the Python class of the same name adds the documentation.
#[pyclass(frozen, subclass, module = "rocking_block._engine")]
pub struct Building {
    building: engine::Building,
}

#[pymethods]
impl Building {
    #[new]
    #[pyo3(signature = (
        *, floor_masses=None, storey_stiffnesses=None, frequencies=None, participation=None, shapes=None, damping=None, rayleigh=None,
    ))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python,
        floor_masses: Option<Vec<f64>>,
        storey_stiffnesses: Option<Vec<f64>>,
        frequencies: Option<Vec<f64>>,
        participation: Option<Vec<f64>>,
        shapes: Option<Vec<Vec<f64>>>,
        damping: Option<DampingOption>,
        rayleigh: Option<(f64, [usize; 2])>,
    ) -> PyResult<Building> {
        let damping = match (damping, rayleigh) {
            (Some(DampingOption::All(ratio)), None) => Damping::All(ratio),
            (Some(DampingOption::Each(ratios)), None) => Damping::Each(ratios),
            (None, Some((ratio, modes))) => Damping::Rayleigh(ratio, modes),
            _ => return Err(PyValueError::new_err("expected damping or rayleigh, and not both")),
        };
        let building = match (floor_masses, storey_stiffnesses, frequencies, participation, shapes) {
            (Some(masses), Some(stiffnesses), None, None, None) => {
                engine::Building::shear(&masses, &stiffnesses, &damping)
            }
            (None, None, Some(frequencies), Some(participation), Some(shapes)) => {
                engine::Building::of_modes(&frequencies, &participation, &shapes, &damping)
            }
            _ => {
                let message = "expected floor_masses and storey_stiffnesses, or frequencies, participation and shapes";
                return Err(PyValueError::new_err(message));
            }
        };
        let building = building.map_err(invalid)?;
        warn(py, building.doubt(), 1)?;
        Ok(Building { building })
    }

    /// Returns the arguments of the same building from its modes.
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((), Bound<'py, PyDict>)> {
        let arguments = PyDict::new(py);
        for (name, values) in [
            ("frequencies", self.frequencies(py)),
            ("participation", self.participation(py)),
            ("damping", self.damping(py)),
        ] {
            arguments.set_item(name, values.call_method0("tolist")?)?;
        }
        arguments.set_item("shapes", self.shapes())?;
        Ok(((), arguments))
    }

    #[getter]
    fn floors(&self) -> usize {
        self.building.floors()
    }

    #[getter]
    fn frequencies<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.of_modes(py, |mode| mode.frequency)
    }

    #[getter]
    fn damping<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.of_modes(py, |mode| mode.damping)
    }

    #[getter]
    fn participation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.of_modes(py, |mode| mode.participation)
    }

    #[getter]
    fn shapes(&self) -> Vec<Vec<f64>> {
        self.building.modes().iter().map(|mode| mode.shape.clone()).collect()
    }

    /// Returns the motions of the ground and of all floors.
    fn motions<'py>(&self, py: Python<'py>, record: &Bound<'py, Record>) -> Vec<Floor<'py>> {
        let record = &record.get().record;
        let found = py.detach(|| self.building.floor_motions(record));
        let shown = |motion: FloorMotion| {
            let FloorMotion { floor, record, pfa, pfv } = motion;
            (floor, PyArray1::from_slice(py, &record.acceleration), pfa, pfv)
        };
        found.into_iter().map(shown).collect()
    }
}

impl Building {
    fn of_modes<'py>(&self, py: Python<'py>, value: impl Fn(&Mode) -> f64) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.building.modes().iter().map(value))
    }
}
