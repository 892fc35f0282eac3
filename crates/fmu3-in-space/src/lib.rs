//! The functions of FMI 3.0 as a shared library exports them, over the solver of the block in space.

use rocking_block::unit::in_space::SpaceUnit as Unit;
use rocking_block::{fmi, unit};

#[path = "../../../src/fmi/fmi3/exports.rs"]
pub mod exports;
