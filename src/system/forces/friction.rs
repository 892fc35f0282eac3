//! Coulomb friction on a sliding foot.

use crate::block::Body;
use crate::numerics::scalar::{CombinesWith, Scalar};

/// Returns the horizontal reaction H/M (m/s²), `H = −σ μ N`, against the `direction` σ of sliding. The direction is +1 to the right, −1 to the left.
///
/// `normal` is the vertical reaction N/M (m/s²).
#[inline(always)]
pub fn reaction<P: Scalar, T: CombinesWith<P>>(body: &Body<P>, direction: f64, normal: T) -> T {
    normal * (body.friction * -direction)
}

/// Returns the power per mass dissipated by friction (m²/s³). The foot has this `rate` (m/s).
#[inline(always)]
pub fn power<T: Scalar>(horizontal: T, rate: T) -> T {
    -(horizontal * rate)
}
