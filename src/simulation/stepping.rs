//! Steps of a smooth piece of the excitation → the first event in each, peaks and energy sums.

use crate::block::{Block, Foundation, Regime, restraints};
use crate::numerics::control::{
    Attempt, LONGEST, ShortStepTo, eighth_root, near_a_peak, short_factor, shortest, size_factor,
};
use crate::numerics::dop853::{DenseStep, EVALUATIONS_PER_STEP};
use crate::numerics::short::{EVALUATIONS_PER_SHORT_STEP, ShortStep};
use crate::simulation::smooth_piece::{SmoothPiece, StepStart};
use crate::simulation::step_end::{Finished, StepEnd};
use crate::simulation::step_interior::{Between, MAX_TURN, SMALL_TURN, StepInterior, may_hold_event, turn_in_flight};
use crate::simulation::{Pending, Simulation, SimulationError};
use crate::system::evaluation::{DAMPED, EXTENDED, Evaluation, Motion};
use crate::system::events::{Event, EventFunction};
use crate::system::instant::{Pose, Powers, State};
use crate::system::motion_mode::{AnyMode, Gripping, MotionMode, dispatch_mode};

/// Limits of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits<const N: usize = 4> {
    /// Reciprocals of the errors that a step may make in each component of the state.
    pub(super) weights: State<f64, N>,
    /// The reciprocal of the error that a step may make in each of the works.
    pub(super) work_weight: f64,
    /// The longest step (s).
    pub(super) longest: f64,
    /// The part of the error of other steps that a short step may make.
    pub(super) short_fraction: f64,
}

/// Frequent stops, as under a record, add up the errors of more steps than the motion needs. So a short step may make only a tenth
/// of the error of others, in the motion and in the works, unless the tolerance is loose.
const SHORT_FRACTION: f64 = 0.1;

/// The smallest loose tolerance: from it on a short step may make the whole error.
const LOOSE: f64 = 1e-6;

impl Simulation {
    /// Steps under the present mode to the end of the piece, or of the mode. The first one is `accepted`, if that is already known.
    #[inline(always)]
    pub(super) fn steps(
        &mut self,
        piece: &SmoothPiece,
        start: StepStart,
        accepted: Option<&DenseStep>,
        budget: &mut u64,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        let mode = AnyMode::of(piece.block, &self.pose);
        match mode.extended() {
            Some(mode) if piece.block.restraints.has_dampers() => {
                self.steps_under::<DAMPED>(mode, piece, start, None, budget, observer)
            }
            Some(mode) => self.steps_under::<EXTENDED>(mode, piece, start, None, budget, observer),
            None => dispatch_mode!(mode, mode => self.steps_under::<4>(mode, piece, start, accepted, budget, observer)),
        }
    }

    /// Steps under a mode that integrates N quantities.
    #[inline(never)]
    fn steps_under<const N: usize>(
        &mut self,
        mode: impl MotionMode,
        piece: &SmoothPiece,
        start: StepStart,
        mut accepted: Option<&DenseStep<N>>,
        budget: &mut u64,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        let &SmoothPiece { block, excitation, stop, .. } = piece;
        if let Some(pivot) = mode.pivot()
            && excitation.has_series()
        {
            return self.swings(mode, pivot, piece, start, budget, observer);
        }
        let steady = excitation.is_constant();
        if mode.is_at_rest() && excitation.is_linear() && !steady && self.stays_upright(mode, piece, budget)? {
            return Ok(());
        }
        // After an event the block is evaluated once more, which is not counted, rather than copied.
        let start_of = |pose: &Pose| Motion::<_, 4>::under(mode, block, pose, excitation).at(pose.time, pose.state);
        let mut here = start_of(&self.pose);
        // Reactions of supports do not jump with the excitation.
        let may_have_fallen = mode.foundation() == Foundation::Rigid || mode.has_friction();
        if start.of_piece
            && may_have_fallen
            && let Some(function) = self.system.fallen(&here)
        {
            return self.apply_or_stop(function, &here, piece, observer);
        }
        if mode.is_at_rest()
            && !excitation.is_linear()
            && excitation.has_series()
            && self.stays_under_pulse(mode, piece, budget, observer)?
        {
            return Ok(());
        }
        let limits = self.limits(mode, excitation.frequency());
        let (mut short_failed, mut attempt) = (start.short_failed, start.attempt);
        loop {
            if steady && here.rests() {
                // Loads may have come at this instant.
                self.peaks.include(&here.channels());
                self.settle_at_rest(piece.end);
                return Ok(());
            }
            self.spend(budget, piece, limits.longest)?;
            let motion = Motion::<_, N>::under(mode, block, &self.pose, excitation);
            if !std::mem::take(&mut short_failed) && self.short_step(stop, &motion, &here, &limits) {
                return Ok(());
            }
            let own;
            let step = match accepted.take() {
                Some(step) => step,
                None => {
                    own = self.accepted_step(stop, &motion, &here, &limits, attempt.take())?;
                    &own
                }
            };
            let there = motion.at(step.end_time, step.end);
            let end_rate = motion.rate_of(&there);
            if !(step.end.is_finite() && end_rate.state.is_finite()) {
                return Err(SimulationError::NotFinite { time: here.time });
            }
            let end = StepEnd { state: step.end, work: step.work, longest: limits.longest };
            let inside = StepInterior { motion, between: Between::Within(step, end_rate), evaluations: 0 };
            match self.finish(piece, &mut here, there, &end, inside, observer)? {
                Finished::TooLong(size) => {
                    self.control.restart(size);
                    short_failed = true;
                    continue;
                }
                Finished::Left => return Ok(()),
                Finished::Lasts => {}
            }
            if self.pose.time >= stop || piece.single {
                return Ok(());
            }
        }
    }

    /// Applies an event, or leaves it pending if the motion stops there.
    pub(super) fn apply_or_stop(
        &mut self,
        function: EventFunction,
        now: &Evaluation,
        piece: &SmoothPiece,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        if self.stops(piece.at_event, function, now) {
            self.pending = Some(Pending { function, piece: piece.since });
            return Ok(());
        }
        self.apply(function, now, observer).map(|_| ())
    }

    /// Ends the motion of a block at rest under an excitation that does not change; motion below round-off is dropped.
    fn settle_at_rest(&mut self, stop: f64) {
        self.pose.time = stop;
        self.pose.state[1] = 0.0;
        self.pose.state[3] = 0.0;
        self.events_in_this_instant = 0;
    }

    /// Makes an instant of the motion the present one; `work` was done on the way, per unit mass.
    #[inline]
    pub(super) fn commit(&mut self, there: &Evaluation, work: Powers) {
        self.sums.input += work[0];
        self.sums.dashpots += work[1];
        if there.time > self.pose.time {
            self.events_in_this_instant = 0;
        }
        let Evaluation { time, state, footing, .. } = *there;
        self.pose = Pose { time, state, footing, ..self.pose };
    }

    /// Takes a short step to `stop` if that is near enough and nothing happens on the way; returns whether it did.
    #[inline(always)]
    fn short_step<'a, L: MotionMode, const N: usize>(
        &mut self,
        stop: f64,
        motion: &Motion<'a, L, N>,
        here: &Evaluation<'a>,
        limits: &Limits<N>,
    ) -> bool {
        let size = stop - self.pose.time;
        if motion.mode().held().is_some() || L::EXTENDED {
            return false;
        }
        match self.control.short_step(size, limits.longest) {
            ShortStepTo::TooFar => return false,
            ShortStepTo::NotYet => {
                self.control.grow_short();
                return false;
            }
            ShortStepTo::Stop => {}
        }
        let step = ShortStep::attempt(here.time, size, motion.state_of(here), motion.rate_of(here), motion);
        let there = motion.at(stop, step.end);
        self.counts.evaluations += EVALUATIONS_PER_SHORT_STEP + 1;
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
        if may_hold_event(motion.mode(), here, &there) {
            return false;
        }
        let [start, end] = self.channels_at_ends(here, &there, near_a_peak(size, limits.longest));
        if self.peaks.may_rise_inside(&start, &end, size) {
            return false;
        }
        // After an event or a jump of the inputs the beginning is new, too.
        self.peaks.include(&start);
        self.peaks.include(&end);
        self.counts.steps += 1;
        if !motion.mode().grips() {
            self.accumulate_slip(here, &there);
        }
        let mut work = step.work;
        work[0] += here.footing.free_work(&there.footing);
        self.commit(&there, work);
        true
    }

    /// A step within the tolerance, from `here` towards `stop`: this `attempt`, if there is one, or a shorter one.
    #[inline(always)]
    fn accepted_step<'a, L: MotionMode, const N: usize>(
        &mut self,
        stop: f64,
        motion: &Motion<'a, L, N>,
        here: &Evaluation<'a>,
        &Limits { weights, longest, .. }: &Limits<N>,
        attempt: Option<Attempt>,
    ) -> Result<DenseStep<N>, SimulationError> {
        let (start, first) = (motion.state_of(here), motion.rate_of(here));
        let time = here.time;
        let shortest = shortest(time, stop);
        let mut attempt = attempt.unwrap_or_else(|| self.control.attempt(stop - time, longest, shortest));
        loop {
            let mut step = DenseStep::attempt(time, attempt.size, start, first, motion);
            self.counts.evaluations += EVALUATIONS_PER_STEP;
            let error = step.error(weights);
            let factor = size_factor(eighth_root(error));
            let turn = turn_in_flight(motion.mode(), &start, &step.end, attempt.size);
            // Where the clock resolves no shorter step, none is asked for.
            let turns_far = turn > MAX_TURN && attempt.size > 2.0 * shortest;
            if error <= 1.0 && !turns_far {
                self.control.accept(&attempt, factor, longest);
                self.counts.steps += 1;
                if attempt.last {
                    step.end_time = stop;
                }
                return Ok(step);
            }
            self.counts.rejected += 1;
            let factor = if error <= 1.0 { (MAX_TURN / turn).max(2.0 * shortest / attempt.size) } else { factor };
            attempt = self.control.reject(&attempt, factor);
            let size = attempt.size;
            if size < shortest {
                return Err(if here.rate.state.is_finite() && error.is_finite() {
                    SimulationError::StepTooSmall { time, size, tolerance: self.settings.tolerance }
                } else {
                    SimulationError::NotFinite { time }
                });
            }
        }
    }

    /// Limits of a step.
    ///
    /// An error counts as an equivalent velocity: a displacement times the circular frequency of its motion, a vertical one
    /// divided by R0. Allowed is the tolerance times the velocity of rocking, α p; of the vertical velocity also
    /// not more than a change of a reaction by some 5 tolerances of the weight, which is less on stiff supports. A step
    /// is at most a third of the shortest period, so that it holds at most one extremum.
    #[inline(always)]
    pub(super) fn limits<const N: usize>(&self, mode: impl MotionMode, pulse_frequency: f64) -> Limits<N> {
        let Block { alpha, p, b, h, i0, r0, omega_v, xi_v, gravity, eccentricity, friction, .. } = self.system.block;
        const OF_WEIGHT: f64 = 10.0;
        // A block whose foot slides turns about its centre of mass, and friction adds to the moment.
        let arm = b + eccentricity.abs() + if mode.grips() { 0.0 } else { friction * h };
        let turning = if mode.grips() { arm * arm / (i0 + h * h) } else { arm * arm / i0 };
        let (rocking, vertical) = match (mode.foundation(), mode.regime()) {
            (Foundation::Rigid, _) | (_, Regime::Separated) => (p, p),
            (_, Regime::FullContact) => (p.max(omega_v * turning.sqrt()), omega_v),
            (_, Regime::TiltingLeft | Regime::TiltingRight) => (p, omega_v * (0.5 * (1.0 + turning)).sqrt()),
        };
        // The greatest rate at which damped motion dies away.
        let decay = match (mode.foundation(), mode.regime()) {
            (Foundation::Rigid, _) | (_, Regime::Separated) => 0.0,
            (_, Regime::FullContact) => 2.0 * xi_v * omega_v * turning.max(1.0),
            (_, Regime::TiltingLeft | Regime::TiltingRight) => xi_v * omega_v * (1.0 + turning),
        };
        let allowed = 1.0 / (self.settings.tolerance * alpha * p);
        let most = match mode.foundation() {
            Foundation::Rigid => r0 * alpha * p,
            // The reaction of one support changes by ω_v ẇ/2 or ξ_v ω_v ẇ, whichever is more, per mass.
            Foundation::Viscoelastic => (r0 * alpha * p).min(OF_WEIGHT * gravity / (omega_v * (2.0 * xi_v).max(1.0))),
        };
        let upright = 1.0 / (self.settings.tolerance * most);
        let across = 1.0 / (self.settings.tolerance * r0 * alpha * p);
        // The energy of a block that rocks with the velocity of the other weights.
        let work_weight = allowed / ((i0 + r0 * r0) * alpha * p);
        let of_motion = [rocking * allowed, allowed, vertical * upright, upright, p * across, across];
        let weights = State::from(std::array::from_fn(|i| *of_motion.get(i).unwrap_or(&work_weight)));
        let restrained = if mode.is_extended() { restraints::fastest(&self.system.block) } else { 0.0 };
        let longest = LONGEST / rocking.max(vertical).max(decay).max(pulse_frequency).max(restrained);
        Limits {
            weights,
            work_weight,
            longest,
            short_fraction: if self.settings.tolerance >= LOOSE { 1.0 } else { SHORT_FRACTION },
        }
    }
}
