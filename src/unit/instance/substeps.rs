//! Communication steps in parts: they stop at events, and at intermediate updates, where the importer sets inputs and reads outputs.
//!
//! Inputs are linear in time over each part. A part continues across an early return: a step that is left at an event and then
//! completed gives the same bits as an uninterrupted step.

use crate::excitation::Inputs;
use crate::run::Progress;
use crate::system::events::Event;
use crate::unit::fault::Fault;
use crate::unit::fmu::Reached;
use crate::unit::instance::Unit;
use crate::unit::life_cycle::Phase;
use crate::unit::variables::Input;

impl Unit {
    /// Begins a communication step as [`Unit::advance`] does, and returns its end (s).
    ///
    /// An event that the last step left unapplied is applied first.
    ///
    /// # Errors
    /// Those of [`Unit::advance`] for its arguments, and of [`Unit::apply_pending_event`].
    pub fn begin_substeps(&mut self, time: f64, step: f64, observer: &mut dyn FnMut(&Event)) -> Result<f64, Fault> {
        let end = self.begin_step(time, step)?;
        self.apply_pending_event(observer)?;
        Ok(end)
    }

    /// Leaves the present step, which would have ended at `end` (s).
    pub fn leave_step(&mut self, end: f64) {
        self.life.leave_step(self.time(), end);
    }

    /// Whether [`Unit::do_substep`] needs the inputs of a new part.
    pub fn needs_substep(&self) -> bool {
        self.at_end.is_none()
    }

    /// Whether the block is at rest and stays so unless the inputs change.
    pub fn rests(&self) -> bool {
        let Some(simulation) = &self.simulation else { return false };
        let (inputs, end) = self.with_records(&self.present_inputs(), self.time());
        end == f64::INFINITY && simulation.rests(&inputs)
    }

    /// Begins a part that ends at `end` (s). The inputs there are the present ones until they are set.
    ///
    /// They can be set by [`Unit::set_ahead`] until [`Unit::end_setting_ahead`].
    pub fn begin_setting_ahead(&mut self, end: f64) {
        self.at_end = Some(Inputs { time: end, ..self.present_inputs() });
        self.life.phase = Phase::SettingAhead;
    }

    /// Sets an input at the end of the new part.
    pub fn set_ahead(&mut self, input: Input, value: f64) {
        if let Some(at_end) = &mut self.at_end {
            at_end[input].value = value;
        }
    }

    /// Makes the inputs linear from their present values to those at the end.
    pub fn end_setting_ahead(&mut self) {
        self.life.phase = Phase::StepComplete;
        if let Some(at_end) = &self.at_end {
            self.inputs = self.present_inputs().line_to(at_end);
        }
    }

    /// Advances to the end of the part, to `until` (s), or to an event. That event is the first one later than `after` (s), if given.
    ///
    /// Allocates no memory unless it fails.
    ///
    /// # Errors
    /// An error of the solver, after which the unit is in the error state.
    pub fn do_substep(
        &mut self,
        until: f64,
        after: Option<f64>,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Reached, Fault> {
        let end = self.at_end.map_or(until, |at_end| at_end.time.min(until));
        let (progress, stopped) = self.advance_by_intervals(end, |simulation, until, acting| match after {
            Some(after) => {
                let progress = simulation.advance_to_event(until, after, acting, observer)?;
                Ok((progress.unwrap_or(Progress::Reached), progress.is_none()))
            }
            None => Ok((simulation.advance(until, acting, observer)?, false)),
        })?;
        let time = self.time();
        if let Some(at_end) = self.at_end.take_if(|at_end| time >= at_end.time) {
            self.inputs = at_end;
        }
        Ok(match progress {
            Progress::Ended(ending, time) => Reached::Ended(ending, time),
            Progress::Reached if stopped => Reached::Event,
            Progress::Reached => Reached::End,
        })
    }
}
