//! Materials and sizes → friction, restitution, stiffness and damping, each with its source.
//!
//! | module | in → out |
//! | --- | --- |
//! | `pairs` | the file of pairs of surfaces → friction and restitution with their sources |
//! | `supports` | rubber pad, or footing and soil → stiffness and damping of a support |

mod pairs;
mod supports;

pub use pairs::{Pair, Quantity, Source, ValueMeaning, pairs};
pub use supports::{Pad, Soil, Support, SupportError};
