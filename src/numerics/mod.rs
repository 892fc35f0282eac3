//! Numerical methods; they know nothing of blocks.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`dop853`] | a right-hand side and a step → the state a step later, its error, and the motion inside |
//! | [`short`] | the same of order 5, to a stop close ahead, without the motion inside |
//! | [`control`] | the error of a step → the size of the next |
//! | [`roots`] | a function over a step → its first fall through zero, its greatest value |

mod coefficients;
pub mod control;
pub mod dop853;
pub mod roots;
pub mod short;

use nalgebra::SVector;

/// The state of a system with four degrees, second-order in two of them: `[x, ẋ, y, ẏ]`.
pub type State = SVector<f64, 4>;

/// What is integrated along with the state and does not act back on it: its rates, or their integrals.
pub type Quadratures = SVector<f64, 2>;

/// What a right-hand side gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rate {
    /// Rate of the state.
    pub state: State,
    /// Rates of what is integrated along.
    pub quadratures: Quadratures,
}

/// A right-hand side.
///
/// Steps are one piece of machine code with it, inlined into each of their stages: its result is in registers then. A
/// function would leave it in memory number by number, where the sums over stages, which load pairs of numbers, have to wait
/// for it.
pub trait Equations {
    /// Rate of a state at a time (s).
    fn rate(&self, time: f64, state: &State) -> Rate;
}

impl<F: Fn(f64, &State) -> Rate> Equations for F {
    #[inline(always)]
    fn rate(&self, time: f64, state: &State) -> Rate {
        self(time, state)
    }
}
