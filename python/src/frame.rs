//! Columns under a beam → the parameters of the equivalent block, and the motion of the beam with the forces of the columns.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rocking_studies::frame::{self, BlockMotion, FrameResponse};

use crate::block::Block;
use crate::options::{invalid, whole};

fn of_engine(columns: i64, column: &Bound<Block>, beam_mass: f64) -> PyResult<frame::Frame> {
    let columns = whole("columns", columns, 0..=i64::from(u32::MAX))? as u32;
    frame::Frame::new(columns, column.get().block, beam_mass).map_err(invalid)
}

/// Returns α, p, γ, mass, factor on the restitution, and gravity of the block that rocks like the frame.
#[pyfunction]
pub fn frame_block(columns: i64, column: &Bound<Block>, beam_mass: f64) -> PyResult<(f64, f64, f64, f64, f64, f64)> {
    let block = of_engine(columns, column, beam_mass)?.block;
    Ok((block.alpha, block.p, block.gamma, block.mass, block.restitution_factor, block.gravity))
}

/// Returns the columns of a frame's response from those of its block: `u`, `v`, `u_ddot`, `v_ddot`, `H`, `N`, `a_gx`, `a_gz`.
#[pyfunction]
pub fn frame_response<'py>(
    py: Python<'py>,
    columns: i64,
    column: &Bound<'py, Block>,
    beam_mass: f64,
    motion: [PyReadonlyArray1<f64>; 8],
) -> PyResult<Bound<'py, PyDict>> {
    let frame = of_engine(columns, column, beam_mass)?;
    let [u, v, u_ddot, v_ddot, horizontal, vertical, along, up] = motion.each_ref().map(|array| array.as_array());
    let response = |i: usize| {
        frame.response(&BlockMotion {
            displacement: [u[i], v[i]],
            acceleration: [u_ddot[i], v_ddot[i]],
            reaction: [horizontal[i], vertical[i]],
            ground: [along[i], up[i]],
        })
    };
    let rows: Vec<FrameResponse> = (0..u.len()).map(response).collect();
    let shown = PyDict::new(py);
    type Pair = fn(&FrameResponse) -> [f64; 2];
    let pairs: [([&str; 2], Pair); 3] = [
        (["beam_u", "beam_v"], |row| row.beam),
        (["base_H", "base_N"], |row| row.base),
        (["top_H", "top_N"], |row| row.top),
    ];
    for (names, of) in pairs {
        for (i, name) in names.into_iter().enumerate() {
            shown.set_item(name, PyArray1::from_iter(py, rows.iter().map(|row| of(row)[i])))?;
        }
    }
    Ok(shown)
}
