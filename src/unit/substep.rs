//! A part of a communication step, over which inputs are linear in time.

use serde::{Deserialize, Serialize};

use crate::excitation::Inputs;
use crate::unit::values::{PerInput, ramp};
use crate::unit::variables::Input;

/// A part of a communication step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Substep {
    /// Its end (s).
    pub end: f64,
    /// The inputs over it.
    pub over: Inputs,
    /// The inputs at its end.
    pub at_end: PerInput,
}

impl Substep {
    /// Whether all numbers are finite.
    pub fn is_valid(&self) -> bool {
        let ramps = Input::ALL.into_iter().map(|input| ramp(&self.over, input));
        let ramps = ramps.flat_map(|ramp| [ramp.value, ramp.rate]);
        [self.end, self.over.time].into_iter().chain(ramps).chain(self.at_end).all(f64::is_finite)
    }
}
