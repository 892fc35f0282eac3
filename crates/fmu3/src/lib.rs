//! The functions of FMI 3.0 as a shared library exports them, over the solver.

use rocking_block::{fmi, simulation, unit};

#[path = "../../../src/fmi/fmi3/exports.rs"]
pub mod exports;
