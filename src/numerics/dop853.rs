//! State, its rate and a step size → the state a step later, its error, and the motion inside the step.
//!
//! The pair is DOP853: order 8 with embedded results of order 5 and 3, and a dense output of order 7 that costs three
//! more evaluations in the steps that ask for it. Where a stop is so close that order 5 leads there as well, a
//! [`ShortStep`](super::short::ShortStep) does with half the evaluations. docs/integrator.md has the comparison that led to both.

use nalgebra::SVector;

use crate::numerics::coefficients::{NODES, combine, dense, difference, increment};
use crate::numerics::control::size_factor;
use crate::numerics::{Equations, Quadratures, Rate, State};

/// An attempted step, kept whole for its dense output.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Time at its beginning (s).
    pub time: f64,
    /// Its size (s).
    pub size: f64,
    /// Time at its end (s).
    pub end_time: f64,
    /// State at its beginning.
    pub start: State,
    /// State at its end.
    pub end: State,
    /// What is integrated along, over the step.
    pub work: Quadratures,
    stages: [State; 12],
    quadratures: [Quadratures; 12],
}

/// Number of evaluations of the right-hand side in one attempted step, the first stage aside, which is known.
pub const EVALUATIONS_PER_STEP: u64 = 11;

/// Number of evaluations for the dense output of a step.
pub const EVALUATIONS_OF_DENSE_OUTPUT: u64 = 3;

impl Step {
    /// Takes a step of `size` from `start` with known rate there. The right-hand side is evaluated
    /// [`EVALUATIONS_PER_STEP`] times, not at the end.
    #[inline(always)]
    pub fn attempt(time: f64, size: f64, start: State, first: Rate, equations: &impl Equations) -> Step {
        let mut k = [State::zeros(); 12];
        let mut q = [Quadratures::zeros(); 12];
        (k[0], q[0]) = (first.state, first.quadratures);
        macro_rules! stages {
            ($($i:tt)*) => {$({
                let Rate { state, quadratures } = equations.rate(time + NODES[$i] * size, &(start + increment!(k, $i) * size));
                (k[$i], q[$i]) = (state, quadratures);
            })*};
        }
        stages!(1 2 3 4 5 6 7 8 9 10 11);
        Step {
            time,
            size,
            end_time: time + size,
            start,
            end: start + increment!(k, 12) * size,
            work: increment!(q, 12) * size,
            stages: k,
            quadratures: q,
        }
    }

    /// Estimated error of the step, in units of what is allowed: a step above 1 is to be repeated.
    ///
    /// `weights` are the reciprocals of the errors allowed in each component of the state.
    #[inline(always)]
    pub fn error(&self, weights: &State) -> f64 {
        let fifth = difference!(self.stages, 5).component_mul(weights).norm_squared();
        let third = difference!(self.stages, 3).component_mul(weights).norm_squared();
        let denominator = fifth + 0.01 * third;
        if denominator > 0.0 { self.size * fifth / denominator.sqrt() } else { 0.0 }
    }

    /// The factor by which the step size may change after a step of this error: `0.9 error^(−1/8)` within 1/3 … 6.
    /// Square roots are rounded alike everywhere, which a power is not.
    pub fn size_factor(error: f64) -> f64 {
        size_factor(error.sqrt().sqrt().sqrt())
    }

    /// The motion inside the step; evaluates `rate` three times. `end` is the rate at the end.
    #[inline(never)]
    pub fn dense(&self, end: Rate, equations: &impl Equations) -> DenseOutput {
        let mut k = [State::zeros(); 16];
        let mut q = [Quadratures::zeros(); 16];
        k[..12].copy_from_slice(&self.stages);
        q[..12].copy_from_slice(&self.quadratures);
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

/// Value at the beginning, then the coefficients of the dense output.
type Polynomial<const N: usize> = [SVector<f64, N>; 8];

fn polynomial<const N: usize>(
    start: SVector<f64, N>,
    change: SVector<f64, N>,
    size: f64,
    k: &[SVector<f64, N>; 16],
) -> Polynomial<N> {
    let first = k[0] * size - change;
    [
        start,
        change,
        first,
        change - k[12] * size - first,
        dense!(k, 0) * size,
        dense!(k, 1) * size,
        dense!(k, 2) * size,
        dense!(k, 3) * size,
    ]
}

/// The motion inside a step: polynomials of degree 7 that take on the step's ends and their rates.
#[derive(Clone, Copy, Debug)]
pub struct DenseOutput {
    /// Time at the step's beginning (s).
    pub time: f64,
    /// Size of the step (s).
    pub size: f64,
    state: Polynomial<4>,
    work: Polynomial<2>,
}

impl DenseOutput {
    /// State `elapsed` seconds after the beginning of the step.
    pub fn state(&self, elapsed: f64) -> State {
        evaluate(&self.state, elapsed / self.size)
    }

    /// What is integrated along, from the beginning of the step to `elapsed`.
    pub fn work(&self, elapsed: f64) -> Quadratures {
        evaluate(&self.work, elapsed / self.size)
    }
}

fn evaluate<const N: usize>(f: &Polynomial<N>, x: f64) -> SVector<f64, N> {
    let y = 1.0 - x;
    f[0] + (f[1] + (f[2] + (f[3] + (f[4] + (f[5] + (f[6] + f[7] * x) * y) * x) * y) * x) * y) * x
}
