//! An elastic building → its modes and the motions of its floors under a record.
//!
//! | module | in → out |
//! | --- | --- |
//! | `modes` | floor masses and storey stiffnesses, or given modes → modes with damping |
//! | `floors` | a record, a building → the absolute accelerations of its floors |
//! | [`mod@file`] | `[building]` of a study file → a building |

pub mod file;
mod floors;
mod modes;

pub use floors::FloorMotion;
pub use modes::{Building, BuildingError, Damping, Mode};
