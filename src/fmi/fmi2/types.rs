//! The C types of the standard's headers (fmi2TypesPlatform.h, fmi2FunctionTypes.h, version 2.0.4).

#![allow(non_camel_case_types, reason = "the names are the standard's")]

use std::ffi::{c_char, c_int, c_uint, c_void};

use crate::fmi::size_t;

pub use crate::fmi::Status;

/// The importer's handle of an instance.
pub type fmi2Component = *mut c_void;
/// The importer's own pointer, passed back with each message.
pub type fmi2ComponentEnvironment = *mut c_void;
/// The importer's handle of a saved state.
pub type fmi2FMUstate = *mut c_void;
/// Value reference of a variable.
pub type fmi2ValueReference = c_uint;
/// A real number.
pub type fmi2Real = f64;
/// An integer or an item of an enumeration.
pub type fmi2Integer = c_int;
/// 0 is false, everything else is true.
pub type fmi2Boolean = c_int;
/// A character.
pub type fmi2Char = c_char;
/// A string that ends with 0.
pub type fmi2String = *const fmi2Char;
/// A byte of a serialized state.
pub type fmi2Byte = c_char;
/// An enumeration of C. Any integer may come in, unlike with an enum of Rust.
pub type fmi2Status = c_int;
/// `fmi2Type`, an integer for the same reason.
pub type fmi2Type = c_int;
/// `fmi2StatusKind`, an integer for the same reason.
pub type fmi2StatusKind = c_int;

/// Yes.
pub const FMI2_TRUE: fmi2Boolean = 1;
/// No.
pub const FMI2_FALSE: fmi2Boolean = 0;

/// `fmi2ModelExchange` of `fmi2Type`.
pub const FMI2_MODEL_EXCHANGE: fmi2Type = 0;
/// `fmi2CoSimulation` of `fmi2Type`.
pub const FMI2_CO_SIMULATION: fmi2Type = 1;

/// Kinds of status that can be requested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StatusKind {
    /// Status of an asynchronous step.
    DoStepStatus,
    /// A text on a pending step.
    PendingStatus,
    /// The time that the last step reached.
    LastSuccessfulTime,
    /// Whether the FMU has ended the run.
    Terminated,
}

impl StatusKind {
    /// Returns the kind with this number, if there is one.
    pub fn from_code(code: fmi2StatusKind) -> Option<StatusKind> {
        [StatusKind::DoStepStatus, StatusKind::PendingStatus, StatusKind::LastSuccessfulTime, StatusKind::Terminated]
            .get(usize::try_from(code).ok()?)
            .copied()
    }
}

/// The importer's logger, variadic as in C: the message is a printf format.
///
/// It should not unwind, but unwinding is not undefined behaviour; see [`crate::fmi::boundary`].
pub type fmi2CallbackLogger = unsafe extern "C-unwind" fn(
    environment: fmi2ComponentEnvironment,
    instance_name: fmi2String,
    status: fmi2Status,
    category: fmi2String,
    message: fmi2String,
    ...
);

/// The importer's functions.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct fmi2CallbackFunctions {
    /// Receives messages.
    pub logger: Option<fmi2CallbackLogger>,
    /// Not used.
    pub allocate_memory: Option<unsafe extern "C" fn(count: size_t, size: size_t) -> *mut c_void>,
    /// Not used.
    pub free_memory: Option<unsafe extern "C" fn(memory: *mut c_void)>,
    /// Not used: steps are never asynchronous.
    pub step_finished: Option<unsafe extern "C" fn(environment: fmi2ComponentEnvironment, status: fmi2Status)>,
    /// Passed back to the logger.
    pub environment: fmi2ComponentEnvironment,
}

/// Information for the importer after an event.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct fmi2EventInfo {
    /// Whether `fmi2NewDiscreteStates` has to be called again.
    pub new_discrete_states_needed: fmi2Boolean,
    /// Whether the run ended.
    pub terminate_simulation: fmi2Boolean,
    /// Whether nominal values of states changed.
    pub nominals_of_continuous_states_changed: fmi2Boolean,
    /// Whether values of states changed.
    pub values_of_continuous_states_changed: fmi2Boolean,
    /// Whether the next event is a time event.
    pub next_event_time_defined: fmi2Boolean,
    /// Its time (s).
    pub next_event_time: fmi2Real,
}
