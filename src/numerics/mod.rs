//! Numerical methods; they know nothing of blocks.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`dop853`] | a right-hand side and a step → the state a step later, its error, and the motion inside |
//! | [`short`] | the same of order 5, to a stop close ahead, with fewer evaluations |
//! | [`control`] | the error of a step → the size of the next |
//! | [`roots`] | a function over a step → its first fall through zero, its greatest value |
//! | [`wide`] | several numbers side by side → the same operations on each, by the processor's vectors |

mod coefficients;
pub mod control;
pub mod dop853;
pub mod roots;
pub mod short;
#[cfg(feature = "studies")]
pub mod wide;

use std::ops::{Add, Div, Mul, Sub};

use nalgebra::SVector;

/// The state of a system with four degrees, second-order in two of them: `[x, ẋ, y, ẏ]`.
pub type State = SVector<f64, 4>;

/// What is integrated along with the state and does not act back on it: its rates, or their integrals.
pub type Quadratures = SVector<f64, 2>;

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
    /// The state of a system, as [`State`].
    type State: Vector<Self>;
    /// What is integrated along, as [`Quadratures`].
    type Quadratures: Vector<Self>;

    /// The square root.
    fn sqrt(self) -> Self;

    /// `yes` where `a < b`, `no` elsewhere.
    fn where_less(a: Self, b: Self, yes: Self, no: Self) -> Self;
}

/// Numbers that are integrated together.
pub trait Vector<R>: Copy + Add<Output = Self> + Mul<f64, Output = Self> + Mul<R, Output = Self> {
    /// All components zero.
    fn zero() -> Self;

    /// Each component times that of `weights`.
    fn weighted(self, weights: Self) -> Self;

    /// Sum of the squares of the components.
    fn square(self) -> R;

    /// Of two vectors `[x, ẋ, y, ẏ]` one with the velocities of the first in the places of displacements, and those of the second.
    fn of_second_order(displacements: Self, velocities: Self) -> Self;
}

impl Real for f64 {
    type State = State;
    type Quadratures = Quadratures;

    #[inline(always)]
    fn sqrt(self) -> f64 {
        self.sqrt()
    }

    #[inline(always)]
    fn where_less(a: f64, b: f64, yes: f64, no: f64) -> f64 {
        if a < b { yes } else { no }
    }
}

impl<const N: usize> Vector<f64> for SVector<f64, N> {
    #[inline(always)]
    fn zero() -> Self {
        SVector::zeros()
    }

    #[inline(always)]
    fn weighted(self, weights: Self) -> Self {
        self.component_mul(&weights)
    }

    #[inline(always)]
    fn square(self) -> f64 {
        self.norm_squared()
    }

    #[inline(always)]
    fn of_second_order(displacements: Self, velocities: Self) -> Self {
        Self::from_fn(|i, _| if i % 2 == 0 { displacements[i + 1] } else { velocities[i] })
    }
}

/// What a right-hand side gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rate<R: Real = f64> {
    /// Rate of the state.
    pub state: R::State,
    /// Rates of what is integrated along.
    pub quadratures: R::Quadratures,
}

/// A right-hand side.
///
/// Steps are one piece of machine code with it, inlined into each of their stages: its result is in registers then. A
/// function would leave it in memory number by number, where the sums over stages, which load pairs of numbers, have to wait
/// for it.
pub trait Equations<R: Real = f64> {
    /// Rate of a state at a time (s).
    fn rate(&self, time: R, state: &R::State) -> Rate<R>;
}

impl<F: Fn(f64, &State) -> Rate> Equations for F {
    #[inline(always)]
    fn rate(&self, time: f64, state: &State) -> Rate {
        self(time, state)
    }
}
