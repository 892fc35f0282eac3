//! What the block is: a hybrid system, without a clock, counters or settings of an integrator.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`dynamics`] | state, regime, forcing → accelerations, reactions, energy |
//! | `rigid_base` | the same on the rigid base |
//! | [`held`] | the same where a corner bears nothing and is held on its support |
//! | [`law`] | a pose → which of these equations hold, and which surfaces end them |
//! | [`now`] | a pose and an excitation → the block at any instant while the pose's contacts last |
//! | [`surfaces`] | an instant → the functions whose fall through zero is an event |
//! | [`impact`] | velocities before a landing → velocities after |
//! | `wide` | the numbers of several blocks side by side → the same bits as those of each alone |
//! | [`transitions`] | initial values → the pose at the beginning; a pose and an event → the pose right after, and what happened |

pub mod dynamics;
pub mod held;
pub mod impact;
pub mod law;
pub mod now;
mod rigid_base;
pub mod surfaces;
pub mod transitions;
#[cfg(feature = "studies")]
mod wide;

use serde::{Deserialize, Serialize};

use crate::block::Block;

/// A block and the rules by which it moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct System {
    /// The block on its foundation.
    pub block: Block,
    /// Whether the block flies when no corner touches any more. In the paper's analysis it does not: the run ends, as soon as
    /// the last corner bears nothing.
    pub flies: bool,
    /// Slowest rocking on the rigid base that goes on after an impact, as a part of p: it comes to rest after infinitely many
    /// impacts in finite time, which are not told apart any more below this.
    pub slowest: f64,
}

impl System {
    /// What a solver that locates events to rounding tells apart.
    pub const SLOWEST: f64 = 1e-9;
}
