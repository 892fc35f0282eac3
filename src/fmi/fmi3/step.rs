//! `fmi3DoStep`: a communication step with intermediate updates, left early at events if the importer wishes.

use std::ops::ControlFlow;

use crate::fmi::fmi3::callbacks::{IntermediateUpdate, UpdateReply};
use crate::fmi::fmi3::instance::{Answer, Instance};
use crate::fmi::fmi3::types::Status;
use crate::fmi::log::Category;
use crate::unit::fault::Fault;
use crate::unit::fmu::{Fmu, Reached};
use crate::unit::life_cycle::Phase;

/// Fraction by which the last interval between two updates may be longer than the others.
///
/// It prevents a last part as short as a round-off error of the clock.
const ROUNDING: f64 = 1e-6;

/// Maximum number of intervals between updates in one step. In a longer step the intervals are longer.
const MAX_UPDATES: f64 = 1e6;

/// Returns the time of the next update (s). It is an `interval` (s) after `time`, at least one ulp later, or `until` if that is near.
fn next_update(time: f64, interval: f64, until: f64) -> f64 {
    let next = (time + interval).max(time.next_up());
    if next + ROUNDING * interval < until { next } else { until }
}

/// A step in progress, and its result.
#[derive(Clone, Copy, Debug)]
pub struct StepOutcome {
    /// Its beginning (s).
    time: f64,
    /// Its requested length (s).
    size: f64,
    /// Its planned end (s); `None` before it has begun.
    end: Option<f64>,
    /// Its actual end (s): the planned one, or where the importer leaves it.
    until: f64,
    /// Whether an event is to be handled.
    pub event: bool,
    /// Whether the run has ended.
    pub terminates: bool,
    /// Whether the step was left before its planned end.
    pub early: bool,
    /// The time that was reached (s).
    pub reached: f64,
}

impl StepOutcome {
    /// Makes a step that has not begun.
    pub fn new(time: f64, size: f64) -> StepOutcome {
        StepOutcome {
            time,
            size,
            end: None,
            until: f64::NAN,
            event: false,
            terminates: false,
            early: false,
            reached: f64::NAN,
        }
    }
}

/// Ends the importer's update in a step to `end` (s), and takes its reply.
fn end_update(unit: &mut impl Fmu, step: &mut StepOutcome, end: f64, reply: Option<UpdateReply>) {
    match (unit.life().phase, reply) {
        (Phase::SettingAhead, _) => unit.end_setting_ahead(),
        (Phase::ReadingOutputs, reply) => {
            unit.set_phase(Phase::StepComplete);
            let early_return = reply.and_then(|reply| reply.early_return);
            step.until = step.until.min(early_return.unwrap_or(end).max(unit.time()));
        }
        (
            Phase::Instantiated
            | Phase::ConfigurationMode
            | Phase::InitializationMode
            | Phase::StepComplete
            | Phase::StepFailed
            | Phase::EventMode
            | Phase::ContinuousTimeMode
            | Phase::Terminated
            | Phase::Error
            | Phase::Fatal,
            _,
        ) => {}
    }
}

impl<U: Fmu> Instance<U> {
    /// Advances a step to its end or to the importer's next update. Allocates no memory unless it fails.
    ///
    /// # Errors
    /// Those of [`Fmu::begin_substeps`] and [`Fmu::do_substep`].
    pub fn step_on(
        &mut self,
        step: &mut StepOutcome,
        reply: Option<UpdateReply>,
        done: &impl Fn(&StepOutcome) -> Answer,
    ) -> Result<ControlFlow<Status, IntermediateUpdate>, Fault> {
        if let Some(update) = self.take_substeps(step, reply)? {
            return Ok(ControlFlow::Continue(update));
        }
        step.reached = self.unit.time();
        let (time, reached) = (step.time, step.reached);
        self.log.tell(Status::Ok, Category::Steps, format_args!("step from t = {time:?} s to t = {reached:?} s"));
        done(step).map(ControlFlow::Break)
    }

    /// Advances a step to the importer's next update. Returns `None` if the step is done.
    fn take_substeps(
        &mut self,
        step: &mut StepOutcome,
        reply: Option<UpdateReply>,
    ) -> Result<Option<IntermediateUpdate>, Fault> {
        let Instance { log, unit, version, .. } = self;
        let mut tell = |event: &U::Event| log.tell(Status::Ok, Category::Events, format_args!("{event}"));
        let end = match step.end {
            Some(end) => end,
            None => {
                if unit.has_ended() {
                    step.terminates = true;
                    step.early = version.early_return;
                    return Ok(None);
                }
                step.until = unit.begin_substeps(step.time, step.size, &mut tell)?;
                *step.end.insert(step.until)
            }
        };
        end_update(unit, step, end, reply);
        let after = version.early_return.then_some(step.time);
        while unit.time() < step.until {
            if let Some(updater) = version.updater.filter(|_| unit.needs_substep()) {
                let time = if version.sets_inputs || !unit.rests() {
                    next_update(unit.time(), unit.interval().max(step.size / MAX_UPDATES), step.until)
                } else {
                    step.until
                };
                unit.begin_setting_ahead(time);
                if version.sets_inputs {
                    return Ok(Some(IntermediateUpdate {
                        updater,
                        time,
                        requests_inputs: true,
                        can_return_early: version.early_return,
                    }));
                }
                unit.end_setting_ahead();
            }
            match unit.do_substep(step.until, after, &mut tell)? {
                Reached::End => {
                    if let Some(updater) = version.updater {
                        unit.set_phase(Phase::ReadingOutputs);
                        let (time, can_return_early) = (unit.time(), version.early_return);
                        let requests_inputs = false;
                        return Ok(Some(IntermediateUpdate { updater, time, requests_inputs, can_return_early }));
                    }
                }
                Reached::Event => {
                    step.event = version.event_mode;
                    if !version.event_mode {
                        unit.apply_pending_event(&mut tell)?;
                    }
                    break;
                }
                Reached::Ended(ending, at) => {
                    step.terminates = true;
                    log.tell(
                        Status::Ok,
                        Category::Warning,
                        format_args!("{ending} at t = {at:?} s ends the run; the outputs are those of that time"),
                    );
                    break;
                }
            }
        }
        step.early = version.early_return && unit.time() < end;
        if step.early && !step.terminates {
            unit.leave_step(end);
        }
        Ok(None)
    }
}
