//! A run one step at a time, with the event at the end of a step before it is applied: for those who integrate other quantities
//! beside the motion, such as its derivatives.

use std::cell::Cell;
use std::sync::Arc;

use crate::block::{Block, Foundation, Regime};
use crate::excitation::{Excitation, Inputs, Pulse};
use crate::numerics::dop853::{self, EVALUATIONS_PER_STEP};
use crate::numerics::gradient::Gradient;
use crate::numerics::scalar::Elementary;
use crate::numerics::{State, short};
use crate::simulation::smooth_piece::SmoothPiece;
use crate::simulation::stepping::{MOST_STEPS, StepStart};
use crate::simulation::{AtEvent, Pending, Simulation, SimulationError};
use crate::system::System;
use crate::system::evaluation::Motion;
use crate::system::events::Surface;
use crate::system::instant::Pose;
use crate::system::law::{AnyLaw, Gripping, Law, in_law};
use crate::system::swing::Swing;

/// The way in which a run went on.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "a step allocates nothing")]
pub enum Course {
    /// It stayed where it was: an event happens at once.
    Stayed,
    /// By a step of order 8, or by a part of one up to an event.
    Step,
    /// By a [short step](crate::numerics::short).
    ShortStep,
    /// By this [swing](crate::system::swing), or by a part of it.
    Swing(Swing),
    /// The block rests to the stop.
    Rested,
}

/// A run that goes to a stop one step at a time. It has the bits of [`Simulation::advance`].
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    stop: f64,
    begins: bool,
    budget: u64,
    course: Course,
}

impl Steps {
    /// The steps of a run on the way to `until` (s): to there, or to where its pulse begins or ends.
    pub fn towards(simulation: &Simulation, until: f64) -> Steps {
        let stop = simulation.pulse.next_kink(simulation.pose.time).map_or(until, |kink| kink.min(until));
        Steps { stop, begins: true, budget: MOST_STEPS, course: Course::Stayed }
    }

    /// Takes the next step under these inputs, and returns its course and the surface through which the motion falls at its end.
    /// [`Simulation::settle`] applies that event. None if the run has reached the stop, or has ended.
    pub fn next(
        &mut self,
        simulation: &mut Simulation,
        inputs: &Inputs,
    ) -> Result<Option<(&Course, Option<Surface>)>, SimulationError> {
        let (time, counts) = (simulation.pose.time, simulation.counts);
        if time >= self.stop || simulation.ending.is_some() {
            return Ok(None);
        }
        let excitation = Excitation::from_time(time, inputs, &simulation.pulse, &simulation.system.block);
        let start = StepStart { of_piece: std::mem::take(&mut self.begins), short_failed: false };
        let (system, swing) = (Arc::clone(&simulation.system), Cell::new(None));
        let piece = SmoothPiece {
            block: &system.block,
            excitation: &excitation,
            since: time,
            stop: self.stop,
            end: self.stop,
            at_event: AtEvent::Stop,
            single: true,
            swing: Some(&swing),
        };
        simulation.steps(&piece, start, None, &mut self.budget, &mut |_| ())?;
        let evaluations = simulation.counts.evaluations - counts.evaluations;
        self.course = if simulation.pose.time == time {
            Course::Stayed
        } else if let Some(swing) = swing.take() {
            Course::Swing(swing)
        } else if simulation.counts.steps == counts.steps {
            Course::Rested
        } else if evaluations < EVALUATIONS_PER_STEP {
            Course::ShortStep
        } else {
            Course::Step
        };
        Ok(Some((&self.course, simulation.pending.map(|Pending { surface, .. }| surface))))
    }
}

impl Simulation {
    /// Comes to `until` (s) once steps have led there, or the block is held.
    pub fn arrive(&mut self, until: f64) {
        if self.ending.is_none() || self.is_frozen() {
            self.pose.time = until;
        }
    }

    /// The block now.
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// The block and the rules by which it moves.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// The pulse.
    pub fn pulse(&self) -> &Pulse {
        &self.pulse
    }
}

/// The numbers of states under laws that integrate the horizontal motion too: `[θ, θ̇, w, ẇ, u, u̇]`.
const EXTENDED: usize = 6;

/// Times inside a step at which the block is looked at.
pub struct Samples<'a, T> {
    /// The times (s), from the beginning of the step on.
    pub times: &'a [f64],
    /// Receives the block at each of them.
    pub seen: &'a mut dyn FnMut(&Pose<T>),
}

/// The block at `end` (s) and at the times of the samples, in numbers with derivatives, by the formulas of the run's step from `pose`.
pub fn repeat_step<const D: usize>(
    block: &Block<Gradient<D>>,
    pose: &Pose<Gradient<D>>,
    excitation: &Excitation<Gradient<D>>,
    course: &Course,
    end: f64,
    samples: Samples<Gradient<D>>,
) -> Pose<Gradient<D>> {
    let law = AnyLaw::of(block, pose);
    if let (Course::Swing(swing), Some(corner)) = (course, law.regime().pivot()) {
        let [theta, theta_dot, ..] = pose.state.0;
        let tangents = swing.tangents(block, corner, excitation, [pose.time, theta, theta_dot]);
        let at = |time: f64| {
            let [theta, theta_dot] = tangents.at((time - pose.time.re) / swing.size);
            let zero = Gradient::from(0.0);
            Pose { time: time.into(), state: [theta, theta_dot, zero, zero].into(), ..*pose }
        };
        samples.times.iter().for_each(|&time| (samples.seen)(&at(time)));
        return at(end);
    }
    match law.extended() {
        Some(_) => repeat_under::<EXTENDED, _, _>(law, block, pose, excitation, course, end, samples),
        None => in_law!(law, law => repeat_under::<4, _, _>(law, block, pose, excitation, course, end, samples)),
    }
}

fn repeat_under<const N: usize, L: Law, T: Elementary>(
    law: L,
    block: &Block<T>,
    pose: &Pose<T>,
    excitation: &Excitation<T>,
    course: &Course,
    end: f64,
    Samples { times, seen }: Samples<T>,
) -> Pose<T>
where
    for<'a> Motion<'a, L, N, T>: StateRate<T, N>,
{
    let motion = Motion::<_, N, _>::under(law, block, pose, excitation);
    let (state, start) = (motion.state_at(pose), pose.time.value());
    let at = |time: f64, state: State<T, N>| motion.pose_at(pose, T::from(time), state);
    let straight = |time: f64| state + StateRate::state_rate(&motion, start, &state) * (time - start);
    let short = |time: f64| by_short_step(&motion, state, start, time - start);
    let end_state = match course {
        // Nothing accelerates.
        _ if law.is_at_rest() => {
            times.iter().for_each(|&time| seen(&at(time, straight(time))));
            straight(end)
        }
        // A part of a short step is one, too, and more accurate.
        Course::ShortStep => {
            times.iter().for_each(|&time| seen(&at(time, short(time))));
            short(end)
        }
        Course::Stayed | Course::Step | Course::Swing(_) | Course::Rested => {
            by_step(&motion, state, start, end - start, times, &mut |time, state| seen(&at(time, state)))
        }
    };
    at(end, end_state)
}

/// The state after a short step: one function for all laws, since sums over stages are much to compile.
#[inline(never)]
fn by_short_step<const N: usize, T: Elementary>(
    equations: &dyn StateRate<T, N>,
    state: State<T, N>,
    start: f64,
    size: f64,
) -> State<T, N> {
    short::follow(start, size, state, |time, state| equations.state_rate(time, &state))
}

/// The same after a step of order 8, with the states inside.
#[inline(never)]
fn by_step<const N: usize, T: Elementary>(
    equations: &dyn StateRate<T, N>,
    state: State<T, N>,
    start: f64,
    size: f64,
    inside: &[f64],
    seen: &mut dyn FnMut(f64, State<T, N>),
) -> State<T, N> {
    let rate = |time, state| equations.state_rate(time, &state);
    // Without samples no room is cleared for the dense output.
    if inside.is_empty() {
        dop853::follow(start, size, state, rate)
    } else {
        dop853::follow_inside(start, size, state, rate, inside, seen)
    }
}

/// A right-hand side without the quadratures.
trait StateRate<T, const N: usize> {
    /// Rate of a state at a time (s).
    fn state_rate(&self, time: f64, state: &State<T, N>) -> State<T, N>;
}

impl<T: Elementary, const LEFT: bool, const RIGHT: bool, const RIGID: bool> StateRate<T, 4>
    for Motion<'_, Gripping<LEFT, RIGHT, RIGID>, 4, T>
{
    fn state_rate(&self, time: f64, state: &State<T>) -> State<T> {
        Motion::state_rate(self, T::from(time), state)
    }
}

impl<T: Elementary, const N: usize> StateRate<T, N> for Motion<'_, AnyLaw, N, T> {
    fn state_rate(&self, time: f64, state: &State<T, N>) -> State<T, N> {
        self.rate_at_called(T::from(time), state)
    }
}
