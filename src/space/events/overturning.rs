//! Overturning: the vertical component of the body's axis falls through zero. The run ends.

use crate::numerics::dual::Dual;
use crate::space::events::{ROUND_OFF, SpaceSample};
use crate::space::motion::Turn;

/// Returns the vertical component of the axis R e_z (1).
pub(super) fn sample(turn: &Turn<Dual>) -> SpaceSample {
    SpaceSample { value: -(turn.half_tilt_square() * 2.0) + 1.0, rounding: ROUND_OFF }
}
