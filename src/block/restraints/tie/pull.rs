//! The pull of ties, along the line between their ends.
//!
//! A taut tie stretched by `s = L − L0 − slack + T0/k` pulls with `T = k (s − s_p) + c ṡ`; slack, limp and broken ties do not pull.
//! The plastic elongation s_p changes while the spring yields in the direction σ, also that of a limp tie: then
//! `k (s − s_p) − h s_p = σ F_y` with the kinematic hardening `h = k r/(1 − r)`, so that s_p follows from s and the force of the spring is
//! `r k s + (1 − r) σ F_y`.

use super::{Link, LinkKind, MAX_TIES, Plastic, Tie, TieState, TieStates, Ties, YieldDirection, links};
use crate::block::restraints::ObservedRestraint;
use crate::block::{Body, Kinematics};
use crate::numerics::scalar::{CombinesWith, Elementary, Scalar};

/// Stretch of a tie, and its direction.
#[derive(Clone, Copy, Debug)]
pub struct Stretch<T> {
    /// Stretch s (m); the tie pulls only if it is positive.
    pub length: T,
    /// Its rate ṡ (m/s).
    pub rate: T,
    /// Direction from the ground to the block (1), and moment arm (m). The arm is about the centre of mass, positive clockwise.
    along: [T; 3],
}

/// Returns the stretch of a tie.
pub fn stretch<P: Scalar, T: CombinesWith<P>>(body: &Body<P>, tie: &Tie<P>, kinematics: &Kinematics<T>) -> Stretch<T> {
    let &Kinematics { sin_cos: [sin, cos], theta_dot, center: [u, v], velocity: [u_dot, v_dot] } = kinematics;
    // From the centre of mass to the end on the block: at rest, then rotated.
    let [x, z] = [tie.block[0] - body.eccentricity, tie.block[1] - body.h];
    let [x, z] = [cos * x + sin * z, cos * z - sin * x];
    let at_rest = [tie.block[0] - tie.ground[0], tie.block[1] - tie.ground[1]];
    // From the end on the ground to that on the block.
    let d = [u + x - (tie.ground[0] - body.eccentricity), v + z - (tie.ground[1] - body.h)];
    let d_dot = [u_dot + z * theta_dot, v_dot - x * theta_dot];
    let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
    // A tie without stiffness is absent.
    let stretched = tie.pretension / tie.stiffness;
    let stretched = P::select_less(P::Real::from(0.0), tie.stiffness.value(), stretched, P::from(0.0));
    let free = (at_rest[0] * at_rest[0] + at_rest[1] * at_rest[1]).sqrt() + tie.slack - stretched;
    // A tie whose ends coincide has no direction.
    let inverse = T::select_less(T::Real::from(0.0), length.value(), T::from(1.0) / length, T::from(0.0));
    let along = [d[0] * inverse, d[1] * inverse];
    Stretch {
        length: length - free,
        rate: along[0] * d_dot[0] + along[1] * d_dot[1],
        along: [along[0], along[1], z * along[0] - x * along[1]],
    }
}

/// Size of the terms of a stretch (m). That by the pretension of a soft tie may be far above its length.
pub(super) fn size_of_stretch<T: Elementary>(body: &Body<T>, tie: &Tie<T>) -> f64 {
    let [stiffness, pretension] = [tie.stiffness, tie.pretension].map(|number| number.value());
    let by_pretension = if stiffness > 0.0 { pretension / stiffness } else { 0.0 };
    tie.length().value().max(body.r0.value()).max(by_pretension)
}

/// Returns the plastic elongation s_p (m) of a tie stretched by `length` (m).
pub fn plastic<P: Scalar, S: Copy, T: CombinesWith<P> + From<S>>(link: Link<P, S>, length: T) -> T {
    let Link { tie, state, plastic } = link;
    match (state.yields(), plastic) {
        (Some(direction), _) => {
            (length - tie.yield_force / tie.stiffness * direction.sign()) * (P::from(1.0) - tie.hardening)
        }
        (_, Some(plastic)) => T::from(plastic),
        (_, None) => T::from(0.0),
    }
}

/// Returns the elastic elongation `s − s_p` (m) of a tie stretched by `length` (m).
#[inline(always)]
pub fn elastic<P: Scalar, S: Copy, T: CombinesWith<P> + From<S>>(link: Link<P, S>, length: T) -> T {
    match link.plastic {
        None => length,
        Some(_) => length - plastic(link, length),
    }
}

/// Returns the tension (N) of a taut tie.
#[inline(always)]
pub fn taut_tension<P: Scalar, S: Copy, T: CombinesWith<P> + From<S>>(link: Link<P, S>, stretch: &Stretch<T>) -> T {
    spring(link, stretch.length) + stretch.rate * link.tie.damping
}

/// Returns the force (N) of the spring of a tie stretched by `length` (m).
#[inline(always)]
fn spring<P: Scalar, S: Copy, T: CombinesWith<P> + From<S>>(link: Link<P, S>, length: T) -> T {
    let Link { tie, state, .. } = link;
    match state.yields() {
        Some(direction) => {
            length * (tie.hardening * tie.stiffness)
                + (P::from(1.0) - tie.hardening) * tie.yield_force * direction.sign()
        }
        None => elastic(link, length) * tie.stiffness,
    }
}

/// Returns the tension (N) of a tie in its state.
#[inline(always)]
pub fn tension<P: Scalar, S: Copy, T: CombinesWith<P> + From<S>>(link: Link<P, S>, stretch: &Stretch<T>) -> T {
    if link.state.acts() { taut_tension(link, stretch) } else { T::from(0.0) }
}

/// Adds the pull of the ties to a forcing `[x, z, moment]` per mass.
pub fn add_pull<P: Scalar, S: Copy, T: CombinesWith<P> + From<S>>(
    body: &Body<P>,
    states: &TieStates,
    plastic: &Plastic<S>,
    kinematics: &Kinematics<T>,
    [mut x, mut z, mut moment]: [T; 3],
) -> [T; 3] {
    for link in links(body, states, plastic).filter(|link| link.state.acts()) {
        let stretch = stretch(body, link.tie, kinematics);
        let pull = tension(link, &stretch) * (P::from(1.0) / body.mass);
        let along = stretch.along;
        // A forcing is a ground acceleration, so a load on the block has the opposite sign.
        x = x + pull * along[0];
        z = z + pull * along[1];
        moment = moment - pull * along[2];
    }
    [x, z, moment]
}

/// Whether a tie pulls or pushes.
#[inline(always)]
pub fn pulls(states: &TieStates) -> bool {
    any(states, TieState::acts)
}

/// Whether a tie may take energy, in its dashpot or by yielding.
#[inline(always)]
pub fn dissipates(states: &TieStates) -> bool {
    any(states, TieState::is_strained)
}

/// Whether any of the states is one of these. Without a loop the compiler evaluates it for constant states.
#[inline(always)]
fn any(&[a, b, c, d, e, f, g, h]: &TieStates, is: impl Fn(TieState) -> bool) -> bool {
    is(a) | is(b) | is(c) | is(d) | is(e) | is(f) | is(g) | is(h)
}

/// Returns the direction in which a tie stretched by `length` (m) yields, if it does. It has no plastic elongation.
pub fn yielding_at_rest<T: Elementary>(tie: &Tie<T>, length: T, rounding: f64) -> Option<YieldDirection> {
    let beyond = (length * tie.stiffness).value().abs() > tie.yield_force.value() + rounding;
    let direction = if length.value() > 0.0 { YieldDirection::Longer } else { YieldDirection::Shorter };
    (tie.yields() && beyond).then_some(direction)
}

/// Whether a tie that is just taut, within `rounding` (m), becomes slack or stays taut in the direction in which its stretch varies. `None`
/// if it is not just taut, or does not vary. A tie without slack or pretension can only get some: its derivatives are those of that side.
pub fn slackens<T: Elementary>(tie: &Tie<T>, stretch: T, rounding: f64) -> Option<bool> {
    let varies = tie.kind == LinkKind::Tie && stretch.value().abs() <= rounding && stretch.slope() != 0.0;
    varies.then(|| stretch.slope() < 0.0)
}

/// Returns a tie in its state at rest. `rounding` is the round-off of a zero over its largest term, here and below.
fn at_rest<'t, T: Elementary>(body: &Body<T>, tie: &'t Tie<T>, length: T, rounding: f64) -> Link<'t, T, T> {
    let slackens = slackens(tie, length, rounding * size_of_stretch(body, tie));
    let state = match yielding_at_rest(tie, length, 0.0) {
        _ if tie.kind == LinkKind::Tie && slackens.unwrap_or(length.value() <= 0.0) => TieState::Slack,
        Some(direction) => TieState::Yields(direction),
        None => TieState::Taut,
    };
    Link { tie, state, plastic: None }
}

/// Returns a vertical force at rest less the pull of the ties (N, positive up).
pub fn less_static_pull<T: Elementary>(
    body: &Body<T>,
    ties: &Ties<T>,
    kinematics: &Kinematics<T>,
    mut force: T,
    rounding: f64,
) -> T {
    for tie in ties.all().iter().filter(|tie| tie.stiffness.value() != 0.0) {
        let Stretch { length, along: [_, z, _], .. } = stretch(body, tie, kinematics);
        let link = at_rest(body, tie, length, rounding);
        let tension = if link.state.acts() { spring(link, length) } else { T::from(0.0) };
        force = force - tension * z;
    }
    force
}

/// Returns the vertical stiffness (N/m) of the ties at rest.
pub fn static_stiffness<T: Elementary>(
    body: &Body<T>,
    ties: &Ties<T>,
    kinematics: &Kinematics<T>,
    rounding: f64,
) -> f64 {
    ties.all().iter().map(|tie| stiffness_at_rest(body, tie, kinematics, rounding)).sum()
}

/// Returns the vertical stiffness (N/m) of a tie at rest. It is `k z² + T (1 − z²)/L` with its vertical direction z, and `r k` in place of
/// k where it yields.
fn stiffness_at_rest<T: Elementary>(body: &Body<T>, tie: &Tie<T>, kinematics: &Kinematics<T>, rounding: f64) -> f64 {
    let stiffness = tie.stiffness.value();
    if stiffness == 0.0 {
        return 0.0;
    }
    let Stretch { length, along: [_, z, _], .. } = stretch(body, tie, kinematics);
    let link = at_rest(body, tie, length, rounding);
    let (stretch, z) = (length.value(), z.value());
    let free = tie.length().value() + tie.slack.value() - tie.pretension.value() / stiffness;
    match link.state {
        TieState::Slack | TieState::Limp | TieState::LimpYields | TieState::Broken => 0.0,
        TieState::Taut => stiffness * (z * z + stretch * (1.0 - z * z) / (stretch + free)),
        TieState::Yields(_) => {
            tie.hardening.value() * stiffness * z * z + spring(link, length).value() * (1.0 - z * z) / (stretch + free)
        }
    }
}

/// Returns pull, stretch and plastic elongation of all ties.
pub fn observe<P: Scalar, S: Copy, T: CombinesWith<P> + From<S>>(
    body: &Body<P>,
    states: &TieStates,
    plastics: &Plastic<S>,
    kinematics: &Kinematics<T>,
) -> [ObservedRestraint<T>; MAX_TIES] {
    let mut all = [ObservedRestraint::of_all(T::from(0.0)); MAX_TIES];
    for (observed, link) in all.iter_mut().zip(links(body, states, plastics)) {
        let stretch = stretch(body, link.tie, kinematics);
        let Tie { stiffness, damping, kind, .. } = *link.tie;
        let pull = tension(link, &stretch);
        // Round-off may take the tension of a tie below zero where it goes slack.
        let (acting, pull) = match kind {
            LinkKind::Tie => {
                let pulls = T::select_less(pull.value(), T::Real::from(0.0), T::from(0.0), pull);
                (stiffness.value(), pulls)
            }
            LinkKind::Damper => (stiffness.value() + damping.value(), pull),
        };
        let is_present = P::select_less(P::Real::from(0.0), acting, P::from(1.0), P::from(0.0));
        *observed =
            ObservedRestraint { pull, elongation: stretch.length * is_present, plastic: plastic(link, stretch.length) };
    }
    all
}

/// Returns the energy stored in the ties per mass (m²/s²). It is `½ k (s − s_p)²` of each stretched tie and `½ h s_p²` of each that is not
/// broken.
pub fn energy<P: Scalar, S: Copy, T: CombinesWith<P> + From<S>>(
    body: &Body<P>,
    states: &TieStates,
    plastics: &Plastic<S>,
    kinematics: &Kinematics<T>,
) -> T {
    let springs = sum_stretched(body, links(body, states, plastics), kinematics, |link, Stretch { length, .. }| {
        let elastic = elastic(link, length);
        elastic * elastic * (link.tie.stiffness * 0.5)
    });
    if plastics.is_none() {
        return springs;
    }
    let mut sum = springs;
    for link in links(body, states, plastics).filter(|link| link.state != TieState::Broken) {
        let Tie { hardening, stiffness, .. } = *link.tie;
        let plastic = plastic(link, stretch(body, link.tie, kinematics).length);
        let modulus = stiffness * hardening / (P::from(1.0) - hardening);
        sum = sum + plastic * plastic * (modulus * 0.5 / body.mass);
    }
    sum
}

/// Returns the work (J) that stretches a tie to `length` (m) without a turn. It begins at the plastic elongation, is `½ k (s − s_p)²` up to
/// the yield surface, and has the stiffness `r k` beyond.
pub fn work_to(link: Link<f64, f64>, length: f64) -> f64 {
    let Link { tie, plastic, .. } = link;
    let Tie { stiffness, yield_force, hardening, .. } = *tie;
    let plastic = plastic.unwrap_or(0.0);
    let elastic = match tie.kind {
        LinkKind::Tie => (length - plastic).max(0.0),
        LinkKind::Damper => length - plastic,
    };
    if !tie.yields() {
        return 0.5 * stiffness * elastic * elastic;
    }
    let back_stress = stiffness * hardening / (1.0 - hardening) * plastic;
    let first = ((yield_force + back_stress * elastic.signum()) / stiffness).clamp(0.0, elastic.abs());
    let beyond = elastic.abs() - first;
    stiffness * (0.5 * first * first + beyond * (first + 0.5 * hardening * beyond))
}

/// Returns the power per mass (m²/s³) dissipated by the ties of a kind. It is `(T − F) ṡ` by the dashpots beside the force F of the spring,
/// and `F_y |ṡ_p|` by yielding.
pub fn power<P: Scalar, S: Copy, T: CombinesWith<P> + From<S>>(
    body: &Body<P>,
    states: &TieStates,
    plastic: &Plastic<S>,
    kinematics: &Kinematics<T>,
    kind: LinkKind,
) -> T {
    let links = links(body, states, plastic).filter(|link| link.tie.kind == kind);
    sum_stretched(body, links, kinematics, |link, stretch| {
        let dashpot = (tension(link, &stretch) - spring(link, stretch.length)) * stretch.rate;
        match link.state.yields() {
            Some(direction) => {
                let Tie { yield_force, hardening, .. } = *link.tie;
                dashpot + stretch.rate * ((P::from(1.0) - hardening) * yield_force * direction.sign())
            }
            None => dashpot,
        }
    })
}

/// Returns the sum of `term` over the stretched ties among these, per mass.
fn sum_stretched<'a, P: Scalar + 'a, S: Copy, T: CombinesWith<P> + From<S>>(
    body: &Body<P>,
    links: impl Iterator<Item = Link<'a, P, S>>,
    kinematics: &Kinematics<T>,
    term: impl Fn(Link<P, S>, Stretch<T>) -> T,
) -> T {
    let mut sum = T::from(0.0);
    for link in links {
        if link.state.is_strained() {
            sum = sum + term(link, stretch(body, link.tie, kinematics)) * (P::from(1.0) / body.mass);
        }
    }
    sum
}

/// Returns sums of bounds on squared circular frequencies ((rad/s)²) and decay rates (1/s) from ties. The block is free.
pub fn stiffest(body: &Body, ties: &Ties) -> [f64; 2] {
    let (mut stiffness, mut damping) = (0.0, 0.0);
    for tie in ties.all() {
        let mobility = mobility(body, tie);
        stiffness += tie.stiffness * mobility;
        damping += tie.damping * mobility;
    }
    [stiffness, damping]
}

/// Returns a bound on the acceleration of the end of a tie under a unit force (1/kg). The block is free.
pub fn mobility(body: &Body, tie: &Tie) -> f64 {
    let Body { mass, i0, h, eccentricity, .. } = *body;
    let (x, z) = (tie.block[0] - eccentricity, tie.block[1] - h);
    (1.0 + (x * x + z * z) / i0) / mass
}
