//! The functions of FMI 3.0 as a shared library exports them, over the solver.

use rocking_block::unit::instance::Unit;
use rocking_block::{fmi, unit};

#[path = "../../../src/fmi/fmi3/exports.rs"]
pub mod exports;
