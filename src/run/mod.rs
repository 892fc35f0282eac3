//! What runs of every body share: their choices, the ways in which they end, and the steps that a call may take.

mod budget;
mod ending;
mod settings;

pub(crate) use budget::{MAX_STEPS, spend_step};
pub use ending::{Ending, Progress, SimulationError};
pub use settings::{OnOverturning, OnSeparation, Settings};
