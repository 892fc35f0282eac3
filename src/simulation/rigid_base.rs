//! A block on the rigid base → its rest, or swings about a corner, each to the next landing or to the end of the piece.

use crate::block::{Block, Corner, Regime};
use crate::excitation::{Forcing, ForcingSeries};
use crate::numerics::bernstein::{Pair, Zero};
use crate::numerics::control::LONGEST;
use crate::simulation::force_peaks::{is_below_peaks, unit};
use crate::simulation::outputs::strain;
use crate::simulation::peaks::greater;
use crate::simulation::step::{FirstStep, StepsInput, StepsOutcome};
use crate::simulation::step_interior::{Between, StepInterior, event_time};
use crate::simulation::stepping::{Finished, StepEnd};
use crate::simulation::{Simulation, SimulationError};
use crate::system::dynamics::{instant, instant_of};
use crate::system::evaluation::{Evaluation, Motion};
use crate::system::events::EventFunction;
use crate::system::instant::{Footing, Instant, Pose, Powers, State};
use crate::system::motion_mode::MotionMode;
use crate::system::swing::{Bounds, ORDER, Pivoting, Swing};

/// The greatest rotation (rad) that is below a quarter turn.
pub(super) const UPRIGHT: f64 = 1.5;

/// A part of a swing, and the event function that reaches zero at its end.
#[derive(Clone, Copy)]
struct SwingSegment {
    part: f64,
    function: Option<EventFunction>,
}

impl SwingSegment {
    /// The way of a swing about `pivot` as far as the rotation decides it; none where that is unclear.
    #[inline]
    fn of(swing: &Swing, bounds: &Bounds, pivot: Corner) -> Option<SwingSegment> {
        let landing = match (bounds.is_certain, bounds.last < 0.0) {
            (true, true) => Zero::At(swing.landing()),
            (true, false) => Zero::None,
            (false, _) => swing.first_landing(pivot),
        };
        let turn = if bounds.theta < UPRIGHT { Zero::None } else { swing.quarter_turn(pivot) };
        match (landing, turn) {
            (Zero::None, Zero::None) => Some(SwingSegment { part: 1.0, function: None }),
            (Zero::At(part), Zero::None) => {
                Some(SwingSegment { part, function: Some(EventFunction::Gap(pivot.other())) })
            }
            (Zero::None, Zero::At(part)) => Some(SwingSegment { part, function: Some(EventFunction::QuarterTurn) }),
            (Zero::At(_), Zero::At(_)) | (Zero::Unclear, _) | (_, Zero::Unclear) => None,
        }
    }
}

/// Whether both reactions of a block at rest are above their round-off.
fn is_pressed_down(now: &Evaluation) -> bool {
    let rounding = EventFunction::Reaction(Corner::Left).rounding(now.block);
    now.instant.reaction.iter().all(|&reaction| reaction > rounding)
}

/// The forces on a block at rest over a step, N_L/M, N_R/M and H/M (m/s²), as series in powers of the elapsed part.
struct RestForceSeries([[f64; ORDER + 1]; 3]);

impl RestForceSeries {
    /// They are linear in the excitation.
    fn of(block: &Block, footing: Footing<f64>, series: &ForcingSeries<{ ORDER + 1 }>, size: f64) -> RestForceSeries {
        let under = |forcing: Forcing<f64>| {
            let Instant { reaction: [left, right], horizontal, .. } =
                instant(block, Regime::FullContact, [0.0; 4], footing, forcing);
            [left, right, horizontal]
        };
        let none = under(Forcing::default());
        // The differences to both sides, so that a mirrored block has the same numbers.
        let by = |unit: fn(f64) -> Forcing<f64>| {
            let (up, down) = (under(unit(1.0)), under(unit(-1.0)));
            [0, 1, 2].map(|i| 0.5 * (up[i] - down[i]))
        };
        let by_ramp = |ramp: [f64; 2], unit| if ramp == [0.0; 2] { [0.0; 3] } else { by(unit) };
        let by = [
            by(|x| Forcing { x, ..Forcing::default() }),
            by_ramp(series.z, |z| Forcing { z, ..Forcing::default() }),
            by_ramp(series.moment, |moment| Forcing { moment, ..Forcing::default() }),
        ];
        let (mut forces, mut power) = ([[0.0; ORDER + 1]; 3], 1.0);
        for k in 0..ORDER + 1 {
            let linear = |ramp: [f64; 2]| if k < 2 { ramp[k] } else { 0.0 };
            let forcing = [series.x[k], linear(series.z), linear(series.moment)];
            for (i, force) in forces.iter_mut().enumerate() {
                force[k] = (forcing[0] * by[0][i] + forcing[1] * by[1][i] + forcing[2] * by[2][i]) * power;
            }
            power *= size;
        }
        for (force, none) in forces.iter_mut().zip(none) {
            force[0] += none;
        }
        RestForceSeries(forces)
    }

    /// N_L/M and N_R/M up to a part of the step.
    fn reactions(&self, part: f64) -> Pair {
        let [left, right, _] = &self.0;
        pair(part, |k| [left[k], right[k]])
    }

    /// Their sum and H/M up to a part of the step.
    fn resultant(&self, part: f64) -> Pair {
        let [left, right, shear] = &self.0;
        pair(part, |k| [left[k] + right[k], shear[k]])
    }
}

/// Two polynomials from their coefficients of each power, in powers of the elapsed part of a `part`.
#[inline(always)]
fn pair(part: f64, of_power: impl Fn(usize) -> [f64; 2]) -> Pair {
    let (mut powers, mut power) = ([[0.0; 2]; ORDER + 1], 1.0);
    for (k, both) in powers.iter_mut().enumerate() {
        let [p, q] = of_power(k);
        *both = [p * power, q * power];
        power *= part;
    }
    Pair::of(powers, ORDER)
}

/// The longest swing (s) under a pulse of this circular frequency (rad/s).
#[inline]
pub(super) fn longest_swing(p: f64, frequency: f64) -> f64 {
    LONGEST / p.max(frequency)
}

/// The allowed error of θ̇ (rad/s per second of a swing).
///
/// The longest swing may make the error of a step, others in proportion, so that the errors between frequent stops do not add up.
#[inline]
pub(super) fn allowed_error(block: &Block, tolerance: f64) -> f64 {
    tolerance * block.alpha * block.p / longest_swing(block.p, 0.0)
}

impl Simulation {
    /// Stays at rest to the end of a piece in which the excitation changes linearly, if no corner lifts before; returns whether it did.
    /// Reactions are linear, too, and the friction demand, their quotient, has its peak at an end.
    #[inline(always)]
    pub(super) fn stays_upright(
        &mut self,
        mode: impl MotionMode,
        input: &StepsInput,
        budget: &mut u64,
    ) -> Result<bool, SimulationError> {
        let &StepsInput { block, excitation, stop, .. } = input;
        let Pose { time, state, footing, .. } = self.pose;
        // A corner that is pressed on by more than the round-off of its reaction has not lifted.
        let pressed = EventFunction::Reaction(Corner::Left).rounding(block);
        let strain_at = |time: f64| {
            instant_of(block, mode.foundation(), mode.regime(), state.0, footing, excitation.at(time), |x| {
                let [left, right] = x.reaction;
                (left > pressed && right > pressed).then(|| strain(block, mode.regime(), &x, [0.0; 2]))
            })
        };
        let (here, there) = (strain_at(time), strain_at(stop));
        let (Some(here), Some(there)) = (here, there) else { return Ok(false) };
        input.spend(budget, time, longest_swing(block.p, 0.0))?;
        self.include_strain(&here);
        self.include_strain(&there);
        self.counts.evaluations += 1;
        self.counts.steps += 1;
        (self.pose.time, self.events_in_this_instant) = (stop, 0);
        Ok(true)
    }

    /// Stays at rest from one instant to another.
    fn stay(&mut self, here: &Evaluation, there: &Evaluation) {
        self.include_forces(here);
        self.include_forces(there);
        self.counts.evaluations += 1;
        self.counts.steps += 1;
        self.commit(there, Powers::zeros());
    }

    /// Stays at rest under a pulse, to the end of the piece or until a corner lifts.
    ///
    /// Returns `None`, having done nothing, where it is unclear whether one does.
    #[inline(never)]
    pub(super) fn stays_under_pulse<'a>(
        &mut self,
        mode: impl MotionMode,
        input: &StepsInput<'a>,
        budget: &mut u64,
    ) -> Result<Option<StepsOutcome<'a>>, SimulationError> {
        let &StepsInput { block, excitation, stop, .. } = input;
        let longest = longest_swing(block.p, excitation.frequency());
        let motion = Motion::<_, 4>::under(mode, block, &self.pose, excitation);
        let (upright, begin) = (State::zeros(), self.pose.time);
        let mut here = motion.at(self.pose.time, upright);
        let stayed = |time: f64| (time > begin).then_some(StepsOutcome::Lasts);
        while self.pose.time < stop {
            let time = self.pose.time;
            input.spend(budget, time, longest)?;
            let remaining = stop - time;
            let size = remaining / (remaining / longest).ceil().max(1.0);
            let forces = RestForceSeries::of(block, here.footing, &excitation.series(time), size);
            let reactions = forces.reactions(1.0);
            let zeros = Corner::each(|corner| {
                let i = corner.index();
                let reaction = |part: f64| motion.at(time + part * size, upright).instant.reaction[i];
                if reactions.coefficients().iter().all(|both| both[i] > 0.0) {
                    Zero::None
                } else {
                    reactions.combined(unit(i)).zero_of(reaction)
                }
            });
            let (part, lifts) = match zeros {
                [Zero::None, Zero::None] => (1.0, None),
                [Zero::At(part), Zero::None] => (part, Some(Corner::Left)),
                [Zero::None, Zero::At(part)] => (part, Some(Corner::Right)),
                [Zero::At(left), Zero::At(right)] if left <= right => (left, Some(Corner::Left)),
                [Zero::At(_), Zero::At(right)] => (right, Some(Corner::Right)),
                [Zero::Unclear, _] | [_, Zero::Unclear] => return Ok(stayed(time)),
            };
            let end = if part == 1.0 && size == remaining { stop } else { time + part * size };
            let there = motion.at(end, upright);
            if !is_pressed_down(&here) || end <= time || (lifts.is_none() && !is_pressed_down(&there)) {
                return Ok(stayed(time));
            }
            self.stay(&here, &there);
            let reactions = if part == 1.0 { reactions } else { forces.reactions(part) };
            let each = [0, 1].map(|i| (&reactions, unit(i)));
            self.search_peaks(&each, &forces.resultant(part), |this, place| {
                this.include_forces(&motion.at(time + place * part * size, upright));
            });
            if let Some(corner) = lifts {
                return Ok(Some(StepsOutcome::Event(EventFunction::Reaction(corner), there)));
            }
            if input.single {
                break;
            }
            here = there;
        }
        Ok(Some(StepsOutcome::Lasts))
    }

    /// Includes a rotation (rad) about a corner in the peaks.
    #[inline]
    pub(super) fn raise_rotation(&mut self, theta: f64) {
        if theta > self.peaks.theta {
            self.peaks.theta = theta;
            self.peaks.uplift = greater(self.peaks.uplift, libm::sin(theta) * (2.0 * self.system.block.b));
        }
    }

    /// Follows a block that turns about `pivot`, to the end of the piece or to an event.
    #[inline(never)]
    pub(super) fn swings<'a>(
        &mut self,
        mode: impl MotionMode,
        pivot: Corner,
        input: &StepsInput<'a>,
        budget: &mut u64,
    ) -> Result<StepsOutcome<'a>, SimulationError> {
        let &StepsInput { block, excitation, stop, mut begins_piece, .. } = input;
        let longest = longest_swing(block.p, excitation.frequency());
        let (allowed, pivoting) = (allowed_error(block, self.settings.tolerance), Pivoting::of(block, pivot));
        let mut most = longest;
        let mut known = if let FirstStep::Swing(swing) = input.first { Some(swing) } else { None };
        loop {
            input.spend(budget, self.pose.time, longest)?;
            let (time, [theta, theta_dot, ..]) = (self.pose.time, self.pose.state.0);
            let remaining = stop - time;
            let made;
            let swing = match known.take() {
                Some(known) => known,
                None => {
                    made = Swing::of(block, pivot, excitation, [time, theta, theta_dot], remaining.min(most), allowed);
                    &made
                }
            };
            if let Some(place) = input.swing {
                place.set(Some(*swing));
            }
            self.counts.evaluations += 1;
            self.counts.steps += 1;
            let bounds = swing.bounds(block, pivot);
            let (lasts, last_end) = (swing.size == remaining, time + swing.size);
            let mut segment = SwingSegment::of(swing, &bounds, pivot)
                .filter(|segment| segment.function.is_some() || lasts || last_end > time);
            if !is_below_peaks(&bounds, block, &self.peaks) {
                segment = segment.and_then(|segment| {
                    let next_is_swing = !lasts && segment.function.is_none();
                    match self.accumulate_forces(excitation, &pivoting, swing, segment.part, next_is_swing) {
                        Zero::None => Some(segment),
                        Zero::At(part) => Some(SwingSegment { part, function: Some(EventFunction::Reaction(pivot)) }),
                        Zero::Unclear => None,
                    }
                });
            }
            let SwingSegment { part, function } = segment.unwrap_or(SwingSegment { part: 1.0, function: None });
            let end = match function {
                None if lasts => stop,
                None => last_end,
                Some(function) => event_time(function, time, part * swing.size),
            };
            let [theta, theta_dot] = swing.at(part);
            let state = State::from([theta, theta_dot, 0.0, 0.0]);
            if segment.is_some() {
                if !bounds.is_greatest_at_end
                    && bounds.theta > self.peaks.theta
                    && let Some(highest) = swing.highest(pivot, &bounds, part, self.peaks.theta)
                {
                    self.raise_rotation(swing.at(highest)[0].abs());
                }
                self.commit_swing(end, state, swing.work(part));
            } else {
                let mut here = Motion::<_, 4>::under(mode, block, &self.pose, excitation).at(time, self.pose.state);
                if begins_piece && let Some(function) = self.system.fallen(&here) {
                    self.counts.steps -= 1;
                    return Ok(StepsOutcome::Event(function, here));
                }
                match self.examine(mode, swing, part, end, &mut here)? {
                    Finished::TooLong(size) => {
                        most = size;
                        continue;
                    }
                    Finished::Event(function) => return Ok(StepsOutcome::Event(function, here)),
                    Finished::Lasts => {}
                }
            }
            if let Some(function) = function {
                return Ok(StepsOutcome::Event(function, self.now(block, excitation)));
            }
            (begins_piece, most) = (false, longest);
            if self.pose.time >= stop || input.single {
                return Ok(StepsOutcome::Lasts);
            }
        }
    }

    /// Comes to the end of a swing in which nothing happens.
    #[inline(always)]
    fn commit_swing(&mut self, end: f64, state: State, work: f64) {
        self.raise_rotation(state[0].abs());
        self.sums.input += work;
        self.pose.state = state;
        if end > self.pose.time {
            (self.pose.time, self.events_in_this_instant) = (end, 0);
        }
    }

    /// Looks for events and peaks in a part of a swing that ends at `end` (s), by the equations, and goes from `here` to the first event or
    /// to the end.
    #[inline(never)]
    fn examine(
        &mut self,
        mode: impl MotionMode,
        swing: &Swing,
        part: f64,
        end: f64,
        here: &mut Evaluation,
    ) -> Result<Finished, SimulationError> {
        let (time, block, excitation) = (here.time, here.block, here.excitation);
        let motion = Motion::<_, 4>::under(mode, block, &self.pose, excitation);
        let [theta, theta_dot] = swing.at(part);
        let state = State::from([theta, theta_dot, 0.0, 0.0]);
        let there = motion.at(end, state);
        self.counts.evaluations += 2;
        if ![theta, theta_dot, there.instant.theta_ddot].iter().all(|x| x.is_finite()) {
            return Err(SimulationError::NotFinite { time });
        }
        if end <= time && part == 1.0 {
            let (size, tolerance) = (swing.size, self.settings.tolerance);
            return Err(SimulationError::StepTooSmall { time, size, tolerance });
        }
        let longest = longest_swing(block.p, excitation.frequency());
        let step_end = StepEnd { state, work: [swing.work(part), 0.0].into(), longest };
        let inside = StepInterior { motion, between: Between::Swing(time, swing), evaluations: 0 };
        Ok(self.finish(here, there, &step_end, inside))
    }
}
