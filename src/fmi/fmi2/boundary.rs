//! FMI 2.0: instantiation. The rest of the boundary is in [`crate::fmi::boundary`].

use std::ffi::{CStr, CString};

use crate::fmi::arrays::text;
use crate::fmi::boundary;
use crate::fmi::fmi2::callbacks::Messenger;
use crate::fmi::fmi2::calls::Call;
use crate::fmi::fmi2::instance::{Answer, Fmi2, Instance};
use crate::fmi::fmi2::types::{
    FMI2_CO_SIMULATION, FMI2_FALSE, FMI2_MODEL_EXCHANGE, Status, fmi2Boolean, fmi2CallbackFunctions, fmi2Component,
    fmi2Status, fmi2String, fmi2Type,
};
use crate::fmi::log::Log;
use crate::unit::fmu::Fmu;
use crate::unit::life_cycle::Interface;

pub use crate::fmi::boundary::{free_state, get_state, give_state, state};

/// Runs a call on an instance, as [`boundary::call`] does.
///
/// # Safety
/// `component` is null or comes from [`instantiate`] and has not been freed.
pub unsafe fn call<U: Fmu>(
    component: fmi2Component,
    call: Call,
    act: impl FnOnce(&mut Instance<U>) -> Answer,
) -> fmi2Status {
    // SAFETY: by contract.
    unsafe { boundary::call::<Fmi2<U>>(component, call, act) }.code()
}

/// `fmi2Instantiate`: makes an instance. Returns null and logs the reason if the request is not for this FMU.
///
/// # Safety
/// Strings are null or end with 0; `functions` is null or points to the importer's callbacks, whose logger may be called
/// during the life of the instance (standard, 2.1.5).
pub unsafe fn instantiate<U: Fmu>(
    name: fmi2String,
    kind: fmi2Type,
    guid: fmi2String,
    functions: *const fmi2CallbackFunctions,
    logging: fmi2Boolean,
) -> fmi2Component {
    // SAFETY: null or, by contract, the importer's structure with all members set (standard, 2.1.5).
    let Some(&callbacks) = (unsafe { functions.as_ref() }) else { return std::ptr::null_mut() };
    // SAFETY: by contract the logger of the standard (2.1.5), which may be called during the life of the instance.
    let messenger = unsafe { Messenger::new(callbacks) };
    boundary::create(|| {
        // SAFETY: by contract null or a string that ends with 0 (standard, 2.1.2) and does not change during this call.
        let (name, guid) = unsafe { (text(name), text(guid)) };
        let shown = name.filter(|name| !name.is_empty()).unwrap_or(c"?");
        let log = Log::new(messenger, CString::from(shown), is_true(logging));
        match fit::<U>(name, kind, guid) {
            Ok(interface) => Some(Instance::<U>::new(log, interface, Fmi2::default())),
            Err(reason) => {
                log.status(Status::Error, &format!("fmi2Instantiate: {reason}"));
                None
            }
        }
    })
}

fn fit<U: Fmu>(name: Option<&CStr>, kind: fmi2Type, guid: Option<&CStr>) -> Result<Interface, String> {
    if name.is_none_or(|name| name.to_bytes().trim_ascii().is_empty()) {
        return Err("instanceName is missing; expected a name".into());
    }
    let interface = match kind {
        FMI2_MODEL_EXCHANGE => Interface::ModelExchange,
        FMI2_CO_SIMULATION => Interface::CoSimulation,
        _ => {
            return Err(format!(
                "fmuType = {kind}; expected {FMI2_MODEL_EXCHANGE}, fmi2ModelExchange, or {FMI2_CO_SIMULATION}, fmi2CoSimulation"
            ));
        }
    };
    match guid.map(CStr::to_string_lossy) {
        Some(guid) if guid == U::GUID => Ok(interface),
        Some(guid) => Err(format!("fmuGUID = {guid:?}; expected {:?}", U::GUID)),
        None => Err(format!("fmuGUID is missing; expected {:?}", U::GUID)),
    }
}

/// `fmi2FreeInstance`: does nothing for null or from within a call on the instance.
///
/// # Safety
/// As for [`call`]; unless a call is in progress, the handle is invalid afterwards.
pub unsafe fn free_instance<U: Fmu>(component: fmi2Component) {
    // SAFETY: by contract.
    unsafe { boundary::free::<Fmi2<U>>(component) }
}

/// Whether a Boolean of C is true.
pub fn is_true(value: fmi2Boolean) -> bool {
    value != FMI2_FALSE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmi::boundary::guarded;
    use crate::fmi::fmi2::types::fmi2CallbackLogger;
    use crate::unit::fault::Fault;
    use crate::unit::instance::Unit;

    /// Tests a host that shares this library's Rust runtime. tests/abi/callbacks.rs tests other hosts.
    #[test]
    fn a_panic_of_the_logger_is_caught() {
        unsafe extern "C-unwind" fn panicking() {
            panic!("broken logger");
        }
        // SAFETY: a function that reads no argument can be called with any.
        let logger: fmi2CallbackLogger = unsafe { std::mem::transmute(panicking as *const ()) };
        let callbacks = fmi2CallbackFunctions {
            logger: Some(logger),
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            environment: std::ptr::null_mut(),
        };
        // SAFETY: a logger of any arguments.
        let messenger = unsafe { Messenger::new(callbacks) };
        let log = Log::new(messenger, c"block".into(), false);
        let mut instance = Instance::<Unit>::new(log, Interface::CoSimulation, Fmi2::default());
        assert_eq!(guarded(&mut instance, Call::SetReal, |_| Err(Fault::new("refused"))), Status::Fatal);
        assert_eq!(guarded(&mut instance, Call::SetReal, |_| Ok(Status::Ok)), Status::Fatal);
    }
}
