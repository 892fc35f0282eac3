//! Numerical methods, independent of blocks.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`scalar`] | the operations of a number in formulas: plain, one per lane, or dual |
//! | [`dual`] | a number with its derivative |
//! | `gradient` | a number with its derivatives in several directions |
//! | `numbers` | vectors of numbers, such as states, and their operations |
//! | [`dop853`] | a right-hand side and a step → the state a step later, its error, and the motion inside |
//! | [`stepper`] | the same for a state whose dimension is known at run time |
//! | [`short`] | a step of order 5 to a stop close ahead, with fewer evaluations |
//! | `repeat` | an accepted step → its end in other numbers, such as those with derivatives |
//! | [`control`] | the error of a step → the size of the next |
//! | [`roots`] | a function over a step → its first fall through zero, its greatest value |
//! | `bernstein` | the coefficients of a polynomial → its bounds, first zero and greatest value on [0, 1] |
//! | `wide` | several numbers side by side → the same operations on each, by the processor's vectors |

pub(crate) mod bernstein;
mod coefficients;
pub mod control;
pub mod dop853;
pub mod dual;
pub(crate) mod gradient;
pub(crate) mod numbers;
#[cfg(any(test, feature = "lanes"))]
pub(crate) mod repeat;
pub mod roots;
pub mod scalar;
pub mod short;
pub mod stepper;
#[cfg(test)]
mod tests;
#[cfg(feature = "lanes")]
pub mod wide;

pub use scalar::{Real, Scalar};

use std::ops::{Add, Mul};

use numbers::Numbers;

/// The state of a second-order system: `[x, ẋ, y, ẏ, …]`.
pub type State<R = f64, const N: usize = 4> = Numbers<R, N>;

/// Quantities integrated beside the state without feedback on it: rates, or integrals.
pub type Quadratures<R = f64> = Numbers<R, 2>;

/// The result of a right-hand side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rate<R: Scalar = f64, const N: usize = 4> {
    /// Rate of the state.
    pub state: State<R, N>,
    /// Rates of the quadratures.
    pub quadratures: Quadratures<R>,
}

/// Rates at the stages of a step; the first stage is its beginning.
#[derive(Clone, Copy, Debug)]
pub struct StageRates<R: Scalar, const N: usize, const STAGES: usize = 12> {
    /// Rates of the state.
    pub states: [State<R, N>; STAGES],
    /// Rates of the quadratures.
    pub quadratures: [Quadratures<R>; STAGES],
}

impl<R: Scalar, const N: usize, const STAGES: usize> StageRates<R, N, STAGES> {
    /// Rates with this first stage, which also fills the other stages.
    #[inline(always)]
    pub fn beginning_with(first: Rate<R, N>) -> Self {
        StageRates { states: [first.state; STAGES], quadratures: [first.quadratures; STAGES] }
    }
}

/// A right-hand side.
///
/// It is inlined into each stage of a step, so that its result stays in registers. A call would store it in memory number by number, and
/// the sums over stages, which load pairs of numbers, would stall on it.
pub trait Equations<R: Scalar = f64, const N: usize = 4> {
    /// Returns the rate of a state at a time (s).
    fn rate(&self, time: R, state: &State<R, N>) -> Rate<R, N>;
}

/// A state or rate; the methods form weighted sums of it.
pub trait LinearSpace: Copy + Add<Output = Self> + Mul<f64, Output = Self> {}

impl<S: Copy + Add<Output = S> + Mul<f64, Output = S>> LinearSpace for S {}

/// A right-hand side that may look up a precomputed excitation by the stage. Stages count from 1.
pub trait Stages<R: Scalar = f64, const N: usize = 4> {
    /// Returns the rate of a state at the time (s) of a stage.
    fn rate_at(&self, stage: usize, time: R, state: &State<R, N>) -> Rate<R, N>;
}

impl<R: Scalar, const N: usize, E: Equations<R, N>> Stages<R, N> for E {
    #[inline(always)]
    fn rate_at(&self, _stage: usize, time: R, state: &State<R, N>) -> Rate<R, N> {
        self.rate(time, state)
    }
}

impl<F: Fn(f64, &State) -> Rate> Equations for F {
    #[inline(always)]
    fn rate(&self, time: f64, state: &State) -> Rate {
        self(time, state)
    }
}
