//! The C types of the standard's headers (fmi2TypesPlatform.h, fmi2FunctionTypes.h, version 2.0.4).

#![allow(non_camel_case_types, reason = "the names are the standard's")]

use libc::{c_char, c_int, c_uint, c_void, size_t};

pub use crate::fmi::Status;

/// An instance, as the importer sees it.
pub type fmi2Component = *mut c_void;
/// What the importer gets back with each message.
pub type fmi2ComponentEnvironment = *mut c_void;
/// A saved state, as the importer sees it.
pub type fmi2FMUstate = *mut c_void;
/// Number of a variable.
pub type fmi2ValueReference = c_uint;
/// A real number.
pub type fmi2Real = f64;
/// An integer or an item of an enumeration.
pub type fmi2Integer = c_int;
/// 0 is false, everything else is true.
pub type fmi2Boolean = c_int;
/// A character.
pub type fmi2Char = c_char;
/// A text that ends with 0.
pub type fmi2String = *const fmi2Char;
/// A byte of a serialized state.
pub type fmi2Byte = c_char;
/// An enumeration that comes in from C: any integer may, so it is none in Rust.
pub type fmi2Status = c_int;
/// `fmi2Type`, likewise.
pub type fmi2Type = c_int;
/// `fmi2StatusKind`, likewise.
pub type fmi2StatusKind = c_int;

/// Yes.
pub const FMI2_TRUE: fmi2Boolean = 1;
/// No.
pub const FMI2_FALSE: fmi2Boolean = 0;

/// `fmi2ModelExchange` of `fmi2Type`.
pub const FMI2_MODEL_EXCHANGE: fmi2Type = 0;
/// `fmi2CoSimulation` of `fmi2Type`.
pub const FMI2_CO_SIMULATION: fmi2Type = 1;

/// Kinds of status that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StatusKind {
    /// Status of an asynchronous step.
    DoStepStatus,
    /// A text on a pending step.
    PendingStatus,
    /// The time up to which the last step came.
    LastSuccessfulTime,
    /// Whether the instance wants to end the run.
    Terminated,
}

impl StatusKind {
    /// The kind of this number, if it is one.
    pub fn from_code(code: fmi2StatusKind) -> Option<StatusKind> {
        [StatusKind::DoStepStatus, StatusKind::PendingStatus, StatusKind::LastSuccessfulTime, StatusKind::Terminated]
            .get(usize::try_from(code).ok()?)
            .copied()
    }
}

/// The importer's logger; variadic as in C: the message is a printf format. It should not unwind, but what does so must not be
/// undefined behaviour; see [`crate::fmi::fmi2::boundary`].
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
    /// Takes messages.
    pub logger: Option<fmi2CallbackLogger>,
    /// Not used.
    pub allocate_memory: Option<unsafe extern "C" fn(count: size_t, size: size_t) -> *mut c_void>,
    /// Not used.
    pub free_memory: Option<unsafe extern "C" fn(memory: *mut c_void)>,
    /// Not used: steps are never asynchronous.
    pub step_finished: Option<unsafe extern "C" fn(environment: fmi2ComponentEnvironment, status: fmi2Status)>,
    /// Handed back to the logger.
    pub environment: fmi2ComponentEnvironment,
}

/// What an importer has to know after an event.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct fmi2EventInfo {
    /// Whether `fmi2NewDiscreteStates` has to be called again.
    pub new_discrete_states_needed: fmi2Boolean,
    /// Whether the run ended.
    pub terminate_simulation: fmi2Boolean,
    /// Whether the nominal values of states are others than before.
    pub nominals_of_continuous_states_changed: fmi2Boolean,
    /// Whether states are others than before.
    pub values_of_continuous_states_changed: fmi2Boolean,
    /// Whether the time of the next event is known.
    pub next_event_time_defined: fmi2Boolean,
    /// That time (s).
    pub next_event_time: fmi2Real,
}
