//! The functions of FMI 2.0 as a shared library exports them, over the solver of the block in space.

use rocking_block::unit::in_space::SpaceUnit as Unit;
use rocking_block::{fmi, unit};

#[path = "../../../src/fmi/fmi2/exports.rs"]
pub mod exports;
