//! The quarter turn: a side of the block lies on the ground.

use std::f64::consts::FRAC_PI_2;

use crate::numerics::Scalar;
use crate::numerics::dual::Dual;

/// Size of the function (rad).
pub(crate) const SIZE: f64 = FRAC_PI_2;

/// Returns the remaining angle to a quarter turn, `π/2 − |θ|` (rad), and its rate (rad/s).
#[inline(always)]
pub fn remaining_angle<R: Scalar>([theta, theta_dot]: [R; 2]) -> Dual<R> {
    let (side, zero) = (theta.value(), R::Real::default());
    Dual::new(-R::select_less(side, zero, -theta, theta) + FRAC_PI_2, R::select_less(side, zero, theta_dot, -theta_dot))
}
