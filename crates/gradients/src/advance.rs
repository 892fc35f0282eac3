//! A run and its followers → both at a later time, and samples on the way.

use rocking_block::excitation::Inputs;
use rocking_block::simulation::follow::Steps;
use rocking_block::simulation::{Simulation, SimulationError};

use crate::Number;
use crate::follower::{Follower, Sample};

/// Sends a run to `until` (s) under inputs that are linear in time, as [`Simulation::advance`] does, to the same bits; its derivatives
/// go with it.
pub fn advance(
    simulation: &mut Simulation,
    followers: &mut [Follower],
    until: f64,
    inputs: &Inputs,
) -> Result<(), SimulationError> {
    advance_with_samples(simulation, followers, until, inputs, &[], &mut |_, _, _| ()).map(|_| ())
}

/// The same, which also passes the block at increasing `times` (s) before `until` to `seen`, with the numbers of the time and of the
/// follower; no step stops there. Returns the number of these times.
///
/// Where an event happens or a pulse begins at one of them, the block is that right after it.
pub fn advance_with_samples(
    simulation: &mut Simulation,
    followers: &mut [Follower],
    until: f64,
    inputs: &Inputs,
    times: &[f64],
    seen: &mut dyn FnMut(usize, usize, &Sample),
) -> Result<usize, SimulationError> {
    let mut first = 0;
    while simulation.time() < until && simulation.ending().is_none() {
        for follower in followers.iter_mut() {
            follower.begin_piece(simulation, inputs);
        }
        let mut steps = Steps::towards(simulation, until);
        loop {
            let peaks = simulation.peaks();
            let Some((course, fall)) = steps.next(simulation, inputs)? else { break };
            let inside = &times[first..];
            let inside = &inside[..inside.partition_point(|time| *time < simulation.time())];
            for (number, follower) in followers.iter_mut().enumerate() {
                let mut next = first;
                follower.take_step(course, fall, &peaks, simulation, inside, &mut |sample| {
                    seen(next, number, sample);
                    next += 1;
                });
            }
            first += inside.len();
            let Some(fall) = fall else { continue };
            let mut happened = None;
            let Some(after) = simulation.settle_with_rates(inputs, &mut |event| happened = Some(*event))? else {
                continue;
            };
            for follower in followers.iter_mut() {
                follower.pass_event(&fall, happened, &after, simulation);
            }
        }
    }
    simulation.wait(until);
    for follower in followers {
        follower.pose.time = Number::from(simulation.time());
    }
    Ok(first)
}
