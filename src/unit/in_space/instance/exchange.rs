//! Model Exchange: the importer's solver steps the block.

use std::ops::Range;

use crate::space::exchange::nominals;
use crate::space::motion::dimension;
use crate::space::piece::OF_FEET;
use crate::space::piece::indicator_count;
use crate::space::{SpaceBody, SpaceEvent, SpaceInputs};
use crate::unit::fault::Fault;
use crate::unit::fmu::{AfterEvent, Exchanged, counted};
use crate::unit::in_space::instance::{NAMED_FEET, SpaceUnit, no_block, with_ground};
use crate::unit::in_space::variables::Output;
use crate::unit::life_cycle::{Interface, Phase};

impl SpaceUnit {
    /// Refuses a block with another number of feet than that for which the states are declared.
    pub(super) fn check_feet(&self, body: &SpaceBody) -> Result<(), Fault> {
        let (found, expected) = (body.count(), self.values.fmi3.foot_count());
        if self.life.interface == Interface::CoSimulation || found == expected {
            return Ok(());
        }
        Err(Fault::new(format!(
            "the block has {found} feet; expected {expected} in Model Exchange, whose states they have. FMI 3.0 sets this number by \
             foot_count; FMI 2.0 has other numbers in Co-Simulation"
        )))
    }

    /// Returns the number of continuous states.
    pub(super) fn state_count(&self) -> usize {
        dimension(self.values.fmi3.foot_count())
    }

    /// Returns the number of event indicators.
    pub(super) fn indicator_count(&self) -> usize {
        indicator_count(self.values.fmi3.foot_count())
    }

    /// Returns the places of an array of indicators of FMI 3.0, by its number: contacts, friction, overturning.
    pub(super) fn indicator_places(&self, array: usize) -> Range<usize> {
        let feet = self.values.fmi3.foot_count();
        feet * array..(feet * (array + 1)).min(self.indicator_count())
    }

    /// Enters Event Mode. The present inputs acted up to now.
    pub(super) fn enter_event_mode(&mut self) {
        self.complete_step();
        self.life.phase = Phase::EventMode;
    }

    /// Applies the events of the present time: kinks of the excitation and changes of feet.
    pub(super) fn pass_events(&mut self, observer: &mut dyn FnMut(&SpaceEvent)) -> Result<AfterEvent, Fault> {
        self.preview()?;
        let SpaceUnit { life, inputs, last_inputs, ground, run, observed, .. } = self;
        let run = run.as_mut().ok_or_else(no_block)?;
        observed.is_stale = true;
        let (time, before) = (run.time(), run.clone());
        let present = time + run.clock_rounding();
        let next_time = loop {
            let (acting, end) = with_ground(&inputs.moved_to(time), ground.as_deref(), run.time());
            if let Err(error) = run.pass_events(&acting, observer) {
                *run = before;
                life.phase = Phase::Error;
                return Err(Fault::new(error.to_string()));
            }
            match [run.next_kink(), Some(end)].into_iter().flatten().reduce(f64::min) {
                // No solver steps to a time so near.
                Some(next) if next <= present && run.state().ending.is_none() => run.set_outside_time(next),
                next => break next,
            }
        };
        run.set_time(time);
        *last_inputs = *inputs;
        Ok(AfterEvent {
            ended: run.state().ending.is_some() && !run.is_frozen(),
            states_changed: true,
            next_time: next_time.filter(|time| time.is_finite()),
        })
    }

    /// Sets the time (s).
    pub(super) fn set_time(&mut self, time: f64) -> Result<(), Fault> {
        if !time.is_finite() {
            return Err(Fault::new(format!("time = {time}; expected a finite time")));
        }
        self.run.as_mut().ok_or_else(no_block)?.set_outside_time(time);
        self.observed.is_stale = true;
        Ok(())
    }

    /// Sets the continuous states.
    pub(super) fn set_states(&mut self, states: &[f64]) -> Result<(), Fault> {
        counted(states.len(), self.state_count(), "states")?;
        if let Some(i) = states.iter().position(|state| !state.is_finite()) {
            return Err(Fault::new(format!("state {i} = {}; expected a finite number", states[i])));
        }
        self.run.as_mut().ok_or_else(no_block)?.set_continuous_states(states);
        self.observed.is_stale = true;
        Ok(())
    }

    /// Passes numbers of Model Exchange to `give`.
    pub(super) fn exchanged(&mut self, numbers: Exchanged, give: &mut dyn FnMut(&[f64])) -> Result<(), Fault> {
        if numbers == Exchanged::Nominals && self.run.is_none() {
            let body = self.values.body().map_err(Fault)?;
            self.check_feet(&body)?;
            give(&nominals(&body));
            return Ok(());
        }
        self.preview()?;
        let acting = self.effective_inputs();
        let run = self.run.as_mut().ok_or_else(no_block)?;
        match numbers {
            Exchanged::States => give(run.continuous_states()),
            Exchanged::Derivatives => give(run.derivatives(&acting)),
            Exchanged::Nominals => give(&nominals(run.body())),
            Exchanged::Indicators => give(run.indicators(&acting)),
        }
        Ok(())
    }

    /// Accepts a step of the importer's solver. Inputs count as linear in time over it.
    pub(super) fn complete_step(&mut self) {
        let SpaceUnit { life, inputs, last_inputs, ground, run, observed, .. } = self;
        let Some(run) = run.as_mut().filter(|_| life.interface == Interface::ModelExchange) else { return };
        let (last, time) = (run.last_completed(), run.time());
        if last < time {
            let over = SpaceInputs { time: last, ..*last_inputs }.line_to(&SpaceInputs { time, ..*inputs });
            run.complete_step(&with_ground(&over, ground.as_deref(), run.piece_time()).0);
            *last_inputs = *inputs;
            observed.is_stale = true;
        }
    }
}

/// The continuous states of a block with [`NAMED_FEET`], in their order.
const STATES: [Output; dimension(NAMED_FEET)] = [
    Output::U,
    Output::W,
    Output::V,
    Output::QW,
    Output::QX,
    Output::QY,
    Output::QZ,
    Output::UDot,
    Output::WDot,
    Output::VDot,
    Output::OmegaX,
    Output::OmegaY,
    Output::OmegaZ,
    Output::EnergyInput,
    Output::EnergyDashpots,
    Output::EnergySlip,
    Output::StretchXSW,
    Output::StretchXNW,
    Output::StretchXSE,
    Output::StretchXNE,
    Output::StretchYSW,
    Output::StretchYNW,
    Output::StretchYSE,
    Output::StretchYNE,
    Output::SlipSW,
    Output::SlipNW,
    Output::SlipSE,
    Output::SlipNE,
];

impl SpaceUnit {
    /// Returns the place of an output among the continuous states, if it is one. Those of feet are in arrays, except of four feet.
    pub(super) fn state_place(&self, output: Output) -> Option<usize> {
        let place = STATES.into_iter().position(|state| state == output)?;
        (place < OF_FEET || self.values.fmi3.foot_count() == NAMED_FEET).then_some(place)
    }

    /// Whether an output can be set now: a continuous state in Continuous-Time Mode.
    pub(super) fn is_settable_state(&self, output: Output) -> bool {
        self.life.phase == Phase::ContinuousTimeMode && self.state_place(output).is_some()
    }

    /// Sets a continuous state as an output.
    pub(super) fn set_state(&mut self, output: Output, value: f64) {
        if let (Some(place), Some(run)) = (self.state_place(output), &mut self.run) {
            let mut states = run.continuous_states().to_vec();
            states[place] = value;
            run.set_continuous_states(&states);
        }
    }
}
