//! The functions of FMI 3.0 as a shared library exports them, over the solver.

use rocking_block::{fmi, fmi3, model, simulation};

#[path = "../../src/fmi3/exports.rs"]
pub mod exports;
