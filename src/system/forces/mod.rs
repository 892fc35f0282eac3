//! The forces on the block, a file each: value, rate, energy, power. Everything is per unit of the block's mass.
//!
//! | module | in → out |
//! | --- | --- |
//! | `support` | height and rate of a corner → its vertical reaction; spring energy, dashpot power |
//! | `load` | excitation → its power on the moving block |
//! | `weight` | height of the centre of mass → potential energy |
//! | `friction` | vertical reaction under a sliding foot → its horizontal reaction, its power |
//!
//! Weight, supports, friction and the excitation stand in the equations themselves ([`super::dynamics`]). The functions here combine them
//! with [restraints], the forces between block and ground that switch, of any kind.

pub(crate) mod friction;
pub(crate) mod load;
pub(crate) mod support;
pub(crate) mod weight;

use crate::block::restraints::{self, MAX, ObservedRestraint, States};
use crate::block::{Body, Kinematics, Regime};
use crate::excitation::Forcing;
use crate::numerics::scalar::{CombinesWith, Elementary, Scalar};
use crate::system::instant::Instant;

impl<T: Scalar> Instant<T> {
    /// Returns the powers of the excitation and of the dashpots (m²/s³). The second is positive for dissipation.
    #[inline(always)]
    pub fn powers<P: Scalar>(&self, body: &Body<P>, regime: Regime, forcing: Forcing<T>) -> [T; 2]
    where
        T: CombinesWith<P>,
    {
        [load::power(self, forcing), support::power(body, regime, self.corner_dot)]
    }
}

/// Returns the forcing with the pull of the restraints.
pub fn added_to<P: Scalar, T: CombinesWith<P>>(
    body: &Body<P>,
    forcing: Forcing<T>,
    kinematics: &Kinematics<T>,
) -> Forcing<T> {
    let Forcing { x, z, moment, restraints } = forcing;
    let [x, z, moment] = restraints::add_pull(body, &restraints, kinematics, [x, z, moment]);
    Forcing { x, z, moment, restraints }
}

/// Joins two arrays, `N + M = K`.
#[inline(always)]
pub fn joined<T: Copy, const N: usize, const M: usize, const K: usize>(first: [T; N], second: [T; M]) -> [T; K] {
    const { assert!(N + M == K) };
    let mut all = [first[0]; K];
    // Copied number by number, they stay in registers.
    for i in 0..K {
        all[i] = if i < N { first[i] } else { second[i - N] };
    }
    all
}

/// Number of dissipative forces besides the dashpots of the supports.
pub const DISSIPATIVE: usize = 1 + restraints::KINDS;

/// Returns the powers per mass (m²/s³) dissipated by friction and by each kind of restraint.
#[inline(always)]
pub fn dissipated<P: Scalar, T: CombinesWith<P>>(
    body: &Body<P>,
    forcing: &Forcing<T>,
    x: &Instant<T>,
) -> [T; DISSIPATIVE] {
    joined([x.friction_power], powers_of_restraints(body, &forcing.restraints, x).into_array())
}

/// Returns the restraints at one instant, by their numbers.
#[inline(always)]
pub fn observe_restraints<P: Scalar, T: CombinesWith<P>>(
    body: &Body<P>,
    states: &States<T>,
    x: &Instant<T>,
) -> [ObservedRestraint<T>; MAX] {
    if body.restraints.is_empty() {
        return [ObservedRestraint::of_all(T::from(0.0)); MAX];
    }
    restraints::observe(body, states, &Kinematics::of(x))
}

/// Returns the powers per mass (m²/s³) dissipated by restraints.
#[inline(always)]
pub fn powers_of_restraints<P: Scalar, T: CombinesWith<P>>(
    body: &Body<P>,
    states: &States<T>,
    x: &Instant<T>,
) -> restraints::RestraintEnergies<T> {
    if states.dissipate() {
        restraints::powers(body, states, &Kinematics::of(x))
    } else {
        restraints::RestraintEnergies::of_all(T::from(0.0))
    }
}

/// Returns kinetic energy, and potential energy of weight, supports and restraints, per unit mass (m²/s²).
///
/// Both are zero at rest without restraints. Eq. (30), with the springs measured from their free height:
/// `½ (i0 θ̇² + u̇² + v̇²) + g v + ½ K/M Σ [(δ_I − v_I)² − δ_I²]`, and the second term of a lifted support alone.
pub fn energy<P: Elementary, T: CombinesWith<P> + From<F>, F: Copy>(
    body: &Body<P>,
    regime: Regime,
    forcing: &Forcing<F>,
    x: &Instant<T>,
) -> (T, T) {
    let kinetic = (x.theta_dot * x.theta_dot * body.i0 + x.u_dot * x.u_dot + x.v_dot * x.v_dot) * 0.5;
    let mut potential = weight::energy(body, x.v) + support::energy(body, regime, x.corner);
    if !body.restraints.is_empty() {
        potential = potential + restraints::energy(body, &forcing.restraints, &Kinematics::of(x));
    }
    (kinetic, potential)
}

/// Whether the block has forces that switch on and off: friction or restraints.
pub fn switch(body: &Body) -> bool {
    body.friction > 0.0 || !body.restraints.is_empty()
}
