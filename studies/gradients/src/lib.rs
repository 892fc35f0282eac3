//! Exact derivatives of a run with respect to parameters, the scale of the ground motion and initial values, through all events.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`varied`] | parameters and their directions → block, initial values and excitation with their derivatives |
//! | [`follower`] | a run, step by step → the derivatives of its state, of its outputs and of the times of its events |
//! | [`mod@advance`] | a run and its followers → both at a later time, and samples on the way |
//! | [`peaks`] | the steps in which peaks rise → the derivatives of the peaks |
//!
//! The tangent equations are the equations of motion in numbers with derivatives, integrated over the steps of the run by the same
//! formulas. At an event the derivative of its time follows from the event function, and the transition is applied at that moving time
//! (the saltation matrix of hybrid systems). docs/studies/gradients.md has the method and its limits.

pub mod advance;
pub mod follower;
pub mod peaks;
pub mod varied;

pub use rocking_block::numerics::wide::{DIRECTIONS as BATCH, Number};

pub use advance::{advance, advance_with_samples};
pub use follower::{EventGradient, Follower, Grazing, Sample};
pub use varied::{Parameters, Varied, unit};
