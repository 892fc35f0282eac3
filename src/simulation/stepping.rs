//! Steps of a smooth piece of the excitation → the first event in each, peaks and energy sums.

use crate::block::{Foundation, Regime};
use crate::numerics::control::{Attempt, ShortStepTo, eighth_root, near_a_peak, short_factor, shortest, size_factor};
use crate::numerics::dop853::{DenseStep, EVALUATIONS_PER_STEP};
use crate::numerics::roots::{SHORTENED, may_shorten};
use crate::numerics::short::{EVALUATIONS_PER_SHORT_STEP, ShortStep};
use crate::run::SimulationError;
use crate::simulation::limits::Limits;
use crate::simulation::peaks::greater;
use crate::simulation::state::{Committed, RunState};
use crate::simulation::step::{FirstStep, StepKind, StepsInput, StepsOutcome};
use crate::simulation::step_interior::{
    Between, EventCrossing, MAX_TURN, SMALL_TURN, StepInterior, event_time, first_event, may_contain_event,
    turn_in_flight,
};
use crate::system::evaluation::{DAMPED, Evaluation, Motion, WITH_WORKS, works_of};
use crate::system::events::EventFunction;
use crate::system::instant::{Pose, Powers, State};
use crate::system::motion_mode::{AnyMode, Gripping, MotionMode, dispatch_mode};

/// Evaluations of a short step, with that of its end.
pub(super) const EVALUATIONS_OF_SHORT_STEP: u64 = EVALUATIONS_PER_SHORT_STEP + 1;

/// The end of a step without events.
pub(super) struct StepEnd<const N: usize> {
    /// The evaluations that led there.
    pub(super) evaluations: u64,
    /// The state there.
    pub(super) state: State<f64, N>,
    /// The works on the way, per unit mass.
    pub(super) work: Powers,
    /// The longest step (s).
    pub(super) longest: f64,
}

/// The result of a step.
pub(super) enum Finished {
    /// No event: a function rises from zero unseen within the step. The next attempt has this size (s).
    TooLong(f64),
    /// The event function has reached zero.
    Event(EventFunction),
    /// The block has come to the end of the step.
    Lasts,
}

impl RunState {
    /// Steps under the present mode to its first event or end, or the piece's end.
    #[inline(always)]
    pub(super) fn steps<'a>(
        &mut self,
        input: &StepsInput<'a>,
        budget: &mut u64,
    ) -> Result<StepsOutcome<'a>, SimulationError> {
        let block = input.block();
        let mode = AnyMode::of(block, &self.pose);
        match mode.extended() {
            Some(mode) if block.restraints.has_dampers() => self.steps_under::<DAMPED>(mode, input, None, budget),
            Some(mode) => self.steps_under::<WITH_WORKS>(mode, input, None, budget),
            None => {
                let made = if let FirstStep::Made(step) = input.first { Some(step) } else { None };
                dispatch_mode!(mode, mode => self.steps_under::<4>(mode, input, made, budget))
            }
        }
    }

    /// Steps under a mode that integrates N quantities. The first step is `made`, if a lane has taken it.
    #[inline(never)]
    fn steps_under<'a, const N: usize>(
        &mut self,
        mode: impl MotionMode,
        input: &StepsInput<'a>,
        mut made: Option<&DenseStep<N>>,
        budget: &mut u64,
    ) -> Result<StepsOutcome<'a>, SimulationError> {
        let (block, &StepsInput { setup, excitation, stop, .. }) = (input.block(), input);
        if let Some(pivot) = mode.pivot()
            && excitation.has_series()
        {
            return self.swings(mode, pivot, input, budget);
        }
        let steady = excitation.is_constant();
        if mode.is_at_rest() && excitation.is_linear() && !steady && self.rest_under_ramp(mode, input, budget)? {
            return Ok(StepsOutcome::Lasts);
        }
        // After an event the block is evaluated again instead of copied. The count of evaluations leaves this one out.
        let start_of = |pose: &Pose| Motion::<_, 4>::under(mode, block, pose, excitation).at(pose.time, pose.state);
        let mut here = start_of(&self.pose);
        // Reactions of supports do not jump with the excitation.
        let may_have_fallen = mode.foundation() == Foundation::Rigid || mode.has_friction();
        if input.begins_piece
            && may_have_fallen
            && let Some(function) = setup.system.crossed_by_jump(&here)
        {
            return Ok(StepsOutcome::Event(function, here));
        }
        if mode.is_at_rest()
            && !excitation.is_linear()
            && excitation.has_series()
            && let Some(outcome) = self.rest_under_pulse(mode, input, budget)?
        {
            return Ok(outcome);
        }
        let limits = Limits::of(block, setup.settings.tolerance, mode, excitation.frequency());
        let (mut may_be_short, mut attempt) = match input.first {
            FirstStep::Open | FirstStep::Swing(_) => (true, None),
            FirstStep::NotShort | FirstStep::Made(_) => (false, None),
            FirstStep::Attempt(attempt) => (false, Some(attempt)),
        };
        loop {
            if steady && here.rests() {
                // Loads may begin at this instant.
                self.peaks.include(&here.channels_outlined());
                self.settle_at_rest(input);
                return Ok(StepsOutcome::Lasts);
            }
            input.spend(budget, self.pose.time, limits.longest)?;
            let motion = Motion::<_, N>::under(mode, block, &self.pose, excitation);
            let tries_short = std::mem::replace(&mut may_be_short, true);
            let short = if tries_short { self.short_step_to(stop, mode, &limits) } else { ShortStepTo::TooFar };
            if short == ShortStepTo::Stop && self.short_step(input, &motion, &here, &limits) {
                return Ok(StepsOutcome::Lasts);
            }
            let own;
            let step = match made.take() {
                Some(step) => step,
                None => {
                    own = self.accepted_step(input, &motion, &here, &limits, attempt.take(), short)?;
                    &own
                }
            };
            let there = motion.at(step.end_time, step.end);
            let end_rate = motion.rate_of(&there);
            if !(step.end.is_finite() && end_rate.state.is_finite()) {
                return Err(SimulationError::NotFinite { time: here.time });
            }
            let DenseStep { end: state, work, .. } = *step;
            let end = StepEnd { evaluations: EVALUATIONS_PER_STEP, state, work, longest: limits.longest };
            input.report(|| StepKind::Step);
            let inside = StepInterior { motion, between: Between::Within(step, end_rate), evaluations: 0 };
            match self.finish(&mut here, there, &end, inside) {
                Finished::TooLong(size) => {
                    self.control.restart(size);
                    may_be_short = false;
                    continue;
                }
                Finished::Event(function) => return Ok(StepsOutcome::Event(function, here)),
                Finished::Lasts => {}
            }
            if self.pose.time >= stop || input.single {
                return Ok(StepsOutcome::Lasts);
            }
        }
    }

    /// Whether a short step may end at `stop`; never in modes with a held corner or with works of friction and restraints.
    #[inline(always)]
    fn short_step_to<const N: usize>(&self, stop: f64, mode: impl MotionMode, limits: &Limits<N>) -> ShortStepTo {
        if mode.held().is_some() || mode.integrates_u() {
            return ShortStepTo::TooFar;
        }
        self.control.short_step(stop - self.pose.time, limits.longest)
    }

    /// Takes a short step to the stop, unless something happens on the way. Returns whether it did.
    #[inline(always)]
    fn short_step<'a, L: MotionMode, const N: usize>(
        &mut self,
        input: &StepsInput,
        motion: &Motion<'a, L, N>,
        here: &Evaluation<'a>,
        limits: &Limits<N>,
    ) -> bool {
        let is_taken = self.try_short_step(input.stop, motion, here, limits);
        if is_taken {
            input.report(|| StepKind::ShortStep);
        } else {
            self.counts.evaluations += EVALUATIONS_OF_SHORT_STEP;
        }
        is_taken
    }

    #[inline(always)]
    fn try_short_step<'a, L: MotionMode, const N: usize>(
        &mut self,
        stop: f64,
        motion: &Motion<'a, L, N>,
        here: &Evaluation<'a>,
        limits: &Limits<N>,
    ) -> bool {
        let size = stop - self.pose.time;
        let step = ShortStep::attempt(here.time, size, motion.state_of(here), motion.rate_of(here), motion);
        let there = motion.at(stop, step.end);
        if turn_in_flight(motion.mode(), &here.state, &there.state, size) > SMALL_TURN {
            return false;
        }
        let error = step.error(motion.rate_of(&there), limits.weights, limits.work_weight) / limits.short_fraction;
        let factor = short_factor(error);
        // An error of NaN gives a factor of NaN, which rejects the step.
        if factor.is_nan() || factor < 1.0 {
            self.control.reject_short(size, factor);
            return false;
        }
        if may_contain_event(motion.mode(), here, &there) {
            return false;
        }
        let [start, end] = self.peaks.channels_at_ends(here, &there, near_a_peak(size, limits.longest));
        if self.peaks.may_rise_inside(&start, &end, size) {
            return false;
        }
        // After an event or a jump of the inputs the beginning is new, too.
        self.peaks.include_ends(&start, &end);
        // Without a limit of friction a foot may slide in any mode.
        if !motion.mode().grips() {
            self.accumulate_slip(here, &there);
        }
        let mut work = step.work;
        work[0] += here.footing.free_work(&there.footing);
        self.commit_at(&there, work, EVALUATIONS_OF_SHORT_STEP);
        true
    }

    /// Returns a step within the tolerance, from `here` towards `stop`. It is this `attempt`, or a shorter one.
    #[inline(always)]
    fn accepted_step<'a, L: MotionMode, const N: usize>(
        &mut self,
        input: &StepsInput,
        motion: &Motion<'a, L, N>,
        here: &Evaluation<'a>,
        &Limits { weights, longest, .. }: &Limits<N>,
        attempt: Option<Attempt>,
        short: ShortStepTo,
    ) -> Result<DenseStep<N>, SimulationError> {
        let (start, first) = (motion.state_of(here), motion.rate_of(here));
        let (time, &StepsInput { setup, stop, .. }) = (here.time, input);
        let shortest = shortest(time, longest);
        let mut attempt =
            attempt.unwrap_or_else(|| self.control.attempt(stop - time, longest, shortest).instead_of(short));
        loop {
            let mut step = DenseStep::attempt(time, attempt.size, start, first, motion);
            let error = step.error(weights);
            let factor = size_factor(eighth_root(error));
            let turn = turn_in_flight(motion.mode(), &start, &step.end, attempt.size);
            // Where the clock resolves no shorter step, none is asked for.
            let turns_far = turn > MAX_TURN && attempt.size > 2.0 * shortest;
            if error <= 1.0 && !turns_far {
                self.control.accept(&attempt, factor, longest);
                if attempt.last {
                    step.end_time = stop;
                }
                return Ok(step);
            }
            self.reject(EVALUATIONS_PER_STEP);
            let factor = if error <= 1.0 { (MAX_TURN / turn).max(2.0 * shortest / attempt.size) } else { factor };
            attempt = self.control.reject(&attempt, factor);
            let size = attempt.size;
            if size < shortest {
                return Err(if here.rate.state.is_finite() && error.is_finite() {
                    SimulationError::StepTooSmall { time, size, tolerance: setup.settings.tolerance }
                } else {
                    SimulationError::NotFinite { time }
                });
            }
        }
    }

    /// Advances from `here` to the first event or end of a step, with its peaks.
    #[inline(always)]
    pub(super) fn finish<'a, L: MotionMode, const N: usize>(
        &mut self,
        here: &mut Evaluation<'a>,
        mut there: Evaluation<'a>,
        end: &StepEnd<N>,
        mut inside: StepInterior<'_, 'a, L, N>,
    ) -> Finished {
        let (mode, size) = (inside.motion.mode(), there.time - here.time);
        let mut event = first_event(here, &there, end.longest, &mut inside);
        if let Some(EventCrossing { rise_unseen: true, elapsed, .. }) = &mut event {
            if may_shorten(self.pose.time, size, end.longest) {
                self.reject(end.evaluations + inside.evaluations);
                return Finished::TooLong(SHORTENED * size);
            }
            *elapsed = size;
        }
        let (mut beyond, mut work) = (end.state, end.work);
        if let Some(EventCrossing { elapsed, function, .. }) = event
            && elapsed < size
        {
            there = inside.at(elapsed);
            there.time = event_time(function, here.time, elapsed);
            work = inside.work(elapsed);
            if N > 4 {
                beyond = inside.state(elapsed);
            }
        }
        let elapsed = event.map_or(size, |fall| fall.elapsed);
        inside.include_in(&mut self.peaks, here, &there, near_a_peak(elapsed, end.longest));
        if !mode.grips() {
            self.accumulate_slip(here, &there);
        }
        if N > 4 {
            self.sums.add(works_of(&beyond));
            self.peaks.include_pulls_of_step(here, &there, |elapsed| inside.at(elapsed));
            self.accumulate_plastic(here, &there);
        } else {
            work[0] += here.footing.free_work(&there.footing);
        }
        self.commit_at(&there, work, end.evaluations + inside.evaluations);
        if mode.held().is_some() {
            // The corner lifts and lands too often for an account of each event; the balance of energy has their sum.
            let dissipated: f64 = works_of(&beyond).into_iter().sum();
            let made = there.energy() - here.energy() - work[0] + work[1] + dissipated;
            self.sums.constraint += made;
            self.sums.impacts -= made;
        }
        *here = there;
        event.map_or(Finished::Lasts, |crossing| Finished::Event(crossing.function))
    }

    /// Includes the plastic elongations of a step.
    pub(super) fn accumulate_plastic(&mut self, here: &Evaluation, there: &Evaluation) {
        if here.forcing.restraints.plastic.is_some() {
            let [before, after] = [here, there].map(Evaluation::plastic_elongations);
            for ((path, before), after) in self.plastic_paths.iter_mut().zip(before).zip(after) {
                *path += (after - before).abs();
            }
            self.peaks.include_plastic(&after);
        }
    }

    /// Includes the slip of the foot in a step.
    pub(super) fn accumulate_slip(&mut self, here: &Evaluation, there: &Evaluation) {
        if self.pose.slides() {
            let path = there.foot_place() - here.foot_place();
            self.slip.now += path;
            self.slip.total += path.abs();
            self.peaks.slip = greater(self.peaks.slip, self.slip.now.abs());
        }
    }

    /// [Commits](RunState::commit) a step to this instant. `work` is that on the way, per unit mass.
    #[inline]
    pub(super) fn commit_at(&mut self, there: &Evaluation, work: Powers, evaluations: u64) {
        let Evaluation { time, state, footing, .. } = *there;
        self.commit(Committed { time, state, footing, works: self.works_after(work), evaluations });
    }

    /// Counts a step that is repeated with a smaller size.
    pub(super) fn reject(&mut self, evaluations: u64) {
        self.counts.evaluations += evaluations;
        self.counts.rejected += 1;
    }

    /// Ends the motion of a block at rest under a constant excitation. Motion below round-off is dropped.
    fn settle_at_rest(&mut self, input: &StepsInput) {
        input.report(|| StepKind::Rested);
        self.pose.time = input.stop;
        self.pose.state[1] = 0.0;
        self.pose.state[3] = 0.0;
        self.events_in_this_instant = 0;
    }
}
