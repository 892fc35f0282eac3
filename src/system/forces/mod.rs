//! The forces on the block, a file each: value, rate, energy, power. Everything is per unit of the block's mass.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`support`] | height and rate of a corner → its vertical reaction; spring energy, dashpot power |
//! | [`load`] | excitation → its power on the moving block |
//! | [`weight`] | height of the centre of mass → potential energy |
//! | [`friction`] | vertical reaction under a foot that slides → its horizontal reaction, its power |
//! | [`tie`] | place of the block → tension; its energy, its power |
//!
//! A force that follows from the excitation alone, or from the state, adds to the [`Forcing`] of an instant or stands beside
//! the supports in [`super::dynamics`]; its energy and its power are added here.

pub mod friction;
pub mod load;
pub mod support;
pub mod tie;
pub mod weight;

use crate::block::{Block, Regime, TieStates};
use crate::excitation::Forcing;
use crate::numerics::scalar::{Beside, Elementary, Scalar};
use crate::system::instant::Instant;

impl<T: Scalar> Instant<T> {
    /// Powers of the excitation and of the dashpots (m²/s³); the second is positive when they take energy.
    #[inline(always)]
    pub fn powers<P: Scalar>(&self, block: &Block<P>, regime: Regime, forcing: Forcing<T>) -> [T; 2]
    where
        T: Beside<P>,
    {
        [load::power(self, forcing), support::power(block, regime, self.corner_dot)]
    }
}

/// Potential energy of weight, supports and ties in these states (m²/s²), zero at rest without ties.
fn potential<P: Elementary, T: Beside<P>>(block: &Block<P>, regime: Regime, ties: &TieStates, x: &Instant<T>) -> T {
    let untied = weight::energy(block, x.v) + support::energy(block, regime, x.corner);
    if block.ties.is_empty() { untied } else { untied + tie::energy(block, ties, x) }
}

/// Kinetic and potential energy per unit mass (m²/s²); their sum is zero at rest.
pub fn energy<P: Elementary, T: Beside<P>>(
    block: &Block<P>,
    regime: Regime,
    ties: &TieStates,
    x: &Instant<T>,
) -> (T, T) {
    let kinetic = (x.theta_dot * x.theta_dot * block.i0 + x.u_dot * x.u_dot + x.v_dot * x.v_dot) * 0.5;
    (kinetic, potential(block, regime, ties, x))
}
