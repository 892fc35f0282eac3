//! A step of order 5 to a stop close ahead. It has no dense output: its ends alone bound the motion inside.

use crate::numerics::coefficients::{SHORT_NODES, combine, short_difference, short_end_difference, short_increment};
use crate::numerics::{Equations, Quadratures, Rate, Real, Scalar, Stages, State};

/// Number of evaluations of the right-hand side in a short step, without those at its ends.
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
pub struct ShortStep<R: Real = f64, const N: usize = 4> {
    /// State at its end.
    pub end: State<R, N>,
    /// Integrals of the quadratures over the step.
    pub work: Quadratures<R>,
    size: R,
    /// Error estimate over the size of the step, without the share of the rate at its end.
    of_stages: Rate<R, N>,
}

impl<R: Real, const N: usize> ShortStep<R, N> {
    /// Takes a step of `size` from `start` with known rate there.
    #[inline(always)]
    pub fn attempt(
        time: R,
        size: R,
        start: State<R, N>,
        first: Rate<R, N>,
        equations: &impl Equations<R, N>,
    ) -> ShortStep<R, N> {
        let (mut k, mut q) = ShortStep::begin(first);
        macro_rules! stages {
            ($($i:tt)*) => {$({
                let x = start + short_increment!(k, $i).times(size);
                let Rate { state, quadratures } = equations.rate(time + size * SHORT_NODES[$i], &x);
                (k[$i], q[$i]) = (state, quadratures);
            })*};
        }
        stages!(1 2 3 4 5);
        ShortStep::finish(size, start, k, q)
    }

    /// Takes the same step by a loop with one copy of the right-hand side, which is less to compile. With single numbers it takes
    /// twice the time.
    #[inline(always)]
    pub fn attempt_in_loop(
        time: R,
        size: R,
        start: State<R, N>,
        first: Rate<R, N>,
        equations: &impl Stages<R, N>,
    ) -> ShortStep<R, N> {
        let (mut k, mut q) = ShortStep::begin(first);
        for stage in 1..6 {
            let Rate { state, quadratures } =
                equations.rate_at(stage, stage_time(time, size, stage), &(start + increment(&k, stage).times(size)));
            (k[stage], q[stage]) = (state, quadratures);
        }
        ShortStep::finish(size, start, k, q)
    }

    #[inline(always)]
    fn begin(first: Rate<R, N>) -> ([State<R, N>; 6], [Quadratures<R>; 6]) {
        let mut k = [State::zeros(); 6];
        let mut q = [Quadratures::zeros(); 6];
        (k[0], q[0]) = (first.state, first.quadratures);
        (k, q)
    }

    #[inline(always)]
    fn finish(size: R, start: State<R, N>, k: [State<R, N>; 6], q: [Quadratures<R>; 6]) -> ShortStep<R, N> {
        ShortStep {
            end: start + short_increment!(k, 6).times(size),
            work: short_increment!(q, 6).times(size),
            size,
            of_stages: Rate { state: short_difference!(k), quadratures: short_difference!(q) },
        }
    }

    /// Estimated error of the step with this rate at its end, in units of the allowed error; `weights` as in
    /// [`Step::error`](super::dop853::Step::error), `work_weight` the same of the works.
    #[inline(always)]
    pub fn error(&self, end: Rate<R, N>, weights: State<R, N>, work_weight: R) -> R {
        let Rate { state, quadratures } = self.of_stages;
        let state = short_end_difference!(state, end.state).weighted(weights);
        let work = short_end_difference!(quadratures, end.quadratures).times(work_weight);
        self.size * (state.square() + work.square()).sqrt()
    }
}

/// The sum of the weighted stages that leads to a stage from 1 to 5.
#[inline(always)]
fn increment<R: Scalar, const N: usize>(k: &[State<R, N>; 6], stage: usize) -> State<R, N> {
    match stage {
        1 => short_increment!(k, 1),
        2 => short_increment!(k, 2),
        3 => short_increment!(k, 3),
        4 => short_increment!(k, 4),
        _ => short_increment!(k, 5),
    }
}

/// State at the end of a short step that is known to be accurate, in numbers with derivatives; the values have the bits of
/// [`ShortStep::attempt`].
#[inline(always)]
pub fn follow<T: Scalar, const N: usize>(
    time: f64,
    size: f64,
    start: State<T, N>,
    rate: impl Fn(f64, State<T, N>) -> State<T, N>,
) -> State<T, N> {
    let mut k = [State::zeros(); 6];
    k[0] = rate(time, start);
    for stage in 1..6 {
        k[stage] = rate(time + size * SHORT_NODES[stage], start + increment(&k, stage) * size);
    }
    start + short_increment!(k, 6) * size
}
