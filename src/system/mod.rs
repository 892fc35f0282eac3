//! The block as a hybrid system, without a clock, counters or settings of an integrator.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`instant`] | state, pose, horizontal hold, accelerations and reactions: shared by forces, equations and events |
//! | [`forces`] | the forces on the block, a file each: value, rate, energy, power |
//! | [`dynamics`] | state, regime, forcing → the sum of forces → accelerations, reactions, energy |
//! | `motion_mode` | a pose → the equations that hold from there on |
//! | [`swing`] | a block on one corner of the rigid base → its motion as a power series |
//! | [`evaluation`] | a pose and an excitation → the block at any instant while the pose's contacts last |
//! | [`events`] | an instant → the watched functions; a pose and an event, a file each → the pose right after |
//! | [`impact`] | velocities before a landing → velocities after |
//! | [`beginning`] | initial values → the pose at the beginning |

pub mod beginning;
pub mod dynamics;
pub mod evaluation;
pub mod events;
pub mod forces;
pub mod impact;
pub mod instant;
pub(crate) mod motion_mode;
pub mod swing;

use serde::{Deserialize, Serialize};

use crate::block::Block;

/// A block and the rules of its motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct System<T = f64> {
    /// The block on its foundation.
    pub block: Block<T>,
    /// Whether the block flies once no corner touches. In the paper's analysis the run ends as soon as the last corner bears nothing.
    pub flies: bool,
}
