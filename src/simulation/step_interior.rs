//! A step → the motion between its ends, and the first event function that reaches zero.

use crate::block::{Body, Foundation, Regime};
use crate::numerics::Rate;
use crate::numerics::dop853::{DenseOutput, DenseStep, EVALUATIONS_OF_DENSE_OUTPUT};
use crate::numerics::dual::Dual;
use crate::numerics::roots;
use crate::simulation::outputs::Channels;
use crate::simulation::peaks::{Channel, Peaks};
use crate::system::evaluation::{Evaluation, Motion};
use crate::system::events::{EventFunction, extended_event_functions, quarter_turn, watched};
use crate::system::instant::{Powers, State};
use crate::system::motion_mode::MotionMode;
use crate::system::swing::Swing;

/// The largest rotation of a block in flight within a step (rad). Its rotation is a polynomial of time, which every step follows
/// without error, so the error never limits the step; but the heights of its corners follow the sine of the angle.
pub(super) const MAX_TURN: f64 = 1.0;

/// Largest rotation in a step (rad) whose ends alone show whether a corner landed inside. The height is then a cubic up to `turn⁴/384` R0.
pub(super) const SMALL_TURN: f64 = 0.1;

/// Bound on the rotation (rad) of a flying block in a step of `size` (s). Zero if the block stands.
///
/// Its angular acceleration is linear in time in flight. So its rate is a parabola, whose control polygon bounds it.
#[inline(always)]
pub(super) fn turn_in_flight<const A: usize, const B: usize>(
    mode: impl MotionMode,
    start: &State<f64, A>,
    end: &State<f64, B>,
    size: f64,
) -> f64 {
    if mode.regime() != Regime::Separated {
        return 0.0;
    }
    let [theta, theta_dot, theta_after, theta_dot_after] = [start[0], start[1], end[0], end[1]];
    let (first, last) = (size * theta_dot, size * theta_dot_after);
    let between = 3.0 * (theta_after - theta) - first - last;
    first.abs().max(between.abs()).max(last.abs())
}

/// Round-off of a watched function with these samples at the ends of a step.
///
/// An arc of a block that tilts on the rigid base has none, since the gap is a function of θ alone. With that of other gaps the
/// landings of the lowest arcs would be placed too late, and the block would gain energy on the wrong side of its pivot.
#[inline(always)]
fn rounding(mode: impl MotionMode, function: EventFunction, body: &Body, [start, end]: [Dual; 2]) -> f64 {
    let tilts = mode.foundation() == Foundation::Rigid && mode.regime().pivot().is_some();
    let is_arc = start.re >= 0.0 && start.eps > 0.0 || start.re > 0.0 && end.re < 0.0;
    if tilts && is_arc && matches!(function, EventFunction::Gap(_)) { 0.0 } else { function.rounding(body) }
}

/// Whether a function with these samples at the ends may fall through zero. On supports their bounds decide.
#[inline(always)]
fn may_fall(mode: impl MotionMode, start: Dual, end: Dual, rounding: f64, duration: f64) -> bool {
    if mode.is_static() && mode.foundation() == Foundation::Viscoelastic {
        roots::may_fall_by_bounds(start, end, rounding, duration)
    } else {
        // The gap of a block that tilts on a rigid base has no round-off, and one that slides or is held may soon be back at zero.
        roots::may_fall(start, end, rounding, duration)
    }
}

/// Whether an event function may fall through zero between two instants.
#[inline(always)]
pub(super) fn may_contain_event(mode: impl MotionMode, here: &Evaluation, there: &Evaluation) -> bool {
    let may_fall = |function: EventFunction| {
        let start = function.sample_on(mode.foundation(), here);
        let end = function.sample_on(mode.foundation(), there);
        may_fall(mode, start, end, rounding(mode, function, here.body, [start, end]), there.time - here.time)
    };
    watched(mode).into_iter().flatten().any(may_fall)
        || (!mode.is_static() && may_contain_extended_event(mode, here, there))
}

#[inline(never)]
fn may_contain_extended_event(mode: impl MotionMode, here: &Evaluation, there: &Evaluation) -> bool {
    extended_event_functions(mode, here.body).into_iter().flatten().any(|function| {
        let (start, end) = (function.sample(here), function.sample(there));
        roots::may_fall(start, end, function.rounding(here.body), there.time - here.time)
    })
}

/// The fall of an event function through zero between two instants.
#[derive(Clone, Copy, Debug)]
pub(super) struct EventCrossing {
    /// Its time, in seconds after the first of them.
    pub(super) elapsed: f64,
    /// The event function.
    pub(super) function: EventFunction,
    /// Whether the function begins at zero and seems to fall, against its rate there. It rises for a time too short for this step.
    pub(super) rise_unseen: bool,
}

/// The first event function that falls through zero between two instants. Their step is at most `longest` (s).
#[inline(always)]
pub(super) fn first_event<L: MotionMode, const N: usize>(
    here: &Evaluation,
    there: &Evaluation,
    longest: f64,
    inside: &mut StepInterior<L, N>,
) -> Option<EventCrossing> {
    let mut first: Option<EventCrossing> = None;
    let duration = there.time - here.time;
    let mode = inside.motion.mode();
    // In flight, heights of corners may turn faster than the motion that limits steps.
    let bounded = mode.is_static() && mode.foundation() == Foundation::Viscoelastic;
    let turns_far = turn_in_flight::<4, 4>(mode, &here.state, &there.state, duration) > SMALL_TURN;
    for function in watched(mode).into_iter().flatten() {
        let [start, end] = [here, there].map(|now| function.sample_on(mode.foundation(), now));
        let rounding = rounding(mode, function, here.body, [start, end]);
        let hidden = turns_far && matches!(function, EventFunction::Gap(_));
        if !hidden && !may_fall(mode, start, end, rounding, duration) {
            continue;
        }
        let mut sample = |elapsed| inside.sample(function, elapsed);
        // No corner leaves the rigid base with a rate, so a gap that falls from zero is that of a corner beside the pivot, which has come
        // down. A corner may leave a support with a rate, as the angular momentum is kept.
        let on_base = here.body.foundation == Foundation::Rigid && matches!(function, EventFunction::Gap(_));
        let down = on_base && roots::leaves_downwards(start, rounding, duration, &mut sample);
        let fall = if down {
            Some(0.0)
        } else {
            let pieces = if bounded { roots::pieces(duration / longest) } else { roots::PIECES };
            roots::first_fall(start, end, rounding, duration, pieces, bounded, &mut sample)
        };
        if let Some(elapsed) = fall
            && first.is_none_or(|earliest| elapsed < earliest.elapsed)
        {
            let rise_unseen = elapsed == 0.0 && !down && start.re >= -rounding;
            first = Some(EventCrossing { elapsed, function, rise_unseen });
        }
    }
    if L::STATIC { first } else { first_extended_event(here, there, inside, first) }
}

/// The first event of friction or restraints, if it is earlier than `first`, else `first`.
#[inline(never)]
fn first_extended_event<L: MotionMode, const N: usize>(
    here: &Evaluation,
    there: &Evaluation,
    inside: &mut StepInterior<L, N>,
    mut first: Option<EventCrossing>,
) -> Option<EventCrossing> {
    let duration = there.time - here.time;
    for function in extended_event_functions(inside.motion.mode(), here.body).into_iter().flatten() {
        let rounding = function.rounding(here.body);
        let (start, end) = (function.sample(here), function.sample(there));
        if !roots::may_fall(start, end, rounding, duration) {
            continue;
        }
        let mut sample = |elapsed| function.sample(&inside.at(elapsed));
        let down = roots::leaves_downwards(start, rounding, duration, &mut sample);
        let fall = if down {
            Some(0.0)
        } else {
            roots::first_fall(start, end, rounding, duration, roots::PIECES, false, &mut sample)
        };
        if let Some(elapsed) = fall
            && first.is_none_or(|earliest| elapsed < earliest.elapsed)
        {
            let rise_unseen = elapsed == 0.0 && !down && start.re >= -rounding;
            first = Some(EventCrossing { elapsed, function, rise_unseen });
        }
    }
    first
}

/// The time (s) of an event, `elapsed` seconds after another.
///
/// A landing after less than the clock resolves is at the next time of the clock: in the same instant the base or a support that only
/// pulls there would lift the block again, and again.
pub(super) fn event_time(function: EventFunction, time: f64, elapsed: f64) -> f64 {
    let lands = matches!(function, EventFunction::Gap(_));
    if lands && elapsed > 0.0 { (time + elapsed).max(time.next_up()) } else { time + elapsed }
}

/// The motion between the ends of a step.
pub(super) enum Between<'s, const N: usize = 4> {
    /// A dense output that is known.
    Known(DenseOutput<N>),
    /// The dense output of a step with this final rate, computed on first use.
    Within(&'s DenseStep<N>, Rate<f64, N>),
    /// A swing about a corner of the rigid base, from this time (s) on.
    Swing(f64, &'s Swing),
}

/// The motion inside a step.
pub(super) struct StepInterior<'s, 'a, L, const N: usize = 4> {
    pub(super) motion: Motion<'a, L, N>,
    pub(super) between: Between<'s, N>,
    /// Evaluations of the right-hand side for the dense output.
    pub(super) evaluations: u64,
}

impl<'a, L: MotionMode, const N: usize> StepInterior<'_, 'a, L, N> {
    #[inline]
    fn dense(&mut self) -> &DenseOutput<N> {
        if let Between::Within(step, end) = self.between {
            self.between = Between::Known(step.dense(end, &self.motion));
            self.evaluations = EVALUATIONS_OF_DENSE_OUTPUT;
        }
        match &self.between {
            Between::Known(dense) => dense,
            Between::Within(..) => unreachable!("it has been formed"),
            Between::Swing(..) => unreachable!("a swing needs none"),
        }
    }

    /// The state `elapsed` seconds after the beginning of the step.
    pub(super) fn state(&mut self, elapsed: f64) -> State<f64, N> {
        match self.between {
            Between::Swing(_, swing) => {
                let [theta, theta_dot] = swing.at(elapsed / swing.size);
                State::from(std::array::from_fn(|i| [theta, theta_dot, 0.0, 0.0].get(i).copied().unwrap_or(0.0)))
            }
            Between::Known(_) | Between::Within(..) => self.dense().state(elapsed),
        }
    }

    /// Value and rate of an event function `elapsed` seconds after the beginning of the step.
    #[inline]
    fn sample(&mut self, function: EventFunction, elapsed: f64) -> Dual {
        if function == EventFunction::QuarterTurn {
            let state = self.state(elapsed);
            return quarter_turn::remaining_angle([state[0], state[1]]);
        }
        function.sample(&self.at(elapsed))
    }

    /// A candidate of [`Channels::candidates`], with its channel, `elapsed` seconds after the beginning of the step.
    #[inline]
    pub(super) fn candidate(&mut self, channel: Channel, number: usize, elapsed: f64) -> Dual {
        let channels = match channel {
            Channel::Theta => {
                let state = self.state(elapsed);
                Channels { theta: Dual::new(state[0], state[1]), ..Channels::default() }
            }
            Channel::Reaction | Channel::Horizontal | Channel::FrictionDemand | Channel::Uplift => {
                self.at(elapsed).channels_outlined()
            }
        };
        channels.candidates()[number].1
    }

    /// Includes the peaks from `here` to `there`, which lie in the step. See [`Peaks::channels_at_ends`].
    #[inline(always)]
    pub(super) fn include_in(&mut self, peaks: &mut Peaks, here: &Evaluation, there: &Evaluation, near: f64) {
        let duration = there.time - here.time;
        if duration <= 0.0 {
            return;
        }
        let [start, end] = peaks.channels_at_ends(here, there, near);
        let mut candidate = |channel, number, elapsed| self.candidate(channel, number, elapsed);
        peaks.include_step(&start, &end, duration, &mut candidate);
    }

    /// The works from the beginning of the step to `elapsed`.
    pub(super) fn work(&mut self, elapsed: f64) -> Powers {
        match self.between {
            Between::Swing(_, swing) => [swing.work(elapsed / swing.size), 0.0].into(),
            Between::Known(_) | Between::Within(..) => self.dense().work(elapsed),
        }
    }

    /// The block `elapsed` seconds after the beginning of the step.
    #[inline(never)]
    pub(super) fn at(&mut self, elapsed: f64) -> Evaluation<'a> {
        let start = match self.between {
            Between::Swing(start, _) => start,
            Between::Known(_) | Between::Within(..) => self.dense().time,
        };
        let state = self.state(elapsed);
        self.motion.at(start + elapsed, state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::{Block, Common, Corner, Dimensionless, Supports};
    use crate::excitation::{Inputs, Pulse, Ramp};
    use crate::simulation::{Initial, Settings, Simulation};
    use crate::system::motion_mode::Gripping;

    /// State and work at a time inside a swing are those of a run that ends there.
    #[test]
    fn the_interior_of_a_swing_is_the_motion_up_to_there() {
        let numbers = Dimensionless { alpha: 0.25, p: 2.0, supports: Supports::HOUSNER };
        let block = Block::from_dimensionless(&numbers, &Common::default()).unwrap();
        let inputs = Inputs { a_gx: Ramp { value: 0.3, rate: 2.0 }, ..Inputs::default() };
        let [theta, theta_dot] = [0.1, 0.2];
        let initial = Initial { theta, theta_dot, ..Initial::default() };
        let settings = Settings { tolerance: 1e-12, ..Settings::default() };
        let start = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &inputs);
        let excitation = start.setup.excitation(0.0, &inputs);
        let swing = Swing::of(&block, Corner::Right, &excitation, [0.0, theta, theta_dot], 0.1, 1e-9);
        let motion = Motion::<_, 4>::under(Gripping::<false, true, true>, &block, &start.run.pose, &excitation);
        let mut inside = StepInterior { motion, between: Between::Swing(0.0, &swing), evaluations: 0 };
        for fraction in [0.3, 0.8] {
            let elapsed = fraction * swing.size;
            let mut run = start.clone();
            run.advance(elapsed, &inputs, &mut |_| ()).unwrap();
            let (found, expected) = (inside.state(elapsed), run.state());
            let close = |found: f64, expected: f64| (found - expected).abs() < 1e-10 * expected.abs();
            assert!(close(found[0], expected[0]) && close(found[1], expected[1]), "{found:?}, not {expected:?}");
            let (found, expected) = (inside.work(elapsed)[0], run.run.sums.input);
            assert!(close(found, expected), "a work of {found}, not {expected}");
        }
    }
}
