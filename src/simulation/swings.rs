//! A block that turns about a corner of the rigid base → swings, each to the next event or to the end of the piece.

use crate::block::{Block, Body, Corner};
use crate::excitation::Excitation;
use crate::numerics::bernstein::{Searched, Zero};
use crate::numerics::control::LONGEST;
use crate::numerics::scalar::Runs;
use crate::run::SimulationError;
use crate::simulation::force_peaks::{ForcePeaks, ForceSegment, PRESSED, UNITS, visible};
use crate::simulation::state::{Committed, RunState};
use crate::simulation::step::{FirstStep, StepKind, StepsInput, StepsOutcome};
use crate::simulation::step_interior::{Between, StepInterior, event_time};
use crate::simulation::stepping::{Finished, StepEnd};
use crate::system::evaluation::{Evaluation, Motion};
use crate::system::events::EventFunction;
use crate::system::instant::State;
use crate::system::motion_mode::MotionMode;
use crate::system::swing::{Bounds, Pivoting, Swing};

/// The greatest rotation (rad) that is below a quarter turn.
pub(super) const UPRIGHT: f64 = 1.5;

/// The evaluation of its beginning, from which a swing has its series.
pub(super) const EVALUATIONS_PER_SWING: u64 = 1;

/// The beginning of a swing, and the event function that reaches zero at its end.
#[derive(Clone, Copy)]
struct SwingSegment {
    fraction: f64,
    function: Option<EventFunction>,
}

impl SwingSegment {
    /// The segment of a swing about `pivot` as far as the rotation decides it. `None` if that is unclear.
    #[inline]
    fn of(swing: &Swing, bounds: &Bounds, pivot: Corner) -> Option<SwingSegment> {
        let landing = match (bounds.is_certain, bounds.last < 0.0) {
            (true, true) => Zero::At(swing.landing(true)),
            (true, false) => Zero::None,
            (false, _) => swing.first_landing(pivot),
        };
        let turn = if bounds.theta < UPRIGHT { Zero::None } else { swing.quarter_turn(pivot) };
        match (landing, turn) {
            (Zero::None, Zero::None) => Some(SwingSegment { fraction: 1.0, function: None }),
            (Zero::At(fraction), Zero::None) => {
                Some(SwingSegment { fraction, function: Some(EventFunction::Gap(pivot.other())) })
            }
            (Zero::None, Zero::At(fraction)) => {
                Some(SwingSegment { fraction, function: Some(EventFunction::QuarterTurn) })
            }
            (Zero::At(_), Zero::At(_)) | (Zero::Unclear, _) | (_, Zero::Unclear) => None,
        }
    }
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

/// A swing up to a fraction, or one in each lane, and the numbers that act on it.
pub(super) struct SwingForces<'a, T = f64> {
    pub(super) pivoting: &'a Pivoting<T>,
    pub(super) mass: T,
    pub(super) excitation: &'a Excitation<T>,
    /// Its beginning (s).
    pub(super) time: T,
    pub(super) swing: &'a Swing<T>,
    pub(super) fraction: T,
}

impl<T: Searched> SwingForces<'_, T> {
    /// N/M and H/M (m/s²) at a place up to the fraction, by the equations of motion.
    #[inline(always)]
    fn at(&self, place: T) -> [T; 2] {
        let fraction = place * self.fraction;
        self.pivoting.forces(self.swing.at(fraction), &self.excitation.at(self.time + fraction * self.swing.size))
    }
}

impl<T: Searched> ForceSegment<T> for SwingForces<'_, T> {
    #[inline(always)]
    fn include_at(&self, peaks: &mut ForcePeaks<T>, runs: T::Runs, place: T) {
        if runs.any() {
            peaks.include(runs, self.mass, self.at(place));
            peaks.evaluations = runs.choose(peaks.evaluations + 1.0, peaks.evaluations);
        }
    }
}

impl RunState {
    /// Includes the greatest rotation inside a swing, up to a fraction.
    #[inline(always)]
    fn raise_highest(&mut self, swing: &Swing, bounds: &Bounds, pivot: Corner, fraction: f64, body: &Body) {
        if !bounds.is_greatest_at_end
            && bounds.theta > self.peaks.theta
            && let Some(highest) = swing.highest(pivot, bounds, fraction, self.peaks.theta)
        {
            self.peaks.include_rotation(swing.at(highest)[0].abs(), body);
        }
    }

    /// Follows a block that turns about `pivot` to an event or the piece's end.
    #[inline(never)]
    pub(super) fn swings<'a>(
        &mut self,
        mode: impl MotionMode,
        pivot: Corner,
        input: &StepsInput<'a>,
        budget: &mut u64,
    ) -> Result<StepsOutcome<'a>, SimulationError> {
        let (block, &StepsInput { setup, excitation, stop, mut begins_piece, .. }) = (input.block(), input);
        let tolerance = setup.settings.tolerance;
        let longest = longest_swing(block.p, excitation.frequency());
        let (allowed, pivoting) = (allowed_error(block, tolerance), Pivoting::of(block, pivot));
        let mut most = longest;
        let mut known = if let FirstStep::Swing(swing) = input.first { Some(swing) } else { None };
        loop {
            input.spend(budget, self.pose.time, longest)?;
            let (time, [theta, theta_dot, ..]) = (self.pose.time, self.pose.state.0);
            let remaining = stop - time;
            let swing = match known.take() {
                Some(known) => known,
                None => &Swing::of(block, pivot, excitation, [time, theta, theta_dot], remaining.min(most), allowed),
            };
            input.report(|| StepKind::Swing(*swing));
            let bounds = swing.bounds(&pivoting);
            let (lasts, last_end) = (swing.size == remaining, time + swing.size);
            let mut segment = SwingSegment::of(swing, &bounds, pivot)
                .filter(|segment| segment.function.is_some() || lasts || last_end > time);
            let peaks = self.peaks.of_forces();
            if !peaks.are_above(bounds.reaction, bounds.horizontal, [block.mass, block.gravity]) {
                segment = segment.and_then(|segment| {
                    let next_is_swing = !lasts && segment.function.is_none();
                    let (pivoting, mass, fraction) = (&pivoting, block.mass, segment.fraction);
                    let forces = SwingForces { pivoting, mass, excitation, time, swing, fraction };
                    match self.accumulate_forces(forces, visible(tolerance), next_is_swing) {
                        Zero::None => Some(segment),
                        Zero::At(fraction) => {
                            Some(SwingSegment { fraction, function: Some(EventFunction::Reaction(pivot)) })
                        }
                        Zero::Unclear => None,
                    }
                });
            }
            let SwingSegment { fraction, function } = segment.unwrap_or(SwingSegment { fraction: 1.0, function: None });
            let end = match function {
                None if lasts => stop,
                None => last_end,
                Some(function) => event_time(function, time, fraction * swing.size),
            };
            let [theta, theta_dot] = swing.at(fraction);
            let state = State::from([theta, theta_dot, 0.0, 0.0]);
            if segment.is_some() {
                self.raise_highest(swing, &bounds, pivot, fraction, block);
                self.commit_swing(end, state, swing.work(fraction), block);
            } else {
                let mut here = Motion::<_, 4>::under(mode, block, &self.pose, excitation).at(time, self.pose.state);
                if begins_piece && let Some(function) = setup.system.crossed_by_jump(&here) {
                    self.counts.evaluations += EVALUATIONS_PER_SWING;
                    return Ok(StepsOutcome::Event(function, here));
                }
                match self.examine(mode, swing, fraction, end, &mut here, tolerance)? {
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

    /// Includes the forces up to a fraction of a swing in the peaks. They are N, H and the friction demand. Returns the fraction at which
    /// the corner lifts, if that comes before.
    ///
    /// The forces at the end are left to the next swing, which begins with them, unless another motion or the caller comes first.
    #[inline(never)]
    fn accumulate_forces(&mut self, mut segment: SwingForces, visible: f64, next_is_swing: bool) -> Zero {
        let SwingForces { pivoting: &Pivoting { gravity, .. }, swing, mass, .. } = segment;
        let (pressed, mut lift_off) = (PRESSED * gravity, Zero::None);
        let mut forces = swing.forces(segment.fraction, gravity);
        if !forces.coefficients().iter().all(|&[n, _]| n > pressed) {
            if forces.coefficients()[0][0] <= pressed {
                return Zero::Unclear;
            }
            match forces.combined(UNITS[0]).zero_of(|place| segment.at(place)[0]) {
                Zero::None => {}
                Zero::At(place) => {
                    segment.fraction *= place;
                    lift_off = Zero::At(segment.fraction);
                    forces = swing.forces(segment.fraction, gravity);
                }
                Zero::Unclear => return Zero::Unclear,
            }
        }
        let with_end = lift_off != Zero::None || !next_is_swing;
        self.counts.evaluations += self.peaks.raise_forces(|peaks| {
            peaks.raise(true, &segment, &forces, [mass, visible], with_end);
        });
        lift_off
    }

    /// Commits a swing up to its end or to an event.
    #[inline(always)]
    fn commit_swing(&mut self, end: f64, state: State, work: f64, body: &Body) {
        self.peaks.include_rotation(state[0].abs(), body);
        let (works, footing) = (self.works_after([work, 0.0].into()), self.pose.footing);
        self.commit(Committed {
            time: end.max(self.pose.time),
            state,
            footing,
            works,
            evaluations: EVALUATIONS_PER_SWING,
        });
    }

    /// Searches a segment of a swing for events and peaks, by the equations. The segment ends at `end` (s). Advances from `here` to the
    /// first event, or to that end.
    #[inline(never)]
    fn examine(
        &mut self,
        mode: impl MotionMode,
        swing: &Swing,
        fraction: f64,
        end: f64,
        here: &mut Evaluation,
        tolerance: f64,
    ) -> Result<Finished, SimulationError> {
        let (time, block, excitation) = (here.time, here.body, here.excitation);
        let motion = Motion::<_, 4>::under(mode, block, &self.pose, excitation);
        let [theta, theta_dot] = swing.at(fraction);
        let state = State::from([theta, theta_dot, 0.0, 0.0]);
        let there = motion.at(end, state);
        if ![theta, theta_dot, there.instant.theta_ddot].iter().all(|x| x.is_finite()) {
            return Err(SimulationError::NotFinite { time });
        }
        if end <= time && fraction == 1.0 {
            return Err(SimulationError::StepTooSmall { time, size: swing.size, tolerance });
        }
        let longest = longest_swing(block.p, excitation.frequency());
        // Those of both ends, too.
        let evaluations = EVALUATIONS_PER_SWING + 2;
        let step_end = StepEnd { evaluations, state, work: [swing.work(fraction), 0.0].into(), longest };
        let inside = StepInterior { motion, between: Between::Swing(time, swing), evaluations: 0 };
        Ok(self.finish(here, there, &step_end, inside))
    }
}
