//! The smooth piece in which an outside solver is, and the event foreseen in it.

use serde::{Deserialize, Serialize};

use crate::excitation::Inputs;
use crate::simulation::peaks::Peaks;
use crate::system::events::{EventFunction, INDICATORS};
use crate::system::instant::Pose;

/// The present smooth piece of a motion that is stepped from outside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::simulation) struct ExchangePiece {
    /// Beginning of the piece (s). At its end the excitation is still that of the piece.
    pub(super) since: f64,
    /// Rounding added to each indicator, so that zero at the beginning is no event.
    pub(super) offsets: [f64; INDICATORS],
    /// The block after the last completed step, or right after a later event.
    pub(in crate::simulation) last: Option<Pose>,
    /// The next event, if it is known.
    pub(in crate::simulation) foreseen: Option<Foreseen>,
}

impl ExchangePiece {
    /// Whether all numbers are finite.
    pub(in crate::simulation) fn is_finite(&self) -> bool {
        let last = self.last.is_none_or(|pose| pose.is_finite());
        let foreseen = self.foreseen.is_none_or(|foreseen| foreseen.is_valid());
        last && foreseen && self.since.is_finite() && self.offsets.iter().all(|offset| offset.is_finite())
    }
}

/// A predicted event, too near for a solver to resolve the motion before: of rocking that dies out, or of bounces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::simulation) struct Foreseen {
    /// The block right before the event.
    pub pose: Pose,
    /// The event function that reaches zero.
    pub function: EventFunction,
    /// The greatest values until then.
    pub peaks: Peaks,
    /// The inputs that lead there.
    pub inputs: Inputs,
}

impl Foreseen {
    /// Whether all numbers are finite, and no peak is negative.
    fn is_valid(&self) -> bool {
        self.pose.is_finite() && self.peaks.is_valid() && self.inputs.is_finite()
    }
}
