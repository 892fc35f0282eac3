//! The weight.

use crate::block::Body;
use crate::numerics::scalar::{CombinesWith, Scalar};

/// Returns the potential energy per mass (m²/s²) at the height `v` above rest (m).
pub fn energy<P: Scalar, T: CombinesWith<P>>(body: &Body<P>, v: T) -> T {
    v * body.gravity
}
