//! A run one step at a time, with the event at the end of a step before it is applied: for those who integrate other quantities
//! beside the motion, such as its derivatives.

use std::cell::Cell;
use std::sync::Arc;

use crate::block::{Block, Foundation, Regime};
use crate::excitation::{Excitation, Inputs, Pulse};
use crate::numerics::dop853::{self, EVALUATIONS_PER_STEP};
use crate::numerics::gradient::Gradient;
use crate::numerics::scalar::{Elementary, Scalar};
use crate::numerics::wide::{PlainTask, vectorized};
use crate::numerics::{State, short};
use crate::simulation::smooth_piece::SmoothPiece;
use crate::simulation::smooth_piece::{MOST_STEPS, StepStart};
use crate::simulation::{AtEvent, Pending, Simulation, SimulationError};
use crate::system::System;
use crate::system::evaluation::Motion;
use crate::system::events::Surface;
use crate::system::instant::{Footing, Pose};
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

/// The motion falls through a surface at the end of a step.
#[derive(Clone, Copy, Debug)]
pub struct Fall {
    /// The surface.
    pub surface: Surface,
    /// Rate of its function (1/s of its unit).
    pub rate: f64,
    /// Whether the function hardly falls below zero before it rises again: a neighbouring run has no such event.
    pub grazes: bool,
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

    /// Takes the next step under these inputs, and returns its course and the fall at its end. [`Simulation::settle`] applies that
    /// event. None if the run has reached the stop, or has ended.
    pub fn next(
        &mut self,
        simulation: &mut Simulation,
        inputs: &Inputs,
    ) -> Result<Option<(&Course, Option<Fall>)>, SimulationError> {
        let (time, counts) = (simulation.pose.time, simulation.counts);
        if time >= self.stop || simulation.ending.is_some() {
            return Ok(None);
        }
        let excitation = Excitation::from_time(time, inputs, &simulation.pulse, &simulation.system.block);
        let start = StepStart { of_piece: std::mem::take(&mut self.begins), short_failed: false };
        let (system, swing) = (Arc::clone(&simulation.system), Cell::new(None));
        let piece = SmoothPiece::new(&system.block, &excitation, time, [self.stop; 2], AtEvent::Stop);
        let piece = SmoothPiece { single: true, swing: Some(&swing), ..piece };
        simulation.steps(&piece, start, None, &mut self.budget, &mut |_| ())?;
        let evaluations = simulation.counts.evaluations - counts.evaluations;
        if simulation.pose.time == time {
            self.course = Course::Stayed;
        } else if let Some(swing) = swing.into_inner() {
            self.course = Course::Swing(swing);
        } else if simulation.counts.steps == counts.steps {
            self.course = Course::Rested;
        } else if evaluations < EVALUATIONS_PER_STEP {
            self.course = Course::ShortStep;
        } else {
            self.course = Course::Step;
        }
        let fall = simulation.pending.map(|Pending { surface, .. }| simulation.fall(surface, &excitation));
        Ok(Some((&self.course, fall)))
    }
}

impl Simulation {
    /// Lets time pass to `until` (s) if the block is held; only steps take any other block there.
    pub fn wait(&mut self, until: f64) {
        if self.is_frozen() {
            self.pose.time = until;
        }
    }

    /// The fall through a surface now.
    fn fall(&self, surface: Surface, excitation: &Excitation) -> Fall {
        // Depth of the dip of an event that grazes, in units of the round-off of a zero, which is 1e-13 of the largest term.
        const DEPTH: f64 = 1e4;
        // Part of the fastest period over which the rate is compared.
        const NEAR: f64 = 1e-4;
        let block = &self.system.block;
        let rate = |pose: &Pose| {
            let now = Motion::from_pose(block, pose, excitation).at(pose.time, pose.state);
            (surface.sample(&now).rate, now)
        };
        let (first, now) = rate(&self.pose);
        let duration = NEAR / block.omega_v.max(block.p);
        let x = &now.instant;
        let mut later = self.pose;
        later.time += duration;
        later.state = later.state + now.rate.state * duration;
        if let Footing::Free { u, u_dot } | Footing::Slides { u, u_dot, .. } = &mut later.footing {
            (*u, *u_dot) = (*u + x.u_dot * duration, *u_dot + x.u_ddot * duration);
        }
        let curvature = (rate(&later).0 - first) / duration;
        // It falls as `first t + curvature t²/2`.
        let is_shallow = curvature > 0.0 && first * first <= 2.0 * curvature * DEPTH * surface.rounding(block);
        Fall { surface, rate: first, grazes: first >= 0.0 || is_shallow }
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

/// State and footing at `end` (s), and the block at the times of the samples, in numbers with derivatives, by the formulas of the run's step
/// from `pose`.
pub fn repeat_step<const D: usize>(
    block: &Block<Gradient<D>>,
    pose: &Pose<Gradient<D>>,
    excitation: &Excitation<Gradient<D>>,
    course: &Course,
    end: f64,
    samples: Samples<Gradient<D>>,
) -> (State<Gradient<D>>, Footing<Gradient<D>>) {
    let law = AnyLaw::of(block, pose);
    if let (Course::Swing(swing), Some(corner)) = (course, law.regime().pivot()) {
        let [theta, theta_dot, ..] = pose.state.0;
        let tangents = swing.tangents(block, corner, excitation, [pose.time, theta, theta_dot]);
        let state = |time: f64| {
            let [theta, theta_dot] = tangents.at((time - pose.time.re) / swing.size);
            let zero = Gradient::from(0.0);
            State::from([theta, theta_dot, zero, zero])
        };
        for &time in samples.times {
            (samples.seen)(&Pose { time: time.into(), state: state(time), ..*pose });
        }
        return (state(end), pose.footing);
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
) -> (State<T>, Footing<T>)
where
    for<'a> Motion<'a, L, N, T>: StateRate<T, N>,
{
    let motion = Motion::<_, N, _>::under(law, block, pose, excitation);
    let (state, start) = (motion.state_at(pose), pose.time.value());
    let mut look = |time: f64, state: State<T, N>| {
        let (state, footing) = motion.place_at(time.into(), state);
        seen(&Pose { time: time.into(), state, footing, ..*pose });
    };
    let straight = |time: f64| state + StateRate::state_rate(&motion, start, &state) * (time - start);
    let short = |time: f64| by_short_step(&motion, state, start, time - start);
    let end_state = match course {
        // Nothing accelerates.
        _ if law.is_at_rest() => {
            times.iter().for_each(|&time| look(time, straight(time)));
            straight(end)
        }
        // A part of a short step is one, too, and more accurate.
        Course::ShortStep => {
            times.iter().for_each(|&time| look(time, short(time)));
            short(end)
        }
        Course::Stayed | Course::Step | Course::Swing(_) | Course::Rested => {
            by_step(&motion, state, start, end - start, times, &mut look)
        }
    };
    motion.place_at(end.into(), end_state)
}

/// A step in numbers with derivatives, for all laws: sums over stages are much to compile.
struct Follow<'a, T: Scalar, const N: usize> {
    equations: &'a dyn StateRate<T, N>,
    state: State<T, N>,
    start: f64,
    size: f64,
}

struct ByShortStep<'a, T: Scalar, const N: usize>(Follow<'a, T, N>);

impl<T: Scalar, const N: usize> PlainTask for ByShortStep<'_, T, N> {
    type Output = State<T, N>;

    #[inline(always)]
    fn run(self) -> State<T, N> {
        let Follow { equations, state, start, size } = self.0;
        short::follow(start, size, state, |time, state| equations.state_rate(time, &state))
    }
}

struct ByStep<'a, T: Scalar, const N: usize>(Follow<'a, T, N>);

impl<T: Scalar, const N: usize> PlainTask for ByStep<'_, T, N> {
    type Output = State<T, N>;

    #[inline(always)]
    fn run(self) -> State<T, N> {
        let Follow { equations, state, start, size } = self.0;
        dop853::follow(start, size, state, |time, state| equations.state_rate(time, &state))
    }
}

/// The state after a short step: one function for all laws, since sums over stages are much to compile.
#[inline(never)]
fn by_short_step<const N: usize, T: Elementary>(
    equations: &dyn StateRate<T, N>,
    state: State<T, N>,
    start: f64,
    size: f64,
) -> State<T, N> {
    vectorized(ByShortStep(Follow { equations, state, start, size }))
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
    // Without samples no room is cleared for the dense output.
    if inside.is_empty() {
        vectorized(ByStep(Follow { equations, state, start, size }))
    } else {
        dop853::follow_inside(start, size, state, |time, state| equations.state_rate(time, &state), inside, seen)
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
        vectorized(RateAt { motion: self, time, state })
    }
}

struct RateAt<'a, 'b, L, T: Scalar> {
    motion: &'a Motion<'b, L, 4, T>,
    time: f64,
    state: &'a State<T>,
}

impl<L: Law, T: Elementary> PlainTask for RateAt<'_, '_, L, T> {
    type Output = State<T>;

    #[inline(always)]
    fn run(self) -> State<T> {
        self.motion.state_rate(T::from(self.time), self.state)
    }
}

impl<T: Elementary, const N: usize> StateRate<T, N> for Motion<'_, AnyLaw, N, T> {
    fn state_rate(&self, time: f64, state: &State<T, N>) -> State<T, N> {
        self.rate_at_called(T::from(time), state)
    }
}
