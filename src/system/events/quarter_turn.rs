//! The quarter turn: a side of the block lies on the ground.

use std::f64::consts::FRAC_PI_2;

use crate::numerics::Scalar;
use crate::numerics::roots::Sample;
use crate::system::instant::Instant;

/// Size of the function (rad).
pub(crate) const SIZE: f64 = FRAC_PI_2;

/// The rest of the quarter turn, `π/2 − |θ|` (rad).
#[inline(always)]
pub fn rest<R: Scalar>(x: &Instant<R>) -> Sample<R> {
    let (theta, zero) = (x.theta.value(), R::Real::default());
    Sample {
        value: -R::select_less(theta, zero, -x.theta, x.theta) + FRAC_PI_2,
        rate: R::select_less(theta, zero, x.theta_dot, -x.theta_dot),
    }
}
