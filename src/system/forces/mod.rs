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
//! Weight, supports, friction and the excitation stand in the equations themselves ([`super::dynamics`]). Any force between block
//! and ground is one more line of the functions here: the equations, the energies, the step sizes and the beginning know no
//! single force.

pub mod friction;
pub mod load;
pub mod support;
pub mod tie;
pub mod weight;

use crate::block::{Block, Regime};
use crate::excitation::Forcing;
use crate::numerics::scalar::{CombinesWith, Elementary, Scalar};
use crate::system::instant::{Instant, Place};

impl<T: Scalar> Instant<T> {
    /// Powers of the excitation and of the dashpots (m²/s³); the second is positive when they take energy.
    #[inline(always)]
    pub fn powers<P: Scalar>(&self, block: &Block<P>, regime: Regime, forcing: Forcing<T>) -> [T; 2]
    where
        T: CombinesWith<P>,
    {
        [load::power(self, forcing), support::power(block, regime, self.corner_dot)]
    }
}

/// Whether a force between block and ground acts.
#[inline(always)]
pub fn act<T>(forcing: &Forcing<T>) -> bool {
    tie::pulls(&forcing.ties)
}

/// The forcing with the forces between block and ground.
pub fn added_to<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, forcing: Forcing<T>, place: &Place<T>) -> Forcing<T> {
    tie::added_to(block, forcing, place)
}

/// The number of dissipative forces besides the dashpots of the supports.
pub const DISSIPATIVE: usize = 2;

/// Powers per mass (m²/s³) taken by friction and by the dashpots of the ties.
#[inline(always)]
pub fn dissipated<P: Scalar, T: CombinesWith<P>>(
    block: &Block<P>,
    forcing: &Forcing<T>,
    x: &Instant<T>,
) -> [T; DISSIPATIVE] {
    [friction::power(x.horizontal, x.slip_rate), tie::power(block, &forcing.ties, x)]
}

/// A bound on the circular frequencies and rates of decay that the forces between block and ground give (rad/s).
pub fn fastest(block: &Block) -> f64 {
    tie::fastest(block)
}

/// Whether a force between block and ground acts on a block at rest.
pub fn act_at_rest<T>(block: &Block<T>) -> bool {
    !block.ties.is_empty()
}

/// Returns a vertical force on the block at rest (N, positive up) less the pull of the forces between block and ground.
pub fn less_static_pull<T: Elementary>(block: &Block<T>, place: &Place<T>, force: T) -> T {
    tie::less_static_pull(block, place, force)
}

/// Vertical stiffness (N/m) of the forces between block and ground at rest.
pub fn static_stiffness<T: Elementary>(block: &Block<T>, place: &Place<T>) -> f64 {
    tie::static_stiffness(block, place)
}

/// Kinetic energy, and potential energy of weight, supports and ties, per unit mass (m²/s²); their sum is zero at rest without ties.
pub fn energy<P: Elementary, T: CombinesWith<P>, F>(
    block: &Block<P>,
    regime: Regime,
    forcing: &Forcing<F>,
    x: &Instant<T>,
) -> (T, T) {
    let kinetic = (x.theta_dot * x.theta_dot * block.i0 + x.u_dot * x.u_dot + x.v_dot * x.v_dot) * 0.5;
    let untied = weight::energy(block, x.v) + support::energy(block, regime, x.corner);
    let potential = if block.ties.is_empty() { untied } else { untied + tie::energy(block, &forcing.ties, x) };
    (kinetic, potential)
}

/// Whether forces of the block switch on and off: friction, and the forces between block and ground.
pub fn switch(block: &Block) -> bool {
    block.friction > 0.0 || act_at_rest(block)
}
