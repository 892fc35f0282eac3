//! The error of an attempted step → the size of the next one.

use serde::{Deserialize, Serialize};

/// The factor by which a step size may change, from the root of the step's error: `0.9/root` within 1/3 … 6, where the root is
/// of the order of the pair.
pub fn size_factor(root: f64) -> f64 {
    const SAFETY: f64 = 0.9;
    const LEAST: f64 = 1.0 / 3.0;
    const MOST: f64 = 6.0;
    if root.is_nan() { LEAST } else { (SAFETY / root).clamp(LEAST, MOST) }
}

/// Proposes step sizes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepControl {
    size: f64,
}

/// A step that is attempted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attempt {
    /// Its size.
    pub size: f64,
    /// Whether it leads to the stop.
    pub last: bool,
    grow: bool,
}

impl Attempt {
    /// A step of `size` that leads to the stop.
    pub fn to_stop(size: f64) -> Attempt {
        Attempt { size, last: true, grow: true }
    }
}

impl StepControl {
    /// Nothing is known yet: the first step is as long as it may be.
    pub const NEW: StepControl = StepControl { size: f64::INFINITY };

    /// The next step has this size.
    pub fn of_size(size: f64) -> StepControl {
        StepControl { size }
    }

    /// Whether a control that came from outside can be resumed.
    pub fn is_valid(&self) -> bool {
        self.size > 0.0
    }

    /// The first attempt on the way to a stop that is `remaining` away. The way is cut into equal steps of at most the
    /// proposed size and `longest`, so that a stop close ahead is not met by a tiny step.
    pub fn attempt(&self, remaining: f64, longest: f64, shortest: f64) -> Attempt {
        let steps = (remaining / self.size.min(longest).max(shortest)).ceil().max(1.0);
        Attempt { size: remaining / steps, last: steps == 1.0, grow: true }
    }

    /// Takes a step; `factor` is that of its error.
    pub fn accept(&mut self, attempt: &Attempt, factor: f64, longest: f64) {
        let proposal = if attempt.grow { attempt.size * factor } else { attempt.size * factor.min(1.0) };
        self.size = if factor < 1.0 { proposal } else { self.size.min(longest).max(proposal) };
    }

    /// Refuses a step; what is attempted instead. The step after it does not grow.
    pub fn reject(&mut self, attempt: &Attempt, factor: f64) -> Attempt {
        self.size = attempt.size * factor;
        Attempt { size: self.size, last: false, grow: false }
    }
}
