//! The block stepped from outside, compared with its own steps.

use std::cell::RefCell;

use proptest::prelude::*;
use rocking_block::numerics::stepper::{SliceEquations, Stepper};
use rocking_block::space::motion::dimension;
use rocking_block::space::run::SpaceRun;
use rocking_block::space::{SpaceBody, SpaceEvent, SpaceEventKind, SpaceInputs};

use crate::random::{beginnings, blocks, pulses};
use crate::{advance, cases, of_foot, run};

/// A solver outside: steps of constant size, and bisection of a step that contains an event.
struct Solver {
    run: RefCell<SpaceRun>,
    inputs: SpaceInputs,
    stepper: Stepper,
    time: f64,
    states: Vec<f64>,
    events: Vec<SpaceEvent>,
}

impl SliceEquations for Solver {
    fn write_rates(&self, time: f64, state: &[f64], rates: &mut [f64]) {
        let mut run = self.run.borrow_mut();
        run.set_outside_time(time);
        run.set_continuous_states(state);
        rates.copy_from_slice(run.derivatives(&self.inputs));
    }
}

impl Solver {
    fn begin(mut run: SpaceRun, inputs: SpaceInputs) -> Solver {
        run.begin_exchange();
        let (time, dimension) = (run.time(), dimension(run.body().count()));
        let stepper = Stepper::new(dimension, dimension);
        let mut solver = Solver { run: run.into(), inputs, stepper, time, states: Vec::new(), events: Vec::new() };
        solver.pass_events();
        solver
    }

    fn pass_events(&mut self) {
        let run = self.run.get_mut();
        run.pass_events(&self.inputs, &mut |event| self.events.push(*event)).unwrap();
        self.states = run.continuous_states().to_vec();
    }

    /// Tries a step, and returns whether an event is due at its end.
    fn attempt(&mut self, size: f64) -> bool {
        let mut stepper = std::mem::replace(&mut self.stepper, Stepper::new(0, 0));
        let mut end = self.states.clone();
        let mut rates = end.clone();
        self.write_rates(self.time, &self.states, &mut rates);
        stepper.begin(self.time, &self.states, &rates);
        stepper.attempt(size, &*self, &mut end);
        self.stepper = stepper;
        let run = self.run.get_mut();
        run.set_outside_time(self.time + size);
        run.set_continuous_states(&end);
        run.indicators(&self.inputs).iter().any(|&indicator| indicator <= 0.0)
    }

    fn accept(&mut self, size: f64) {
        self.time += size;
        let run = self.run.get_mut();
        run.complete_step(&self.inputs);
        self.states = run.continuous_states().to_vec();
    }

    fn go(&mut self, until: f64, size: f64) {
        let mut stop = self.run.get_mut().next_kink().unwrap_or(until).min(until);
        while self.time < until && self.run.get_mut().state().ending.is_none() {
            let size = size.min(stop - self.time);
            if self.attempt(size) {
                let (mut before, mut after) = (0.0, size);
                while after - before > 1e-15 {
                    let middle = 0.5 * (before + after);
                    if self.attempt(middle) {
                        after = middle
                    } else {
                        before = middle
                    }
                    if middle == before && middle == after {
                        break;
                    }
                }
                self.attempt(after);
                self.accept(after);
                self.pass_events();
            } else {
                self.accept(size);
            }
            if self.time >= stop && stop < until {
                self.time = stop;
                self.run.get_mut().set_outside_time(stop);
                self.pass_events();
                stop = self.run.get_mut().next_kink().unwrap_or(until).min(until);
            }
        }
    }
}

/// Returns a step in which the fastest motion is resolved (s).
fn step(body: &SpaceBody) -> f64 {
    0.1 / body.fastest_square.sqrt().max(body.horizontal_stiffness / body.horizontal_damping)
}

fn kinds(events: &[SpaceEvent], foot: usize) -> Vec<SpaceEventKind> {
    of_foot(events, foot).into_iter().map(|(kind, _)| kind).collect()
}

proptest! {
    #![proptest_config(cases::cases(24))]

    /// Kinds and times, of each foot.
    #[test]
    fn events_are_those_of_the_blocks_own_steps(block in blocks(), pulses in pulses(), initial in beginnings()) {
        let body = SpaceBody::new(&block).unwrap();
        let mut inside = run(body.clone(), 1e-11, pulses, &initial);
        let expected = advance(&mut inside, 1.5, &SpaceInputs::default());
        let mut outside = Solver::begin(run(body.clone(), 1e-11, pulses, &initial), SpaceInputs::default());
        outside.go(1.5, step(&body));
        for foot in 0..body.count() {
            prop_assert_eq!(kinds(&outside.events, foot), kinds(&expected, foot), "foot {}", foot);
            for (found, expected) in of_foot(&outside.events, foot).iter().zip(of_foot(&expected, foot)) {
                prop_assert!((found.1 - expected.1).abs() < 1e-5, "{found:?}, {expected:?}");
            }
        }
        let tilts = [&*outside.run.borrow(), &inside].map(|run| run.observe(&SpaceInputs::default()).attitude.tilt);
        prop_assert!((tilts[0] - tilts[1]).abs() < 1e-6 * body.alpha, "{tilts:?}");
    }
}
