//! What a run that is stepped from outside knows of it: the present piece of the excitation, and the places of its states and indicators.

use serde::{Deserialize, Serialize};

use crate::space::events::PER_CONTACT;
use crate::space::motion::{FEET_FROM, PER_FOOT, WORKS, moving};

/// The smooth piece of the excitation in which an outside solver is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpacePiece {
    /// Its beginning (s). At its end the excitation is still that of the piece.
    pub(super) since: f64,
    /// The time (s) of the last completed step, or of a later event, and the numbers of the state there.
    pub(super) last: (f64, Vec<f64>),
}

impl SpacePiece {
    /// Returns all its numbers.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        [self.since, self.last.0].into_iter().chain(self.last.1.iter().copied())
    }
}

/// Returns the number of event indicators of a block with n feet: the contacts of all feet, their friction, and the overturning.
pub const fn indicator_count(feet: usize) -> usize {
    PER_CONTACT * feet + 1
}

/// Place among the continuous states of the first quantity of the feet, which follows the works.
pub const OF_FEET: usize = FEET_FROM + WORKS;

/// Returns the place among the continuous states of a number of the state. Outside, works follow the body, and a quantity of all feet
/// follows another.
pub const fn place(number: usize, feet: usize) -> usize {
    if number < FEET_FROM || number >= moving(feet) + WORKS {
        number
    } else if number < moving(feet) {
        let of_feet = number - FEET_FROM;
        OF_FEET + (of_feet % PER_FOOT) * feet + of_feet / PER_FOOT
    } else {
        number - moving(feet) + FEET_FROM
    }
}
