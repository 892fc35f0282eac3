//! The loop: step → locate the first event → apply it → decide the regime → continue.

mod ending;
mod energies;
pub mod exchange;
#[cfg(feature = "lanes")]
pub mod follow;
mod force_peaks;
mod initial_sensitivity;
#[cfg(feature = "lanes")]
pub mod lanes;
pub mod outputs;
pub mod peaks;
mod rigid_base;
mod settings;
mod smooth_piece;
mod step_end;
mod step_interior;
mod stepping;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::block::{Block, Corner, Regime, restraints};
use crate::excitation::{Excitation, Inputs, Pulse};
use crate::numerics::control::StepControl;
use crate::system::System;
use crate::system::evaluation::{Evaluation, Motion};
use crate::system::events::{Event, EventFunction, EventKind, Transition, TransitionCounts};
use crate::system::instant::{Footing, Pose, State};
use peaks::{Peaks, greater};

pub use crate::system::beginning::Initial;
pub use ending::{Ending, Progress, SimulationError};
pub use energies::{Energies, EnergySums};
use exchange::ExchangePiece;
pub use initial_sensitivity::{InitialDerivatives, Start};
pub use settings::{OnOverturning, OnSeparation, Settings};

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
    /// Displacement of the foot from its place at the start (m), positive to the right; in flight, that of the last contact.
    pub now: f64,
    /// Length of its path on the ground (m).
    pub total: f64,
}

/// A block in motion. It is a plain value: a copy continues exactly as the original does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Simulation {
    /// Shared, so that a step can borrow it while the rest of the simulation changes.
    system: Arc<System>,
    settings: Settings,
    pulse: Pulse,
    pose: Pose,
    /// The present piece of a motion that is stepped from outside.
    piece: Option<ExchangePiece>,
    control: StepControl,
    ending: Option<(Ending, f64)>,
    sums: EnergySums,
    peaks: Peaks,
    slip: Slip,
    /// Paths of the plastic elongations of the restraints (m).
    plastic_paths: [f64; restraints::MAX],
    counts: Counts,
    last_event: f64,
    events_in_this_instant: u32,
    /// An event that the motion has reached and that has not been applied.
    pending: Option<Pending>,
}

/// An event that has not been applied.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Pending {
    function: EventFunction,
    /// Beginning of the smooth piece of the excitation that leads to the event (s); a piece that ends at the event still acts.
    piece: f64,
}

/// The treatment of an event.
#[derive(Clone, Copy, Debug, PartialEq)]
enum AtEvent {
    /// It is applied.
    Apply,
    /// The motion stops at the event.
    #[cfg(feature = "lanes")]
    Stop,
    /// The motion stops at the event, unless it ends the run or is not later than this time (s).
    StopAfter(f64),
}

impl Simulation {
    /// A block at its beginning at `time`, with the excitation of that time.
    ///
    /// A support that nothing touches stands at its free height.
    pub fn new(
        block: Block,
        settings: Settings,
        pulse: Pulse,
        initial: &Initial,
        time: f64,
        inputs: &Inputs,
    ) -> Simulation {
        let [least, most] = Settings::TOLERANCES;
        let flies = settings.on_separation == OnSeparation::Fly;
        let system = System { block, flies, slowest: System::SLOWEST };
        let excitation = Excitation::from_time(time, inputs, &pulse, &block);
        let mut simulation = Simulation {
            system: Arc::new(system),
            settings: Settings { tolerance: settings.tolerance.clamp(least, most), ..settings },
            pulse,
            pose: system.beginning(initial, time, &excitation),
            piece: None,
            control: StepControl::NEW,
            ending: None,
            sums: EnergySums::default(),
            peaks: Peaks::default(),
            slip: Slip::default(),
            plastic_paths: [0.0; restraints::MAX],
            counts: Counts::default(),
            last_event: time,
            events_in_this_instant: 0,
            pending: None,
        };
        simulation.end_if_separated();
        let start = simulation.now(&block, &excitation);
        simulation.sums = EnergySums { initial: start.energy(), ..EnergySums::default() };
        let shown = system.released(&simulation.pose, &start).unwrap_or(simulation.pose);
        let shown = Motion::from_pose(&block, &shown, &excitation).at(time, shown.state);
        simulation.peaks.include(&shown.channels());
        simulation.peaks.include_restraints(&shown);
        simulation
    }

    /// Advances to `until` (s), which is not before the present time, under inputs that are linear in time, and reports each event
    /// to `observer` as it happens.
    ///
    /// Stops at the end of the run if that comes first. After the end nothing advances, or only time does if the block is held. No
    /// memory is allocated. On an error the state is that of the last good step.
    pub fn advance(
        &mut self,
        until: f64,
        inputs: &Inputs,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Progress, SimulationError> {
        self.settle(inputs, observer)?;
        self.pieces(until, inputs, AtEvent::Apply, observer)
    }

    /// As [`Simulation::advance`], but stops at the first event later than `after` (s) without applying it, and returns `None`.
    ///
    /// [`Simulation::settle`] then applies it; continuing under the same inputs gives the bits of an uninterrupted run. An event
    /// that ends the run is applied.
    pub fn advance_to_event(
        &mut self,
        until: f64,
        after: f64,
        inputs: &Inputs,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Option<Progress>, SimulationError> {
        self.settle(inputs, observer)?;
        let progress = self.pieces(until, inputs, AtEvent::StopAfter(after), observer)?;
        Ok(self.pending.is_none().then_some(progress))
    }

    /// Applies the event at which [`Simulation::advance_to_event`] stopped, if it did, under these inputs.
    pub fn settle(&mut self, inputs: &Inputs, observer: &mut dyn FnMut(&Event)) -> Result<(), SimulationError> {
        self.apply_pending(inputs, observer, |_| ()).map(|_| ())
    }

    /// Applies a pending event as [`Simulation::settle`] does, and returns what `inspect` makes of the block right after it.
    fn apply_pending<R>(
        &mut self,
        inputs: &Inputs,
        observer: &mut dyn FnMut(&Event),
        inspect: impl FnOnce(&Evaluation) -> R,
    ) -> Result<Option<R>, SimulationError> {
        let Some(Pending { function, piece }) = self.pending.take() else { return Ok(None) };
        let system = Arc::clone(&self.system);
        let excitation = Excitation::from_time(piece, inputs, &self.pulse, &system.block);
        let now = self.now(&system.block, &excitation);
        self.apply(function, &now, observer).map(|after| Some(inspect(&after)))
    }

    /// Whether the motion has stopped at an event that has not been applied.
    pub fn is_at_event(&self) -> bool {
        self.pending.is_some()
    }

    /// Whether the block is at rest and stays so under these inputs.
    pub fn rests(&self, inputs: &Inputs) -> bool {
        let (block, excitation) = (self.block(), self.excitation(inputs));
        let lasts = excitation.is_constant() && self.pulse.next_kink(self.pose.time).is_none();
        self.is_frozen() || lasts && self.now(block, &excitation).rests()
    }

    fn pieces(
        &mut self,
        until: f64,
        inputs: &Inputs,
        at_event: AtEvent,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Progress, SimulationError> {
        let system = Arc::clone(&self.system);
        let block = &system.block;
        let mut budget = smooth_piece::MAX_STEPS;
        while self.pose.time < until && self.ending.is_none() {
            let stop = self.pulse.next_kink(self.pose.time).map_or(until, |kink| kink.min(until));
            let excitation = Excitation::from_time(self.pose.time, inputs, &self.pulse, block);
            self.smooth_piece(stop, block, &excitation, &mut budget, at_event, observer)?;
            if self.pending.is_some() {
                return Ok(Progress::Reached);
            }
        }
        match self.ending {
            Some((ending, time)) if !self.is_frozen() => Ok(Progress::Ended(ending, time)),
            _ => {
                self.pose.time = until;
                Ok(Progress::Reached)
            }
        }
    }

    /// Whether the motion stops at `now`, where an event function is zero, before the event is applied.
    fn stops(&self, at_event: AtEvent, function: EventFunction, now: &Evaluation) -> bool {
        let after = match at_event {
            AtEvent::Apply => return false,
            #[cfg(feature = "lanes")]
            AtEvent::Stop => return true,
            AtEvent::StopAfter(time) => time,
        };
        if now.time <= after {
            return false;
        }
        let Transition { pose, event, .. } = self.system.transition(&self.pose, now, function);
        let separates = pose.contacts.regime() == Regime::Separated && !self.system.flies;
        let ends = match event {
            None => return false,
            Some(EventKind::Overturning) => self.settings.on_overturning == OnOverturning::Terminate,
            Some(_) => separates && self.settings.on_separation == OnSeparation::Terminate,
        };
        !ends
    }

    /// Whether a state from outside can be resumed: all numbers are finite, and the tolerance is within its limits. The caller, who
    /// knows the parameters, checks the block.
    pub fn is_valid(&self) -> bool {
        let Simulation { settings, pulse, pose, piece, control, sums, last_event, .. } = self;
        let others = [*last_event, pulse.amplitude, pulse.period, pulse.start, pulse.phase, pulse.cycles];
        let [least, most] = Settings::TOLERANCES;
        (least..=most).contains(&settings.tolerance)
            && control.is_valid()
            && pulse.period > 0.0
            && pulse.cycles >= 1.0
            && piece.is_none_or(|piece| piece.is_finite())
            && pose.is_finite()
            && self.peaks.is_valid()
            && self.slip.now.is_finite()
            && self.slip.total.is_finite()
            && self.plastic_paths.iter().all(|path| path.is_finite())
            && self.ending.is_none_or(|(_, time)| time.is_finite())
            && self.pending.is_none_or(|pending| pending.piece.is_finite() && pending.function.is_of(self.block()))
            && self.foreseen_surface().is_none_or(|function| function.is_of(self.block()))
            && sums.is_finite()
            && others.into_iter().all(f64::is_finite)
    }

    /// Sets the clock without motion, to adopt the rounding of a master's clock.
    pub fn set_time(&mut self, time: f64) {
        self.pose.time = time;
    }

    /// Present time (s).
    pub fn time(&self) -> f64 {
        self.pose.time
    }

    /// Present state `[θ, θ̇, w, ẇ]`; the meaning of w depends on the regime, see [`crate::system::dynamics`].
    pub fn state(&self) -> &State {
        &self.pose.state
    }

    /// Present regime. After a jump of the inputs a block on the rigid base may lift in this instant;
    /// [`Simulation::observe`] shows the regime after it.
    pub fn regime(&self) -> Regime {
        self.pose.contacts.regime()
    }

    /// The block.
    pub fn block(&self) -> &Block {
        &self.system.block
    }

    /// The reason and the time of the end of the run, if it ended.
    pub fn ending(&self) -> Option<(Ending, f64)> {
        self.ending
    }

    /// Counters since the start.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Greatest values since the start.
    pub fn peaks(&self) -> Peaks {
        self.peaks
    }

    /// The slip of the foot since the start.
    pub fn slip(&self) -> Slip {
        let Slip { now, total } = self.slip;
        // A solver outside may be within a step.
        match self.piece.and_then(|piece| piece.last()) {
            Some(last) if self.slides() => {
                let path = self.foot_place(&self.pose) - self.foot_place(&last);
                Slip { now: now + path, total: total + path.abs() }
            }
            _ => Slip { now, total },
        }
    }

    fn foot_place(&self, pose: &Pose) -> f64 {
        Motion::from_pose(self.block(), pose, &Excitation::none()).at(pose.time, pose.state).foot_place()
    }

    /// Whether the foot slides now. After a jump of the inputs it may begin to slide in this instant, which
    /// [`Simulation::slides_under`] tells.
    pub fn slides(&self) -> bool {
        !self.pose.footing.grips() && self.regime() != Regime::Separated && !self.is_frozen()
    }

    /// The horizontal hold.
    pub fn footing(&self) -> Footing<f64> {
        self.pose.footing
    }

    /// Time of the last event (s); the start if there was none.
    pub fn last_event(&self) -> f64 {
        self.last_event
    }

    /// The block now, under this excitation.
    fn now<'a>(&self, block: &'a Block, excitation: &'a Excitation) -> Evaluation<'a> {
        Motion::from_pose(block, &self.pose, excitation).at(self.pose.time, self.pose.state)
    }

    /// Applies the event at `now`, where `function` has fallen through zero, and returns the block right after it.
    fn apply<'a>(
        &mut self,
        function: EventFunction,
        now: &Evaluation<'a>,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Evaluation<'a>, SimulationError> {
        const MAX_EVENTS_IN_AN_INSTANT: u32 = 64;
        let time = self.pose.time;
        self.events_in_this_instant += 1;
        if self.events_in_this_instant > MAX_EVENTS_IN_AN_INSTANT {
            return Err(SimulationError::NoRegime { time, count: self.events_in_this_instant });
        }
        let Transition { pose, event, counts, path } = self.system.transition(&self.pose, now, function);
        if path.overflows() {
            return Err(SimulationError::NoRegime { time, count: self.events_in_this_instant });
        }
        let TransitionCounts { impacts, liftoffs, constraint, evaluations } = counts;
        self.pose = pose;
        self.last_event = time;
        self.counts.impacts += impacts;
        self.counts.liftoffs += liftoffs;
        self.counts.evaluations += evaluations + 1;
        self.sums.constraint += constraint;
        let after = self.now(now.block, now.excitation);
        let lost = now.energy() - after.energy();
        self.sums.lose(event, lost);
        if now.regime == Regime::Separated && after.regime != Regime::Separated {
            // The flight has moved the foot.
            self.slip.now = after.foot_place();
            self.peaks.slip = greater(self.peaks.slip, self.slip.now.abs());
        }
        let Some(kind) = event else { return Ok(after) };
        if kind == EventKind::Overturning {
            self.ending = Some((Ending::Overturned, time));
        }
        self.end_if_separated();
        observer(&Event { time, kind, before: now.regime, after: after.regime });
        Ok(after)
    }

    /// Applies an event to which the motion has come under this excitation.
    #[cfg(feature = "lanes")]
    fn apply_alone(
        &mut self,
        function: EventFunction,
        block: &Block,
        excitation: &Excitation,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        let now = self.now(block, excitation);
        self.apply(function, &now, observer).map(|_| ())
    }

    fn end_if_separated(&mut self) {
        if self.regime() == Regime::Separated && !self.system.flies {
            let Pose { time, state, .. } = self.pose;
            let side = if state[0] < 0.0 { Corner::Left } else { Corner::Right };
            self.ending = Some((Ending::at_separation(self.system.block.alpha_of(side), state[0], state[1]), time));
        }
    }
}
