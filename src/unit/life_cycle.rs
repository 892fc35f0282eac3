//! The states of an instance and the rules of its communication steps, for all units and all versions of FMI.
//!
//! The tables of the calls that are legal in each state are in `calls.rs` of each version.

use serde::{Deserialize, Serialize};

use crate::run::Settings;
use crate::unit::fault::Fault;

/// Interface type of an instance: who steps the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Interface {
    /// The FMU's own solver.
    CoSimulation,
    /// The importer's solver.
    ModelExchange,
}

/// State of an instance.
///
/// Steps are synchronous: no step is in progress when a function is called, except in the intermediate updates of FMI 3.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// After instantiation or reset.
    Instantiated,
    /// Sizes of arrays can be set.
    ConfigurationMode,
    /// Start values can be set; at its end they define the block.
    InitializationMode,
    /// Ready for a step.
    StepComplete,
    /// Inside a step: the importer sets inputs for a later time.
    SettingAhead,
    /// Inside a step: the importer reads the outputs at the time reached so far.
    ReadingOutputs,
    /// The last step was discarded because the run ended within it.
    StepFailed,
    /// At the start or at an event, before its effects are applied.
    EventMode,
    /// Model Exchange: the importer's solver steps the block.
    ContinuousTimeMode,
    /// The importer ended the run.
    Terminated,
    /// The integration failed.
    Error,
    /// A panic was caught.
    Fatal,
}

impl Phase {
    /// All states.
    pub const ALL: [Phase; 12] = [
        Phase::Instantiated,
        Phase::ConfigurationMode,
        Phase::InitializationMode,
        Phase::StepComplete,
        Phase::SettingAhead,
        Phase::ReadingOutputs,
        Phase::StepFailed,
        Phase::EventMode,
        Phase::ContinuousTimeMode,
        Phase::Terminated,
        Phase::Error,
        Phase::Fatal,
    ];

    /// Returns the bit of this state in a set of states.
    pub const fn bit(self) -> u16 {
        1 << self as u16
    }

    /// Whether initialization has ended.
    pub fn is_initialized(self) -> bool {
        match self {
            Phase::Instantiated | Phase::ConfigurationMode | Phase::InitializationMode => false,
            Phase::EventMode
            | Phase::StepComplete
            | Phase::SettingAhead
            | Phase::ReadingOutputs
            | Phase::StepFailed
            | Phase::ContinuousTimeMode
            | Phase::Terminated
            | Phase::Error
            | Phase::Fatal => true,
        }
    }
}

/// Settings of the run, known before it begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Experiment {
    /// Relative tolerance of the solver, if given.
    pub tolerance: Option<f64>,
    /// Start of the run (s).
    pub start: f64,
    /// Its end (s), if given.
    pub stop: Option<f64>,
}

impl Experiment {
    /// Refuses times that are not finite or not in order, and a tolerance that is not a finite number above 0.
    fn check(&self) -> Result<(), Fault> {
        let Experiment { tolerance, start, stop } = *self;
        if !start.is_finite() {
            return Err(Fault::new(format!("startTime = {start:?}; expected a finite time")));
        }
        if let Some(stop) = stop
            && !(stop.is_finite() && stop > start)
        {
            return Err(Fault::new(format!("stopTime = {stop:?}; expected a finite time after startTime = {start:?}")));
        }
        if let Some(tolerance) = tolerance
            && !(tolerance.is_finite() && tolerance > 0.0)
        {
            return Err(Fault::new(format!("tolerance = {tolerance:?}; expected a finite number > 0")));
        }
        Ok(())
    }
}

/// Largest error of a master's clock, relative to the greater of step and time.
const CLOCK_ROUNDING: f64 = 1e-9;

/// Largest fraction of a communication step that a master's clock may skip.
const MAX_SKIPPED: f64 = 1e-3;

/// Returns the largest accepted error (s) of a master's clock. It is near `time` (s), for a communication step of `step` (s).
fn clock_slack(step: f64, time: f64) -> f64 {
    (CLOCK_ROUNDING * step.max(time.abs())).min(MAX_SKIPPED * step)
}

/// An instance without its block: interface type, state, experiment, and the step that was left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LifeCycle {
    /// The interface type.
    pub interface: Interface,
    /// The state.
    pub phase: Phase,
    /// The experiment.
    pub experiment: Experiment,
    /// Planned end of a communication step that was left early (s).
    left: Option<f64>,
}

impl LifeCycle {
    /// Begins the life of an instance.
    pub fn new(interface: Interface) -> LifeCycle {
        LifeCycle { interface, phase: Phase::Instantiated, experiment: Experiment::default(), left: None }
    }

    /// Whether this can be the life cycle of a saved state.
    pub fn is_valid(&self) -> bool {
        let is_inside_a_step = matches!(self.phase, Phase::SettingAhead | Phase::ReadingOutputs);
        let stepped = matches!(self.phase, Phase::StepComplete | Phase::StepFailed);
        self.phase != Phase::Fatal
            && match self.interface {
                Interface::CoSimulation => self.phase != Phase::ContinuousTimeMode,
                Interface::ModelExchange => !stepped,
            }
            && !is_inside_a_step
            && self.experiment.check().is_ok()
            && self.left.is_none_or(f64::is_finite)
    }

    /// Sets tolerance, start and stop of the run. Returns the tolerance used if it differs from the requested one.
    ///
    /// # Errors
    /// Times that are not finite or not in order, or a tolerance that is not a finite number above 0.
    pub fn plan(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<Option<f64>, Fault> {
        let experiment = Experiment { tolerance, start, stop };
        experiment.check()?;
        self.experiment = experiment;
        let [least, most] = Settings::TOLERANCES;
        let clamped = |tolerance: f64| tolerance.clamp(least, most);
        Ok(tolerance.filter(|&tolerance| clamped(tolerance) != tolerance).map(clamped))
    }

    /// Refuses an impossible communication step of a block at `present` (s), and returns the step's end (s).
    ///
    /// # Errors
    /// A step that does not begin at the present time, has no finite length above 0 or goes beyond the stop.
    #[inline]
    pub fn begin_step(&mut self, present: f64, time: f64, step: f64) -> Result<f64, Fault> {
        if !(step.is_finite() && step > 0.0) {
            return Err(Fault::new(format!("communicationStepSize = {step:?} at t = {present:?} s; expected > 0 s")));
        }
        let slack = clock_slack(step, present);
        // A NaN would pass the comparison with the present time.
        if !time.is_finite() || (time - present).abs() > slack {
            return Err(Fault::new(format!(
                "currentCommunicationPoint = {time:?} s; expected t = {present:?} s, the time of the FMU, to {slack:e} s"
            )));
        }
        let until = time + step;
        if !until.is_finite() {
            return Err(Fault::new(format!(
                "communicationStepSize = {step:?} at t = {present:?} s; expected a step to a finite time"
            )));
        }
        if let Some(stop) = self.experiment.stop
            && until > stop + clock_slack(step, stop)
        {
            return Err(Fault::new(format!(
                "found a step to t = {until:?} s; expected none past stopTime = {stop:?} s"
            )));
        }
        if until == time {
            return Err(Fault::new(format!(
                "communicationStepSize = {step:e} s is lost in t = {time:?} s; expected a longer step"
            )));
        }
        // The rest of a step left early ends exactly at that step's planned end, if `time + step` is near it.
        let rounding = slack.max(f64::EPSILON * until.abs());
        Ok(self.left.take().filter(|end| (end - until).abs() <= rounding && *end > time).unwrap_or(until))
    }

    /// Leaves at `time` (s) the present step, which would have ended at `end` (s).
    pub fn leave_step(&mut self, time: f64, end: f64) {
        self.left = (time < end).then_some(end);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A saved state has no settings of a run that an importer could not set.
    #[test]
    fn impossible_settings_of_a_run_are_invalid() {
        let is_valid = |tolerance: Option<f64>, start: f64, stop: Option<f64>| {
            let life = LifeCycle::new(Interface::CoSimulation);
            LifeCycle { experiment: Experiment { tolerance, start, stop }, ..life }.is_valid()
        };
        assert!(is_valid(None, 0.0, None) && is_valid(Some(1e-8), 1.0, Some(2.0)));
        for tolerance in [f64::NAN, -1.0, 0.0, f64::INFINITY] {
            assert!(!is_valid(Some(tolerance), 0.0, None), "{tolerance}");
        }
        for stop in [f64::NAN, f64::INFINITY, 1.0] {
            assert!(!is_valid(None, 1.0, Some(stop)), "{stop}");
        }
    }
}
