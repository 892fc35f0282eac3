//! The driver: step → locate the first event → apply it → decide the regime → continue.
//!
//! | call | advances |
//! | --- | --- |
//! | [`Simulation::advance`] | to a time, over several smooth pieces of the excitation |
//! | `smooth_piece` | to the end of a piece, over several modes of motion |
//! | `RunState::steps`, in [`stepping`](super::stepping) | under one mode, by steps or swings, to the first event |
//! | `apply` | through an event, into the next regime |

use crate::block::{Block, Corner, Regime, restraints};
use crate::excitation::{Inputs, Pulse};
use crate::numerics::control::StepControl;
use crate::run::{Ending, MAX_STEPS, OnOverturning, OnSeparation, Progress, Settings, SimulationError};
use crate::simulation::energies::EnergySums;
#[cfg(feature = "lanes")]
use crate::simulation::follow::Rates;
use crate::simulation::peaks::{Peaks, greater};
use crate::simulation::state::{Counts, Pending, RunState, Setup, Simulation, Slip};
use crate::simulation::step::{StepsInput, StepsOutcome};
use crate::system::System;
use crate::system::beginning::Initial;
use crate::system::evaluation::{Evaluation, Motion};
use crate::system::events::{Event, EventFunction, EventKind, Transition, TransitionCounts};
use crate::system::instant::Pose;

impl Simulation {
    /// Places a block at its beginning at `time` (s), with the excitation of that time.
    ///
    /// A support that nothing touches stands at its free height. A tolerance outside [`Settings::TOLERANCES`] becomes the nearer limit.
    pub fn new(
        block: Block,
        settings: Settings,
        pulse: Pulse,
        initial: &Initial,
        time: f64,
        inputs: &Inputs,
    ) -> Simulation {
        let flies = settings.on_separation == OnSeparation::Fly;
        let system = System { block, flies };
        let setup = Setup { system, settings: settings.within_limits(), pulse };
        let excitation = setup.excitation(time, inputs);
        let mut run = RunState {
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
            begins: !system.block.restraints.is_empty(),
        };
        run.end_if_separated(&setup);
        let start = run.now(&block, &excitation);
        run.sums = EnergySums { initial: start.energy(), ..EnergySums::default() };
        let shown = system.pose_after_jump(&run.pose, &start).unwrap_or(run.pose);
        let shown = Motion::from_pose(&block, &shown, &excitation).at(time, shown.state);
        run.peaks.include(&shown.channels_outlined());
        run.peaks.include_restraints(&shown);
        Simulation { setup, run }
    }

    /// Advances to `until` (s) under inputs that are linear in time. Reports each event to `observer` as it happens. `until` is not before
    /// the present time.
    ///
    /// Stops at the end of the run if that comes first. After the end nothing advances, or only time does if the block is held. No
    /// memory is allocated. On an error the state is that of the last good step.
    ///
    /// # Errors
    /// The solver cannot go on: see [`SimulationError`].
    pub fn advance(
        &mut self,
        until: f64,
        inputs: &Inputs,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Progress, SimulationError> {
        self.apply_pending_event(inputs, observer)?;
        self.pieces(until, inputs, None, observer)
    }

    /// Advances as [`Simulation::advance`] does, but not past the first event later than `after` (s). That event is not yet applied, and
    /// the result is `None`.
    ///
    /// [`Simulation::apply_pending_event`] then applies it; continuing under the same inputs gives the bits of an uninterrupted run. An event
    /// that ends the run is applied.
    ///
    /// # Errors
    /// Those of [`Simulation::advance`].
    pub fn advance_to_event(
        &mut self,
        until: f64,
        after: f64,
        inputs: &Inputs,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Option<Progress>, SimulationError> {
        self.apply_pending_event(inputs, observer)?;
        let progress = self.pieces(until, inputs, Some(after), observer)?;
        Ok(self.run.pending.is_none().then_some(progress))
    }

    /// Applies the event at which [`Simulation::advance_to_event`] stopped, if it did, under these inputs.
    ///
    /// # Errors
    /// The event leaves no regime that lasts.
    #[inline]
    pub fn apply_pending_event(
        &mut self,
        inputs: &Inputs,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        self.report_beginning(observer);
        if self.run.pending.is_some() {
            self.apply_pending(inputs, observer, |_| ())?;
        }
        Ok(())
    }

    /// Reports the events of restraints that yield or are broken at the beginning, once.
    pub(super) fn report_beginning(&mut self, observer: &mut dyn FnMut(&Event)) {
        if !std::mem::take(&mut self.run.begins) {
            return;
        }
        let (time, regime) = (self.time(), self.regime());
        for event in restraints::events_at_beginning(self.block(), &self.restraints()) {
            observer(&Event { time, kind: EventKind::Restraint(event), before: regime, after: regime });
        }
    }

    /// Applies a pending event as [`Simulation::apply_pending_event`] does, and returns the rates right after it.
    ///
    /// # Errors
    /// The event leaves no regime that lasts.
    #[cfg(feature = "lanes")]
    pub fn apply_pending_event_with_rates(
        &mut self,
        inputs: &Inputs,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Option<Rates>, SimulationError> {
        self.apply_pending(inputs, observer, Rates::of)
    }

    /// Applies a pending event. Returns the result of `inspect` for the block right after it.
    fn apply_pending<R>(
        &mut self,
        inputs: &Inputs,
        observer: &mut dyn FnMut(&Event),
        inspect: impl FnOnce(&Evaluation) -> R,
    ) -> Result<Option<R>, SimulationError> {
        let Some(Pending { function, piece_start }) = self.run.pending.take() else { return Ok(None) };
        let Simulation { setup, run } = self;
        let excitation = setup.excitation(piece_start, inputs);
        let now = run.now(&setup.system.block, &excitation);
        run.apply(setup, function, &now, observer).map(|after| Some(inspect(&after)))
    }

    /// Advances over smooth pieces of the excitation to `until` (s). Stops at the first event later than `stop_after` (s).
    fn pieces(
        &mut self,
        until: f64,
        inputs: &Inputs,
        stop_after: Option<f64>,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Progress, SimulationError> {
        let mut budget = MAX_STEPS;
        while self.run.pose.time < until && self.run.ending.is_none() {
            let stop = self.setup.pulse.next_kink(self.run.pose.time).map_or(until, |kink| kink.min(until));
            self.smooth_piece(stop, inputs, &mut budget, stop_after, observer)?;
            if self.run.pending.is_some() {
                return Ok(Progress::Reached);
            }
        }
        match self.run.ending {
            Some((ending, time)) if !self.is_frozen() => Ok(Progress::Ended(ending, time)),
            _ => {
                self.run.pose.time = until;
                Ok(Progress::Reached)
            }
        }
    }

    /// Steps over a smooth piece of the excitation to `stop` (s). The end of the run, or an event that stops the motion, comes first.
    fn smooth_piece(
        &mut self,
        stop: f64,
        inputs: &Inputs,
        budget: &mut u64,
        stop_after: Option<f64>,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        let Simulation { setup, run } = self;
        let since = run.pose.time;
        let excitation = setup.excitation(since, inputs);
        let mut input = StepsInput::of_piece(setup, &excitation, stop);
        run.counts.evaluations += 1;
        while run.pose.time < stop && run.ending.is_none() {
            // No `?`: it would copy the block at an event even if none occurs.
            match run.steps(&input, budget) {
                Ok(StepsOutcome::Lasts) => {}
                Ok(StepsOutcome::Event(function, now)) => {
                    if stop_after.is_some_and(|after| run.stops(setup, after, function, &now)) {
                        run.pending = Some(Pending { function, piece_start: since });
                        return Ok(());
                    }
                    run.apply(setup, function, &now, observer)?;
                }
                Err(error) => return Err(error),
            }
            input.begins_piece = false;
        }
        Ok(())
    }
}

impl RunState {
    /// Whether the motion stops at `now`, before an event. That event is later than `after` (s), and does not end the run.
    fn stops(&self, setup: &Setup, after: f64, function: EventFunction, now: &Evaluation) -> bool {
        if now.time <= after {
            return false;
        }
        let Transition { pose, event, .. } = setup.system.transition(&self.pose, now, function);
        let separates = pose.contacts.regime() == Regime::Separated && !setup.system.flies;
        let ends = match event {
            None => return false,
            Some(EventKind::Overturning) => setup.settings.on_overturning == OnOverturning::Terminate,
            Some(_) => separates && setup.settings.on_separation == OnSeparation::Terminate,
        };
        !ends
    }

    /// Applies the event at `now` of a function that fell through zero. Returns the block right after it.
    pub(super) fn apply<'a>(
        &mut self,
        setup: &'a Setup,
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
        let Transition { pose, event, counts, path } = setup.system.transition(&self.pose, now, function);
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
        let after = self.now(&setup.system.block, now.excitation);
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
        self.end_if_separated(setup);
        observer(&Event { time, kind, before: now.regime, after: after.regime });
        Ok(after)
    }

    fn end_if_separated(&mut self, setup: &Setup) {
        if self.pose.contacts.regime() == Regime::Separated && !setup.system.flies {
            let Pose { time, state, .. } = self.pose;
            let side = if state[0] < 0.0 { Corner::Left } else { Corner::Right };
            self.ending = Some((Ending::at_separation(setup.system.block.alpha_of(side), state[0], state[1]), time));
        }
    }
}
