//! Names and units of measures, as Python hands them over → the engine's measures.

use pyo3::prelude::*;
use rocking_studies::intensity::{self, BlockScales, Measure, MeasureColumn};

use crate::options::{finite, invalid};

/// Returns the name of a measure in the columns of tables, as `Sa(0.5 s)` for `sa(0.5)`. Other names stay.
#[pyfunction]
pub fn measure_name(im: &str) -> String {
    intensity::canonical(im)
}

/// Returns the measure in SI units behind the numbers of a column, that of records if it is relative to a block, and their factor on it.
pub fn behind(column: &MeasureColumn, alpha: Option<f64>, p: Option<f64>, g: f64) -> PyResult<(MeasureColumn, f64)> {
    finite("g", g, |x| x > 0.0, "an acceleration above 0")?;
    let relative = column.measure.filter(|measure| measure.relative_to() != [false; 2]);
    let [with_alpha, with_p] = relative.map_or([false; 2], Measure::relative_to);
    let of_block = |name: &str, value: Option<f64>, is_needed: bool| match (value, is_needed) {
        (Some(value), true) => finite(name, value, |x| x > 0.0, "a number above 0").map(|()| value),
        (None, false) => Ok(1.0),
        (None, true) => Err(invalid(format!("{name} is missing; expected that of the block, for {}", column.name))),
        (Some(_), false) => Err(invalid(format!("{name} has no effect on {}", column.name))),
    };
    let (alpha, p) = (of_block("alpha", alpha, with_alpha)?, of_block("p", p, with_p)?);
    column
        .behind(relative.map(|measure| measure.record_measure(BlockScales { alpha, p, gravity: g })), g)
        .map_err(invalid)
}

/// The measure of a name and a unit, empty if nothing names it.
pub fn column((name, unit): &(String, String)) -> MeasureColumn {
    MeasureColumn::new(name, Some(unit.as_str()).filter(|unit| !unit.is_empty()))
}
