//! Columns under a beam → the parameters of the equivalent block, and the motion of the beam with the forces of the columns.

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use rocking_studies::frame::{self, BlockMotion, FrameResponse};
use rocking_studies::output::table::Table;
use rocking_studies::spec::BlockSpec;

use crate::block::Block;
use crate::options::{invalid, whole};
use crate::table::{Column, columns as columns_of};

fn of_engine(columns: i64, column: &Bound<Block>, beam_mass: f64) -> PyResult<frame::Frame> {
    let columns = whole("columns", columns, 0..=i64::from(u32::MAX))? as u32;
    frame::Frame::new(columns, column.get().block, beam_mass).map_err(invalid)
}

/// Returns the block that rocks like the frame.
#[pyfunction]
pub fn frame_block(py: Python, columns: i64, column: &Bound<Block>, beam_mass: f64) -> PyResult<Py<Block>> {
    let block = Block::of(BlockSpec::of(&of_engine(columns, column, beam_mass)?.block))?;
    Py::new(py, block.with_numbers())
}

/// Returns the columns of a frame's response from those of its block: `u`, `v`, `u_ddot`, `v_ddot`, `H`, `N`, `a_gx`, `a_gz`.
#[pyfunction]
pub fn frame_response<'py>(
    py: Python<'py>,
    columns: i64,
    column: &Bound<'py, Block>,
    beam_mass: f64,
    motion: [PyReadonlyArray1<f64>; 8],
) -> PyResult<Vec<Column<'py>>> {
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
    columns_of(py, Table::of(&FrameResponse::columns(|response: &FrameResponse| response), &rows))
}
