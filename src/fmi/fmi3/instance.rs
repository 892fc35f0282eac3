//! An instance of FMI 3.0: the part of [`crate::fmi::instance`] that depends on the version.

use std::marker::PhantomData;

use crate::fmi;
use crate::fmi::fmi3::callbacks::Updater;
use crate::fmi::fmi3::types::Status;
use crate::fmi::log::Category;
use crate::unit::attributes::{Causality, Variability};
use crate::unit::fault::Fault;
use crate::unit::fmu::{AfterEvent, Fmu};
use crate::unit::life_cycle::{Interface, Phase};

pub use crate::fmi::instance::{Answer, always, moves_to, write};

/// The importer's choices at instantiation.
#[derive(Debug)]
pub struct Fmi3<U> {
    /// Whether the importer handles events in Event Mode.
    pub event_mode: bool,
    /// Whether a step may be left early.
    pub early_return: bool,
    /// The importer's callback for intermediate updates.
    pub updater: Option<Updater>,
    /// The variables that the importer sets and reads there.
    required: Vec<u32>,
    /// Whether inputs are among them.
    pub sets_inputs: bool,
    unit: PhantomData<U>,
}

/// An instance of FMI 3.0.
pub type Instance<U> = fmi::instance::Instance<Fmi3<U>>;

impl<U: Fmu> Fmi3<U> {
    /// Returns the choices of Model Exchange.
    pub fn exchanged() -> Fmi3<U> {
        Fmi3 {
            event_mode: true,
            early_return: false,
            updater: None,
            required: Vec::new(),
            sets_inputs: false,
            unit: PhantomData,
        }
    }

    /// Returns the choices for Co-Simulation. Refuses variables that cannot be set or read inside a step.
    ///
    /// # Errors
    /// The first variable that cannot be set or read inside a step.
    pub fn stepped(
        event_mode: bool,
        early_return: bool,
        required: &[u32],
        updater: Option<Updater>,
    ) -> Result<Fmi3<U>, String> {
        let mut sets_inputs = false;
        for &reference in required {
            let known = U::known(reference).filter(|known| known.variability == Variability::Continuous);
            let Some(known) = known else {
                return Err(format!(
                    "requiredIntermediateVariables holds {reference}; expected value references of inputs and continuous outputs"
                ));
            };
            sets_inputs |= known.causality == Causality::Input;
        }
        Ok(Fmi3 { event_mode, early_return, updater, required: required.to_vec(), sets_inputs, unit: PhantomData })
    }

    /// Refuses variables that were not requested for intermediate updates.
    ///
    /// # Errors
    /// The first variable that was not requested.
    pub fn check_required(&self, references: &[u32]) -> Result<(), Fault> {
        match references.iter().find(|&reference| !self.required.contains(reference)) {
            None => Ok(()),
            Some(reference) => Err(Fault::new(format!(
                "value reference {reference} is set or read inside a step; expected one of the requiredIntermediateVariables"
            ))),
        }
    }
}

impl<U: Fmu> Instance<U> {
    /// `fmi3EnterInitializationMode`.
    ///
    /// # Errors
    /// Those of [`Instance::plan`].
    pub fn enter_initialization_mode(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Answer {
        let status = self.plan(tolerance, start, stop)?;
        self.unit.enter_initialization_mode();
        Ok(status)
    }

    /// `fmi3ExitInitializationMode`: enters Event Mode if that is used, otherwise Step Mode.
    ///
    /// # Errors
    /// Those of [`Instance::exit_initialization_mode`].
    pub fn leave_initialization_mode(&mut self) -> Answer {
        let status = self.exit_initialization_mode()?;
        if self.version.event_mode {
            self.unit.enter_event_mode();
        }
        Ok(status)
    }

    /// `fmi3EnterEventMode`.
    ///
    /// # Errors
    /// Event Mode was not requested at instantiation.
    pub fn begin_event(&mut self) -> Answer {
        if !self.version.event_mode {
            return Err(Fault::new(
                "eventModeUsed was false at instantiation; expected true, since the FMU handles events itself",
            ));
        }
        self.unit.enter_event_mode();
        Ok(Status::Ok)
    }

    /// `fmi3UpdateDiscreteStates`: applies an event.
    ///
    /// # Errors
    /// Those of [`Fmu::pass_events`] and [`Fmu::apply_pending_event`].
    pub fn update_discrete_states(&mut self) -> Result<AfterEvent, Fault> {
        if self.unit.life().interface == Interface::ModelExchange {
            return self.new_discrete_states();
        }
        let log = &self.log;
        self.unit.apply_pending_event(&mut |event| log.tell(Status::Ok, Category::Events, format_args!("{event}")))?;
        Ok(AfterEvent { ended: self.unit.has_ended(), ..AfterEvent::default() })
    }

    /// `fmi3EnterStepMode`: applies an event that is not yet applied, and enters Step Mode.
    ///
    /// # Errors
    /// Those of [`Instance::update_discrete_states`].
    pub fn enter_step_mode(&mut self) -> Answer {
        self.update_discrete_states()?;
        self.unit.set_phase(Phase::StepComplete);
        Ok(Status::Ok)
    }
}
