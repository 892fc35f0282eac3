//! The step rule: the way to a stop, and the errors of the steps so far → the next step. Single runs and lanes share it.
//!
//! Errors are in units of the allowed error: a step of an error above 1 is repeated. A stop that is near enough is reached by one
//! [short step](crate::numerics::short); all others are of order 8.

use serde::{Deserialize, Serialize};

use crate::numerics::Real;

/// The longest step over the reciprocal of the fastest circular frequency: a third of its period, so that a step holds at most one
/// extremum.
pub const LONGEST: f64 = 2.0;

/// The growth of the short step that is tried next where one failed before: the motion may have become slower.
const SHORT_GROWTH: f64 = 1.1;

/// The least part of the size of a short step that failed by its error which the next one has.
const LEAST_SHORT_FACTOR: f64 = 0.1;

/// The factor by which a step size may change, from the root of the step's error: `0.9/root` within 1/3 … 6, where the root is
/// of the order of the pair.
pub fn size_factor(root: f64) -> f64 {
    const SAFETY: f64 = 0.9;
    const LEAST: f64 = 1.0 / 3.0;
    const MOST: f64 = 6.0;
    if root.is_nan() { LEAST } else { (SAFETY / root).clamp(LEAST, MOST) }
}

/// The root of an error of order 8. Square roots are rounded alike everywhere, which a power is not.
#[inline(always)]
pub fn eighth_root<R: Real>(error: R) -> R {
    error.sqrt().sqrt().sqrt()
}

/// The factor by which the size of a short step of this error may change. The root of order 4 is two square roots, and less than
/// that of order 5.
#[inline(always)]
pub fn short_factor<R: Real>(error: R) -> R {
    R::from(1.0) / error.sqrt().sqrt()
}

/// The shortest step on the way from `time` to `stop`, by the resolution of the clock. Near time zero the clock resolves far less,
/// but such steps lead nowhere.
pub fn shortest(time: f64, stop: f64) -> f64 {
    (f64::EPSILON * time.abs().max(stop.abs())).max(f64::MIN_POSITIVE)
}

/// Whether steps of at most `longest` lead to a stop that is `remaining` away, by the resolution of the clock there.
pub fn is_resolved(remaining: f64, longest: f64) -> bool {
    f64::EPSILON * remaining < longest
}

/// The part of a peak that a value at one end of a step reaches if it may grow above the peak inside.
///
/// In a step of h at a circular frequency ω an oscillation of amplitude A rises by at most A (ωh)²/8 above its ends; this
/// is eight times as much, since the value may be a sum of larger ones, and at least half, since that is all
/// that a sinusoid rises in the longest step.
#[inline(always)]
pub fn near_a_peak<R: Real>(elapsed: R, longest: R) -> R {
    let phase = elapsed * LONGEST / longest;
    let (part, half) = (R::from(1.0) - phase * phase, R::from(0.5));
    R::select_less(part, half, half, part)
}

/// Proposes step sizes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepControl {
    size: f64,
    short_size: f64,
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

/// Whether a short step leads to the stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShortStepTo {
    /// It does.
    Stop,
    /// It would, but shorter ones have failed: [`StepControl::grow_short`].
    NotYet,
    /// The stop is too far away.
    TooFar,
}

impl StepControl {
    /// Nothing is known yet: the first step is as long as it may be.
    pub const NEW: StepControl = StepControl { size: f64::INFINITY, short_size: f64::INFINITY };

    /// Whether a control that came from outside can be resumed.
    pub fn is_valid(&self) -> bool {
        self.size > 0.0 && self.short_size > 0.0
    }

    /// Whether a short step leads to a stop that is `remaining` away.
    #[inline]
    pub fn short_step(&self, remaining: f64, longest: f64) -> ShortStepTo {
        if LONGEST * remaining > longest {
            ShortStepTo::TooFar
        } else if remaining > self.short_size {
            ShortStepTo::NotYet
        } else {
            ShortStepTo::Stop
        }
    }

    /// Tries a longer short step before long.
    #[inline]
    pub fn grow_short(&mut self) {
        self.short_size *= SHORT_GROWTH;
    }

    /// Refuses a short step of `size` for its error, whose [`short_factor`] is `factor`.
    #[inline]
    pub fn reject_short(&mut self, size: f64, factor: f64) {
        self.short_size = size * factor.max(LEAST_SHORT_FACTOR);
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

    /// Refuses a step and returns the next attempt. The step after it does not grow.
    pub fn reject(&mut self, attempt: &Attempt, factor: f64) -> Attempt {
        self.size = attempt.size * factor;
        Attempt { size: self.size, last: false, grow: false }
    }

    /// The next step has this size, whatever the errors were.
    pub fn restart(&mut self, size: f64) {
        self.size = size;
    }
}
