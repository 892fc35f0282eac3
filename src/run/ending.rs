//! The ways in which a run, or a call, ends.

use serde::{Deserialize, Serialize};

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ending {
    /// The last touching corner lifted from a block that may still come down.
    Separated,
    /// The last touching corner lifted from a block on its way over: separated and overturned. There |θ| ≥ α and θ θ̇ > 0. On supports a
    /// block that topples leaves them before it lies on its side.
    Toppled,
    /// The block reached a quarter turn.
    Overturned,
}

impl Ending {
    /// Returns the ending of a run whose block leaves its last support. It does so at the rotation θ (rad) and the rate θ̇ (rad/s); `alpha`
    /// (rad) is the slenderness angle of the side to which it tilts. docs/unit/model.md gives the rate of misjudged runs.
    pub fn at_separation(alpha: f64, theta: f64, theta_dot: f64) -> Ending {
        if theta.abs() >= alpha && theta * theta_dot > 0.0 { Ending::Toppled } else { Ending::Separated }
    }

    /// Whether the block left its supports.
    pub fn is_separation(self) -> bool {
        match self {
            Ending::Separated | Ending::Toppled => true,
            Ending::Overturned => false,
        }
    }

    /// Whether the block overturned or is bound to.
    pub fn is_overturning(self) -> bool {
        match self {
            Ending::Overturned | Ending::Toppled => true,
            Ending::Separated => false,
        }
    }
}

impl std::fmt::Display for Ending {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Ending::Separated => "complete separation",
            Ending::Toppled => "overturning, with complete separation",
            Ending::Overturned => "overturning",
        })
    }
}

/// The result of a call that advances a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// The requested time was reached.
    Reached,
    /// The run ended earlier, at this time (s).
    Ended(Ending, f64),
}

/// A run that cannot go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// The step size fell below the resolution of time.
    #[error(
        "the step size fell to {size:e} s at t = {time} s; expected a tolerance above {tolerance:e}, which cannot be met there"
    )]
    StepTooSmall {
        /// Time (s).
        time: f64,
        /// Step size (s).
        size: f64,
        /// The tolerance asked for.
        tolerance: f64,
    },
    /// The motion overflowed.
    #[error(
        "the motion is not finite after t = {time} s; expected ground accelerations and loads in proportion to the block"
    )]
    NotFinite {
        /// Time of the last good state (s).
        time: f64,
    },
    /// The motion takes more steps than any reasonable call, or the clock does not resolve them.
    #[error(
        "stopped at t = {time} s after {steps} steps towards t = {until} s; expected a shorter step, or a slower motion than that of {fastest}"
    )]
    TooManySteps {
        /// Time that was reached (s).
        time: f64,
        /// Requested time (s), or an earlier kink of the excitation.
        until: f64,
        /// Number of steps taken.
        steps: u64,
        /// The number of the block that makes its motion fastest, with the rate.
        fastest: String,
    },
    /// The regime changed again and again at one time.
    #[error("found {count} events in the instant t = {time} s; expected a regime that lasts after them")]
    NoRegime {
        /// Time (s).
        time: f64,
        /// Events so far in that instant.
        count: u32,
    },
}
