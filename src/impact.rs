//! Velocities before a corner lands while the other stands → velocities after.

use crate::block::Block;
use crate::regime::Corner;

/// `(v̇, θ̇)` of the centre of mass and of the rotation right after the landing of `corner` at the rotation `theta`,
/// from those right before; eqs. (14)–(19) with the sign of J12 corrected, and their mirror image (28).
///
/// Linear and angular momentum change by the impulses of H and N at the landing corner only, the corner's vertical
/// velocity by the factor ε, and the horizontal constraint from the standing corner to the middle of the base.
/// (m/s), (rad/s) positive clockwise.
pub fn landing(block: &Block, corner: Corner, theta: f64, v_dot: f64, theta_dot: f64) -> (f64, f64) {
    let Block { i0, epsilon, b, h, .. } = *block;
    // The mirror image of a landing on R is one on L: θ and θ̇ change sign.
    let s = corner.sign();
    let (sin, cos) = libm::sincos(s * theta);
    // R0 sin(α+θ), R0 cos(α+θ), R0 cos(α−θ) on L.
    let reach = b * cos + h * sin;
    let height = h * cos - b * sin;
    let height_before = h * cos + b * sin;
    // A, B, P of the paper, each times R0².
    let a = h * cos * height;
    let big_b = reach * reach;
    let p = height_before * height;
    let d = i0 + a + big_b;
    let j11 = (epsilon * (i0 + a) + big_b) / d;
    let j12 = ((epsilon - 1.0) * i0 + epsilon * a - p) * reach / d;
    let j21 = (epsilon - 1.0) * reach / d;
    let j22 = (i0 + epsilon * big_b + p) / d;
    (j11 * v_dot + s * j12 * theta_dot, s * j21 * v_dot + j22 * theta_dot)
}

/// v̇ of a corner from v̇ of the centre of mass and θ̇ [m/s]: `v̇_I = v̇ + s R0 sin(α + sθ) θ̇`.
pub fn corner_rate(block: &Block, corner: Corner, theta: f64, v_dot: f64, theta_dot: f64) -> f64 {
    let (sin, cos) = libm::sincos(theta);
    let s = corner.sign();
    v_dot + s * (block.b * cos + s * block.h * sin) * theta_dot
}

/// θ̇ after the other corner's lift-off from full contact (rad/s), if the angular momentum about the `pivot` that is
/// left is kept while v̇ is: the middle of the base moves no more without friction, the pivot does.
///
/// `(I0 + M Q²) θ̇_a = (I0 + M Q h cos θ) θ̇_b` with `Q = R0 cos(α + sθ)`.
pub fn new_pivot(block: &Block, pivot: Corner, theta: f64, theta_dot: f64) -> f64 {
    let Block { i0, b, h, .. } = *block;
    let (sin, cos) = libm::sincos(theta);
    let height = h * cos - pivot.sign() * b * sin;
    (i0 + height * h * cos) / (i0 + height * height) * theta_dot
}
