//! Ties: each pulls a point of the block towards a point of the ground, along the line between them.
//!
//! Stretched by `s = L − L0 − slack + T0/k` a tie pulls with `T = k s + c ṡ` while it is taut, and not at all otherwise.

use super::{MOST_TIES, Tie, TieState, TieStates, Ties};
use crate::block::{Block, Place};
use crate::numerics::scalar::{CombinesWith, Elementary, Scalar};

/// A tie that is stretched.
#[derive(Clone, Copy, Debug)]
pub struct Stretch<T> {
    /// Its stretch s (m); it pulls only where this is positive.
    pub length: T,
    /// Its rate ṡ (m/s).
    pub rate: T,
    /// Direction from the ground to the block (1), and its moment arm about the centre of mass (m), positive clockwise.
    along: [T; 3],
}

/// Stretch of a tie.
pub fn stretch<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, tie: &Tie<P>, place: &Place<T>) -> Stretch<T> {
    let &Place { sin_cos: [sin, cos], theta_dot, center: [u, v], velocity: [u_dot, v_dot] } = place;
    // From the centre of mass to the end at the block, at rest and turned.
    let [x, z] = [tie.block[0] - block.eccentricity, tie.block[1] - block.h];
    let [x, z] = [cos * x + sin * z, cos * z - sin * x];
    let at_rest = [tie.block[0] - tie.ground[0], tie.block[1] - tie.ground[1]];
    // From the end at the ground to that at the block.
    let d = [u + x - (tie.ground[0] - block.eccentricity), v + z - (tie.ground[1] - block.h)];
    let d_dot = [u_dot + z * theta_dot, v_dot - x * theta_dot];
    let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
    let free = (at_rest[0] * at_rest[0] + at_rest[1] * at_rest[1]).sqrt() + tie.slack - tie.pretension / tie.stiffness;
    // Ends that meet pull in no direction.
    let inverse = T::select_less(T::Real::from(0.0), length.value(), T::from(1.0) / length, T::from(0.0));
    let along = [d[0] * inverse, d[1] * inverse];
    Stretch {
        length: length - free,
        rate: along[0] * d_dot[0] + along[1] * d_dot[1],
        along: [along[0], along[1], z * along[0] - x * along[1]],
    }
}

/// Tension (N) of a tie if it is taut.
#[inline(always)]
pub fn taut_tension<P: Scalar, T: CombinesWith<P>>(tie: &Tie<P>, stretch: &Stretch<T>) -> T {
    stretch.length * tie.stiffness + stretch.rate * tie.damping
}

/// Tension (N) of a tie.
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
    place: &Place<T>,
    [mut x, mut z, mut moment]: [T; 3],
) -> [T; 3] {
    for (tie, &state) in block.ties().iter().zip(states) {
        if state == TieState::Taut {
            let stretch = stretch(block, tie, place);
            let pull = tension(tie, state, &stretch) * (P::from(1.0) / block.mass);
            let along = stretch.along;
            // A forcing is an acceleration of the ground: a load counts less.
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
    // Of constant states the compiler knows the answer, other than of `contains`.
    states.iter().any(|state| matches!(state, TieState::Taut))
}

/// Whether the dashpot of a tie may take energy.
#[inline(always)]
pub fn dissipates(states: &TieStates) -> bool {
    states.iter().any(|state| matches!(state, TieState::Taut | TieState::Limp))
}

/// Returns a vertical force on the block at rest (N, positive up) less the pull of the ties.
pub fn less_static_pull<T: Elementary>(block: &Block<T>, ties: &Ties<T>, place: &Place<T>, mut force: T) -> T {
    for tie in ties.all().iter().filter(|tie| tie.stiffness.value() != 0.0) {
        let Stretch { length, along: [_, z, _], .. } = stretch(block, tie, place);
        let tension = T::select_less(0.0, length.value(), length * tie.stiffness, T::from(0.0));
        force = force - tension * z;
    }
    force
}

/// Vertical stiffness (N/m) of the ties at rest.
pub fn static_stiffness<T: Elementary>(block: &Block<T>, ties: &Ties<T>, place: &Place<T>) -> f64 {
    ties.all().iter().map(|tie| stiffness_at_rest(block, tie, place)).sum()
}

/// Vertical stiffness (N/m) of a tie at rest: `k z² + T (1 − z²)/L` with its vertical direction z.
fn stiffness_at_rest<T: Elementary>(block: &Block<T>, tie: &Tie<T>, place: &Place<T>) -> f64 {
    let stiffness = tie.stiffness.value();
    if stiffness == 0.0 {
        return 0.0;
    }
    let Stretch { length, along: [_, z, _], .. } = stretch(block, tie, place);
    let (stretch, z) = (length.value(), z.value());
    let free = tie.length().value() + tie.slack.value() - tie.pretension.value() / stiffness;
    if stretch > 0.0 { stiffness * (z * z + stretch * (1.0 - z * z) / (stretch + free)) } else { 0.0 }
}

/// Tensions of all ties (N).
pub fn tensions<P: Scalar, T: CombinesWith<P>>(
    block: &Block<P>,
    states: &TieStates,
    place: &Place<T>,
) -> [T; MOST_TIES] {
    let mut tensions = [T::from(0.0); MOST_TIES];
    for ((of, tie), &state) in tensions.iter_mut().zip(block.ties()).zip(states) {
        *of = tension(tie, state, &stretch(block, tie, place));
    }
    tensions
}

/// Energy of the springs of the ties per mass (m²/s²): `½ k s²` while a tie is stretched.
pub fn energy<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, states: &TieStates, place: &Place<T>) -> T {
    each(block, states, place, |tie, _, Stretch { length, .. }| length * length * (tie.stiffness * 0.5))
}

/// Power per mass (m²/s³) that the dashpots of the ties take: all that T does beyond the spring, `(T − k s) ṡ`.
pub fn power<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, states: &TieStates, place: &Place<T>) -> T {
    each(block, states, place, |tie, state, stretch| {
        (tension(tie, state, &stretch) - stretch.length * tie.stiffness) * stretch.rate
    })
}

/// A sum over the stretched ties, per mass.
fn each<P: Scalar, T: CombinesWith<P>>(
    block: &Block<P>,
    states: &TieStates,
    place: &Place<T>,
    of: impl Fn(&Tie<P>, TieState, Stretch<T>) -> T,
) -> T {
    let mut sum = T::from(0.0);
    for (tie, &state) in block.ties().iter().zip(states) {
        if matches!(state, TieState::Taut | TieState::Limp) {
            sum = sum + of(tie, state, stretch(block, tie, place)) * (P::from(1.0) / block.mass);
        }
    }
    sum
}

/// Sums of bounds on the squares of the circular frequencies ((rad/s)²) and on the rates of decay (1/s) that ties give the block:
/// those of a free block.
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
