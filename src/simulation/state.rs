//! The state of a run: its data, and views of them.

use serde::{Deserialize, Serialize};

use crate::block::restraints::{self, States};
use crate::block::{Block, Body, Regime};
use crate::excitation::{Excitation, Forcing, Inputs, Pulse};
use crate::numerics::control::StepControl;
use crate::numerics::dual::Dual;
use crate::run::{Ending, Settings};
use crate::simulation::energies::{Energies, EnergySums, powers};
use crate::simulation::exchange::piece::ExchangePiece;
use crate::simulation::initial_sensitivity::{InitialDerivatives, Start};
use crate::simulation::outputs::Observation;
use crate::simulation::peaks::Peaks;
use crate::system::System;
use crate::system::evaluation::{Evaluation, Motion};
use crate::system::events::EventFunction;
use crate::system::forces::energy;
use crate::system::instant::{Footing, Pose, Powers, State};

/// Counters since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counts {
    /// Landings to which the impact map (or e, on the rigid base) was applied.
    pub impacts: u32,
    /// Corners that lifted.
    pub liftoffs: u32,
    /// Steps of the integrator that were accepted.
    pub steps: u64,
    /// Steps that were repeated with a smaller size.
    pub rejected: u64,
    /// Evaluations of the equations of motion, dense output and restarts included.
    pub evaluations: u64,
}

/// The slip of the foot since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Slip {
    /// Displacement of the foot since the start (m), positive to the right. In flight, that of the last contact.
    pub now: f64,
    /// Length of its path on the ground (m).
    pub total: f64,
}

/// A block in motion. It is a plain value: a copy continues exactly as the original does.
///
/// A step borrows the setup and changes the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Simulation {
    pub(super) setup: Setup,
    pub(super) run: RunState,
}

/// The block, its settings and its pulse, which no step changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Setup {
    pub(super) system: System,
    pub(super) settings: Settings,
    pub(super) pulse: Pulse,
}

impl Setup {
    /// Returns the excitation from `time` (s) to the pulse's next kink.
    #[inline(always)]
    pub(super) fn excitation(&self, time: f64, inputs: &Inputs) -> Excitation {
        Excitation::from_time(time, inputs, &self.pulse, &self.system.block)
    }
}

/// The state of a run, which steps and events change.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RunState {
    pub(super) pose: Pose,
    /// The present piece of a motion that is stepped from outside.
    pub(super) piece: Option<ExchangePiece>,
    pub(super) control: StepControl,
    pub(super) ending: Option<(Ending, f64)>,
    pub(super) sums: EnergySums,
    pub(super) peaks: Peaks,
    pub(super) slip: Slip,
    /// Paths of the plastic elongations of the restraints (m).
    pub(super) plastic_paths: [f64; restraints::MAX],
    pub(super) counts: Counts,
    pub(super) last_event: f64,
    pub(super) events_in_this_instant: u32,
    /// An event that the motion has reached and that has not been applied.
    pub(super) pending: Option<Pending>,
    /// Whether events of restraints at the beginning have yet to be reported.
    pub(super) begins: bool,
}

/// An event that has not been applied.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Pending {
    pub(super) function: EventFunction,
    /// Beginning of the smooth piece of the excitation that leads to the event (s). A piece that ends at the event still acts.
    pub(super) piece_start: f64,
}

/// A step that has been taken, as far as steps of all shapes have it in common.
pub(super) struct Committed {
    /// The time at its end (s).
    pub(super) time: f64,
    /// The state there.
    pub(super) state: State,
    /// The horizontal hold there.
    pub(super) footing: Footing<f64>,
    /// Works of the excitation and the dashpots since the start, per unit mass (m²/s²).
    pub(super) works: [f64; 2],
    /// Its evaluations of the equations of motion, those for events and peaks inside included.
    pub(super) evaluations: u64,
}

impl RunState {
    /// Books a step: counts it, sums its works, and makes its end the present instant.
    #[inline(always)]
    pub(super) fn commit(&mut self, Committed { time, state, footing, works, evaluations }: Committed) {
        self.counts.steps += 1;
        self.counts.evaluations += evaluations;
        [self.sums.input, self.sums.dashpots] = works;
        if time > self.pose.time {
            self.events_in_this_instant = 0;
        }
        self.pose = Pose { time, state, footing, ..self.pose };
    }

    /// Works of the excitation and the dashpots since the start, with those of a step, per unit mass (m²/s²).
    #[inline(always)]
    pub(super) fn works_after(&self, work: Powers) -> [f64; 2] {
        [self.sums.input + work[0], self.sums.dashpots + work[1]]
    }

    /// The block now, under this excitation.
    #[inline]
    pub(super) fn now<'a>(&self, body: &'a Body, excitation: &'a Excitation) -> Evaluation<'a> {
        Motion::from_pose(body, &self.pose, excitation).at(self.pose.time, self.pose.state)
    }
}

impl Simulation {
    /// Whether a state from outside can be resumed. Its numbers are finite, and the tolerance is within its limits. The caller, who knows
    /// the parameters, checks the block.
    pub fn is_valid(&self) -> bool {
        let Setup { settings, pulse, .. } = self.setup;
        let RunState { pose, piece, control, sums, last_event, .. } = self.run;
        let others = [last_event, pulse.amplitude, pulse.period, pulse.start, pulse.phase, pulse.cycles];
        let [least, most] = Settings::TOLERANCES;
        (least..=most).contains(&settings.tolerance)
            && control.is_valid()
            && pulse.period > 0.0
            && pulse.cycles >= 1.0
            && piece.is_none_or(|piece| piece.is_finite())
            && pose.is_finite()
            && self.run.peaks.is_valid()
            && self.run.slip.now.is_finite()
            && self.run.slip.total.is_finite()
            && self.run.plastic_paths.iter().all(|path| path.is_finite())
            && self.run.ending.is_none_or(|(_, time)| time.is_finite())
            && self
                .run
                .pending
                .is_none_or(|pending| pending.piece_start.is_finite() && pending.function.is_of(self.block()))
            && piece.and_then(|piece| piece.foreseen).is_none_or(|foreseen| foreseen.function.is_of(self.block()))
            && sums.is_finite()
            && others.into_iter().all(f64::is_finite)
    }

    /// Sets the clock without motion, to adopt the rounding of a master's clock.
    pub fn set_time(&mut self, time: f64) {
        self.run.pose.time = time;
    }

    /// Advances the clock of a frozen block to `until` (s). Any other block needs steps.
    pub fn wait(&mut self, until: f64) {
        if self.is_frozen() {
            self.run.pose.time = until;
        }
    }

    /// Present time (s).
    pub fn time(&self) -> f64 {
        self.run.pose.time
    }

    /// Present state `[θ, θ̇, w, ẇ]`. The meaning of w depends on the regime: see [`crate::system::dynamics`].
    pub fn state(&self) -> &State {
        &self.run.pose.state
    }

    /// Present regime. After a jump of the inputs a block on the rigid base may lift in this instant;
    /// [`Simulation::observe`] shows the regime after it.
    pub fn regime(&self) -> Regime {
        self.run.pose.contacts.regime()
    }

    /// The block.
    pub fn block(&self) -> &Block {
        &self.setup.system.block
    }

    /// The reason and the time of the end of the run, if it ended.
    pub fn ending(&self) -> Option<(Ending, f64)> {
        self.run.ending
    }

    /// Counters since the start.
    pub fn counts(&self) -> Counts {
        self.run.counts
    }

    /// Greatest values since the start.
    pub fn peaks(&self) -> Peaks {
        self.run.peaks
    }

    /// The slip of the foot since the start.
    pub fn slip(&self) -> Slip {
        let Slip { now, total } = self.run.slip;
        // A solver outside may be within a step.
        match self.run.piece.and_then(|piece| piece.last) {
            Some(last) if self.slides() => {
                let path = self.foot_place(&self.run.pose) - self.foot_place(&last);
                Slip { now: now + path, total: total + path.abs() }
            }
            _ => Slip { now, total },
        }
    }

    fn foot_place(&self, pose: &Pose) -> f64 {
        Motion::from_pose(self.block(), pose, &Excitation::none()).at(pose.time, pose.state).foot_place()
    }

    /// Whether the foot slides now. Ignores a slip that starts now; see [`Simulation::slides_under`].
    pub fn slides(&self) -> bool {
        self.run.pose.slides() && !self.is_frozen()
    }

    /// The horizontal hold.
    pub fn footing(&self) -> Footing<f64> {
        self.run.pose.footing
    }

    /// Time of the last event (s); the start if there was none.
    pub fn last_event(&self) -> f64 {
        self.run.last_event
    }

    /// The block now.
    pub fn pose(&self) -> &Pose {
        &self.run.pose
    }

    /// The block and the rules by which it moves.
    pub fn system(&self) -> &System {
        &self.setup.system
    }

    /// The pulse.
    pub fn pulse(&self) -> &Pulse {
        &self.setup.pulse
    }

    /// Whether the motion has stopped at an event that has not been applied.
    pub fn is_at_event(&self) -> bool {
        self.run.pending.is_some()
    }

    /// Whether the block is at rest and stays so under these inputs.
    pub fn rests(&self, inputs: &Inputs) -> bool {
        let (block, excitation) = (self.block(), self.excitation(inputs));
        let lasts = excitation.is_constant() && self.setup.pulse.next_kink(self.run.pose.time).is_none();
        self.is_frozen() || lasts && self.run.now(block, &excitation).rests()
    }

    /// Whether the run has ended and the block is held, without motion or support.
    pub fn is_frozen(&self) -> bool {
        self.run.ending.is_some_and(|(ending, _)| self.setup.settings.holds(ending))
    }

    /// The states of the restraints.
    pub fn restraints(&self) -> States {
        self.run.pose.restraints
    }

    /// The plastic elongations of the restraints (m), by their numbers, positive for longer ones.
    pub fn plastic_elongations(&self) -> [f64; restraints::MAX] {
        self.run.now(self.block(), &Excitation::none()).plastic_elongations()
    }

    /// Energy lost by yielding of the restraint with this number since the start (J). It is the yield force times the path of its plastic
    /// elongation, up to the last step.
    pub fn plastic_work(&self, number: usize) -> f64 {
        self.run.plastic_paths[number] * restraints::yield_force(self.block(), number)
    }

    /// The observed quantities right after these inputs begin to act. A corner that the rigid base would have to pull has lifted. The next
    /// step counts that event.
    pub fn observe(&self, inputs: &Inputs) -> Observation<f64> {
        let seen = self.inspect_after_jump(inputs, |now| now.observe());
        if self.is_frozen() { seen.frozen() } else { seen }
    }

    /// Whether the foot slides right after these inputs have begun to act. The next step counts the event.
    pub fn slides_under(&self, inputs: &Inputs) -> bool {
        let slides = |now: &Evaluation| !now.footing.grips() && now.regime != Regime::Separated;
        !self.is_frozen() && self.inspect_after_jump(inputs, slides)
    }

    /// [`Simulation::observe`] with the exact rates of change along the motion in the dual parts.
    pub fn observe_rates(&self, inputs: &Inputs) -> Observation<Dual> {
        let seen = self.inspect_after_jump(inputs, |now| now.observe_rates());
        if self.is_frozen() { seen.frozen() } else { seen }
    }

    /// [`Simulation::observe`] with exact derivatives in the dual parts. The components of the direction are the values of `direction` and
    /// `time`. State and regime are kept.
    pub fn observe_direction(&self, inputs: &Inputs, direction: &Inputs, time: f64) -> Observation<Dual> {
        let time = if self.run.ending.is_some() { 0.0 } else { time };
        let direction = self.direction(direction, time);
        let seen = self.inspect_after_jump(inputs, |now| now.observe_direction(direction, time));
        if self.is_frozen() { seen.frozen() } else { seen }
    }

    /// The derivative of the forcing in a direction of the inputs and of time.
    pub(super) fn direction(&self, inputs: &Inputs, time: f64) -> Forcing<f64> {
        let block = self.block();
        let given = Excitation::from_time(0.0, inputs, &Pulse::NONE, block).at(inputs.time);
        let pulse = self.setup.excitation(self.piece_time(), &Inputs::default());
        Forcing { x: given.x + time * pulse.rate_at(self.run.pose.time).x, ..given }
    }

    /// Passes the block right after these inputs have begun to act to `inspect`. A solver outside passes events itself: once it has begun,
    /// the block is that of its derivatives.
    pub(super) fn inspect_after_jump<R>(&self, inputs: &Inputs, inspect: impl FnOnce(&Evaluation) -> R) -> R {
        let (block, pose) = (self.block(), &self.run.pose);
        let excitation = self.excitation(inputs);
        let mut now = self.run.now(block, &excitation);
        if let Some((_, ended)) = self.run.ending {
            // Under a block that is held the supports are, too.
            now.support_heights = Motion::from_pose(block, pose, &excitation).support_heights(ended);
        } else if self.run.piece.is_none_or(|piece| piece.last.is_none())
            && let Some(released) = self.setup.system.pose_after_jump(pose, &now)
        {
            now = Motion::from_pose(block, &released, &excitation).at(released.time, released.state);
        }
        inspect(&now)
    }

    /// Energies and their sums now (J).
    pub fn energies(&self) -> Energies {
        let (block, excitation) = (self.block(), Excitation::none());
        let now = self.run.now(block, &excitation);
        self.run.sums.energies(energy(block, now.regime, &now.forcing, &now.instant), block.mass)
    }

    /// Rates at which the energies and their sums change now (W).
    pub fn energy_rates(&self, inputs: &Inputs) -> Energies {
        if self.is_frozen() {
            return Energies::default();
        }
        self.inspect_after_jump(inputs, |now| {
            let block = now.body;
            let (kinetic, potential) = energy(block, now.regime, &now.forcing, &now.with_rates(Forcing::default()));
            let [kinetic, potential] = [kinetic.eps, potential.eps].map(|energy| energy * block.mass);
            Energies::changing(kinetic, potential, powers(now))
        })
    }

    /// Derivatives of the beginning in the direction of `start`. The values of `start` are those from which this block began.
    pub fn initial_sensitivity(&self, start: &Start) -> InitialDerivatives {
        start.derivatives(&self.setup.system, self.is_frozen())
    }
}
