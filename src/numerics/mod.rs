//! Numerical methods; they know nothing of blocks.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`dop853`] | a right-hand side and a step → the state a step later, its error, and the motion inside |
//! | [`short`] | the same of order 5, to a stop close ahead, with fewer evaluations |
//! | [`control`] | the error of a step → the size of the next |
//! | [`numbers`] | what steps are made of: the components of a state, and operations on all of them |
//! | [`roots`] | a function over a step → its first fall through zero, its greatest value |
//! | [`wide`] | several numbers side by side → the same operations on each, by the processor's vectors |

mod coefficients;
pub mod control;
pub mod dop853;
pub mod numbers;
pub mod roots;
pub mod short;
#[cfg(feature = "studies")]
pub mod wide;

use std::ops::{Add, Div, Mul, Sub};

use numbers::Numbers;

/// The state of a system with four degrees, second-order in two of them: `[x, ẋ, y, ẏ]`.
pub type State<R = f64> = Numbers<R, 4>;

/// What is integrated along with the state and does not act back on it: its rates, or their integrals.
pub type Quadratures<R = f64> = Numbers<R, 2>;

/// The numbers that steps are made of: `f64`, or several of them side by side.
pub trait Real:
    Copy
    + Default
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Mul<f64, Output = Self>
{
    /// The square root.
    fn sqrt(self) -> Self;

    /// `yes` where `a < b`, `no` elsewhere.
    fn where_less(a: Self, b: Self, yes: Self, no: Self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn sqrt(self) -> f64 {
        self.sqrt()
    }

    #[inline(always)]
    fn where_less(a: f64, b: f64, yes: f64, no: f64) -> f64 {
        if a < b { yes } else { no }
    }
}

/// What a right-hand side gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rate<R: Real = f64> {
    /// Rate of the state.
    pub state: State<R>,
    /// Rates of what is integrated along.
    pub quadratures: Quadratures<R>,
}

/// A right-hand side.
///
/// Steps are one piece of machine code with it, inlined into each of their stages: its result is in registers then. A
/// function would leave it in memory number by number, where the sums over stages, which load pairs of numbers, have to wait
/// for it.
pub trait Equations<R: Real = f64> {
    /// Rate of a state at a time (s).
    fn rate(&self, time: R, state: &State<R>) -> Rate<R>;
}

impl<F: Fn(f64, &State) -> Rate> Equations for F {
    #[inline(always)]
    fn rate(&self, time: f64, state: &State) -> Rate {
        self(time, state)
    }
}
