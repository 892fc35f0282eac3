//! DOP853 for a state whose dimension is known at run time: rates of a slice → the state a step later, its error, and the motion inside.
//!
//! The numbers are stepped four at a time by the formulas of [`dop853`], so that sums over stages stay in registers. All memory
//! is allocated at the beginning.

use std::hint::black_box;

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

/// Four numbers in a step.
#[derive(Clone, Copy, Debug)]
struct Group {
    start: State,
    end: State,
    stages: [State; DENSE_STAGES],
}

/// The memory of steps, and the present step.
#[derive(Clone, Debug)]
pub struct Stepper {
    dimension: usize,
    time: f64,
    size: f64,
    groups: Vec<Group>,
    dense: Vec<Polynomial<WIDTH>>,
    is_dense: bool,
    /// The state of a stage and its rates. Numbers beyond the dimension are zero.
    state: Vec<[f64; WIDTH]>,
    rates: Vec<[f64; WIDTH]>,
}

/// Returns numbers in groups of four. Those beyond the last are zero.
fn grouped(numbers: &[f64]) -> impl Iterator<Item = State> {
    let (whole, rest) = numbers.as_chunks();
    let last = (!rest.is_empty()).then(|| std::array::from_fn(|i| rest.get(i).copied().unwrap_or(0.0)));
    whole.iter().copied().chain(last).map(State::from)
}

/// Writes groups of four as numbers.
fn write(groups: impl Iterator<Item = State>, numbers: &mut [f64]) {
    for (group, numbers) in groups.zip(numbers.chunks_mut(WIDTH)) {
        numbers.copy_from_slice(&group.0[..numbers.len()]);
    }
}

/// Evaluates stages in turn, each at the state that those before it give. The rates of the one before are in
/// memory; those of the first are known from the beginning of the step.
///
/// Compilers that vectorize over groups, rather than inside of them, take 1.6 times the instructions; `black_box` keeps them from it.
macro_rules! stages {
    ($stepper:ident, $size:ident, $equations:ident; $($before:literal => $i:tt)*) => {$(
        for ((group, state), rates) in $stepper.groups.iter_mut().zip(&mut $stepper.state).zip(&$stepper.rates) {
            let group = black_box(group);
            if $before > 0 {
                group.stages[$before] = State::from(*rates);
            }
            *state = (group.start + increment!(group.stages, $i).times($size)).0;
        }
        $stepper.evaluate($i, $equations);
    )*};
}

impl Stepper {
    /// Returns the memory for steps of a state of this dimension.
    pub fn new(dimension: usize) -> Stepper {
        let groups = dimension.div_ceil(WIDTH);
        let zero = State::zeros();
        Stepper {
            dimension,
            time: 0.0,
            size: 0.0,
            groups: vec![Group { start: zero, end: zero, stages: [zero; DENSE_STAGES] }; groups],
            dense: vec![[Numbers::zeros(); 8]; groups],
            is_dense: false,
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
        for (group, rates) in self.groups.iter_mut().zip(&self.rates) {
            let group = black_box(group);
            group.stages[11] = State::from(*rates);
            group.end = group.start + increment!(group.stages, 12).times(size);
        }
        write(self.groups.iter().map(|group| group.end), end);
    }

    /// Evaluates a stage at the state in memory.
    fn evaluate(&mut self, stage: usize, equations: &impl SliceEquations) {
        let time = self.time + self.size * NODES[stage];
        let state = &self.state.as_flattened()[..self.dimension];
        equations.write_rates(time, state, &mut self.rates.as_flattened_mut()[..self.dimension]);
    }

    /// Returns the estimated error of the step, in units of the allowed error; see [`dop853::error`].
    ///
    /// `weights` are the reciprocals of the errors allowed in each number.
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
        self.groups.iter_mut().zip(grouped(end)).for_each(|(group, end)| group.end = end);
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
        write(self.dense.iter().map(|polynomial| dop853::evaluate(polynomial, place)), state);
        evaluations
    }

    fn form_dense_output(&mut self, equations: &impl SliceEquations) {
        let size = self.size;
        stages!(self, size, equations; 12 => 13 13 => 14 14 => 15);
        for ((dense, group), rates) in self.dense.iter_mut().zip(&mut self.groups).zip(&self.rates) {
            group.stages[15] = State::from(*rates);
            *dense = dop853::polynomial(group.start, group.end - group.start, size, &group.stages);
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
