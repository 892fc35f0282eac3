//! The block stepped from outside: continuous states, derivatives, event indicators, and effects of events.
//!
//! The equations, event functions and transitions are those of [`Simulation::advance`]; the importer's solver only has to find where an
//! indicator falls through zero. In flight and while the foot slides, the horizontal motion is integrated as well, so that inputs
//! may be any functions of time.

mod foresight;
pub(super) mod piece;

use crate::block::{Block, Body, Foundation};
use crate::excitation::{Excitation, Inputs};
use crate::numerics::dop853::DenseOutput;
use crate::numerics::dual::Dual;
use crate::simulation::energies::{WORKS, powers};
use crate::simulation::limits::Limits;
use crate::simulation::outputs::{Observation, observe};
use crate::simulation::state::RunState;
use crate::simulation::step_interior::{Between, StepInterior};
use crate::simulation::{Energies, Simulation, SimulationError};
use crate::system::dynamics::foot_height;
use crate::system::evaluation::{Evaluation, Motion, WITH_WORKS};
use crate::system::events::{Event, EventFunction, ROUNDING, extended_event_functions, watched};
use crate::system::forces::energy;
use crate::system::instant::Pose;
use crate::system::instant::{Footing, Powers, State};
use crate::system::motion_mode::{AnyMode, MotionMode};
use piece::{ExchangePiece, Foreseen};

pub use crate::system::events::INDICATORS;

/// The number of continuous states.
pub const STATES: usize = 6 + WORKS;

/// The continuous states: pose, rates, and works. They are θ (rad), θ̇ (rad/s), v (m), v̇ (m/s), u (m), u̇ (m/s), the work of the
/// excitation (J), and the energies taken by the dashpots and by other [dissipative](crate::system::forces::dissipated) forces (J).
///
/// While the foot grips, u and u̇ follow from the others, and so do v and v̇ on the rigid base: there these
/// states are integrated, but the motion does not depend on them. Each event sets them to the values that follow.
pub type ContinuousStates = [f64; STATES];

/// Depth below the rigid base, over R0, at which a landing is found. It is far less than the height of the last bounce, which begins with
/// 1e-9 p.
const SMALLEST_GAP: f64 = 1e-20;

/// Largest rate of an indicator that counts as none, over p and its rounding.
const NO_RATE: f64 = 1e3;

/// The indicator in place of a function that is not watched at present.
const IDLE: f64 = 1.0;

impl Simulation {
    /// Lets the block be stepped from outside from here on.
    ///
    /// Only the restraints that the FMU has, the first ones, have indicators. Step a block with more by [`Simulation::advance`].
    pub fn begin_exchange(&mut self) {
        let (since, offsets) = (self.run.pose.time, [IDLE; INDICATORS]);
        self.run.piece = Some(ExchangePiece { since, offsets, last: None, foreseen: None });
    }

    /// Beginning of the present smooth piece of the excitation (s).
    pub fn piece_time(&self) -> f64 {
        self.run.piece.map_or(self.run.pose.time, |piece| piece.since)
    }

    /// The excitation of the present smooth piece.
    pub(super) fn excitation(&self, inputs: &Inputs) -> Excitation {
        self.setup.excitation(self.piece_time(), inputs)
    }

    /// The continuous states; without rates once the block is held.
    pub fn states(&self, inputs: &Inputs) -> ContinuousStates {
        let (block, excitation) = (self.block(), self.excitation(inputs));
        let x = self.run.now(block, &excitation).instant;
        let works = self.run.sums.works().map(|work| work * block.mass);
        let [theta_dot, v_dot, u_dot] = if self.is_frozen() { [0.0; 3] } else { [x.theta_dot, x.v_dot, x.u_dot] };
        with_works([x.theta, theta_dot, x.v, v_dot, x.u, u_dot], works)
    }

    /// Sets the continuous states at `time` (s); the contacts stay. A block that is held keeps the rates, and with them the
    /// energies, of the end of its run.
    pub fn set_states(&mut self, time: f64, states: &ContinuousStates) {
        let [theta, theta_dot, v, v_dot, u, u_dot, ref works @ ..] = *states;
        let (block, regime) = (&self.setup.system.block, self.regime());
        if time != self.run.pose.time {
            self.run.events_in_this_instant = 0;
        }
        self.run.pose.time = time;
        let held = self.is_frozen().then_some(self.run.pose);
        let [w, w_dot] = foot_height(block, regime, [theta, theta_dot, v, v_dot]);
        self.run.pose.state = State::from([theta, theta_dot, w, w_dot]);
        self.run.pose.footing = match self.run.pose.footing {
            grips @ Footing::Grips { .. } => grips,
            Footing::Free { .. } => Footing::Free { u, u_dot },
            Footing::Slides { direction, .. } => Footing::Slides { u, u_dot, direction },
        };
        if let Some(held) = held {
            (self.run.pose.state[1], self.run.pose.state[3]) = (held.state[1], held.state[3]);
            if let (
                Footing::Free { u_dot, .. } | Footing::Slides { u_dot, .. },
                Footing::Free { u_dot: at_end, .. } | Footing::Slides { u_dot: at_end, .. },
            ) = (&mut self.run.pose.footing, held.footing)
            {
                *u_dot = at_end;
            }
        }
        self.run.sums = self.run.sums.with_works(works.map(|work| work / block.mass));
    }

    /// The derivatives of the states, per second; zeros once the run has ended.
    pub fn derivatives(&self, inputs: &Inputs) -> ContinuousStates {
        if self.run.ending.is_some() {
            return [0.0; STATES];
        }
        self.inspect_after_jump(inputs, |now| {
            let x = &now.instant;
            with_works([x.theta_dot, x.theta_ddot, x.v_dot, x.v_ddot, x.u_dot, x.u_ddot], powers(now))
        })
    }

    /// The event indicators: an event is due where one falls below zero.
    pub fn indicators(&self, inputs: &Inputs) -> [f64; INDICATORS] {
        if self.run.ending.is_some() || self.foreseen().is_some_and(|foreseen| self.run.pose.time < foreseen.pose.time)
        {
            return [IDLE; INDICATORS];
        }
        let (block, excitation) = (self.block(), self.excitation(inputs));
        let now = self.run.now(block, &excitation);
        let offsets = self.run.piece.map_or([IDLE; INDICATORS], |piece| piece.offsets);
        let surfaces = self.all_surfaces().into_iter().zip(offsets);
        let mut indicators = [IDLE; INDICATORS];
        for (indicator, (function, offset)) in indicators.iter_mut().zip(surfaces) {
            *indicator = function.map_or(IDLE, |function| indicator_of(function, &now, offset, false));
        }
        indicators
    }

    fn all_surfaces(&self) -> [Option<EventFunction>; INDICATORS] {
        let mode = AnyMode::of(self.block(), &self.run.pose);
        let beyond = extended_event_functions(mode, self.block());
        let mut all = watched(mode).into_iter().chain(beyond);
        std::array::from_fn(|_| all.next().flatten())
    }

    /// Begins a new smooth piece of the excitation, and applies all events due. These are the events of functions below zero; `observer`
    /// receives them. The inputs act at least until `until` (s).
    ///
    /// # Errors
    /// The events leave no regime that lasts.
    pub fn pass_events(
        &mut self,
        inputs: &Inputs,
        until: f64,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        self.report_beginning(observer);
        let offsets = self.run.piece.map(|piece| piece.offsets);
        let foreseen = self.foreseen().filter(|foreseen| foreseen.pose.time == self.run.pose.time);
        self.begin_exchange();
        let block = &self.setup.system.block;
        let excitation = self.excitation(inputs);
        if let Some(Foreseen { pose, peaks, .. }) = foreseen {
            (self.run.pose, self.run.peaks) = (pose, peaks);
        }
        let mut now = self.run.now(block, &excitation);
        if let Some(Foreseen { function, .. }) = foreseen {
            now = self.run.apply(&self.setup, function, &now, observer)?;
        }
        // At the beginning no offset is known.
        let mut offsets =
            offsets.filter(|o| foreseen.is_none() && *o != [IDLE; INDICATORS]).unwrap_or_else(|| self.offsets(&now));
        let mut jumped = foreseen.is_some();
        while self.run.ending.is_none() {
            let surfaces = self.all_surfaces().into_iter().zip(offsets);
            let fallen = surfaces.filter_map(|(function, offset)| {
                let below = indicator_of(function?, &now, offset, jumped);
                (below <= 0.0).then_some((function?, below))
            });
            let due = fallen.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(function, _)| function);
            // The block itself looks for what a jump of the excitation has brought about, and in that order.
            let by_jump = if jumped { None } else { self.setup.system.crossed_by_jump(&now) };
            let Some(function) = by_jump.filter(|_| due.is_some()).or(due) else { break };
            // A restraint may be taut and break in one instant.
            self.run.peaks.include_restraints(&now);
            now = self.run.apply(&self.setup, function, &now, observer)?;
            offsets = self.offsets(&now);
            jumped = true;
        }
        self.run.peaks.include(&now.channels_outlined());
        let (since, last, foreseen) = (self.run.pose.time, Some(self.run.pose), self.foresee(inputs, until));
        self.run.piece = Some(ExchangePiece { since, offsets: self.offsets(&now), last, foreseen });
        Ok(())
    }

    /// Time (s) of the last completed step, or of a later event.
    pub fn last_completed(&self) -> f64 {
        self.run.piece.and_then(|piece| piece.last).map_or(self.run.pose.time, |last| last.time)
    }

    /// Includes peaks, slip and plastic paths of the step since the last call, unless a state is not finite. `inputs` are linear over it.
    ///
    /// The motion between its ends is the polynomial that has their displacements, rates and accelerations. A step longer than the block's
    /// own longest one counts by its ends alone: the polynomial would overshoot.
    pub fn complete_step(&mut self, inputs: &Inputs) {
        if self.run.ending.is_some() {
            return;
        }
        let (block, excitation) = (&self.setup.system.block, self.excitation(inputs));
        let there = self.run.now(block, &excitation);
        let channels = there.channels_outlined();
        if !channels.candidates().iter().all(|(_, sample)| sample.re.is_finite() && sample.eps.is_finite()) {
            return;
        }
        let last = self.run.piece.and_then(|piece| piece.last);
        if let Some(last) = last.filter(|last| last.time < there.time) {
            let mode = AnyMode::of(block, &last);
            let tolerance = self.setup.settings.tolerance;
            match mode.extended() {
                Some(mode) => {
                    let motion = Motion::under(mode, block, &last, &excitation);
                    let Limits { longest, .. } =
                        Limits::<WITH_WORKS>::of(block, tolerance, mode, excitation.frequency());
                    self.run.accumulate_step::<WITH_WORKS>(motion, &last, &there, longest);
                }
                None => {
                    let motion = Motion::under(mode, block, &last, &excitation);
                    let Limits { longest, .. } = Limits::<4>::of(block, tolerance, mode, excitation.frequency());
                    self.run.accumulate_step::<4>(motion, &last, &there, longest);
                }
            }
        }
        self.run.peaks.include(&channels);
        if let Some(piece) = &mut self.run.piece {
            piece.last = Some(self.run.pose);
        }
    }

    /// The observation and the energies, with exact derivatives in a direction. Its components are `states`, the values of `inputs`, and
    /// `time`, on which the pulse and creeping supports depend directly.
    pub fn directional(
        &self,
        at: &Inputs,
        states: &ContinuousStates,
        inputs: &Inputs,
        time: f64,
    ) -> (Observation<Dual>, Energies) {
        let (block, excitation) = (self.block(), self.excitation(at));
        let mut states = *states;
        if self.is_frozen() {
            (states[1], states[3], states[5]) = (0.0, 0.0, 0.0);
        }
        let time = if self.run.ending.is_some() { 0.0 } else { time };
        let direction = self.direction(inputs, time);
        let now = self.run.now(block, &excitation);
        let x = &now.instant;
        let dual = |value: f64, i: usize| Dual::new(value, states[i]);
        let motion = [dual(x.theta, 0), dual(x.theta_dot, 1), dual(x.v, 2), dual(x.v_dot, 3)];
        let [w, mut w_dot] = foot_height(block, now.regime, motion);
        if self.is_frozen() {
            // As in `set_states`, a block that is held keeps the rate of its foot, wherever its states place it.
            w_dot = w_dot.re.into();
        }
        let footing = match now.footing {
            grips @ Footing::Grips { .. } => grips.map(Dual::from),
            Footing::Free { u, u_dot } => Footing::Free { u: dual(u, 4), u_dot: dual(u_dot, 5) },
            Footing::Slides { u, u_dot, direction } => {
                Footing::Slides { u: dual(u, 4), u_dot: dual(u_dot, 5), direction }
            }
        };
        let forcing = now.forcing.with_derivative(direction);
        let x = now.instant_along([motion[0], motion[1], w, w_dot], footing, forcing, time);
        let held_since = self.run.ending.map_or(self.run.pose.time, |(_, ended)| ended);
        let support_heights = Motion::from_pose(block, &self.run.pose, &excitation).support_heights(held_since);
        let support_heights = support_heights.map(|top| Dual::new(top.re, time * top.eps));
        let seen = observe(block, now.regime, &x, support_heights, forcing);
        let (kinetic, potential) = energy(block, now.regime, &now.forcing, &x);
        let [kinetic, potential] = [kinetic, potential].map(|energy| energy.eps * block.mass);
        let [_, _, _, _, _, _, works @ ..] = states;
        let energies = Energies::changing(kinetic, potential, works);
        if self.is_frozen() { (seen.without_motion(), energies) } else { (seen, energies) }
    }

    /// Twice the rounding of each indicator. Where an event left a function without a rate, but below zero by the importer's tolerance, the
    /// way back is added.
    fn offsets(&self, now: &Evaluation) -> [f64; INDICATORS] {
        self.all_surfaces().map(|function| {
            let Some(function) = function else { return IDLE };
            let rounding = match (function, now.body.foundation) {
                // Its gaps are zero at θ = 0 without rounding, and rocking that dies out has ever smaller ones.
                (EventFunction::Gap(_), Foundation::Rigid) if now.footing.grips() => SMALLEST_GAP * now.body.r0,
                _ => 2.0 * function.rounding(now.body),
            };
            let sample = function.sample(now);
            let rateless = sample.eps.abs() <= NO_RATE * function.rounding(now.body) * now.body.p;
            let foundation = now.body.foundation;
            let follows = function.follows_from_state(foundation) && !function.jumps_at_impacts(foundation);
            if sample.re < 0.0 && rateless && follows { rounding - sample.re } else { rounding }
        })
    }
}

impl RunState {
    /// Includes the peaks of a step from the pose `last` to `there`, its ends alone if it is longer than `longest` (s).
    fn accumulate_step<const N: usize>(
        &mut self,
        motion: Motion<impl MotionMode, N>,
        last: &Pose,
        there: &Evaluation,
        longest: f64,
    ) {
        let here = motion.at(last.time, motion.state_at(last));
        self.accumulate_slip(&here, there);
        self.accumulate_plastic(&here, there);
        if there.time - here.time > longest {
            self.peaks.include_restraints(there);
            return;
        }
        let ends = [&here, there].map(|at| (motion.state_of(at), motion.rate_of(at)));
        let between = DenseOutput::between(here.time, there.time - here.time, ends, Powers::zeros());
        // An importer may take steps of any length, so the rates of all channels are compared.
        let near = 0.0;
        let mut inside = StepInterior { motion, between: Between::Known(between), evaluations: 0 };
        inside.include_in(&mut self.peaks, &here, there, near);
        self.peaks.include_pulls_of_step(&here, there, |elapsed| inside.at(elapsed));
    }
}

/// The states of this motion with these works, or their derivatives.
fn with_works(motion: [f64; 6], works: [f64; WORKS]) -> ContinuousStates {
    std::array::from_fn(|i| if i < 6 { motion[i] } else { works[i - 6] })
}

/// Typical magnitudes of the states for error control, none of them zero.
pub fn nominals(block: &Block) -> ContinuousStates {
    let Block { alpha, body: Body { p, r0, mass, gravity, omega_v, foundation, .. }, .. } = *block;
    let (vertical, rate) = match foundation {
        Foundation::Viscoelastic => (block.static_deflection(), omega_v),
        Foundation::Rigid => (r0 * alpha * alpha, p),
    };
    let barrier = mass * gravity * r0 * alpha * alpha;
    with_works([alpha, alpha * p, vertical, vertical * rate, r0 * alpha, r0 * alpha * p], [barrier; WORKS])
}

/// The indicator of an event function with its `offset`, as a fraction of its size.
///
/// A function falls through zero only while it falls. So the indicator is positive while the function rises, and clearly
/// positive right after an event that leaves the function at zero: it grows with the rate. A solver's first steps get the sign of
/// the rate right, but may get that of the value wrong. Where an event of this instant may have `jumped` the function below zero, its
/// value alone decides, as inside the block.
fn indicator_of(function: EventFunction, now: &Evaluation, offset: f64, jumped: bool) -> f64 {
    let size = function.rounding(now.body) / ROUNDING;
    let sample = function.sample(now);
    let value = sample.re + offset;
    // Elsewhere the rate depends on those of the inputs, which are not known.
    let foundation = now.body.foundation;
    let has_rate = function.follows_from_state(foundation) && !(jumped && function.jumps_at_impacts(foundation));
    (if has_rate { value.max(sample.eps / now.body.p) } else { value }) / size
}
