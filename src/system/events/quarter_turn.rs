//! The quarter turn: a side of the block lies on the ground.

use std::f64::consts::FRAC_PI_2;

use crate::numerics::Real;
use crate::numerics::roots::Sample;
use crate::system::instant::Instant;

/// Size of the function (rad).
pub(crate) const SIZE: f64 = FRAC_PI_2;

/// The rest of the quarter turn, `π/2 − |θ|` (rad).
#[inline(always)]
pub fn rest<R: Real>(x: &Instant<R>) -> Sample<R> {
    Sample { value: -x.theta.abs() + FRAC_PI_2, rate: R::select_less(x.theta, R::default(), x.theta_dot, -x.theta_dot) }
}
