//! The block in space: equations, closed forms, reference trajectories, symmetries, random runs.

#[path = "../common/cases.rs"]
mod cases;
#[path = "../common/skipped.rs"]
mod skipped;

mod closed_forms;
mod critical_tilts;
mod equations;
mod exchange;
mod excitation;
mod parameters;
mod random;
mod rates;
mod reference;
mod rest;
mod states;
mod symmetry;

use std::f64::consts::TAU;

use rocking_block::excitation::{Pulse, PulseShape, Ramp};
use rocking_block::run::{OnOverturning, OnSeparation, Settings};
use rocking_block::space::excitation::{DirectedPulses, MAX_PULSES};
use rocking_block::space::{
    Base, BaseSize, DirectedPulse, SpaceBody, SpaceEvent, SpaceEventKind, SpaceInitial, SpaceInputs, SpaceParameters,
    SpaceRun, SpaceSetup, SpaceSupports,
};

/// Settings of a block that flies.
fn settings(tolerance: f64) -> Settings {
    Settings { tolerance, on_separation: OnSeparation::Fly, on_overturning: OnOverturning::Terminate }
}

/// No pulses.
const STILL: DirectedPulses = [DirectedPulse::NONE; MAX_PULSES];

fn run(body: SpaceBody, tolerance: f64, pulses: DirectedPulses, initial: &SpaceInitial) -> SpaceRun {
    SpaceRun::new(SpaceSetup { body, settings: settings(tolerance), pulses }, initial, 0.0)
}

/// Advances to `until` (s) in one call, and returns the events.
fn advance(run: &mut SpaceRun, until: f64, inputs: &SpaceInputs) -> Vec<SpaceEvent> {
    let mut events = Vec::new();
    run.advance(until, inputs, &mut |event| events.push(*event)).unwrap();
    events
}

/// A block at rest.
const AT_REST: SpaceInitial = SpaceInitial { tilt: [0.0; 2], twist: 0.0, omega: [0.0; 3], vertical: Some([0.0; 2]) };

fn sine(amplitude: f64, omega: f64, start: f64, direction: [f64; 3]) -> DirectedPulse {
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude, period: TAU / omega, start, ..Pulse::NONE };
    DirectedPulse { pulse, direction }
}

/// The two-axis pulse of the references, with another friction.
fn two_axis(friction: f64) -> (SpaceParameters, DirectedPulses) {
    let base = Base::Rectangle { size: BaseSize::Slenderness { alpha: 0.25, p: 1.5 }, depth_ratio: 1.3 };
    let supports = SpaceSupports::OfRocking { eta: 40.0, xi_v: 0.2 };
    let parameters = SpaceParameters { base, supports, friction, mass: 1.0, ..SpaceParameters::default() };
    let pulses = [sine(3.654, 6.0, 0.0, [1.0, 0.0, 0.0]), sine(3.045, 7.5, 0.2, [0.0, 1.0, 0.0]), DirectedPulse::NONE];
    (parameters, pulses)
}

/// Inputs with constant ground accelerations (m/s²).
fn held(ground: [f64; 3]) -> SpaceInputs {
    SpaceInputs { ground: ground.map(Ramp::held), ..SpaceInputs::default() }
}

/// The events of a foot, with their times.
fn of_foot(events: &[SpaceEvent], foot: usize) -> Vec<(SpaceEventKind, f64)> {
    let is_of = |kind: SpaceEventKind| match kind {
        SpaceEventKind::LiftOff(i)
        | SpaceEventKind::Landing(i)
        | SpaceEventKind::Slides(i)
        | SpaceEventKind::Sticks(i) => i == foot,
        SpaceEventKind::Overturning => false,
    };
    events.iter().filter(|event| is_of(event.kind)).map(|event| (event.kind, event.time)).collect()
}
