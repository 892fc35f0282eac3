//! State and supports of an instant → the functions whose fall through zero is an event.

use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use crate::block::{Block, Foundation};
use crate::contact::{Corner, Regime};
use crate::numerics::roots::Sample;
use crate::scalar::{Elementary, Real};
use crate::system::dynamics::{Footing, Instant, instant};
use crate::system::impact;
use crate::system::now::Now;

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// A corner left its support, or the rigid base.
    LiftOff(Corner),
    /// A corner came down on its support, or on the rigid base.
    Landing(Corner),
    /// Nothing holds the block horizontally any more, though a support still bears it.
    Slip,
    /// What touches is pressed on again and slides no more.
    Grip,
    /// The block reached a quarter turn: a side lies on the ground.
    Overturning,
}

/// An event, as it is reported while the simulation runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Time (s).
    pub time: f64,
    /// What happened.
    pub kind: EventKind,
    /// Regime right before.
    pub before: Regime,
    /// Regime right after, with all that followed in the same instant.
    pub after: Regime,
}

impl std::fmt::Display for Event {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let what = match self.kind {
            EventKind::LiftOff(Corner::Left) => "lift-off of L",
            EventKind::LiftOff(Corner::Right) => "lift-off of R",
            EventKind::Landing(Corner::Left) => "landing on L",
            EventKind::Landing(Corner::Right) => "landing on R",
            EventKind::Slip => "slip",
            EventKind::Grip => "grip",
            EventKind::Overturning => "overturning",
        };
        write!(f, "t = {:.9} s: {what}, {} -> {}", self.time, self.before, self.after)
    }
}

/// A function of the motion that is positive within a regime and falls through zero when the regime ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Surface {
    /// The reaction N_I/M of a touching corner (m/s²).
    Reaction(Corner),
    /// The gap `v_I − y_I` between a lifted corner and its support (m).
    Gap(Corner),
    /// How fast a corner that is held would be pressed on if it were let go (m/s²); see [`gap_opening`].
    Held(Corner),
    /// How fast full contact would lift a corner that is held (m/s²).
    Unloaded(Corner),
    /// How far what slides is from being pressed on if it gripped (m/s²): on supports see [`pressure_if_gripped`], on the
    /// rigid base p times the vertical rate with which gripping would throw the corner up.
    Slide,
    /// What is left of the quarter turn, `π/2 − |θ|` (rad).
    QuarterTurn,
}

impl Surface {
    /// Value and rate at an instant.
    #[inline(always)]
    pub fn sample(self, at: &Now) -> Sample {
        let Now { block, ref instant, .. } = *at;
        match self {
            Surface::Reaction(corner) => {
                let i = corner.index();
                let rate = match block.foundation {
                    Foundation::Viscoelastic => reaction_rate(block, instant.corner_dot[i], instant.corner_ddot[i]),
                    Foundation::Rigid => rigid_reaction_rate(at, corner),
                };
                Sample { value: instant.reaction[i], rate }
            }
            Surface::Gap(corner) => {
                let i = corner.index();
                let top = at.tops[i];
                Sample { value: instant.corner[i] - top.value, rate: instant.corner_dot[i] - top.rate }
            }
            // The rate is not known; a change of sign between samples is enough where the function is monotone.
            Surface::Held(corner) => {
                Sample { value: -gap_opening(at, corner, instant.corner_dot[corner.index()]), rate: 0.0 }
            }
            Surface::Unloaded(corner) => Sample { value: unloading(at, corner), rate: 0.0 },
            Surface::Slide => slide(at),
            Surface::QuarterTurn => Sample {
                value: FRAC_PI_2 - instant.theta.abs(),
                rate: if instant.theta < 0.0 { instant.theta_dot } else { -instant.theta_dot },
            },
        }
    }

    /// What rounding leaves of a zero of this surface.
    #[inline]
    pub fn rounding(self, block: &Block) -> f64 {
        ROUNDING
            * match self {
                Surface::Reaction(_) | Surface::Held(_) | Surface::Unloaded(_) => block.gravity,
                // What slides may be as fast as it wants, and dashpots make forces of what rounding leaves of its rates.
                Surface::Slide => block.gravity.max(block.xi_v * block.omega_v * block.p * block.r0),
                Surface::Gap(_) => match block.foundation {
                    Foundation::Viscoelastic => block.static_deflection().max(block.b),
                    Foundation::Rigid => block.r0,
                },
                Surface::QuarterTurn => FRAC_PI_2,
            }
    }
}

/// What rounding leaves of a zero, beside the largest term that enters: some thousand ulp.
pub(crate) const ROUNDING: f64 = 1e-13;

/// [`Surface::Slide`].
fn slide(at: &Now) -> Sample {
    let block = at.block;
    match (block.foundation, at.regime.pivot()) {
        // It may be pressed on for a moment only, where the slide turns back.
        (Foundation::Viscoelastic, _) => {
            let pressure = pressure_if_gripped(block, at.regime, &at.along(at.forcing_rate()));
            Sample { value: -pressure.re, rate: -pressure.eps }
        }
        (Foundation::Rigid, Some(corner)) => {
            let thrown = impact::thrown_by_grip(block, corner, &at.along(at.forcing_rate()));
            Sample { value: block.p * thrown.re, rate: block.p * thrown.eps }
        }
        // Both corners stand on the rigid base, which neither throws up: they grip.
        (Foundation::Rigid, None) => Sample { value: -block.gravity, rate: 0.0 },
    }
}

/// Ṅ_I/M of a corner that stands on the rigid base (m/s³).
///
/// About a corner that grips `N/M = g + a_z − s P θ̈ − Q θ̇²`, with `Ṗ = s Q θ̇` and `Q̇ = −s P θ̇`.
fn rigid_reaction_rate(at: &Now, corner: Corner) -> f64 {
    let Now { block, forcing, instant: x, .. } = at;
    let &Block { b, h, i0, r0, gravity, .. } = *block;
    let s = corner.sign();
    let rate = at.excitation.rate_at(at.time);
    match (at.regime.pivot(), at.footing) {
        (Some(_), Footing::Grips { offset }) => {
            let (reach, height) = (b + s * (x.u - offset), h + x.v - x.corner[corner.index()]);
            let turning = height * x.theta_dot * (forcing.z + gravity) + s * reach * (rate.z + x.theta_dot * forcing.x)
                - height * rate.x
                + rate.moment;
            let theta_dddot = turning / (i0 + r0 * r0);
            let centripetal = s * reach * x.theta_dot * x.theta_dot - 3.0 * height * x.theta_ddot;
            rate.z + centripetal * x.theta_dot - s * reach * theta_dddot
        }
        (Some(_), Footing::Free { .. }) => at.along(at.forcing_rate()).reaction[corner.index()].eps,
        (None, footing) => {
            let horizontal = if footing.grips() { rate.x } else { 0.0 };
            0.5 * rate.z + s * (horizontal * h - rate.moment) * (0.5 / b)
        }
    }
}

/// `Ṅ_I/M = −(K v̇_I + C v̈_I)/M` of a corner on its support (m/s³).
#[inline(always)]
pub fn reaction_rate<R: Real>(block: &Block<R>, corner_dot: R, corner_ddot: R) -> R {
    let omega_v = block.omega_v;
    omega_v * -0.5 * omega_v * corner_dot - block.xi_v * omega_v * corner_ddot
}

/// Acceleration (m/s²) with which the gap of a touching corner would open if it left its support now, the other one
/// staying as it is: `v̈_I − ÿ_I` with `ẏ_I = v̇_I = corner_dot`, so `ÿ_I = −(K/C) v̇_I`. Without damping the support's top stands still and
/// the gap opens with the rate v̇_I: infinitely fast by this measure.
///
/// Because the horizontal constraint changes with the regime (the middle of the base is held in full contact, the
/// corner on one corner), `v̈_I` jumps a little at lift-off. It can happen that full contact has the corner lift and
/// that the other regime has it pressed on: neither holds, and the true motion slides along the boundary with
/// `N_I ≈ 0`. Then the corner is held in full contact until one of the two lets it go. The last corner that touches
/// slides in that case, since a support that bears nothing cannot hold it.
pub fn gap_opening(at: &Now, corner: Corner, corner_dot: f64) -> f64 {
    let i = corner.index();
    let &Now { block, instant: ref x, .. } = at;
    let other = corner.other();
    let after = if at.regime.touches(other) {
        let state = [x.theta, x.theta_dot, x.corner[other.index()], x.corner_dot[other.index()]];
        instant(block, Regime::on(other), state, at.footing, at.forcing)
    } else {
        let flight = Footing::Free { u: x.u, u_dot: x.u_dot };
        instant(block, Regime::Separated, [x.theta, x.theta_dot, x.v, x.v_dot], flight, at.forcing)
    };
    // Without damping the rate K/C is infinite: a rate decides by its sign, and none leaves the acceleration.
    let creep = if corner_dot == 0.0 { 0.0 } else { block.creep_rate() * corner_dot };
    after.corner_ddot[i] + creep
}

/// Acceleration (m/s²) at which full contact would take a corner that is held away from its support.
fn unloading(at: &Now, corner: Corner) -> f64 {
    let x = instant(at.block, Regime::FullContact, at.state.0, at.footing, at.forcing);
    x.corner_ddot[corner.index()] - at.instant.corner_ddot[corner.index()]
}

/// What presses the corners that touch on their supports if they grip now, per mass (m/s²), the least of them: the
/// reaction right after the horizontal impulse, which turns the block, less what would follow if it threw the corner up.
///
/// A support of stiffness K catches a mass M thrown up with v̇ as long as its force is above `√(K M) v̇`. With less, the
/// corner would leave it again, land, and grip, over and over.
pub fn pressure_if_gripped<T: Elementary>(block: &Block, regime: Regime, x: &Instant<T>) -> T {
    let Block { b, h, i0, omega_v, xi_v, .. } = *block;
    let (sin, cos) = x.theta.sin_cos();
    let reach = |s: f64| cos * b + sin * (s * h);
    let height = match regime.pivot() {
        Some(corner) => cos * h - sin * (corner.sign() * b),
        None => cos * h,
    };
    let theta_dot = (x.theta_dot * i0 + height * x.u_dot) / (height * height + i0);
    let pressed = |corner: Corner| {
        let (i, s) = (corner.index(), corner.sign());
        let change = reach(s) * (theta_dot - x.theta_dot) * s;
        let rate = x.corner_dot[i] + change;
        let thrown = if rate.value() > 0.0 { rate } else { T::from(0.0) };
        x.reaction[i] - (change * xi_v + thrown * std::f64::consts::FRAC_1_SQRT_2) * omega_v
    };
    let touching = Corner::BOTH.into_iter().filter(|&corner| regime.touches(corner));
    let least = |a: T, b: T| if b.value() < a.value() { b } else { a };
    touching.map(pressed).fold(T::from(f64::INFINITY), least)
}
