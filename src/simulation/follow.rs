//! A run one step at a time, with the event at the end of a step before it is applied: for those who integrate other quantities
//! beside the motion, such as its derivatives.

use crate::block::{Block, Foundation, Regime};
use crate::excitation::{Excitation, Inputs, Pulse};
use crate::numerics::dop853::{self, EVALUATIONS_PER_STEP};
use crate::numerics::scalar::Elementary;
use crate::numerics::{Equations, State, short};
use crate::simulation::stepping::{MOST_STEPS, StepStart};
use crate::simulation::{AtEvent, Pending, Simulation, SimulationError};
use crate::system::System;
use crate::system::evaluation::Motion;
use crate::system::events::Surface;
use crate::system::instant::Pose;
use crate::system::law::{AnyLaw, Gripping, Law, in_law};

/// The way in which a run went on. On a corner of the rigid base, where it moves by [swings](crate::system::swing), `Step` and `ShortStep`
/// tell nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// It stayed where it was: an event happens at once.
    Stayed,
    /// By a step of order 8, or by a part of one up to an event.
    Step,
    /// By a [short step](crate::numerics::short).
    ShortStep,
    /// The block rests to the stop.
    Rested,
}

/// A run that goes to a stop one step at a time. It has the bits of [`Simulation::advance`].
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    stop: f64,
    begins: bool,
    budget: u64,
}

impl Steps {
    /// The steps of a run on the way to `until` (s): to there, or to where its pulse begins or ends.
    pub fn towards(simulation: &Simulation, until: f64) -> Steps {
        let stop = simulation.pulse.next_kink(simulation.pose.time).map_or(until, |kink| kink.min(until));
        Steps { stop, begins: true, budget: MOST_STEPS }
    }

    /// Takes the next step under these inputs, and returns its course and the surface through which the motion falls at its end.
    /// [`Simulation::settle`] applies that event. None if the run has reached the stop, or has ended.
    pub fn next(
        &mut self,
        simulation: &mut Simulation,
        inputs: &Inputs,
    ) -> Result<Option<(Course, Option<Surface>)>, SimulationError> {
        let (time, counts) = (simulation.pose.time, simulation.counts);
        if time >= self.stop || simulation.ending.is_some() {
            return Ok(None);
        }
        let excitation = Excitation::from_time(time, inputs, &simulation.pulse, &simulation.system.block);
        let start = StepStart { of_piece: std::mem::take(&mut self.begins), short_failed: false };
        simulation.single_step(self.stop, &excitation, start, AtEvent::Stop, &mut self.budget, &mut |_| ())?;
        let evaluations = simulation.counts.evaluations - counts.evaluations;
        let course = if simulation.pose.time == time {
            Course::Stayed
        } else if simulation.counts.steps == counts.steps {
            Course::Rested
        } else if evaluations < EVALUATIONS_PER_STEP {
            Course::ShortStep
        } else {
            Course::Step
        };
        Ok(Some((course, simulation.pending.map(|Pending { surface, .. }| surface))))
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

/// Steps of order 8 in place of a swing on the rigid base, which has up to twice as many terms: per 1/p, or under a pulse.
const SWING_PARTS: f64 = 8.0;

/// The block at `end` (s) in numbers with derivatives, by the formulas of the run's step from `pose`; a swing on the rigid base is
/// replaced by several steps of order 8.
pub fn repeat_step<T: Elementary>(
    block: &Block<T>,
    pose: &Pose<T>,
    excitation: &Excitation<T>,
    course: Course,
    end: f64,
) -> Pose<T> {
    let law = AnyLaw::of(block, pose);
    match law.extended() {
        Some(law) => repeat_under::<EXTENDED, T>(law, block, pose, excitation, course, end),
        None => in_law!(law, law => repeat_under::<4, T>(law, block, pose, excitation, course, end)),
    }
}

fn repeat_under<const N: usize, T: Elementary>(
    law: impl Law,
    block: &Block<T>,
    pose: &Pose<T>,
    excitation: &Excitation<T>,
    course: Course,
    end: f64,
) -> Pose<T> {
    let motion = Motion::<_, N, _>::under(law, block, pose, excitation);
    let (state, start) = (motion.state_at(pose), pose.time.value());
    let parts = match (law.foundation(), law.regime().pivot()) {
        (Foundation::Rigid, Some(_)) if !excitation.is_linear() => Some(SWING_PARTS),
        (Foundation::Rigid, Some(_)) => Some((SWING_PARTS * block.p.value() * (end - start)).ceil().max(1.0)),
        (Foundation::Rigid, None) | (Foundation::Viscoelastic, _) => None,
    };
    let state = match (course, parts) {
        (Course::ShortStep, None) => by_short_step(&motion, state, start, end - start),
        (_, parts) => by_steps(&motion, state, start, end - start, parts.unwrap_or(1.0)),
    };
    let there = motion.at(T::from(end), state);
    Pose { time: there.time, state: there.state, footing: there.footing, ..*pose }
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

/// The same after this number of steps of order 8.
#[inline(never)]
fn by_steps<const N: usize, T: Elementary>(
    equations: &dyn StateRate<T, N>,
    mut state: State<T, N>,
    start: f64,
    size: f64,
    parts: f64,
) -> State<T, N> {
    for part in 0..parts as u32 {
        let begin = start + f64::from(part) * size / parts;
        state = dop853::follow(begin, size / parts, state, |time, state| equations.state_rate(time, &state));
    }
    state
}

/// A right-hand side without the quadratures.
trait StateRate<T, const N: usize> {
    /// Rate of a state at a time (s).
    fn state_rate(&self, time: f64, state: &State<T, N>) -> State<T, N>;
}

impl<L: Law, T: Elementary, const N: usize> StateRate<T, N> for Motion<'_, L, N, T> {
    fn state_rate(&self, time: f64, state: &State<T, N>) -> State<T, N> {
        self.rate(T::from(time), state).state
    }
}
