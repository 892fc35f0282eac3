//! The step rule of single runs and of lanes: distance to the next stop and errors of the steps so far → the next step.
//!
//! Errors are in units of the allowed error: a step with an error above 1 is repeated. One [short step](crate::numerics::short) reaches a
//! stop that is near enough; all other steps are of order 8.

use serde::{Deserialize, Serialize};

use crate::numerics::Real;

/// Longest step, times the fastest circular frequency (1). It is a third of its period, so that a step has at most one extremum.
pub const LONGEST: f64 = 2.0;

/// Growth of the size up to which short steps are tried again after a rejection. The motion may have become slower.
const SHORT_GROWTH: f64 = 1.1;

/// Smallest factor on the size of a short step after one was rejected.
const MIN_SHORT_FACTOR: f64 = 0.1;

/// Returns the factor on the step size: `0.9/root` within 1/3 … 6. For a pair of order q, `root` is the q-th root of the step's error.
pub fn size_factor(root: f64) -> f64 {
    const SAFETY: f64 = 0.9;
    const MIN: f64 = 1.0 / 3.0;
    const MAX: f64 = 6.0;
    if root.is_nan() { MIN } else { (SAFETY / root).clamp(MIN, MAX) }
}

/// Returns the eighth root of an error. Square roots are rounded alike everywhere; powers are not.
#[inline(always)]
pub fn eighth_root<R: Real>(error: R) -> R {
    error.sqrt().sqrt().sqrt()
}

/// Returns the factor on the size of a short step with this error. Two square roots make the fourth root, which stands in for the fifth.
#[inline(always)]
pub fn short_factor<R: Real>(error: R) -> R {
    R::from(1.0) / error.sqrt().sqrt()
}

/// Returns the shortest useful step: the clock's resolution after at most the longest step from `time`, wherever the stop is.
pub fn shortest(time: f64, longest: f64) -> f64 {
    (f64::EPSILON * time.abs().max(longest)).max(f64::MIN_POSITIVE)
}

/// Whether the clock resolves steps of `longest` at `time`.
pub fn is_resolved(time: f64, longest: f64) -> bool {
    f64::EPSILON * time.abs() < longest
}

/// Returns the least value at an end, over a peak, with a new peak inside.
///
/// In a step h an oscillation of amplitude A and circular frequency ω rises by at most A (ωh)²/8 above its ends. The margin is eight
/// times larger, since the value may be a sum of larger ones, and at most half, the rise of a sinusoid in the longest step.
#[inline(always)]
pub fn near_a_peak<R: Real>(elapsed: R, longest: R) -> R {
    let phase = elapsed * LONGEST / longest;
    let (fraction, half) = (R::from(1.0) - phase * phase, R::from(0.5));
    R::select_less(fraction, half, half, fraction)
}

/// Proposes step sizes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepControl {
    size: f64,
    short_size: f64,
}

/// An attempted step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attempt {
    /// Its size.
    pub size: f64,
    /// Whether it ends at the stop.
    pub last: bool,
    grow: bool,
    /// Whether only rejected steps prevented a short step. Longer ones are then tried later.
    grow_short: bool,
}

impl Attempt {
    /// Returns a step of `size` that ends at the stop.
    pub fn to_stop(size: f64) -> Attempt {
        Attempt { size, last: true, grow: true, grow_short: false }
    }

    /// Returns the attempt after this answer about a short step.
    pub fn instead_of(self, short: ShortStepTo) -> Attempt {
        Attempt { grow_short: short == ShortStepTo::NotYet, ..self }
    }
}

/// Whether a short step may end at the stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShortStepTo {
    /// A short step ends at the stop.
    Stop,
    /// The stop is near enough, but shorter steps were rejected.
    NotYet,
    /// The stop is too far away.
    TooFar,
}

impl StepControl {
    /// Control before the first step, which has the longest size.
    pub const NEW: StepControl = StepControl { size: f64::INFINITY, short_size: f64::INFINITY };

    /// Whether a deserialized control can be resumed.
    pub fn is_valid(&self) -> bool {
        self.size > 0.0 && self.short_size > 0.0
    }

    /// Whether a short step may end at a stop `remaining` ahead.
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

    /// Records a rejected short step of `size`; `factor` is the [`short_factor`] of its error.
    #[inline]
    pub fn reject_short(&mut self, size: f64, factor: f64) {
        self.short_size = size * factor.max(MIN_SHORT_FACTOR);
    }

    /// Returns the first attempt towards a stop `remaining` ahead. The distance is divided into equal steps of at most the proposed size
    /// and `longest`, so that no tiny step is left before the stop.
    pub fn attempt(&self, remaining: f64, longest: f64, shortest: f64) -> Attempt {
        let steps = (remaining / self.size.min(longest).max(shortest)).ceil().max(1.0);
        Attempt { size: remaining / steps, last: steps == 1.0, grow: true, grow_short: false }
    }

    /// Records an accepted step; `factor` is the [`size_factor`] of its error.
    pub fn accept(&mut self, attempt: &Attempt, factor: f64, longest: f64) {
        let proposal = if attempt.grow { attempt.size * factor } else { attempt.size * factor.min(1.0) };
        self.size = if factor < 1.0 { proposal } else { self.size.min(longest).max(proposal) };
        if attempt.grow_short {
            self.short_size *= SHORT_GROWTH;
        }
    }

    /// Records a rejected step and returns the next attempt. The size does not grow after it.
    pub fn reject(&mut self, attempt: &Attempt, factor: f64) -> Attempt {
        self.size = attempt.size * factor;
        Attempt { size: self.size, last: false, grow: false, ..*attempt }
    }

    /// Sets the size of the next step, regardless of earlier errors.
    pub fn restart(&mut self, size: f64) {
        self.size = size;
    }
}
