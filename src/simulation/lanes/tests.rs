//! Runs in lanes that give up.

use super::*;

use crate::block::{Common, Dimensionless, Ratios, Supports};
use crate::excitation::Pulse;
use crate::simulation::{Initial, Settings};

/// A block that tilts and does not come down within the next step.
fn lane() -> Lane {
    let numbers =
        Dimensionless { alpha: 0.25, p: 2.0, supports: Supports::Viscoelastic(Ratios { eta: 20.0, xi_v: 0.1 }) };
    let block = Block::from_dimensionless(&numbers, &Common::default()).unwrap();
    let initial = Initial { theta: 0.15, ..Initial::default() };
    let inputs = Inputs::default();
    Lane::new(Simulation::new(block, Settings::default(), Pulse::NONE, &initial, 0.0, &inputs), 0)
}

fn gives_up(lane: &mut Lane) {
    assert_eq!(lane.next_step(&Inputs::default()), Next::Alone);
    let error = lane.step_alone(&Inputs::default(), &mut |_| ()).unwrap_err();
    assert!(matches!(error, SimulationError::TooManySteps { .. }), "{error}");
}

/// As a run does that is stepped alone.
#[test]
fn a_run_that_has_no_steps_left_gives_up() {
    let mut group = [Box::new(lane())];
    group[0].send(10.0, &Inputs::default());
    group[0].budget = 2;
    for _ in 0..2 {
        let went = loop {
            let next = group[0].next_step(&Inputs::default());
            let Next::Together(kind) = next else { panic!("{next:?}") };
            let went = VectorWidth::widest().map(|width| step_group(width, kind, &mut group));
            // One with too great an error is repeated.
            if !matches!(group[0].next, NextStep::Shorter) {
                break went;
            }
        };
        if went != Some(1) {
            group[0].step_alone(&Inputs::default(), &mut |_| ()).unwrap();
        }
    }
    gives_up(&mut group[0]);
}

/// A stop however far away is reached by steps that the clock resolves, with the bits of a run alone.
#[test]
fn a_run_to_a_far_stop_has_the_bits_of_a_run_alone() {
    let mut group = [Box::new(lane())];
    let mut alone = group[0].simulation.clone();
    alone.advance(1e300, &Inputs::default(), &mut |_| ()).unwrap();
    group[0].send(1e300, &Inputs::default());
    loop {
        match group[0].next_step(&Inputs::default()) {
            Next::Arrived => break,
            Next::Alone => group[0].step_alone(&Inputs::default(), &mut |_| ()).unwrap(),
            Next::Together(kind) => {
                if VectorWidth::widest().map(|width| step_group(width, kind, &mut group)) != Some(1) {
                    group[0].step_alone(&Inputs::default(), &mut |_| ()).unwrap();
                }
            }
        }
    }
    assert_eq!(group[0].simulation().pose(), alone.pose());
    assert_eq!(group[0].simulation().peaks(), alone.peaks());
}

/// Where the clock does not resolve the steps of a moving block.
#[test]
fn a_run_that_the_clock_does_not_resolve_gives_up() {
    let mut lane = lane();
    lane.simulation.set_time(1e18);
    lane.send(2e18, &Inputs::default());
    gives_up(&mut lane);
}
