//! A step of order 5 to a stop close ahead: no dense output, so nothing may happen inside.

use crate::numerics::coefficients::{SHORT_NODES, combine, short_difference, short_increment};
use crate::numerics::{Equations, Rate, Real, Vector};

/// A step of Tsitouras' pair 5(4).
#[derive(Clone, Copy, Debug)]
pub struct ShortStep<R: Real = f64> {
    /// State at its end.
    pub end: R::State,
    /// What is integrated along, over the step.
    pub work: R::Quadratures,
    size: R,
    stages: [R::State; 6],
    quadratures: [R::Quadratures; 6],
}

impl ShortStep {
    /// Number of evaluations of the right-hand side in a step, without those at its ends.
    pub const EVALUATIONS: u64 = 5;
}

impl<R: Real> ShortStep<R> {
    /// Takes a step of `size` from `start` with known rate there.
    #[inline(always)]
    pub fn attempt(time: R, size: R, start: R::State, first: Rate<R>, equations: &impl Equations<R>) -> ShortStep<R> {
        let (mut k, mut q) = ShortStep::begin(first);
        macro_rules! stages {
            ($($i:tt)*) => {$({
                let Rate { state, quadratures } =
                    equations.rate(time + size * SHORT_NODES[$i], &(start + short_increment!(k, $i) * size));
                (k[$i], q[$i]) = (state, quadratures);
            })*};
        }
        stages!(1 2 3 4 5);
        ShortStep::finish(size, start, k, q)
    }

    /// The same step by a loop with one copy of the right-hand side, which is less to compile. Of single numbers it takes twice
    /// the time.
    #[inline(always)]
    pub fn attempt_in_loop(
        time: R,
        size: R,
        start: R::State,
        first: Rate<R>,
        equations: &impl Equations<R>,
    ) -> ShortStep<R> {
        let (mut k, mut q) = ShortStep::begin(first);
        for stage in 1..6 {
            let increment = match stage {
                1 => short_increment!(k, 1),
                2 => short_increment!(k, 2),
                3 => short_increment!(k, 3),
                4 => short_increment!(k, 4),
                _ => short_increment!(k, 5),
            };
            let Rate { state, quadratures } =
                equations.rate(time + size * SHORT_NODES[stage], &(start + increment * size));
            (k[stage], q[stage]) = (state, quadratures);
        }
        ShortStep::finish(size, start, k, q)
    }

    #[inline(always)]
    fn begin(first: Rate<R>) -> ([R::State; 6], [R::Quadratures; 6]) {
        let mut k = [R::State::zero(); 6];
        let mut q = [R::Quadratures::zero(); 6];
        (k[0], q[0]) = (first.state, first.quadratures);
        (k, q)
    }

    #[inline(always)]
    fn finish(size: R, start: R::State, k: [R::State; 6], q: [R::Quadratures; 6]) -> ShortStep<R> {
        ShortStep {
            end: start + short_increment!(k, 6) * size,
            work: short_increment!(q, 6) * size,
            size,
            stages: k,
            quadratures: q,
        }
    }

    /// Estimated error of the step with this rate at its end, in units of what is allowed; `weights` as in
    /// [`Step::error`](super::dop853::Step::error), `work_weight` the same of the works.
    #[inline(always)]
    pub fn error(&self, end: Rate<R>, weights: R::State, work_weight: R) -> R {
        let state = short_difference!(self.stages, end.state).weighted(weights);
        let work = short_difference!(self.quadratures, end.quadratures) * work_weight;
        self.size * (state.square() + work.square()).sqrt()
    }
}
