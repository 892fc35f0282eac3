//! A step of order 5 to a stop close ahead: no dense output, so nothing may happen inside.

use crate::numerics::coefficients::{SHORT_NODES, combine, short_difference, short_increment};
use crate::numerics::{Equations, Quadratures, Rate, State};

/// A step of Tsitouras' pair 5(4).
#[derive(Clone, Copy, Debug)]
pub struct ShortStep {
    /// State at its end.
    pub end: State,
    /// What is integrated along, over the step.
    pub work: Quadratures,
    size: f64,
    stages: [State; 6],
    quadratures: [Quadratures; 6],
}

impl ShortStep {
    /// Number of evaluations of the right-hand side in a step, without those at its ends.
    pub const EVALUATIONS: u64 = 5;

    /// Takes a step of `size` from `start` with known rate there.
    #[inline(always)]
    pub fn attempt(time: f64, size: f64, start: State, first: Rate, equations: &impl Equations) -> ShortStep {
        let mut k = [State::zeros(); 6];
        let mut q = [Quadratures::zeros(); 6];
        (k[0], q[0]) = (first.state, first.quadratures);
        macro_rules! stages {
            ($($i:tt)*) => {$({
                let Rate { state, quadratures } =
                    equations.rate(time + SHORT_NODES[$i] * size, &(start + short_increment!(k, $i) * size));
                (k[$i], q[$i]) = (state, quadratures);
            })*};
        }
        stages!(1 2 3 4 5);
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
    pub fn error(&self, end: Rate, weights: &State, work_weight: f64) -> f64 {
        let state = short_difference!(self.stages, end.state).component_mul(weights);
        let work = short_difference!(self.quadratures, end.quadratures) * work_weight;
        self.size * (state.norm_squared() + work.norm_squared()).sqrt()
    }
}
