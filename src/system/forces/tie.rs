//! Ties: each pulls a point of the block towards a point of the ground, along the line between them.
//!
//! Stretched by `s = L − L0 − slack + T0/k` a tie pulls with `T = k s + c ṡ` while it is taut, and not at all otherwise.

use crate::block::ties::MOST_TIES;
use crate::block::{Block, Tie, TieState, TieStates};
use crate::excitation::Forcing;
use crate::numerics::dual::Dual;
use crate::numerics::roots::Sample;
use crate::numerics::scalar::{CombinesWith, Elementary, Scalar};
use crate::system::instant::{Instant, Place};

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

/// The forcing with the pull of the ties in place of their states.
pub fn added_to<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, forcing: Forcing<T>, place: &Place<T>) -> Forcing<T> {
    let mut sum = forcing;
    for (tie, state) in block.ties.all().iter().zip(forcing.ties) {
        if state == TieState::Taut {
            let stretch = stretch(block, tie, place);
            let pull = tension(tie, state, &stretch) * (P::from(1.0) / block.mass);
            let [x, z, arm] = stretch.along;
            // A forcing is an acceleration of the ground: a load counts less.
            sum.x = sum.x + pull * x;
            sum.z = sum.z + pull * z;
            sum.moment = sum.moment - pull * arm;
        }
    }
    sum
}

/// Whether a tie pulls.
#[inline(always)]
pub fn pulls(states: &TieStates) -> bool {
    // Of constant states the compiler knows the answer, other than of `contains`.
    states.iter().any(|state| matches!(state, TieState::Taut))
}

/// Returns a vertical force on the block at rest (N, positive up) less the pull of the ties.
pub fn less_static_pull<T: Elementary>(block: &Block<T>, place: &Place<T>, mut force: T) -> T {
    for tie in block.ties.all().iter().filter(|tie| tie.stiffness.value() != 0.0) {
        let Stretch { length, along: [_, z, _], .. } = stretch(block, tie, place);
        let tension = T::select_less(0.0, length.value(), length * tie.stiffness, T::from(0.0));
        force = force - tension * z;
    }
    force
}

/// Vertical stiffness (N/m) of the ties at rest.
pub fn static_stiffness<T: Elementary>(block: &Block<T>, place: &Place<T>) -> f64 {
    block.ties.all().iter().map(|tie| stiffness_at_rest(block, tie, place)).sum()
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
#[inline(always)]
pub fn tensions<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, ties: &TieStates, x: &Instant<T>) -> [T; MOST_TIES] {
    if pulls(ties) { taut_tensions(block, ties, *x) } else { [T::from(0.0); MOST_TIES] }
}

#[inline(never)]
fn taut_tensions<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, ties: &TieStates, x: Instant<T>) -> [T; MOST_TIES] {
    let mut tensions = [T::from(0.0); MOST_TIES];
    let place = Place::of(&x);
    for ((of, tie), &state) in tensions.iter_mut().zip(block.ties.all()).zip(ties) {
        *of = tension(tie, state, &stretch(block, tie, &place));
    }
    tensions
}

/// Energy of the springs of the ties per mass (m²/s²): `½ k s²` while a tie is stretched.
pub fn energy<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, ties: &TieStates, x: &Instant<T>) -> T {
    each(block, ties, x, |tie, _, Stretch { length, .. }| length * length * (tie.stiffness * 0.5))
}

/// Power per mass (m²/s³) that the dashpots of the ties take: all that T does beyond the spring, `(T − k s) ṡ`.
#[inline(always)]
pub fn power<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, ties: &TieStates, x: &Instant<T>) -> T {
    if pulls(ties) || ties.contains(&TieState::Limp) { power_of_dashpots(block, ties, *x) } else { T::from(0.0) }
}

#[inline(never)]
fn power_of_dashpots<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, ties: &TieStates, x: Instant<T>) -> T {
    each(block, ties, &x, |tie, state, stretch| {
        (tension(tie, state, &stretch) - stretch.length * tie.stiffness) * stretch.rate
    })
}

/// A sum over the stretched ties, per mass.
fn each<P: Scalar, T: CombinesWith<P>>(
    block: &Block<P>,
    ties: &TieStates,
    x: &Instant<T>,
    of: impl Fn(&Tie<P>, TieState, Stretch<T>) -> T,
) -> T {
    let mut sum = T::from(0.0);
    if block.ties.is_empty() {
        return sum;
    }
    let place = Place::of(x);
    for (tie, &state) in block.ties.all().iter().zip(ties) {
        if matches!(state, TieState::Taut | TieState::Limp) {
            sum = sum + of(tie, state, stretch(block, tie, &place)) * (P::from(1.0) / block.mass);
        }
    }
    sum
}

/// Stretch of a tie (m) and its rate (m/s), from an instant.
#[inline]
pub fn length<R: Scalar>(block: &Block<R>, tie: &Tie<R>, x: &Instant<R>) -> Sample<R> {
    let Stretch { length, rate, .. } = stretch(block, tie, &Place::of(x));
    Sample { value: length, rate }
}

/// Tension of a tie if it is taut (N) and its rate (N/s), from an instant with rates.
#[inline]
pub fn tension_with_rate<R: Scalar>(block: &Block<R>, tie: &Tie<R>, x: &Instant<Dual<R>>) -> Sample<R>
where
    Dual<R>: CombinesWith<R>,
{
    let Dual { re, eps } = tension_if_taut(block, tie, x);
    Sample { value: re, rate: eps }
}

/// Tension of a tie if it is taut (N), from an instant.
#[inline]
pub fn tension_if_taut<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, tie: &Tie<P>, x: &Instant<T>) -> T {
    taut_tension(tie, &stretch(block, tie, &Place::of(x)))
}

/// A bound on the circular frequencies and rates of decay that ties give the block (rad/s): that of a free block.
pub fn fastest(block: &Block) -> f64 {
    let Block { mass, i0, h, eccentricity, ref ties, .. } = *block;
    let (mut stiffness, mut damping) = (0.0, 0.0);
    for tie in ties.all() {
        let (x, z) = (tie.block[0] - eccentricity, tie.block[1] - h);
        let mobility = (1.0 + (x * x + z * z) / i0) / mass;
        stiffness += tie.stiffness * mobility;
        damping += tie.damping * mobility;
    }
    stiffness.sqrt().max(damping)
}
