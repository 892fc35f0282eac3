//! An instance behind FMI 2.0: a [`Unit`], its answers as statuses, and its messages. No pointer, no C.

use std::ffi::CString;
use std::mem::MaybeUninit;

use crate::fmi2::calls::Call;
use crate::fmi2::log::{Category, Log};
use crate::fmi2::types::{Status, StatusKind};
use crate::model::fault::Fault;
use crate::model::life_cycle::Phase;
use crate::model::unit::exchange::{AfterEvent, counted};
use crate::model::unit::{Interface, Unit};
use crate::model::variables::Kind;
use crate::simulation::Progress;

/// What a call answers; a fault is answered with `fmi2Error`.
pub type Answer = Result<Status, Fault>;

/// An instance: what a saved state holds, and where its messages go.
#[derive(Debug)]
pub struct Instance {
    /// Messages.
    pub log: Log,
    /// What a saved state holds.
    pub unit: Unit,
    /// Texts that the importer was given, until its next call for some.
    texts: Vec<CString>,
}

impl Instance {
    /// A new instance, all values at their starts.
    pub fn new(log: Log, interface: Interface) -> Instance {
        Instance { log, unit: Unit::new(interface), texts: Vec::new() }
    }

    /// Refuses a call that the present state does not allow.
    pub fn admit(&self, call: Call) -> Result<(), Fault> {
        call.admitted_in(self.unit.phase(), self.unit.interface()).map_err(Fault)
    }

    /// Whether a panic was caught in an earlier call.
    pub fn is_fatal(&self) -> bool {
        self.unit.phase() == Phase::Fatal
    }

    /// `fmi2SetDebugLogging`.
    pub fn set_debug_logging(&mut self, logging: bool, names: &[&str]) -> Answer {
        let categories = names
            .iter()
            .map(|name| {
                Category::ALL.into_iter().find(|c| c.name().to_bytes() == name.as_bytes()).ok_or_else(|| {
                    let known = Category::ALL.map(|c| c.name().to_string_lossy()).join(", ");
                    Fault::new(format!("log category {name:?} does not exist; there are {known}"))
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        self.log.choose(logging, (!names.is_empty()).then_some(&categories));
        Ok(Status::Ok)
    }

    /// `fmi2SetupExperiment`.
    pub fn setup_experiment(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Answer {
        match (tolerance, self.unit.plan(tolerance, start, stop)?) {
            (Some(tolerance), Some(used)) => {
                self.log.status(Status::Warning, &format!("tolerance = {tolerance:e} is taken as {used:e}"));
                Ok(Status::Warning)
            }
            _ => Ok(Status::Ok),
        }
    }

    /// `fmi2EnterInitializationMode`.
    pub fn enter_initialization_mode(&mut self) -> Answer {
        self.unit.enter_initialization_mode();
        Ok(Status::Ok)
    }

    /// `fmi2ExitInitializationMode`: the values become a block, or the call is refused and they can be corrected.
    pub fn exit_initialization_mode(&mut self) -> Answer {
        let unread = self.unit.exit_initialization_mode()?;
        if unread.is_empty() {
            return Ok(Status::Ok);
        }
        let unread: Vec<String> = unread.iter().map(|(name, needed)| format!("{name} needs {needed}")).collect();
        self.log.status(
            Status::Warning,
            &format!("set, but not read with the other parameters as they are: {}", unread.join(", ")),
        );
        Ok(Status::Warning)
    }

    /// `fmi2Terminate`.
    pub fn terminate(&mut self) -> Answer {
        self.unit.terminate();
        Ok(Status::Ok)
    }

    /// `fmi2Reset`: as after instantiation.
    pub fn reset(&mut self) -> Answer {
        self.unit = Unit::new(self.unit.interface());
        Ok(Status::Ok)
    }

    /// `fmi2DoStep`. Allocates no memory unless it fails.
    pub fn do_step(&mut self, time: f64, step: f64) -> Answer {
        let log = &self.log;
        let progress = self.unit.advance(time, step, &mut |event| {
            log.tell(Status::Ok, Category::Events, format_args!("{event}"));
        })?;
        let reached = self.unit.time();
        log.tell(Status::Ok, Category::Steps, format_args!("step from t = {time:?} s to t = {reached:?} s"));
        match progress {
            Progress::Reached => Ok(Status::Ok),
            Progress::Ended(ending, at) => {
                log.tell(
                    Status::Discard,
                    Category::Discard,
                    format_args!("{ending} at t = {at:?} s ends the run; the outputs are those of that time"),
                );
                Ok(Status::Discard)
            }
        }
    }

    /// `fmi2Get…Status` of a Real.
    pub fn real_status(&self, kind: StatusKind) -> Result<f64, Fault> {
        match kind {
            StatusKind::LastSuccessfulTime => Ok(self.unit.time()),
            StatusKind::DoStepStatus | StatusKind::PendingStatus | StatusKind::Terminated => {
                Err(Fault::new(format!("{kind:?} is no Real; fmi2LastSuccessfulTime is")))
            }
        }
    }

    /// `fmi2Get…Status` of a Boolean.
    pub fn boolean_status(&self, kind: StatusKind) -> Result<bool, Fault> {
        match kind {
            StatusKind::Terminated => Ok(self.unit.phase() == Phase::StepFailed),
            StatusKind::DoStepStatus | StatusKind::PendingStatus | StatusKind::LastSuccessfulTime => {
                Err(Fault::new(format!("{kind:?} is no Boolean; fmi2Terminated is")))
            }
        }
    }

    /// `fmi2GetStatus`: steps are synchronous, so this is what the last step answered.
    pub fn step_status(&self, kind: StatusKind) -> Result<Status, Fault> {
        match (kind, self.unit.phase()) {
            (StatusKind::DoStepStatus, Phase::StepFailed) => Ok(Status::Discard),
            (StatusKind::DoStepStatus, _) => Ok(Status::Ok),
            (StatusKind::PendingStatus | StatusKind::LastSuccessfulTime | StatusKind::Terminated, _) => {
                Err(Fault::new(format!("{kind:?} is no fmi2Status; fmi2DoStepStatus is")))
            }
        }
    }

    /// Sets values of one type, all or none.
    pub fn set<V: Copy>(&mut self, kind: Kind, references: &[u32], values: &[V], real: impl Fn(V) -> f64) -> Answer {
        self.unit.set(kind, references, values, real)?;
        Ok(Status::Ok)
    }

    /// Reads values of one type.
    pub fn get<V>(
        &mut self,
        kind: Kind,
        references: &[u32],
        values: &mut [MaybeUninit<V>],
        convert: impl Fn(f64) -> V,
    ) -> Answer {
        self.unit.check(references, kind)?;
        let unit = &mut self.unit;
        write(references.iter().map(|&reference| unit.get(kind, reference).map(&convert)), values)
    }

    /// Sets texts, all or none.
    pub fn set_texts(&mut self, references: &[u32], texts: &[&str]) -> Answer {
        self.unit.set_texts(references, texts)?;
        Ok(Status::Ok)
    }

    /// Reads texts.
    pub fn get_texts(&mut self, references: &[u32]) -> Result<&[CString], Fault> {
        let text = |&reference| {
            let text = self.unit.text(reference)?;
            CString::new(text).map_err(|_| Fault::new(format!("{text:?} holds a 0; expected none")))
        };
        self.texts = references.iter().map(text).collect::<Result<_, _>>()?;
        Ok(&self.texts)
    }

    /// `fmi2SetRealInputDerivatives`, order 1 only.
    pub fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Answer {
        self.unit.set_input_derivatives(references, orders, values)?;
        Ok(Status::Ok)
    }

    /// `fmi2GetRealOutputDerivatives`, order 1 only.
    pub fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut [MaybeUninit<f64>],
    ) -> Answer {
        write(self.unit.output_derivatives(references, orders)?, values)
    }

    /// `fmi2GetDirectionalDerivative`.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        direction: &[f64],
        sensitivities: &mut [MaybeUninit<f64>],
    ) -> Answer {
        write(self.unit.directional_derivative(unknowns, knowns, direction)?, sensitivities)
    }

    /// `fmi2EnterEventMode`.
    pub fn enter_event_mode(&mut self) -> Answer {
        self.unit.enter_event_mode();
        Ok(Status::Ok)
    }

    /// `fmi2NewDiscreteStates`: one call does it all.
    pub fn new_discrete_states(&mut self) -> Result<AfterEvent, Fault> {
        let log = &self.log;
        let after = self.unit.pass_events(&mut |event| {
            log.tell(Status::Ok, Category::Events, format_args!("{event}"));
        })?;
        Ok(after)
    }

    /// `fmi2EnterContinuousTimeMode`.
    pub fn enter_continuous_time_mode(&mut self) -> Answer {
        self.unit.enter_continuous_time_mode();
        Ok(Status::Ok)
    }

    /// `fmi2CompletedIntegratorStep`: no event follows from it.
    pub fn completed_integrator_step(&mut self) -> Answer {
        self.unit.complete_step();
        Ok(Status::Ok)
    }

    /// `fmi2SetTime`.
    pub fn set_time(&mut self, time: f64) -> Answer {
        self.unit.set_time(time)?;
        Ok(Status::Ok)
    }

    /// `fmi2SetContinuousStates`.
    pub fn set_continuous_states(&mut self, states: &[f64]) -> Answer {
        self.unit.set_states(states)?;
        Ok(Status::Ok)
    }

    /// `fmi2GetContinuousStates`, `fmi2GetDerivatives`, `fmi2GetEventIndicators` and
    /// `fmi2GetNominalsOfContinuousStates`: what `of` gives, all of it.
    pub fn get_all<const N: usize>(
        &mut self,
        of: impl FnOnce(&mut Unit) -> Result<[f64; N], Fault>,
        values: &mut [MaybeUninit<f64>],
    ) -> Answer {
        counted(values.len(), N, "numbers")?;
        write(of(&mut self.unit)?.into_iter().map(Ok), values)
    }

    /// `fmi2SetFMUstate`: from here on as when the state was saved.
    pub fn restore(&mut self, saved: &Unit) -> Answer {
        let (found, expected) = (saved.interface(), self.unit.interface());
        if found != expected {
            return Err(Fault::new(format!("the state is one of {found:?}; expected one of {expected:?}")));
        }
        self.unit.clone_from(saved);
        Ok(Status::Ok)
    }
}

/// Writes results to the importer's places for them.
pub fn write<V>(results: impl Iterator<Item = Result<V, Fault>>, places: &mut [MaybeUninit<V>]) -> Answer {
    for (result, place) in results.zip(places) {
        place.write(result?);
    }
    Ok(Status::Ok)
}
