//! Friction, restitution and supports with their sources → JSON and numbers.

use pyo3::prelude::*;
use rocking_studies::foundations::{Pad, Soil, Support, pairs};

use crate::options::invalid;

/// K, C and the stiffness for rocking of a support; nan where the source has none.
type Values = (f64, f64, f64);

fn values(support: Support) -> Values {
    let Support { stiffness, damping, rocking_stiffness } = support;
    (stiffness, damping.unwrap_or(f64::NAN), rocking_stiffness.unwrap_or(f64::NAN))
}

/// Returns the pairs of surfaces as JSON.
#[pyfunction]
pub fn foundation_pairs() -> PyResult<String> {
    serde_json::to_string(pairs()).map_err(invalid)
}

/// Returns the support of a rubber pad.
#[pyfunction]
pub fn pad_support(
    diameter: f64,
    shape_factor: f64,
    shear_modulus: f64,
    bulk_modulus: Option<f64>,
) -> PyResult<Values> {
    Pad { diameter, shape_factor, shear_modulus, bulk_modulus }.support().map(values).map_err(invalid)
}

/// Returns the support of a footing on soil.
#[pyfunction]
pub fn soil_support(width: f64, length: f64, shear_wave_velocity: f64, density: f64, poisson: f64) -> PyResult<Values> {
    Soil { width, length, density, shear_wave_velocity, poisson }.support().map(values).map_err(invalid)
}
