//! An instance of FMI 2.0: the part of [`crate::fmi::instance`] that depends on the version.

use std::marker::PhantomData;

use crate::fmi;
use crate::fmi::fmi2::types::{Status, StatusKind};
use crate::fmi::log::Category;
use crate::run::Progress;
use crate::unit::fault::Fault;
use crate::unit::fmu::Fmu;
use crate::unit::life_cycle::Phase;

pub use crate::fmi::instance::{Answer, always, moves_to, write};

/// FMI 2.0 of a unit, which adds no fields to an instance.
#[derive(Debug)]
pub struct Fmi2<U>(PhantomData<U>);

impl<U> Default for Fmi2<U> {
    fn default() -> Fmi2<U> {
        Fmi2(PhantomData)
    }
}

/// An instance of FMI 2.0.
pub type Instance<U> = fmi::instance::Instance<Fmi2<U>>;

impl<U: Fmu> Instance<U> {
    /// `fmi2DoStep`. Allocates no memory unless it fails.
    ///
    /// # Errors
    /// Those of [`Fmu::advance`].
    #[inline]
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

    /// `fmi2GetRealStatus`.
    ///
    /// # Errors
    /// A kind of another type.
    pub fn real_status(&self, kind: StatusKind) -> Result<f64, Fault> {
        match kind {
            StatusKind::LastSuccessfulTime => Ok(self.unit.time()),
            StatusKind::DoStepStatus | StatusKind::PendingStatus | StatusKind::Terminated => {
                Err(Fault::new(format!("{kind:?} is no Real; expected fmi2LastSuccessfulTime")))
            }
        }
    }

    /// `fmi2GetBooleanStatus`.
    ///
    /// # Errors
    /// A kind of another type.
    pub fn boolean_status(&self, kind: StatusKind) -> Result<bool, Fault> {
        match kind {
            StatusKind::Terminated => Ok(self.unit.life().phase == Phase::StepFailed),
            StatusKind::DoStepStatus | StatusKind::PendingStatus | StatusKind::LastSuccessfulTime => {
                Err(Fault::new(format!("{kind:?} is no Boolean; expected fmi2Terminated")))
            }
        }
    }

    /// `fmi2GetStatus`: the status of the last step, since steps are synchronous.
    ///
    /// # Errors
    /// A kind of another type.
    pub fn step_status(&self, kind: StatusKind) -> Result<Status, Fault> {
        match (kind, self.unit.life().phase) {
            (StatusKind::DoStepStatus, Phase::StepFailed) => Ok(Status::Discard),
            (StatusKind::DoStepStatus, _) => Ok(Status::Ok),
            (StatusKind::PendingStatus | StatusKind::LastSuccessfulTime | StatusKind::Terminated, _) => {
                Err(Fault::new(format!("{kind:?} is no fmi2Status; expected fmi2DoStepStatus")))
            }
        }
    }

    /// `fmi2SetRealInputDerivatives`, order 1 only.
    ///
    /// # Errors
    /// Those of [`Fmu::set_input_derivatives`].
    #[inline]
    pub fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Answer {
        self.unit.set_input_derivatives(references, orders, values)?;
        Ok(Status::Ok)
    }
}
