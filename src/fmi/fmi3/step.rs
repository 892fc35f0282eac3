//! `fmi3DoStep`: a communication step, left early at events if the importer wants that, with looks of the importer inside.

use std::ops::ControlFlow;

use crate::fmi::fmi3::boundary::Updater;
use crate::fmi::fmi3::instance::{Answer, Instance};
use crate::fmi::fmi3::types::Status;
use crate::fmi::log::Category;
use crate::unit::fault::Fault;
use crate::unit::life_cycle::Phase;
use crate::unit::substeps::Reached;

/// By how much the last interval between two looks may be longer than the others, as a part of them: no part is as short as a
/// rounding error of the clock.
const ROUNDING: f64 = 1e-6;

/// Most intervals between looks in one step: in a longer step the intervals are longer, too.
const MOST_LOOKS: f64 = 1e6;

/// The time of the next look (s): an `interval` (s) after `time`, or as soon as the clock resolves, or `until` if that is near.
fn next_look(time: f64, interval: f64, until: f64) -> f64 {
    let next = (time + interval).max(time.next_up());
    if next + ROUNDING * interval < until { next } else { until }
}

/// A step under way, and in the end what it came to.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Where it begins (s).
    time: f64,
    /// How long it was to be (s).
    size: f64,
    /// Where it was to end (s); nothing before it has begun.
    end: Option<f64>,
    /// Until when it is done (s): the end, or where the importer wants to leave it.
    until: f64,
    /// Whether an event waits to be handled.
    pub event: bool,
    /// Whether the run has ended.
    pub terminates: bool,
    /// Whether it was left before its end.
    pub early: bool,
    /// The time that was reached (s).
    pub reached: f64,
}

/// A look of the importer into a step.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Whose look it is.
    pub updater: Updater,
    /// At which time (s).
    pub time: f64,
    /// Whether inputs of that time are asked for; otherwise it has been reached, and outputs can be read.
    pub asks: bool,
    /// Whether the step may be left.
    pub can_return_early: bool,
}

/// What the importer answered.
#[derive(Clone, Copy, Debug)]
pub struct Given {
    /// The time at which it wants to leave the step (s).
    pub early_return: Option<f64>,
}

impl Step {
    /// A step that has not begun.
    pub fn new(time: f64, size: f64) -> Step {
        Step {
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

impl Instance {
    /// Goes on with a step until it is done, or the importer is to look in. Allocates no memory unless it fails.
    pub fn step_on(
        &mut self,
        step: &mut Step,
        given: Option<Given>,
        done: &impl Fn(&Step) -> Answer,
    ) -> Result<ControlFlow<Status, Look>, Fault> {
        if let Some(look) = self.take_substeps(step, given)? {
            return Ok(ControlFlow::Continue(look));
        }
        step.reached = self.unit.time();
        let (time, reached) = (step.time, step.reached);
        self.log.tell(Status::Ok, Category::Steps, format_args!("step from t = {time:?} s to t = {reached:?} s"));
        done(step).map(ControlFlow::Break)
    }

    /// Goes on until the importer is to look in; nothing if the step is done.
    fn take_substeps(&mut self, step: &mut Step, given: Option<Given>) -> Result<Option<Look>, Fault> {
        let Instance { log, unit, version, .. } = self;
        let mut tell = |event: &_| log.tell(Status::Ok, Category::Events, format_args!("{event}"));
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
        match (unit.phase(), given) {
            (Phase::SettingAhead, _) => unit.end_asking(),
            (Phase::LookingIn, given) => {
                unit.look_in(false);
                let early_return = given.and_then(|given| given.early_return);
                step.until = step.until.min(early_return.unwrap_or(end).max(unit.time()));
            }
            _ => {}
        }
        let after = version.early_return.then_some(step.time);
        while unit.time() < step.until {
            if let Some(updater) = version.updater.filter(|_| unit.needs_substep()) {
                let time = match version.sets_inputs || !unit.rests() {
                    true => next_look(unit.time(), unit.interval().max(step.size / MOST_LOOKS), step.until),
                    false => step.until,
                };
                unit.ask(time);
                if version.sets_inputs {
                    return Ok(Some(Look { updater, time, asks: true, can_return_early: version.early_return }));
                }
                unit.end_asking();
            }
            match unit.do_substep(step.until, after, &mut tell)? {
                Reached::End => {
                    if let Some(updater) = version.updater {
                        unit.look_in(true);
                        let (time, can_return_early) = (unit.time(), version.early_return);
                        return Ok(Some(Look { updater, time, asks: false, can_return_early }));
                    }
                }
                Reached::Event => {
                    step.event = version.event_mode;
                    if !version.event_mode {
                        unit.settle(&mut tell)?;
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
