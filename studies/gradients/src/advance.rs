//! A run and its followers → both at a later time, and samples on the way.

use rocking_block::excitation::Inputs;
use rocking_block::simulation::follow::Steps;
use rocking_block::simulation::{Simulation, SimulationError};

use crate::Number;
use crate::follower::{Follower, Sample};

/// Advances a run and its derivatives to `until` (s) under inputs linear in time. The run has the bits of [`Simulation::advance`].
///
/// # Errors
/// Those of [`Simulation::advance`].
pub fn advance(
    simulation: &mut Simulation,
    followers: &mut [Follower],
    until: f64,
    inputs: &Inputs,
) -> Result<(), SimulationError> {
    advance_with_samples(simulation, followers, until, inputs, &[], &mut |_, _, _| ()).map(|_| ())
}

/// Advances as [`advance`] does, and samples each follower at `times` (s), without a stop there. The times increase, and are before
/// `until`.
///
/// `observer` receives the indices of the time and of the follower, and the sample. At an event or the beginning of a pulse the sample
/// is taken right after it. Returns the number of sampled times.
///
/// # Errors
/// Those of [`Simulation::advance`].
pub fn advance_with_samples(
    simulation: &mut Simulation,
    followers: &mut [Follower],
    until: f64,
    inputs: &Inputs,
    times: &[f64],
    observer: &mut dyn FnMut(usize, usize, &Sample),
) -> Result<usize, SimulationError> {
    let mut first = 0;
    while simulation.time() < until && simulation.ending().is_none() {
        for follower in followers.iter_mut() {
            follower.begin_piece(simulation, inputs);
        }
        let mut steps = Steps::towards(simulation, until);
        loop {
            let peaks = simulation.peaks();
            let Some((kind, fall)) = steps.next(simulation, inputs)? else { break };
            let inside = &times[first..];
            let inside = &inside[..inside.partition_point(|time| *time < simulation.time())];
            for (number, follower) in followers.iter_mut().enumerate() {
                let mut next = first;
                follower.take_step(kind, fall, &peaks, simulation, inside, &mut |sample| {
                    observer(next, number, sample);
                    next += 1;
                });
            }
            first += inside.len();
            let Some(fall) = fall else { continue };
            let mut happened = None;
            let Some(after) =
                simulation.apply_pending_event_with_rates(inputs, &mut |event| happened = Some(*event))?
            else {
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
