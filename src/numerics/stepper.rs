//! DOP853 for a state whose dimension is known at run time: rates of a slice → the state a step later, its error, and the motion inside.
//!
//! The numbers are stepped four at a time by the formulas of [`dop853`], so that sums over stages stay in registers. All memory
//! is allocated at the beginning.

use crate::numerics::State;
use crate::numerics::coefficients::{NODES, combine, difference, increment};
use crate::numerics::dop853::{self, DENSE_STAGES, Polynomial};
use crate::numerics::numbers::Numbers;

/// Numbers that are stepped together.
const WIDTH: usize = 4;

/// A right-hand side of any dimension.
pub trait SliceEquations {
    /// Writes the rates of a state at a time (s).
    fn write_rates(&self, time: f64, state: &[f64], rates: &mut [f64]);
}

/// The memory of steps, and the present step.
#[derive(Clone, Debug, Default)]
pub struct Stepper {
    time: f64,
    size: f64,
    start: Vec<State>,
    end: Vec<State>,
    stages: Vec<[State; DENSE_STAGES]>,
    dense: Vec<Polynomial<WIDTH>>,
    is_dense: bool,
    state: Vec<f64>,
    rates: Vec<f64>,
}

/// Returns the numbers with this index in groups of four. Those beyond the dimension are zero.
fn group(numbers: &[f64], index: usize) -> State {
    let numbers = &numbers[WIDTH * index..numbers.len().min(WIDTH * (index + 1))];
    match <[f64; WIDTH]>::try_from(numbers) {
        Ok(numbers) => State::from(numbers),
        Err(_) => State::from(std::array::from_fn(|i| numbers.get(i).copied().unwrap_or(0.0))),
    }
}

/// Writes groups of four as numbers.
fn write(groups: impl Iterator<Item = State>, numbers: &mut [f64]) {
    for (group, numbers) in groups.zip(numbers.chunks_mut(WIDTH)) {
        numbers.copy_from_slice(&group.0[..numbers.len()]);
    }
}

/// Evaluates stages in turn, each at the state that those before it give.
macro_rules! stages {
    ($stepper:ident, $size:ident, $equations:ident; $($i:tt)*) => {$(
        let states = $stepper.start.iter().zip(&$stepper.stages).map(|(start, k)| *start + increment!(k, $i).times($size));
        write(states, &mut $stepper.state);
        $stepper.evaluate($i, $equations);
    )*};
}

impl Stepper {
    /// Returns the memory for steps of a state of this dimension.
    pub fn new(dimension: usize) -> Stepper {
        let groups = dimension.div_ceil(WIDTH);
        Stepper {
            start: vec![State::zeros(); groups],
            end: vec![State::zeros(); groups],
            stages: vec![[State::zeros(); DENSE_STAGES]; groups],
            dense: vec![[Numbers::zeros(); 8]; groups],
            state: vec![0.0; dimension],
            rates: vec![0.0; dimension],
            ..Stepper::default()
        }
    }

    /// Begins a step at a state with these rates.
    pub fn begin(&mut self, time: f64, state: &[f64], rates: &[f64]) {
        self.time = time;
        for (i, (start, stages)) in self.start.iter_mut().zip(&mut self.stages).enumerate() {
            *start = group(state, i);
            stages[0] = group(rates, i);
        }
    }

    /// Takes a step of `size` (s), with [`dop853::EVALUATIONS_PER_STEP`] evaluations, and writes the state at its end.
    pub fn attempt(&mut self, size: f64, equations: &impl SliceEquations, end: &mut [f64]) {
        (self.size, self.is_dense) = (size, false);
        stages!(self, size, equations; 1 2 3 4 5 6 7 8 9 10 11);
        for (start, (end, k)) in self.start.iter().zip(self.end.iter_mut().zip(&self.stages)) {
            *end = *start + increment!(k, 12).times(size);
        }
        write(self.end.iter().copied(), end);
    }

    /// Evaluates a stage at the state in memory.
    fn evaluate(&mut self, stage: usize, equations: &impl SliceEquations) {
        equations.write_rates(self.time + self.size * NODES[stage], &self.state, &mut self.rates);
        self.store_rates(stage);
    }

    fn store_rates(&mut self, stage: usize) {
        for (i, k) in self.stages.iter_mut().enumerate() {
            k[stage] = group(&self.rates, i);
        }
    }

    /// Returns the estimated error of the step, in units of the allowed error; see [`dop853::error`].
    ///
    /// `weights` are the reciprocals of the errors allowed in each number.
    pub fn error(&self, weights: &[f64]) -> f64 {
        let (mut fifth, mut third) = (0.0, 0.0);
        for (i, k) in self.stages.iter().enumerate() {
            let weights = group(weights, i);
            fifth += difference!(k, 5).weighted(weights).square();
            third += difference!(k, 3).weighted(weights).square();
        }
        dop853::error_from_squares(self.size, [fifth, third])
    }

    /// Replaces the end of the step by one within its error, and gives its rates, for the dense output.
    pub fn set_end(&mut self, end: &[f64], rates: &[f64]) {
        for (i, (group_of_end, k)) in self.end.iter_mut().zip(&mut self.stages).enumerate() {
            *group_of_end = group(end, i);
            k[12] = group(rates, i);
        }
    }

    /// Writes the state `elapsed` seconds after the beginning of the step. Returns the number of evaluations that this took.
    pub fn state_at(&mut self, elapsed: f64, equations: &impl SliceEquations, state: &mut [f64]) -> u64 {
        let mut evaluations = 0;
        if !self.is_dense {
            self.form_dense_output(equations);
            evaluations = dop853::EVALUATIONS_OF_DENSE_OUTPUT;
        }
        let place = elapsed / self.size;
        write(self.dense.iter().map(|polynomial| dop853::evaluate(polynomial, place)), state);
        evaluations
    }

    fn form_dense_output(&mut self, equations: &impl SliceEquations) {
        let size = self.size;
        stages!(self, size, equations; 13 14 15);
        for (i, dense) in self.dense.iter_mut().enumerate() {
            let (start, end) = (self.start[i], self.end[i]);
            *dense = dop853::polynomial(start, end - start, size, &self.stages[i]);
        }
        self.is_dense = true;
    }
}

/// The bits of a step are those of [`dop853::DenseStep`].
#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::dop853::DenseStep;
    use crate::numerics::{Quadratures, Rate};

    /// Two oscillators, one of them driven.
    fn rates_of(time: f64, x: &[f64]) -> [f64; 4] {
        [x[1], -3.0 * x[0] + 0.1 * x[2], x[3], -x[2] + libm::sin(time) - 0.2 * x[1]]
    }

    struct Oscillators;

    impl SliceEquations for Oscillators {
        fn write_rates(&self, time: f64, state: &[f64], rates: &mut [f64]) {
            for (state, rates) in state.chunks(4).zip(rates.chunks_mut(4)) {
                let four = rates_of(time, &[state, &[0.0; 4]].concat());
                rates.copy_from_slice(&four[..rates.len()]);
            }
        }
    }

    #[test]
    fn steps_have_the_bits_of_those_of_fixed_dimension() {
        let start = [0.3, -0.2, 0.1, 0.5];
        let equations =
            |time: f64, x: &State| Rate { state: rates_of(time, &x.0).into(), quadratures: Quadratures::zeros() };
        let first = equations(0.4, &start.into());
        let fixed = DenseStep::attempt(0.4, 0.7, start.into(), first, &equations);
        let end_rate = equations(1.1, &fixed.end);
        // Two copies, and some numbers that do not fill a group.
        let copies = |four: [f64; 4]| [&four[..], &four[..], &[0.0, 0.0]].concat();
        let mut stepper = Stepper::new(10);
        let mut end = vec![0.0; 10];
        stepper.begin(0.4, &copies(start), &copies(first.state.0));
        stepper.attempt(0.7, &Oscillators, &mut end);
        assert_eq!(end, copies(fixed.end.0));
        let weights = [1e3, 2e3, 3e3, 4e3];
        let mut only_first = vec![0.0; 10];
        only_first[..4].copy_from_slice(&weights);
        assert_eq!(stepper.error(&only_first), fixed.error(weights.into()));
        stepper.set_end(&end, &copies(end_rate.state.0));
        let mut inside = vec![0.0; 10];
        assert_eq!(stepper.state_at(0.3, &Oscillators, &mut inside), 3);
        assert_eq!(inside, copies(fixed.dense(end_rate, &equations).state(0.3).0));
    }
}
