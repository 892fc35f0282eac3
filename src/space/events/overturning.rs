//! Overturning: the vertical component of the body's axis falls through zero. The run ends.

use crate::numerics::dual::Dual;
use crate::space::events::ROUND_OFF;
use crate::space::motion::Turn;

/// Returns the vertical component of the axis R e_z (1) and its round-off.
pub(super) fn sample(turn: &Turn<Dual>) -> (Dual, f64) {
    (turn.axis().z, ROUND_OFF)
}
