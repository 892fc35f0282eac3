//! DOP853 for a state whose dimension is known at run time: rates of a slice → the state a step later, its error, and the motion inside.
//!
//! The numbers are stepped four at a time by the formulas of [`dop853`], so that sums over stages stay in registers. Those on which
//! no rate depends are summed at the end of a step alone. All memory is allocated at the beginning.

use std::hint::black_box;

use crate::numerics::State;
use crate::numerics::coefficients::{NODES, combine, difference, increment};
use crate::numerics::dop853::{self, DENSE_STAGES, Polynomial};
use crate::numerics::numbers::Numbers;

/// Numbers that are stepped together.
const WIDTH: usize = 4;

/// A right-hand side of any dimension.
pub trait SliceEquations {
    /// Writes the rates of a state at a time (s). Numbers on which no rate depends may be those of another time.
    fn write_rates(&self, time: f64, state: &[f64], rates: &mut [f64]);
}

/// Four numbers in a step, aligned so that instructions on two of them take them from memory.
#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
struct Group {
    start: State,
    stages: [State; DENSE_STAGES],
}

/// The memory of steps, and the present step.
#[derive(Clone, Debug)]
pub struct Stepper {
    dimension: usize,
    /// Groups with numbers on which rates depend.
    moving: usize,
    time: f64,
    size: f64,
    groups: Vec<Group>,
    dense: Vec<Polynomial<WIDTH>>,
    is_dense: bool,
    /// The state at the end of the step.
    end: Vec<[f64; WIDTH]>,
    /// The state of a stage and its rates. Numbers beyond the dimension are zero.
    state: Vec<[f64; WIDTH]>,
    rates: Vec<[f64; WIDTH]>,
}

/// Returns numbers in groups of four. Those beyond the last are zero.
fn grouped(numbers: &[f64]) -> impl Iterator<Item = State> {
    numbers.chunks(WIDTH).map(|chunk| match chunk.first_chunk() {
        Some(four) => State::from(*four),
        None => State::from(std::array::from_fn(|i| chunk.get(i).copied().unwrap_or(0.0))),
    })
}

/// Evaluates stages in turn, each at the state that those before it give. The rates of the one before are in
/// memory; those of the first are known from the beginning of the step.
///
/// Compilers that vectorize over groups, rather than inside of them, take 1.6 times the instructions; `black_box` keeps them from it.
macro_rules! stages {
    ($stepper:ident, $size:ident, $equations:ident; $($before:literal => $i:tt)*) => {$(
        let groups = $stepper.groups.iter_mut().zip(&mut $stepper.state).zip(&$stepper.rates);
        for (number, ((group, state), rates)) in groups.enumerate() {
            let group = black_box(group);
            if $before > 0 {
                group.stages[$before] = State::from(*rates);
            }
            if number < $stepper.moving {
                *state = (group.start + increment!(group.stages, $i).times($size)).0;
            }
        }
        $stepper.evaluate($i, $equations);
    )*};
}

impl Stepper {
    /// Returns the memory for steps of a state of this dimension, whose rates depend on its first numbers, `moving`.
    pub fn new(dimension: usize, moving: usize) -> Stepper {
        let groups = dimension.div_ceil(WIDTH);
        let zero = State::zeros();
        Stepper {
            dimension,
            moving: moving.div_ceil(WIDTH),
            time: 0.0,
            size: 0.0,
            groups: vec![Group { start: zero, stages: [zero; DENSE_STAGES] }; groups],
            dense: vec![[Numbers::zeros(); 8]; groups],
            is_dense: false,
            end: vec![[0.0; WIDTH]; groups],
            state: vec![[0.0; WIDTH]; groups],
            rates: vec![[0.0; WIDTH]; groups],
        }
    }

    /// Begins a step at a state with these rates.
    pub fn begin(&mut self, time: f64, state: &[f64], rates: &[f64]) {
        self.time = time;
        for (group, (state, rates)) in self.groups.iter_mut().zip(grouped(state).zip(grouped(rates))) {
            group.start = state;
            group.stages[0] = rates;
        }
    }

    /// Takes a step of `size` (s), with [`dop853::EVALUATIONS_PER_STEP`] evaluations, and writes the state at its end.
    pub fn attempt(&mut self, size: f64, equations: &impl SliceEquations, end: &mut [f64]) {
        (self.size, self.is_dense) = (size, false);
        stages!(self, size, equations; 0 => 1 1 => 2 2 => 3 3 => 4 4 => 5 5 => 6 6 => 7 7 => 8 8 => 9 9 => 10 10 => 11);
        for ((group, rates), end) in self.groups.iter_mut().zip(&self.rates).zip(&mut self.end) {
            let group = black_box(group);
            group.stages[11] = State::from(*rates);
            *end = (group.start + increment!(group.stages, 12).times(size)).0;
        }
        end.copy_from_slice(&self.end.as_flattened()[..self.dimension]);
    }

    /// Evaluates a stage at the state in memory.
    fn evaluate(&mut self, stage: usize, equations: &impl SliceEquations) {
        let time = self.time + self.size * NODES[stage];
        let state = &self.state.as_flattened()[..self.dimension];
        equations.write_rates(time, state, &mut self.rates.as_flattened_mut()[..self.dimension]);
    }

    /// Returns the estimated error of the step, in units of the allowed error; see [`dop853::error`].
    ///
    /// `weights` are the reciprocals of the errors allowed in each number, as far as they count.
    pub fn error(&self, weights: &[f64]) -> f64 {
        let (mut fifth, mut third) = (0.0, 0.0);
        for (group, weights) in self.groups.iter().zip(grouped(weights)) {
            fifth += difference!(group.stages, 5).weighted(weights).square();
            third += difference!(group.stages, 3).weighted(weights).square();
        }
        dop853::error_from_squares(self.size, [fifth, third])
    }

    /// Replaces the end of the step by one within its error, and gives its rates, for the dense output.
    pub fn set_end(&mut self, end: &[f64], rates: &[f64]) {
        self.end.as_flattened_mut()[..self.dimension].copy_from_slice(end);
        self.rates.as_flattened_mut()[..self.dimension].copy_from_slice(rates);
    }

    /// Writes the state `elapsed` seconds after the beginning of the step. Returns the number of evaluations that this took.
    pub fn state_at(&mut self, elapsed: f64, equations: &impl SliceEquations, state: &mut [f64]) -> u64 {
        let mut evaluations = 0;
        if !self.is_dense {
            self.form_dense_output(equations);
            evaluations = dop853::EVALUATIONS_OF_DENSE_OUTPUT;
        }
        let place = elapsed / self.size;
        for (polynomial, state) in self.dense.iter().zip(state.chunks_mut(WIDTH)) {
            state.copy_from_slice(&dop853::evaluate(polynomial, place).0[..state.len()]);
        }
        evaluations
    }

    fn form_dense_output(&mut self, equations: &impl SliceEquations) {
        let size = self.size;
        stages!(self, size, equations; 12 => 13 13 => 14 14 => 15);
        let groups = self.groups.iter_mut().zip(&self.end).zip(&self.rates);
        for (dense, ((group, end), rates)) in self.dense.iter_mut().zip(groups) {
            group.stages[15] = State::from(*rates);
            *dense = dop853::polynomial(group.start, State::from(*end) - group.start, size, &group.stages);
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
        let mut stepper = Stepper::new(10, 10);
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

    /// An oscillator, and the sums over time of its numbers and of their squares.
    struct Summed;

    impl SliceEquations for Summed {
        fn write_rates(&self, time: f64, state: &[f64], rates: &mut [f64]) {
            rates[..4].copy_from_slice(&rates_of(time, &state[..4]));
            for i in 0..4 {
                (rates[4 + i], rates[8 + i]) = (state[i], state[i] * state[i]);
            }
        }
    }

    #[test]
    fn sums_over_time_have_the_bits_of_numbers_of_the_state() {
        let start = [[0.3, -0.2, 0.1, 0.5], [0.0; 4], [7.0; 4]].concat();
        let of = |moving: usize| {
            let (mut stepper, mut end, mut inside) = (Stepper::new(12, moving), vec![0.0; 12], vec![0.0; 12]);
            let (mut rates, mut state) = (vec![0.0; 12], start.clone());
            for step in 0..3 {
                let time = 0.7 * f64::from(step);
                Summed.write_rates(time, &state, &mut rates);
                stepper.begin(time, &state, &rates);
                stepper.attempt(0.7, &Summed, &mut end);
                Summed.write_rates(time + 0.7, &end, &mut rates);
                stepper.set_end(&end, &rates);
                stepper.state_at(0.3, &Summed, &mut inside);
                state.copy_from_slice(&end);
            }
            (end, inside, stepper.error(&[1e3; 12]))
        };
        assert_eq!(of(4), of(12));
        assert_eq!(of(5), of(12));
    }
}
