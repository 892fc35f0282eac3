//! A step to a stop close ahead, of order 5 by either of two pairs: no stages for a dense output, so what happens inside is known
//! from its ends alone.

use crate::numerics::coefficients::{
    NYSTROM_NODES, SHORT_NODES, combine, nystrom_displacement, nystrom_velocity, short_difference,
    short_end_difference, short_increment,
};
use crate::numerics::{Equations, Quadratures, Rate, Real, State};

/// A pair of a short step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShortPair {
    /// Nyström's method for second-order equations: of order 5 where the accelerations depend on displacements and time, and of
    /// order 4 in what they owe to the velocities.
    Nystrom,
    /// Tsitouras' pair 5(4).
    Tsitouras,
}

impl ShortPair {
    /// Number of evaluations of the right-hand side in a step, without those at its ends.
    pub const fn evaluations(self) -> u64 {
        match self {
            ShortPair::Nystrom => 3,
            ShortPair::Tsitouras => 5,
        }
    }
}

/// A short step.
#[derive(Clone, Copy, Debug)]
pub struct ShortStep<R: Real = f64> {
    /// State at its end.
    pub end: State<R>,
    /// What is integrated along, over the step.
    pub work: Quadratures<R>,
    pair: ShortPair,
    size: R,
    /// What the stages have to say of its error.
    of_stages: Rate<R>,
}

impl<R: Real> ShortStep<R> {
    /// Takes a step of `size` from `start` with known rate there.
    #[inline(always)]
    pub fn attempt(
        pair: ShortPair,
        time: R,
        size: R,
        start: State<R>,
        first: Rate<R>,
        equations: &impl Equations<R>,
    ) -> ShortStep<R> {
        macro_rules! stages {
            ($number:literal, $rate:ident: $($i:tt)*) => {{
                let (mut k, mut q) = ShortStep::<R>::begin::<$number>(first);
                $(
                    let Rate { state, quadratures } = $rate!(k, $i);
                    (k[$i], q[$i]) = (state, quadratures);
                )*
                (k, q)
            }};
        }
        macro_rules! tsitouras {
            ($k:ident, $i:tt) => {
                equations.rate(time + size * SHORT_NODES[$i], &(start + short_increment!($k, $i).times(size)))
            };
        }
        macro_rules! nystrom {
            ($k:ident, $i:tt) => {{
                let displacement = start * NYSTROM_NODES[$i] + nystrom_displacement!($k, $i).times(size);
                let increment = State::of_second_order(displacement, nystrom_velocity!($k, $i));
                equations.rate(time + size * NYSTROM_NODES[$i], &(start + increment.times(size)))
            }};
        }
        match pair {
            ShortPair::Nystrom => {
                let (k, q) = stages!(4, nystrom: 1 2 3);
                ShortStep::nystrom(size, start, k, q)
            }
            ShortPair::Tsitouras => {
                let (k, q) = stages!(6, tsitouras: 1 2 3 4 5);
                ShortStep::tsitouras(size, start, k, q)
            }
        }
    }

    /// The same step by loops with one copy of the right-hand side, which is less to compile. Of single numbers it takes twice
    /// the time.
    #[inline(always)]
    pub fn attempt_in_loop(
        pair: ShortPair,
        time: R,
        size: R,
        start: State<R>,
        first: Rate<R>,
        equations: &impl Equations<R>,
    ) -> ShortStep<R> {
        match pair {
            ShortPair::Nystrom => {
                let (mut k, mut q) = ShortStep::<R>::begin::<4>(first);
                for stage in 1..4 {
                    let (displacement, velocity) = match stage {
                        1 => (nystrom_displacement!(k, 1), nystrom_velocity!(k, 1)),
                        2 => (nystrom_displacement!(k, 2), nystrom_velocity!(k, 2)),
                        _ => (nystrom_displacement!(k, 3), nystrom_velocity!(k, 3)),
                    };
                    let node = NYSTROM_NODES[stage];
                    let increment = State::of_second_order(start * node + displacement.times(size), velocity);
                    let Rate { state, quadratures } =
                        equations.rate(time + size * node, &(start + increment.times(size)));
                    (k[stage], q[stage]) = (state, quadratures);
                }
                ShortStep::nystrom(size, start, k, q)
            }
            ShortPair::Tsitouras => {
                let (mut k, mut q) = ShortStep::<R>::begin::<6>(first);
                for stage in 1..6 {
                    let increment = match stage {
                        1 => short_increment!(k, 1),
                        2 => short_increment!(k, 2),
                        3 => short_increment!(k, 3),
                        4 => short_increment!(k, 4),
                        _ => short_increment!(k, 5),
                    };
                    let Rate { state, quadratures } =
                        equations.rate(time + size * SHORT_NODES[stage], &(start + increment.times(size)));
                    (k[stage], q[stage]) = (state, quadratures);
                }
                ShortStep::tsitouras(size, start, k, q)
            }
        }
    }

    #[inline(always)]
    fn begin<const STAGES: usize>(first: Rate<R>) -> ([State<R>; STAGES], [Quadratures<R>; STAGES]) {
        let mut k = [State::zeros(); STAGES];
        let mut q = [Quadratures::zeros(); STAGES];
        (k[0], q[0]) = (first.state, first.quadratures);
        (k, q)
    }

    #[inline(always)]
    fn nystrom(size: R, start: State<R>, k: [State<R>; 4], q: [Quadratures<R>; 4]) -> ShortStep<R> {
        let displacement = start + nystrom_displacement!(k, 4).times(size);
        ShortStep {
            end: start + State::of_second_order(displacement, nystrom_velocity!(k, 4)).times(size),
            work: nystrom_velocity!(q, 4).times(size),
            pair: ShortPair::Nystrom,
            size,
            of_stages: Rate { state: k[3], quadratures: q[3] },
        }
    }

    #[inline(always)]
    fn tsitouras(size: R, start: State<R>, k: [State<R>; 6], q: [Quadratures<R>; 6]) -> ShortStep<R> {
        ShortStep {
            end: start + short_increment!(k, 6).times(size),
            work: short_increment!(q, 6).times(size),
            pair: ShortPair::Tsitouras,
            size,
            of_stages: Rate { state: short_difference!(k), quadratures: short_difference!(q) },
        }
    }

    /// Estimated error of the step with this rate at its end, in units of what is allowed; `weights` as in
    /// [`Step::error`](super::dop853::Step::error), `work_weight` the same of the works.
    ///
    /// Of Nyström's method it is what the displacements at the end would be off if its last stage, which is at the end but not in
    /// its state, were taken for the end: of one order less, and some ten times the error. It leaves the works out, whose
    /// estimate of that kind is a hundred times their error.
    #[inline(always)]
    pub fn error(&self, end: Rate<R>, weights: State<R>, work_weight: R) -> R {
        let Rate { state, quadratures } = self.of_stages;
        match self.pair {
            ShortPair::Nystrom => {
                let difference = State::of_second_order(end.state + state * -1.0, State::zeros());
                self.size * self.size * difference.weighted(weights).norm() * (1.0 / 12.0)
            }
            ShortPair::Tsitouras => {
                let state = short_end_difference!(state, end.state).weighted(weights);
                let work = short_end_difference!(quadratures, end.quadratures).times(work_weight);
                self.size * (state.square() + work.square()).sqrt()
            }
        }
    }
}
