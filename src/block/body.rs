//! The part of a block that its motion between impacts depends on.

use serde::{Deserialize, Serialize};

use crate::block::{Block, Corner, Foundation, Restraints};
use crate::numerics::scalar::{Elementary, Scalar};

/// The numbers that equations of motion, event functions and steps read.
///
/// Lanes hold several blocks on foundations of the same kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Body<T = f64> {
    /// Mass M (kg).
    pub mass: T,
    /// I0/M (m²).
    pub i0: T,
    /// Gravity g (m/s²).
    pub gravity: T,
    /// Distance R0 from the centre of mass to each corner (m).
    pub r0: T,
    /// Half width b = R0 sin α (m).
    pub b: T,
    /// Height of the centre of mass h = R0 cos α (m).
    pub h: T,
    /// Distance e_x of the centre of mass from the middle (m), positive to the right.
    pub eccentricity: T,
    /// The fractions of the weight on L and R at rest (1), ½ without eccentricity.
    pub weight_fraction: [T; 2],
    /// Frequency parameter p (rad/s), eq. (3): `p² = γ g/[(1 + γ) R0]`.
    pub p: T,
    /// Supports or rigid base.
    pub foundation: Foundation,
    /// Vertical circular frequency ω_v in full contact on supports (rad/s). Like the next two, 0 on a rigid base.
    pub omega_v: T,
    /// Vertical damping ratio ξ_v (1).
    pub xi_v: T,
    /// Rate K/C at which a lifted support creeps to its free height (1/s). Infinite without damping.
    pub creep_rate: T,
    /// Coulomb's μ (1); 0 means no limit.
    pub friction: T,
    /// Its restraints.
    pub restraints: Restraints<T>,
}

/// A block's numbers read as in the paper: `block.mass` is `block.body.mass`.
impl<T> std::ops::Deref for Block<T> {
    type Target = Body<T>;

    #[inline(always)]
    fn deref(&self) -> &Body<T> {
        &self.body
    }
}

impl<T: Elementary> Body<T> {
    /// Whether the block, unlike the paper's, is uneven, restrained, or has a limit of friction. Its horizontal position then has an
    /// effect, and is kept when the foot changes.
    pub fn tracks_foot(&self) -> bool {
        self.friction.value() > 0.0 || self.eccentricity.value() != 0.0 || !self.restraints.is_empty()
    }
}

impl<T: Scalar> Body<T> {
    /// Mean static deflection δ_s = M g/(2K) = g/ω_v² of the supports (m).
    pub fn static_deflection(&self) -> T {
        self.gravity / (self.omega_v * self.omega_v)
    }

    /// Static deflection of the support under a corner (m): its free height above rest.
    pub fn free_height(&self, corner: Corner) -> T {
        self.static_deflection() * (self.weight_fraction[corner.index()] * 2.0)
    }
}
