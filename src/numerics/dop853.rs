//! State, its rate and a step size → the state a step later, its error, and the motion inside the step.
//!
//! The pair is DOP853: order 8 with embedded results of order 5 and 3, and a dense output of order 7 that costs three more evaluations in
//! the steps that ask for it. If the next stop is so close that order 5 suffices, a [`ShortStep`](super::short::ShortStep) takes half the
//! evaluations. docs/code/integrator.md compares the pairs.

use crate::numerics::coefficients::{NODES, combine, dense, difference, increment};
use crate::numerics::numbers::Numbers;
#[cfg(feature = "lanes")]
use crate::numerics::wide::{Simd, Wide};
use crate::numerics::{Equations, LinearSpace, Quadratures, Rate, Real, Scalar, StageRates, Stages, State};

/// An attempted step with all its stages, which the dense output needs.
#[derive(Clone, Copy, Debug)]
pub struct DenseStep<const N: usize = 4> {
    /// Time at its beginning (s).
    pub time: f64,
    /// Its size (s).
    pub size: f64,
    /// Time at its end (s).
    pub end_time: f64,
    /// State at its beginning.
    pub start: State<f64, N>,
    /// State at its end.
    pub end: State<f64, N>,
    /// Integrals of the quadratures over the step.
    pub work: Quadratures,
    rates: StageRates<f64, N>,
}

/// Evaluations of the right-hand side per attempted step, without the known first stage.
pub const EVALUATIONS_PER_STEP: u64 = 11;

/// Number of stages, with the one at the beginning of the step.
pub const STAGES: usize = 12;

/// Number of stages, with those of the dense output.
pub const DENSE_STAGES: usize = 16;

/// Returns the time of a stage.
#[inline(always)]
pub fn stage_time<R: Scalar>(time: R, size: R, stage: usize) -> R {
    time + size * NODES[stage]
}

/// Number of evaluations for the dense output of a step.
pub const EVALUATIONS_OF_DENSE_OUTPUT: u64 = 3;

impl<const N: usize> DenseStep<N> {
    /// Takes a step of `size` from `start` with the rate `first` there. Evaluates the right-hand side [`EVALUATIONS_PER_STEP`] times, not
    /// at the end.
    #[inline(always)]
    pub fn attempt(
        time: f64,
        size: f64,
        start: State<f64, N>,
        first: Rate<f64, N>,
        equations: &impl Equations<f64, N>,
    ) -> DenseStep<N> {
        let mut rates = StageRates::beginning_with(first);
        let k = &mut rates.states;
        macro_rules! stages {
            ($($i:tt)*) => {$({
                let Rate { state, quadratures } = equations.rate(time + size * NODES[$i], &(start + increment!(k, $i).times(size)));
                (k[$i], rates.quadratures[$i]) = (state, quadratures);
            })*};
        }
        stages!(1 2 3 4 5 6 7 8 9 10 11);
        let (end, work) = at_end(size, start, &rates);
        DenseStep { time, size, end_time: time + size, start, end, work, rates }
    }

    /// Returns the estimated error of the step; see [`error`].
    #[inline(always)]
    pub fn error(&self, weights: State<f64, N>) -> f64 {
        error(&self.rates, self.size, weights)
    }
}

/// Takes the step of [`DenseStep::attempt`] in a loop, with one copy of the right-hand side. Faster to compile, but half as fast with plain
/// numbers.
///
/// Returns the state at its end and the work. The first of `rates` is that at `start`; the others are written.
#[inline(always)]
pub fn attempt_in_loop<R: Real, const N: usize>(
    time: R,
    size: R,
    start: State<R, N>,
    rates: &mut StageRates<R, N>,
    equations: &impl Stages<R, N>,
) -> (State<R, N>, Quadratures<R>) {
    for stage in 1..12 {
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
    rates: &StageRates<R, N>,
) -> (State<R, N>, Quadratures<R>) {
    (start + increment!(rates.states, 12).times(size), increment!(rates.quadratures, 12).times(size))
}

/// Returns the estimated error of a step, in units of the allowed error. A step above 1 is repeated.
///
/// `weights` are the reciprocals of the errors allowed in each component of the state. A NaN in a stage makes the error NaN, and the step
/// is repeated as well.
#[inline(always)]
pub fn error<R: Real, const N: usize>(rates: &StageRates<R, N>, size: R, weights: State<R, N>) -> R {
    let fifth = difference!(rates.states, 5).weighted(weights).square();
    let third = difference!(rates.states, 3).weighted(weights).square();
    error_from_squares(size, [fifth, third])
}

/// Returns the error of a step over which the weighted differences from the results of order 5 and 3 have these squares.
#[inline(always)]
pub(super) fn error_from_squares<R: Real>(size: R, [fifth, third]: [R; 2]) -> R {
    let denominator = fifth + third * 0.01;
    // A denominator of zero or NaN is itself the error.
    R::select_less(R::from(0.0), denominator, size * fifth / denominator.sqrt(), denominator)
}

/// Returns the weighted sum of stages that leads to a stage from 1 to 11.
#[inline(always)]
pub(super) fn increment<S: LinearSpace, const STAGES: usize>(k: &[S; STAGES], stage: usize) -> S {
    match stage {
        1 => increment!(k, 1),
        2 => increment!(k, 2),
        3 => increment!(k, 3),
        4 => increment!(k, 4),
        5 => increment!(k, 5),
        6 => increment!(k, 6),
        7 => increment!(k, 7),
        8 => increment!(k, 8),
        9 => increment!(k, 9),
        10 => increment!(k, 10),
        _ => increment!(k, 11),
    }
}

#[cfg(feature = "lanes")]
impl DenseStep {
    /// Returns the step of one lane.
    #[inline(always)]
    pub fn of_lane<V: Simd>(
        lane: usize,
        [time, size]: [Wide<V>; 2],
        [start, end]: [State<Wide<V>>; 2],
        work: Quadratures<Wide<V>>,
        rates: &StageRates<Wide<V>, 4>,
    ) -> DenseStep {
        let [time, size] = [time.of_lane(lane), size.of_lane(lane)];
        let mut of_lane = StageRates::beginning_with(Rate::default());
        for stage in 0..STAGES {
            of_lane.states[stage] = rates.states[stage].of_lane(lane);
            of_lane.quadratures[stage] = rates.quadratures[stage].of_lane(lane);
        }
        DenseStep {
            time,
            size,
            end_time: time + size,
            start: start.of_lane(lane),
            end: end.of_lane(lane),
            work: work.of_lane(lane),
            rates: of_lane,
        }
    }
}

impl<const N: usize> DenseStep<N> {
    /// Returns the motion inside the step, after three more evaluations. `end` is the rate at the end.
    #[inline(never)]
    pub fn dense(&self, end: Rate<f64, N>, equations: &impl Equations<f64, N>) -> DenseOutput<N> {
        let mut k = [State::zeros(); 16];
        let mut q = [Quadratures::zeros(); 16];
        k[..12].copy_from_slice(&self.rates.states);
        q[..12].copy_from_slice(&self.rates.quadratures);
        (k[12], q[12]) = (end.state, end.quadratures);
        macro_rules! stages {
            ($($i:tt)*) => {$({
                let x = self.start + increment!(k, $i) * self.size;
                let Rate { state, quadratures } = equations.rate(self.time + NODES[$i] * self.size, &x);
                (k[$i], q[$i]) = (state, quadratures);
            })*};
        }
        stages!(13 14 15);
        DenseOutput {
            time: self.time,
            size: self.size,
            state: polynomial(self.start, self.end - self.start, self.size, &k),
            work: polynomial(Quadratures::zeros(), self.work, self.size, &q),
        }
    }
}

/// Coefficients of the dense output, the first one the initial value. See [`evaluate`].
pub type Polynomial<const N: usize, T = f64> = [Numbers<T, N>; 8];

/// Returns the dense output of a step from its initial state and its change. `k` has all its stages.
pub fn polynomial<T: Scalar, const N: usize>(
    start: Numbers<T, N>,
    change: Numbers<T, N>,
    size: f64,
    k: &[Numbers<T, N>; DENSE_STAGES],
) -> Polynomial<N, T> {
    let mut polynomial = cubic(start, change, size, &k[0], &k[12]);
    polynomial[4..].copy_from_slice(&[
        dense!(k, 0) * size,
        dense!(k, 1) * size,
        dense!(k, 2) * size,
        dense!(k, 3) * size,
    ]);
    polynomial
}

/// Returns the Hermite cubic with the rates `first` and `last` at the ends.
fn cubic<T: Scalar, const N: usize>(
    start: Numbers<T, N>,
    change: Numbers<T, N>,
    size: f64,
    first: &Numbers<T, N>,
    last: &Numbers<T, N>,
) -> Polynomial<N, T> {
    let bend = *first * size - change;
    let none = Numbers::zeros();
    [start, change, bend, change - *last * size - bend, none, none, none, none]
}

/// The motion inside a step, as polynomials of degree 7 or less. They match states and rates at both ends.
#[derive(Clone, Copy, Debug)]
pub struct DenseOutput<const N: usize = 4> {
    /// Time at the step's beginning (s).
    pub time: f64,
    /// Size of the step (s).
    pub size: f64,
    state: Polynomial<N>,
    work: Polynomial<2>,
}

impl<const N: usize> DenseOutput<N> {
    /// Returns the motion of a second-order system between two states with known rates.
    ///
    /// Velocities and works, `work` in total, are cubics; displacements are polynomials of degree 5, which also match the accelerations.
    /// Velocities differentiated from them would have the error of the displacements divided by the step size.
    pub fn between(
        time: f64,
        size: f64,
        [(start, first), (end, last)]: [(State<f64, N>, Rate<f64, N>); 2],
        work: Quadratures,
    ) -> DenseOutput<N> {
        let mut state = cubic(start, end - start, size, &first.state, &last.state);
        let [_, _, second, third, fourth, fifth, ..] = &mut state;
        for x in [0, 2, 4].into_iter().filter(|x| x + 1 < N) {
            let half = 0.5 * size * size;
            fourth[x] = half * first.state[x + 1] + second[x] - third[x];
            fifth[x] = half * last.state[x + 1] + second[x] + 2.0 * third[x] - fourth[x];
        }
        let work = cubic(Quadratures::zeros(), work, size, &first.quadratures, &last.quadratures);
        DenseOutput { time, size, state, work }
    }

    /// Returns the state `elapsed` seconds after the beginning of the step.
    pub fn state(&self, elapsed: f64) -> State<f64, N> {
        evaluate(&self.state, elapsed / self.size)
    }

    /// Returns the integrals of the quadratures from the beginning of the step to `elapsed` (s).
    pub fn work(&self, elapsed: f64) -> Quadratures {
        evaluate(&self.work, elapsed / self.size)
    }
}

/// Returns the value of a dense output at the fraction `x` of its step.
pub fn evaluate<T: Scalar, const N: usize>(f: &Polynomial<N, T>, x: f64) -> Numbers<T, N> {
    let y = 1.0 - x;
    f[0] + (f[1] + (f[2] + (f[3] + (f[4] + (f[5] + (f[6] + f[7] * x) * y) * x) * y) * x) * y) * x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error is NaN if a stage overflows, and zero if nothing happens.
    #[test]
    fn a_step_that_overflows_is_not_accepted() {
        let error = |far: f64| {
            let rate = |x: f64| Rate { state: State::from([0.0, x, 0.0, 0.0]), quadratures: Quadratures::zeros() };
            let equations = |_: f64, state: &State| rate(state[1] * state[1] * state[1]);
            let start = State::from([0.0, far, 0.0, 0.0]);
            DenseStep::attempt(0.0, 1.0, start, equations(0.0, &start), &equations).error(State::from([1.0; 4]))
        };
        assert_eq!(error(0.0), 0.0);
        assert!(error(1e100).is_nan());
        assert!(error(1.0) > 1.0);
    }
}
