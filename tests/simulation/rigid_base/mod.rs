//! The rigid base: no corner pulls. First instants and jumps, separation, sliding, flight, landings, restitution.

mod flights;
mod instants;
mod landings;
mod properties;
mod pulses;
mod restitution;

use rocking_block::block::Block;
use rocking_block::excitation::{Inputs, Pulse, Ramp};
use rocking_block::simulation::outputs::Observation;
use rocking_block::simulation::{Initial, OnSeparation, Settings, Simulation};
use rocking_block::system::events::Event;

pub use crate::blocks::rigid as block;

/// Gravity of the blocks (m/s²).
pub const G: f64 = 9.81;

/// Returns a run at its start, at a tight tolerance.
pub fn start(
    block: Block,
    on_separation: OnSeparation,
    pulse: Pulse,
    initial: &Initial,
    inputs: &Inputs,
) -> Simulation {
    let settings = Settings { tolerance: 1e-11, on_separation, ..Settings::default() };
    Simulation::new(block, settings, pulse, initial, 0.0, inputs)
}

/// Advances and returns the events.
pub fn go(simulation: &mut Simulation, until: f64, inputs: &Inputs) -> Vec<Event> {
    let mut events = Vec::new();
    simulation.advance(until, inputs, &mut |event| events.push(*event)).unwrap();
    events
}

/// Constant ground accelerations.
pub fn held(a_gx: f64, a_gz: f64) -> Inputs {
    Inputs { a_gx: Ramp::held(a_gx), a_gz: Ramp::held(a_gz), ..Inputs::default() }
}

/// Returns the outputs without inputs.
pub fn seen(simulation: &Simulation) -> Observation<f64> {
    simulation.observe(&Inputs::default())
}

/// Checks that two numbers agree to round-off, relative to a size.
#[track_caller]
pub fn close(found: f64, exact: f64, relative_to: f64) {
    assert!((found - exact).abs() <= 1e-12 * relative_to.abs(), "{found} instead of {exact}");
}
