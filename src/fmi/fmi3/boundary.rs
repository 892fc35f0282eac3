//! FMI 3.0: instantiation and steps in pieces. The rest of the boundary is in [`crate::fmi::boundary`].

use std::ffi::{CStr, CString};

use crate::fmi::arrays::{read, text};
use crate::fmi::boundary;
use crate::fmi::fmi3::callbacks::{Messenger, UpdateReply, Updater, is_true};
use crate::fmi::fmi3::calls::Call;
use crate::fmi::fmi3::instance::{Answer, Fmi3, Instance};
use crate::fmi::fmi3::step::StepOutcome;
use crate::fmi::fmi3::types::*;
use crate::fmi::log::Log;
use crate::unit::fault::Fault;
use crate::unit::fmu::Fmu;
use crate::unit::life_cycle::Interface;

pub use crate::fmi::boundary::{free_state, get_state, give_state, state};

/// Runs a call on an instance, as [`boundary::call`] does.
///
/// # Safety
/// `instance` is null or comes from [`instantiate`] and has not been freed.
pub unsafe fn call<U: Fmu>(
    instance: fmi3Instance,
    call: Call,
    act: impl FnOnce(&mut Instance<U>) -> Answer,
) -> fmi3Status {
    // SAFETY: by contract.
    unsafe { boundary::call::<Fmi3<U>>(instance, call, act) }.code()
}

/// `fmi3DoStep`: runs a step in pieces, with intermediate updates between them.
///
/// `ready` may refuse the step before it begins; `done` receives its result.
///
/// # Safety
/// As for [`call`].
pub unsafe fn do_step<U: Fmu>(
    instance: fmi3Instance,
    step: StepOutcome,
    ready: impl Fn() -> Result<(), Fault>,
    done: impl Fn(&StepOutcome) -> Answer,
) -> fmi3Status {
    let mut step = step;
    let piece = |instance: &mut Instance<U>, reply: Option<UpdateReply>| {
        if reply.is_none() {
            ready()?;
        }
        instance.step_on(&mut step, reply, &done)
    };
    // SAFETY: by contract.
    unsafe { boundary::call_in_pieces::<Fmi3<U>, _, _>(instance, Call::DoStep, piece, Updater::call) }.code()
}

/// Arguments of an instantiation, for any interface type.
pub struct Request {
    /// `instanceName`.
    pub name: fmi3String,
    /// `instantiationToken`.
    pub token: fmi3String,
    /// `loggingOn`.
    pub logging: fmi3Boolean,
    /// `instanceEnvironment`.
    pub environment: fmi3InstanceEnvironment,
    /// `logMessage`.
    pub logger: Option<fmi3LogMessageCallback>,
}

/// Additional arguments of an instantiation for Co-Simulation.
pub struct Stepping {
    /// `eventModeUsed`.
    pub event_mode: fmi3Boolean,
    /// `earlyReturnAllowed`.
    pub early_return: fmi3Boolean,
    /// `requiredIntermediateVariables`.
    pub required: *const fmi3ValueReference,
    /// Their number.
    pub required_count: usize,
    /// `intermediateUpdate`.
    pub update: Option<fmi3IntermediateUpdateCallback>,
}

/// Makes an instance: for Co-Simulation with `stepping`, otherwise for Model Exchange.
///
/// Returns null and logs the reason if the request is not for this FMU. `function` is the name of the importer's call.
///
/// # Safety
/// Strings are null or end with 0, there are `required_count` required variables, and the callbacks may be called with the
/// environment during the life of the instance (standard, 2.3.1).
pub unsafe fn instantiate<U: Fmu>(function: &str, request: &Request, stepping: Option<Stepping>) -> fmi3Instance {
    let &Request { name, token, logging, environment, logger } = request;
    boundary::create(|| {
        // SAFETY: by contract null or strings that end with 0 (standard, 2.2.1) and do not change during this call.
        let (name, token) = unsafe { (text(name), text(token)) };
        let shown = name.filter(|name| !name.is_empty()).unwrap_or(c"?");
        // SAFETY: by contract the importer's logger, to be called during the life of the instance (standard, 2.3.1).
        let messenger = unsafe { Messenger::new(logger, environment) };
        let log = Log::new(messenger, CString::from(shown), is_true(logging));
        let interface = if stepping.is_some() { Interface::CoSimulation } else { Interface::ModelExchange };
        let how = match stepping {
            None => Ok(Fmi3::exchanged()),
            Some(Stepping { event_mode, early_return, required, required_count, update }) => {
                // SAFETY: by contract an array of `required_count` references (standard, 2.3.1).
                let required = unsafe { read("requiredIntermediateVariables", required, required_count) };
                // SAFETY: by contract the importer's function, to be called during the life of the instance (standard, 2.3.1).
                let updater = update.map(|callback| unsafe { Updater::new(callback, environment) });
                required
                    .map_err(|fault| fault.0)
                    .and_then(|required| Fmi3::stepped(is_true(event_mode), is_true(early_return), required, updater))
            }
        };
        match fit::<U>(name, token).and(how) {
            Ok(how) => Some(Instance::<U>::new(log, interface, how)),
            Err(reason) => {
                log.status(Status::Error, &format!("{function}: {reason}"));
                None
            }
        }
    })
}

fn fit<U: Fmu>(name: Option<&CStr>, token: Option<&CStr>) -> Result<(), String> {
    if name.is_none_or(|name| name.to_bytes().trim_ascii().is_empty()) {
        return Err("instanceName is missing; expected a name".into());
    }
    match token.map(CStr::to_string_lossy) {
        Some(token) if token == U::TOKEN => Ok(()),
        Some(token) => Err(format!("instantiationToken = {token:?}; expected {:?}", U::TOKEN)),
        None => Err(format!("instantiationToken is missing; expected {:?}", U::TOKEN)),
    }
}

/// Answers a request for Scheduled Execution: returns null and logs the reason.
///
/// # Safety
/// As for [`instantiate`].
pub unsafe fn refuse<U: Fmu>(request: &Request, reason: &str) -> fmi3Instance {
    let &Request { logging, environment, logger, .. } = request;
    boundary::create::<Fmi3<U>>(|| {
        // SAFETY: by contract the importer's logger, to be called during this call (standard, 2.3.1).
        let log = Log::new(unsafe { Messenger::new(logger, environment) }, c"?".into(), is_true(logging));
        log.status(Status::Error, reason);
        None
    })
}

/// `fmi3FreeInstance`: does nothing for null or from within a call on the instance.
///
/// # Safety
/// As for [`call`]; unless a call is in progress, the handle is invalid afterwards.
pub unsafe fn free_instance<U: Fmu>(instance: fmi3Instance) {
    // SAFETY: by contract.
    unsafe { boundary::free::<Fmi3<U>>(instance) }
}
