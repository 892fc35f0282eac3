//! The pull of ties, along the line between their ends.
//!
//! A taut tie stretched by `s = L − L0 − slack + T0/k` pulls with `T = k s + c ṡ`; other ties do not pull.

use super::{MAX_TIES, Tie, TieState, TieStates, Ties};
use crate::block::{Block, Kinematics};
use crate::numerics::scalar::{CombinesWith, Elementary, Scalar};

/// Stretch of a tie, and its direction.
#[derive(Clone, Copy, Debug)]
pub struct Stretch<T> {
    /// Stretch s (m); the tie pulls only if it is positive.
    pub length: T,
    /// Its rate ṡ (m/s).
    pub rate: T,
    /// Direction from the ground to the block (1), and its moment arm about the centre of mass (m), positive clockwise.
    along: [T; 3],
}

/// Returns the stretch of a tie.
pub fn stretch<P: Scalar, T: CombinesWith<P>>(
    block: &Block<P>,
    tie: &Tie<P>,
    kinematics: &Kinematics<T>,
) -> Stretch<T> {
    let &Kinematics { sin_cos: [sin, cos], theta_dot, center: [u, v], velocity: [u_dot, v_dot] } = kinematics;
    // From the centre of mass to the end on the block: at rest, then rotated.
    let [x, z] = [tie.block[0] - block.eccentricity, tie.block[1] - block.h];
    let [x, z] = [cos * x + sin * z, cos * z - sin * x];
    let at_rest = [tie.block[0] - tie.ground[0], tie.block[1] - tie.ground[1]];
    // From the end on the ground to that on the block.
    let d = [u + x - (tie.ground[0] - block.eccentricity), v + z - (tie.ground[1] - block.h)];
    let d_dot = [u_dot + z * theta_dot, v_dot - x * theta_dot];
    let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
    let free = (at_rest[0] * at_rest[0] + at_rest[1] * at_rest[1]).sqrt() + tie.slack - tie.pretension / tie.stiffness;
    // A tie whose ends coincide has no direction.
    let inverse = T::select_less(T::Real::from(0.0), length.value(), T::from(1.0) / length, T::from(0.0));
    let along = [d[0] * inverse, d[1] * inverse];
    Stretch {
        length: length - free,
        rate: along[0] * d_dot[0] + along[1] * d_dot[1],
        along: [along[0], along[1], z * along[0] - x * along[1]],
    }
}

/// Returns the tension (N) of a taut tie.
#[inline(always)]
pub fn taut_tension<P: Scalar, T: CombinesWith<P>>(tie: &Tie<P>, stretch: &Stretch<T>) -> T {
    stretch.length * tie.stiffness + stretch.rate * tie.damping
}

/// Returns the tension (N) of a tie in this state.
#[inline(always)]
pub fn tension<P: Scalar, T: CombinesWith<P>>(tie: &Tie<P>, state: TieState, stretch: &Stretch<T>) -> T {
    match state {
        TieState::Taut => taut_tension(tie, stretch),
        TieState::Slack | TieState::Limp | TieState::Broken => T::from(0.0),
    }
}

/// Adds the pull of the ties to a forcing `[x, z, moment]` per mass.
pub fn add_pull<P: Scalar, T: CombinesWith<P>>(
    block: &Block<P>,
    states: &TieStates,
    kinematics: &Kinematics<T>,
    [mut x, mut z, mut moment]: [T; 3],
) -> [T; 3] {
    for (tie, &state) in block.ties().iter().zip(states) {
        if state == TieState::Taut {
            let stretch = stretch(block, tie, kinematics);
            let pull = tension(tie, state, &stretch) * (P::from(1.0) / block.mass);
            let along = stretch.along;
            // A forcing is a ground acceleration, so a load on the block has the opposite sign.
            x = x + pull * along[0];
            z = z + pull * along[1];
            moment = moment - pull * along[2];
        }
    }
    [x, z, moment]
}

/// Whether a tie pulls.
#[inline(always)]
pub fn pulls(states: &TieStates) -> bool {
    // The compiler evaluates this for constant states, unlike `contains`.
    states.iter().any(|state| matches!(state, TieState::Taut))
}

/// Whether the dashpot of a tie may take energy.
#[inline(always)]
pub fn dissipates(states: &TieStates) -> bool {
    states.iter().any(|state| matches!(state, TieState::Taut | TieState::Limp))
}

/// Returns a vertical force on the block at rest (N, positive up) less the pull of the ties.
pub fn less_static_pull<T: Elementary>(
    block: &Block<T>,
    ties: &Ties<T>,
    kinematics: &Kinematics<T>,
    mut force: T,
) -> T {
    for tie in ties.all().iter().filter(|tie| tie.stiffness.value() != 0.0) {
        let Stretch { length, along: [_, z, _], .. } = stretch(block, tie, kinematics);
        let tension = T::select_less(0.0, length.value(), length * tie.stiffness, T::from(0.0));
        force = force - tension * z;
    }
    force
}

/// Returns the vertical stiffness (N/m) of the ties at rest.
pub fn static_stiffness<T: Elementary>(block: &Block<T>, ties: &Ties<T>, kinematics: &Kinematics<T>) -> f64 {
    ties.all().iter().map(|tie| stiffness_at_rest(block, tie, kinematics)).sum()
}

/// Returns the vertical stiffness (N/m) of a tie at rest: `k z² + T (1 − z²)/L` with its vertical direction z.
fn stiffness_at_rest<T: Elementary>(block: &Block<T>, tie: &Tie<T>, kinematics: &Kinematics<T>) -> f64 {
    let stiffness = tie.stiffness.value();
    if stiffness == 0.0 {
        return 0.0;
    }
    let Stretch { length, along: [_, z, _], .. } = stretch(block, tie, kinematics);
    let (stretch, z) = (length.value(), z.value());
    let free = tie.length().value() + tie.slack.value() - tie.pretension.value() / stiffness;
    if stretch > 0.0 { stiffness * (z * z + stretch * (1.0 - z * z) / (stretch + free)) } else { 0.0 }
}

/// Returns the tensions of all ties (N).
pub fn tensions<P: Scalar, T: CombinesWith<P>>(
    block: &Block<P>,
    states: &TieStates,
    kinematics: &Kinematics<T>,
) -> [T; MAX_TIES] {
    let mut tensions = [T::from(0.0); MAX_TIES];
    for ((value, tie), &state) in tensions.iter_mut().zip(block.ties()).zip(states) {
        *value = tension(tie, state, &stretch(block, tie, kinematics));
    }
    tensions
}

/// Returns the energy of the springs of the ties per mass (m²/s²): `½ k s²` of each stretched tie.
pub fn energy<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, states: &TieStates, kinematics: &Kinematics<T>) -> T {
    sum_stretched(block, states, kinematics, |tie, _, Stretch { length, .. }| length * length * (tie.stiffness * 0.5))
}

/// Returns the power per mass (m²/s³) dissipated by the dashpots of the ties: `(T − k s) ṡ`.
pub fn power<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, states: &TieStates, kinematics: &Kinematics<T>) -> T {
    sum_stretched(block, states, kinematics, |tie, state, stretch| {
        (tension(tie, state, &stretch) - stretch.length * tie.stiffness) * stretch.rate
    })
}

/// Returns the sum of `term` over the stretched ties, per mass.
fn sum_stretched<P: Scalar, T: CombinesWith<P>>(
    block: &Block<P>,
    states: &TieStates,
    kinematics: &Kinematics<T>,
    term: impl Fn(&Tie<P>, TieState, Stretch<T>) -> T,
) -> T {
    let mut sum = T::from(0.0);
    for (tie, &state) in block.ties().iter().zip(states) {
        if matches!(state, TieState::Taut | TieState::Limp) {
            sum = sum + term(tie, state, stretch(block, tie, kinematics)) * (P::from(1.0) / block.mass);
        }
    }
    sum
}

/// Returns sums of bounds on the squared circular frequencies ((rad/s)²) and on the decay rates (1/s) that ties give a free block.
pub fn stiffest(block: &Block, ties: &Ties) -> [f64; 2] {
    let Block { mass, i0, h, eccentricity, .. } = *block;
    let (mut stiffness, mut damping) = (0.0, 0.0);
    for tie in ties.all() {
        let (x, z) = (tie.block[0] - eccentricity, tie.block[1] - h);
        let mobility = (1.0 + (x * x + z * z) / i0) / mass;
        stiffness += tie.stiffness * mobility;
        damping += tie.damping * mobility;
    }
    [stiffness, damping]
}
