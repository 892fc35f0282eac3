//! An accepted step → the state at its end in other numbers, such as those with derivatives.

use crate::numerics::coefficients::{NODES, SHORT_NODES, combine, increment, short_increment};
use crate::numerics::dop853::{self, DENSE_STAGES};
use crate::numerics::{LinearSpace, short};

/// A right-hand side without the quadratures.
pub trait StateRate<S> {
    /// Returns the rate of a state at a time (s).
    fn state_rate(&self, time: f64, state: &S) -> S;
}

/// The form of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepForm {
    /// A [`short`] step.
    Short,
    /// A step of order 8.
    Long,
    /// A step of order 8 with the stages of its dense output.
    Dense,
}

/// Repeats a step from `start`. Returns the state at its end, with the bits of the original step, and the stages.
///
/// All forms share a loop, so that the right-hand side is compiled once.
#[inline(always)]
pub fn repeat_step<S: LinearSpace>(
    form: StepForm,
    [time, size]: [f64; 2],
    start: S,
    equations: &(impl StateRate<S> + ?Sized),
) -> (S, [S; DENSE_STAGES]) {
    let (mut k, mut end) = ([start; DENSE_STAGES], start);
    let mut stage = 0;
    loop {
        let state = match (form, stage) {
            (_, 0) => start,
            (StepForm::Short, short::STAGES..) => return (start + short_increment!(k, 6) * size, k),
            (StepForm::Short, _) => start + short::increment(&k, stage) * size,
            (_, dop853::STAGES) => {
                end = start + increment!(k, 12) * size;
                if form == StepForm::Long {
                    return (end, k);
                }
                end
            }
            (_, 13) => start + increment!(k, 13) * size,
            (_, 14) => start + increment!(k, 14) * size,
            (_, 15) => start + increment!(k, 15) * size,
            (_, DENSE_STAGES..) => return (end, k),
            (_, _) => start + dop853::increment(&k, stage) * size,
        };
        let node = if form == StepForm::Short { SHORT_NODES[stage] } else { NODES[stage] };
        k[stage] = equations.state_rate(time + size * node, &state);
        stage += 1;
    }
}
