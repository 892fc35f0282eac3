//! Communication steps that stop at events, and those in whose course the importer sets inputs and looks in: the step is done
//! in parts, over each of which the inputs are linear in time.
//!
//! A part goes on across an early return, so that whoever leaves a step at an event and then does the rest of it comes to the same bits as
//! whoever does it at once.

use serde::{Deserialize, Serialize};

use crate::excitation::Inputs;
use crate::simulation::{Ending, Progress};
use crate::system::events::Event;
use crate::unit::fault::Fault;
use crate::unit::instance::Unit;
use crate::unit::life_cycle::Phase;
use crate::unit::values::{PerInput, inputs, ramp};
use crate::unit::variables::Input;

/// A part of a communication step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Substep {
    /// Where it ends (s).
    end: f64,
    /// The inputs over it.
    over: Inputs,
    /// The inputs at its end.
    at_end: PerInput,
}

impl Substep {
    /// Whether this can be a part.
    pub fn is_valid(&self) -> bool {
        let ramps = Input::ALL.into_iter().map(|input| ramp(&self.over, input));
        let ramps = ramps.flat_map(|ramp| [ramp.value, ramp.rate]);
        [self.end, self.over.time].into_iter().chain(ramps).chain(self.at_end).all(f64::is_finite)
    }
}

/// How far a part came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reached {
    /// Its end, or that of the step.
    End,
    /// An event, of which nothing has come yet.
    Event,
    /// The end of the run, at this time (s).
    Ended(Ending, f64),
}

impl Unit {
    /// Begins a communication step as [`Unit::advance`] does; gives its end (s). An event that is left from the last one is
    /// applied first.
    pub fn begin_substeps(&mut self, time: f64, step: f64, observer: &mut dyn FnMut(&Event)) -> Result<f64, Fault> {
        let end = self.begin_step(time, step)?;
        self.settle(observer)?;
        Ok(end)
    }

    /// The step in which the unit is would have ended at `end` (s) and is left now.
    pub fn leave_step(&mut self, end: f64) {
        self.left = (self.time() < end).then_some(end);
    }

    /// Whether inputs for a new part have to be known before [`Unit::do_substep`] can go on.
    pub fn needs_substep(&self) -> bool {
        self.substep.is_none()
    }

    /// Whether nothing moves, and nothing will unless the inputs change.
    pub fn rests(&self) -> bool {
        let Some(simulation) = &self.simulation else { return false };
        let (inputs, end) = self.acting(&self.values.inputs(self.time(), &PerInput::default()));
        end == f64::INFINITY && simulation.rests(&inputs)
    }

    /// Begins a part that ends at `end` (s), with the inputs at its end as they are now. They can be set until
    /// [`Unit::end_asking`].
    pub fn ask(&mut self, end: f64) {
        let at_end = self.values.present_inputs();
        self.substep = Some(Substep { end, over: Inputs::default(), at_end });
        self.phase = Phase::SettingAhead;
    }

    /// Sets an input at the end of the part that begins.
    pub fn set_ahead(&mut self, input: Input, value: f64) {
        if let Some(substep) = &mut self.substep {
            substep.at_end[input as usize] = value;
        }
    }

    /// The inputs at the end of the part are set.
    pub fn end_asking(&mut self) {
        self.phase = Phase::StepComplete;
        let time = self.time();
        if let Some(substep) = &mut self.substep {
            let here = self.values.present_inputs();
            let rates = std::array::from_fn(|i| (substep.at_end[i] - here[i]) / (substep.end - time));
            substep.over = inputs(time, here, &rates);
        }
    }

    /// Goes on to the end of the part, or to `until` (s), or to the first event later than `after` (s) if there is such a time. Allocates no
    /// memory unless it fails.
    pub fn do_substep(
        &mut self,
        until: f64,
        after: Option<f64>,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Reached, Fault> {
        let held = |unit: &Unit| unit.values.inputs(unit.time(), &PerInput::default());
        let (end, over) =
            self.substep.as_ref().map_or_else(|| (until, held(self)), |substep| (substep.end, substep.over));
        let (progress, stopped) = self.go_on(end.min(until), &over, |simulation, until, inputs| match after {
            Some(after) => {
                let progress = simulation.advance_to_event(until, after, inputs, observer)?;
                Ok((progress.unwrap_or(Progress::Reached), progress.is_none()))
            }
            None => Ok((simulation.advance(until, inputs, observer)?, false)),
        })?;
        let time = self.time();
        if let Some(substep) = self.substep.take() {
            let inside = time < substep.end;
            let here = substep.over.moved_to(time);
            for input in Input::ALL {
                let value = if inside { ramp(&here, input).value } else { substep.at_end[input as usize] };
                self.values[input.variable()] = value;
            }
            self.substep = inside.then_some(substep);
        }
        Ok(match progress {
            Progress::Ended(ending, time) => Reached::Ended(ending, time),
            Progress::Reached if stopped => Reached::Event,
            Progress::Reached => Reached::End,
        })
    }

    /// The importer looks in, or is done with it.
    pub fn look_in(&mut self, looks: bool) {
        self.phase = if looks { Phase::LookingIn } else { Phase::StepComplete };
    }

    /// An event has been handled.
    pub fn enter_step_mode(&mut self) {
        self.phase = Phase::StepComplete;
    }

    /// Sizes of arrays are set, or have been.
    pub fn configure(&mut self, configures: bool) {
        self.phase = if configures { Phase::ConfigurationMode } else { Phase::Instantiated };
    }
}
