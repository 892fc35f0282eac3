//! Coulomb friction on a foot that slides.

use crate::block::Block;
use crate::numerics::scalar::{CombinesWith, Scalar};

/// Horizontal reaction H/M (m/s²) on a foot that slides in a direction (+1 to the right, −1 to the left) under the vertical reaction
/// `normal` N/M (m/s²): it acts against the direction.
#[inline(always)]
pub fn reaction<P: Scalar, T: CombinesWith<P>>(block: &Block<P>, direction: f64, normal: T) -> T {
    normal * (block.friction * -direction)
}

/// Power per mass (m²/s³) that friction takes from a foot that slides at `rate` (m/s).
#[inline(always)]
pub fn power<T: Scalar>(horizontal: T, rate: T) -> T {
    -(horizontal * rate)
}
