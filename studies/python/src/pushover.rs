//! A block → its lateral force over a slow rotation, with its landmarks, and the loop of a cycle.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rocking_block::block::Corner;
use rocking_block::block::restraints::tie;
use rocking_studies::pushover::table::table;
use rocking_studies::pushover::{Landmark, MAX_POINTS, Push, Pushover};

use crate::block::Block;
use crate::options::{invalid, whole};
use crate::table::{Column, columns};

/// The name, θ, u, lateral force and moment of a landmark.
type Named = (String, f64, f64, f64, f64);

/// A pushover for Python. It has the columns, energies by the names of restraints in the closed cycle and before it, equivalent damping,
/// recentring ratio and residual rotation.
type CycleResults<'py> = (Vec<Column<'py>>, Vec<(String, f64, f64)>, f64, f64, f64);

/// Turns a block slowly over a corner, then in cycles if there is an amplitude.
#[pyfunction]
pub fn pushover<'py>(
    py: Python<'py>,
    block: &Bound<'py, Block>,
    side: &str,
    to: Option<f64>,
    amplitude: Option<f64>,
    points: i64,
) -> PyResult<(Vec<Column<'py>>, Vec<Named>, Option<CycleResults<'py>>)> {
    let over = match side.to_lowercase().as_str() {
        "left" => Corner::Left,
        "right" => Corner::Right,
        _ => return Err(PyValueError::new_err(format!("side = '{side}'; expected 'left' or 'right'"))),
    };
    let points = whole("points", points, 1..=i64::from(MAX_POINTS))? as u32;
    let block = block.get().block;
    let found = py.detach(|| Pushover::of(&block, &Push { over, to, amplitude, points })).map_err(invalid)?;
    let named = |Landmark { kind, at }: &Landmark| (kind.to_string(), at.theta, at.u, at.force, at.moment);
    let landmarks = found.landmarks.iter().map(named).collect();
    let rows = columns(py, table(&block, &found.rows))?;
    let Some(cycle) = found.cycle else { return Ok((rows, landmarks, None)) };
    let energies = cycle.lost.into_iter().zip(cycle.lost_before);
    let energy = tie::names(block.ties()).into_iter().zip(energies).map(|(name, (lost, before))| (name, lost, before));
    let energy = energy.collect();
    let of_cycle = columns(py, table(&block, &cycle.rows))?;
    Ok((rows, landmarks, Some((of_cycle, energy, cycle.equivalent_damping, cycle.recentring, cycle.residual))))
}
