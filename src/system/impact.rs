//! Velocities before a corner lands, grips or changes the pivot → velocities after.

use crate::block::{Block, Body, Corner, Foot, Lever, Regime};
use crate::numerics::scalar::{CombinesWith, Elementary, Scalar, greatest, least};
use crate::system::instant::Instant;

/// Velocities of the block relative to the ground. `u̇` and `v̇` are those of the centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Velocities<T = f64> {
    /// u̇ (m/s), positive to the right.
    pub u_dot: T,
    /// v̇ (m/s), positive up.
    pub v_dot: T,
    /// θ̇ (rad/s), positive clockwise.
    pub theta_dot: T,
}

impl<T: Elementary> Velocities<T> {
    /// Returns the kinetic energy per unit mass (m²/s²).
    pub fn kinetic(&self, body: &Body<T>) -> T {
        let Velocities { u_dot, v_dot, theta_dot } = *self;
        (body.i0 * theta_dot * theta_dot + u_dot * u_dot + v_dot * v_dot) * 0.5
    }
}

/// Returns v̇ of the centre of mass (m/s) and θ̇ (rad/s) after a landing. They follow from those before; θ̇ is positive clockwise.
///
/// Eqs. (14)–(19) with the sign of J12 corrected, and their mirror image (28): linear and angular momentum change by the impulses of H and N
/// at the landing corner only, the corner's vertical velocity by the factor ε, and the horizontal constraint moves from the standing corner
/// to the middle of the base.
pub fn landing<T: Elementary>(block: &Block<T>, corner: Corner, theta: T, v_dot: T, theta_dot: T) -> (T, T) {
    let Block { epsilon, body: Body { i0, .. }, .. } = *block;
    let (sin, cos) = theta.sin_cos();
    let Lever { x, q } = block.lever(Foot::Corner(corner), sin, cos);
    let before = block.lever(Foot::Corner(corner.other()), sin, cos);
    let after = block.lever(Foot::Middle, sin, cos);
    // A, B, P of the paper, each times R0².
    let (a, b, p) = (after.q * q, x * x, before.q * q);
    let d = i0 + a + b;
    let j11 = (epsilon * (i0 + a) + b) / d;
    let j12 = ((epsilon - 1.0) * i0 + epsilon * a - p) * x / d;
    let j21 = (epsilon - 1.0) * x / d;
    let j22 = (i0 + epsilon * b + p) / d;
    (j11 * v_dot + j12 * theta_dot, j21 * v_dot + j22 * theta_dot)
}

/// Returns v̇ of a corner (m/s) from v̇ of the centre of mass and θ̇.
///
/// `v̇_I = v̇ + s R0 sin(α + sθ) θ̇`.
pub fn corner_rate<T: Elementary>(body: &Body<T>, corner: Corner, theta: T, v_dot: T, theta_dot: T) -> T {
    v_dot + lever(body, corner, theta).x * theta_dot
}

/// Returns the velocities after the landing of `corner` while the other one does not stand.
///
/// The corner's horizontal velocity is stopped, its vertical one becomes `rate_after` (m/s), and the angular momentum about it is kept:
/// `θ̇_a (i0 + Q² + X²) = i0 θ̇_b + Q u̇_b − X v̇_b + X rate_after`. A smaller rate gains no energy as long as the support pushes, that is, as long as v̇ grows.
pub fn landing_with_grip<T: Elementary>(
    body: &Body<T>,
    corner: Corner,
    theta: T,
    before: Velocities<T>,
    rate_after: T,
) -> Velocities<T> {
    let Lever { x, q } = lever(body, corner, theta);
    let Velocities { u_dot, v_dot, theta_dot } = before;
    let momentum = body.i0 * theta_dot + q * u_dot - x * v_dot;
    let theta_dot = (momentum + x * rate_after) / (body.i0 + q * q + x * x);
    Velocities { u_dot: q * theta_dot, v_dot: rate_after - x * theta_dot, theta_dot }
}

/// Returns the velocities after a vertical impulse at `corner` that gives it `rate_after` (m/s, upwards).
pub fn landing_without_grip<T: Elementary>(
    body: &Body<T>,
    corner: Corner,
    theta: T,
    before: Velocities<T>,
    rate_after: T,
) -> Velocities<T> {
    let Lever { x, .. } = lever(body, corner, theta);
    let Velocities { u_dot, v_dot, theta_dot } = before;
    let impulse = (rate_after - v_dot - x * theta_dot) / (x * x / body.i0 + 1.0);
    Velocities { u_dot, v_dot: v_dot + impulse, theta_dot: theta_dot + x * impulse / body.i0 }
}

/// Returns the velocities after a landing of `corner` with friction and `rate_after` (m/s, upwards).
///
/// `v̇_I after = rate_after`. The horizontal impulse is the one within `|P_H| ≤ μ P_N` that leaves `foot` slowest. P_N is linear in P_H by the restitution, and so is
/// the velocity of the foot.
pub fn landing_with_friction<T: Elementary>(
    body: &Body<T>,
    corner: Corner,
    foot: Foot,
    theta: T,
    before: Velocities<T>,
    rate_after: T,
) -> Velocities<T> {
    let (sin, cos) = theta.sin_cos();
    let Lever { x, q } = body.lever(Foot::Corner(corner), sin, cos);
    let height = body.lever(foot, sin, cos).q;
    let Velocities { u_dot, v_dot, theta_dot } = before;
    let Body { i0, friction, .. } = *body;
    // P_N = constant + slope P_H, per mass.
    let constant = (rate_after - v_dot - x * theta_dot) / (x * x / i0 + 1.0);
    let slope = x * q / (i0 + x * x);
    let speed = u_dot - height * (theta_dot + x * constant / i0);
    let speed_slope = height * (q - x * slope) / i0 + 1.0;
    let horizontal = within_friction(friction, -speed / speed_slope, constant, slope);
    let vertical = constant + slope * horizontal;
    Velocities {
        u_dot: u_dot + horizontal,
        v_dot: v_dot + vertical,
        theta_dot: theta_dot + (x * vertical - q * horizontal) / i0,
    }
}

/// Returns the impulse with `|P_H| ≤ μ P_N` nearest to `wanted`, where `P_N = constant + slope P_H`.
fn within_friction<T: Elementary>(friction: T, wanted: T, constant: T, slope: T) -> T {
    let bound = |direction: f64| {
        let reserve = -(friction * slope * direction) + 1.0;
        if reserve.value() > 0.0 { friction * constant / reserve } else { T::from(f64::INFINITY) }
    };
    greatest(least(wanted, bound(1.0)), -bound(-1.0))
}

/// Returns the impulses per mass (m/s) and the velocities if both corners land at once. Impulses are at L and R; the corners have
/// `rates_after` (m/s).
///
/// They grip as far as friction allows. The landing is possible only if both impulses are positive or zero.
pub fn landing_on_both<T: Elementary>(
    body: &Body<T>,
    theta: T,
    before: Velocities<T>,
    rates_after: [T; 2],
) -> ([T; 2], Velocities<T>) {
    let (sin, cos) = theta.sin_cos();
    let Lever { x, q } = body.lever(Foot::Middle, sin, cos);
    let half_base = body.b * cos;
    let theta_dot = (rates_after[0] - rates_after[1]) * 0.5 / half_base;
    let v_dot = (rates_after[0] + rates_after[1]) * 0.5 - x * theta_dot;
    let sum = v_dot - before.v_dot;
    let grips = q * theta_dot;
    let u_dot = if body.friction.value() > 0.0 {
        before.u_dot + within_friction(body.friction, grips - before.u_dot, sum, T::from(0.0))
    } else {
        grips
    };
    // I0 Δθ̇ = −h cos θ ∫H + b cos θ (∫N_L − ∫N_R) + h sin θ (∫N_L + ∫N_R)
    let turn = body.i0 * (theta_dot - before.theta_dot) + q * (u_dot - before.u_dot) - x * sum;
    let difference = turn / half_base;
    ([(sum + difference) * 0.5, (sum - difference) * 0.5], Velocities { u_dot, v_dot, theta_dot })
}

/// Returns the velocities after a horizontal impulse that stops the foot of `regime`.
///
/// `θ̇_a = (I0 θ̇_b + M k u̇_b)/(I0 + M k²)`, with k the height of the centre of mass over the foot.
pub fn grip<T: Elementary>(body: &Body<T>, regime: Regime, theta: T, before: Velocities<T>) -> Velocities<T> {
    let (sin, cos) = theta.sin_cos();
    let height = body.lever(regime.foot().unwrap_or(Foot::Middle), sin, cos).q;
    let theta_dot = (body.i0 * before.theta_dot + height * before.u_dot) / (body.i0 + height * height);
    Velocities { u_dot: height * theta_dot, theta_dot, ..before }
}

/// Returns the vertical rate (m/s) of a corner after a horizontal impulse stops it. It is on the rigid base; the rate is negative if it is
/// pressed on.
///
/// `s P Q u̇_I/(i0 + Q²)` with the corner's horizontal velocity `u̇_I = u̇ − Q θ̇`.
pub fn thrown_by_grip<P: Scalar, T: CombinesWith<P>>(body: &Body<P>, corner: Corner, x: &Instant<T>) -> T {
    let (sin, cos) = x.theta.sin_cos();
    let Lever { x: across, q } = body.lever(Foot::Corner(corner), sin, cos);
    across * q * (x.u_dot - q * x.theta_dot) / (q * q + body.i0)
}

/// Returns the height of the centre of mass over the foot (m). Without eccentricity it is `R0 cos(α + sθ)` over a corner.
pub fn height_over<T: Elementary>(body: &Body<T>, foot: Foot, theta: T) -> T {
    let (sin, cos) = theta.sin_cos();
    body.lever(foot, sin, cos).q
}

/// Returns the energy per unit mass (m²/s²) lost in the landing of a corner. Its vertical velocity before is `rate` (m/s).
///
/// For a corner without horizontal motion before and after: `½ (1 − ε²) v̇_I² (I0 + M Q²)/(I0 + M R0²)` with `Q = R0 cos(α + sθ)`.
pub fn landing_loss<T: Elementary>(block: &Block<T>, corner: Corner, theta: T, rate: T) -> T {
    let Block { epsilon, body: Body { i0, .. }, .. } = *block;
    let Lever { x, q } = lever(block, corner, theta);
    let fraction = (i0 + q * q) / (i0 + q * q + x * x);
    (-(epsilon * epsilon) + 1.0) * 0.5 * rate * rate * fraction
}

/// Returns the position of the centre of mass relative to a corner.
fn lever<T: Elementary>(body: &Body<T>, corner: Corner, theta: T) -> Lever<T> {
    let (sin, cos) = theta.sin_cos();
    body.lever(Foot::Corner(corner), sin, cos)
}
