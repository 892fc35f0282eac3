//! A step of order 5 to a stop close ahead, without dense output: its ends bound the motion inside.

use crate::numerics::coefficients::{SHORT_NODES, combine, short_difference, short_end_difference, short_increment};
use crate::numerics::{Equations, LinearSpace, Quadratures, Rate, Real, Scalar, StageRates, Stages, State};

/// Evaluations of the right-hand side in a short step, without those at its ends.
pub const EVALUATIONS_PER_SHORT_STEP: u64 = 5;

/// Number of stages, with the one at the beginning of the step.
pub const STAGES: usize = 6;

/// Returns the time of a stage.
#[inline(always)]
pub fn stage_time<R: Scalar>(time: R, size: R, stage: usize) -> R {
    time + size * SHORT_NODES[stage]
}

/// A step of Tsitouras' pair 5(4).
#[derive(Clone, Copy, Debug)]
pub struct ShortStep<const N: usize = 4> {
    /// State at its end.
    pub end: State<f64, N>,
    /// Integrals of the quadratures over the step.
    pub work: Quadratures,
    size: f64,
    /// Error estimate over the size of the step, without the term of its end.
    stage_error: Rate<f64, N>,
}

impl<const N: usize> ShortStep<N> {
    /// Takes a step of `size` from `start` with known rate there.
    #[inline(always)]
    pub fn attempt(
        time: f64,
        size: f64,
        start: State<f64, N>,
        first: Rate<f64, N>,
        equations: &impl Equations<f64, N>,
    ) -> ShortStep<N> {
        let mut rates = StageRates::beginning_with(first);
        let k = &mut rates.states;
        macro_rules! stages {
            ($($i:tt)*) => {$({
                let x = start + short_increment!(k, $i).times(size);
                let Rate { state, quadratures } = equations.rate(time + size * SHORT_NODES[$i], &x);
                (k[$i], rates.quadratures[$i]) = (state, quadratures);
            })*};
        }
        stages!(1 2 3 4 5);
        let (end, work) = at_end(size, start, &rates);
        ShortStep { end, work, size, stage_error: difference(&rates) }
    }

    /// Returns the estimated error of the step, in units of the allowed error. The rate is that at its end; see [`squared_error`].
    #[inline(always)]
    pub fn error(&self, end: Rate<f64, N>, weights: State<f64, N>, work_weight: f64) -> f64 {
        self.size * squared_error(self.stage_error, end, weights, work_weight).sqrt()
    }
}

/// Takes the step of [`ShortStep::attempt`] in a loop; see [`dop853::attempt_in_loop`](super::dop853::attempt_in_loop).
#[inline(always)]
pub fn attempt_in_loop<R: Real, const N: usize>(
    time: R,
    size: R,
    start: State<R, N>,
    rates: &mut StageRates<R, N, STAGES>,
    equations: &impl Stages<R, N>,
) -> (State<R, N>, Quadratures<R>) {
    for stage in 1..STAGES {
        let state = start + increment(&rates.states, stage).times(size);
        let Rate { state, quadratures } = equations.rate_at(stage, stage_time(time, size, stage), &state);
        (rates.states[stage], rates.quadratures[stage]) = (state, quadratures);
    }
    at_end(size, start, rates)
}

/// Returns state and work at the end of a step with these rates.
#[inline(always)]
fn at_end<R: Real, const N: usize>(
    size: R,
    start: State<R, N>,
    rates: &StageRates<R, N, STAGES>,
) -> (State<R, N>, Quadratures<R>) {
    (start + short_increment!(rates.states, 6).times(size), short_increment!(rates.quadratures, 6).times(size))
}

/// Returns the estimated error of a step over its size, without the end's term.
#[inline(always)]
pub fn difference<R: Real, const N: usize>(rates: &StageRates<R, N, STAGES>) -> Rate<R, N> {
    Rate { state: short_difference!(rates.states), quadratures: short_difference!(rates.quadratures) }
}

/// Returns the squared error of a step over its size, over the allowed error's square.
///
/// `stage_error` is its [`difference`], `end` the rate at its end. `weights` are those of [`dop853::error`](super::dop853::error),
/// `work_weight` that of the works.
#[inline(always)]
pub fn squared_error<R: Real, const N: usize>(
    stage_error: Rate<R, N>,
    end: Rate<R, N>,
    weights: State<R, N>,
    work_weight: R,
) -> R {
    let state = short_end_difference!(stage_error.state, end.state).weighted(weights);
    let work = short_end_difference!(stage_error.quadratures, end.quadratures).times(work_weight);
    state.square() + work.square()
}

/// Returns the weighted sum of stages that leads to a stage from 1 to 5.
#[inline(always)]
pub(super) fn increment<S: LinearSpace, const STAGES: usize>(k: &[S; STAGES], stage: usize) -> S {
    match stage {
        1 => short_increment!(k, 1),
        2 => short_increment!(k, 2),
        3 => short_increment!(k, 3),
        4 => short_increment!(k, 4),
        _ => short_increment!(k, 5),
    }
}
