//! Pointers from C → references, slices and strings; panics and faults → a status and a message.
//!
//! All that the exported functions do with pointers is here. The standard (2.0.4) has the importer answer for them:
//! an instance is used from one thread at a time (2.1.5 and 2.2.2), is not used after `fmi2FreeInstance`, and arrays
//! hold as many elements as their counts say (2.1.7).

use std::ffi::{CStr, CString};
use std::panic::{AssertUnwindSafe, catch_unwind};

use libc::size_t;

use crate::fmi2::calls::Call;
use crate::fmi2::instance::{Answer, Core, Fault, Instance};
use crate::fmi2::log::Log;
use crate::fmi2::types::{
    FMI2_CO_SIMULATION, FMI2_FALSE, Status, fmi2Boolean, fmi2CallbackFunctions, fmi2Component, fmi2FMUstate,
    fmi2Status, fmi2String, fmi2Type,
};
use crate::model::variables::GUID;

/// Runs a call on an instance: null check, state check, and whatever goes wrong told and turned into a status.
///
/// # Safety
/// `component` is null or comes from [`instantiate`] and was not freed; no other call on it is under way.
pub unsafe fn call(component: fmi2Component, call: Call, act: impl FnOnce(&mut Instance) -> Answer) -> fmi2Status {
    // SAFETY: by this function's contract the pointer is null or a live, unshared instance (standard, 2.1.5).
    let Some(instance) = (unsafe { component.cast::<Instance>().as_mut() }) else { return Status::Error.code() };
    guarded(instance, call, act).code()
}

/// Runs `act` and lets no panic out.
fn guarded(instance: &mut Instance, call: Call, act: impl FnOnce(&mut Instance) -> Answer) -> Status {
    if instance.is_fatal() {
        return Status::Fatal;
    }
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        instance.admit(call)?;
        act(instance)
    }));
    match outcome {
        Ok(Ok(status)) => status,
        Ok(Err(Fault { status, message })) => {
            instance.log.status(status, &format!("{}: {message}", call.name()));
            status
        }
        Err(panic) => {
            instance.fail_fatally();
            let reason = panic_reason(panic.as_ref());
            // A logger that panics in turn has had its chance.
            let _ = catch_unwind(AssertUnwindSafe(|| {
                instance.log.status(Status::Fatal, &format!("{}: internal error: {reason}", call.name()));
            }));
            Status::Fatal
        }
    }
}

fn panic_reason(panic: &(dyn std::any::Any + Send)) -> &str {
    panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no reason given")
}

/// `fmi2Instantiate`: null, with a reason logged where there is a logger, if the request is not for this FMU.
///
/// # Safety
/// Texts are null or end with 0; `functions` is null or points to the importer's callbacks (standard, 2.1.5).
pub unsafe fn instantiate(
    name: fmi2String,
    kind: fmi2Type,
    guid: fmi2String,
    functions: *const fmi2CallbackFunctions,
    logging: fmi2Boolean,
) -> fmi2Component {
    // SAFETY: null or the importer's structure (standard, 2.1.5).
    let Some(&callbacks) = (unsafe { functions.as_ref() }) else { return std::ptr::null_mut() };
    let created = catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: null or a text that ends with 0 (standard, 2.1.3).
        let (name, guid) = unsafe { (text(name), text(guid)) };
        let shown = name.filter(|name| !name.is_empty()).unwrap_or(c"?");
        let log = Log::new(callbacks, CString::from(shown), is_true(logging));
        match fit(name, kind, guid) {
            Ok(()) => Some(Box::new(Instance::new(log))),
            Err(reason) => {
                log.status(Status::Error, &format!("fmi2Instantiate: {reason}"));
                None
            }
        }
    }));
    match created {
        Ok(Some(instance)) => Box::into_raw(instance).cast(),
        Ok(None) | Err(_) => std::ptr::null_mut(),
    }
}

fn fit(name: Option<&CStr>, kind: fmi2Type, guid: Option<&CStr>) -> Result<(), String> {
    if name.is_none_or(CStr::is_empty) {
        return Err("instanceName is missing; expected a name".into());
    }
    if kind != FMI2_CO_SIMULATION {
        return Err(format!("fmuType = {kind}; expected {FMI2_CO_SIMULATION}, fmi2CoSimulation"));
    }
    match guid.map(CStr::to_string_lossy) {
        Some(guid) if guid == GUID => Ok(()),
        Some(guid) => Err(format!("fmuGUID = {guid:?}; expected {GUID:?}")),
        None => Err(format!("fmuGUID is missing; expected {GUID:?}")),
    }
}

/// `fmi2FreeInstance`.
///
/// # Safety
/// As for [`call`]; the instance is gone afterwards.
pub unsafe fn free_instance(component: fmi2Component) {
    if !component.is_null() {
        // SAFETY: comes from `instantiate`, which made it from a box, and is not used any more (standard, 2.1.5).
        drop(unsafe { Box::from_raw(component.cast::<Instance>()) });
    }
}

/// Hands a message to the importer's logger; the message is an argument of the format `%s`, never a format.
pub fn log(callbacks: &fmi2CallbackFunctions, instance: &CStr, status: Status, category: &CStr, message: &CStr) {
    if let Some(logger) = callbacks.logger {
        // SAFETY: the importer's logger takes these arguments (standard, 2.1.5); all texts end with 0 and outlive the
        // call.
        unsafe {
            logger(
                callbacks.environment,
                instance.as_ptr(),
                status.code(),
                category.as_ptr(),
                c"%s".as_ptr(),
                message.as_ptr(),
            );
        }
    }
}

/// Whether a Boolean of C is true.
pub fn is_true(value: fmi2Boolean) -> bool {
    value != FMI2_FALSE
}

/// An array that is only read.
///
/// # Safety
/// `pointer` is null or points to `count` elements that nothing changes meanwhile (standard, 2.1.7).
pub unsafe fn read<'a, T>(name: &str, pointer: *const T, count: size_t) -> Result<&'a [T], Fault> {
    if count == 0 {
        Ok(&[])
    } else if pointer.is_null() {
        Err(Fault::error(format!("{name} is NULL; expected {count} elements")))
    } else {
        // SAFETY: not null, and by contract as long as it says.
        Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
    }
}

/// An array that is written.
///
/// # Safety
/// `pointer` is null or points to `count` elements that nothing else touches meanwhile (standard, 2.1.7).
pub unsafe fn write<'a, T>(name: &str, pointer: *mut T, count: size_t) -> Result<&'a mut [T], Fault> {
    if count == 0 {
        Ok(&mut [])
    } else if pointer.is_null() {
        Err(Fault::error(format!("{name} is NULL; expected room for {count} elements")))
    } else {
        // SAFETY: not null, and by contract as long as it says and not shared.
        Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
    }
}

/// A single place that is written.
///
/// # Safety
/// As for [`write()`], with one element.
pub unsafe fn place<'a, T>(name: &str, pointer: *mut T) -> Result<&'a mut T, Fault> {
    // SAFETY: null or, by contract, a place that nothing else touches meanwhile.
    unsafe { pointer.as_mut() }.ok_or_else(|| Fault::error(format!("{name} is NULL; expected a place for the result")))
}

/// A text of C.
///
/// # Safety
/// `pointer` is null or points to a text that ends with 0 (standard, 2.1.3).
unsafe fn text<'a>(pointer: fmi2String) -> Option<&'a CStr> {
    // SAFETY: not null here, and by contract a text that ends with 0.
    (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) })
}

/// The texts of an array; those that are no UTF-8 are shown as far as they can be.
///
/// # Safety
/// As for [`read`], and each element as a text that ends with 0.
pub unsafe fn texts(name: &str, pointer: *const fmi2String, count: size_t) -> Result<Vec<String>, Fault> {
    // SAFETY: by contract.
    let pointers = unsafe { read(name, pointer, count) }?;
    pointers
        .iter()
        .map(|&pointer| {
            // SAFETY: by contract.
            unsafe { text(pointer) }
                .map(|text| text.to_string_lossy().into_owned())
                .ok_or_else(|| Fault::error(format!("{name} holds NULL; expected texts")))
        })
        .collect()
}

/// `fmi2GetFMUstate`: a new state, or the present one written over the state that `*state` points to.
///
/// # Safety
/// `*state` is null or a state of this FMU that was not freed (standard, 2.1.8).
pub unsafe fn get_state(instance: &mut Instance, state: *mut fmi2FMUstate) -> Answer {
    // SAFETY: by contract.
    let state = unsafe { place("FMUstate", state) }?;
    // SAFETY: by contract null or a live state.
    match unsafe { state.cast::<Core>().as_mut() } {
        Some(saved) => *saved = instance.save(),
        None => *state = Box::into_raw(Box::new(instance.save())).cast(),
    }
    Ok(Status::Ok)
}

/// A saved state.
///
/// # Safety
/// `state` is null or a state of this FMU that was not freed (standard, 2.1.8).
pub unsafe fn state<'a>(state: fmi2FMUstate) -> Result<&'a Core, Fault> {
    // SAFETY: by contract.
    unsafe { state.cast::<Core>().as_ref() }.ok_or_else(|| Fault::error("FMUstate is NULL; expected a saved state"))
}

/// `fmi2FreeFMUstate`: frees the state and forgets the pointer; nothing for null.
///
/// # Safety
/// `state` is null or points to null or to a state of this FMU that was not freed (standard, 2.1.8).
pub unsafe fn free_state(state: *mut fmi2FMUstate) -> Answer {
    // SAFETY: by contract.
    if let Some(state) = unsafe { state.as_mut() }
        && !state.is_null()
    {
        // SAFETY: by contract it was made by `get_state` or by deserialization, from a box.
        drop(unsafe { Box::from_raw(state.cast::<Core>()) });
        *state = std::ptr::null_mut();
    }
    Ok(Status::Ok)
}

/// Puts a state that was read from bytes where the importer wants it.
///
/// # Safety
/// As for [`place`].
pub unsafe fn give_state(state: *mut fmi2FMUstate, core: Core) -> Answer {
    // SAFETY: by contract.
    let place = unsafe { place("FMUstate", state) }?;
    *place = Box::into_raw(Box::new(core)).cast();
    Ok(Status::Ok)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn silent_instance() -> Instance {
        let callbacks = fmi2CallbackFunctions {
            logger: None,
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            environment: std::ptr::null_mut(),
        };
        Instance::new(Log::new(callbacks, c"block".into(), false))
    }

    #[test]
    fn a_panic_is_caught_and_the_instance_refuses_from_then_on() {
        let mut instance = silent_instance();
        assert_eq!(guarded(&mut instance, Call::SetReal, |_| panic!("broken")), Status::Fatal);
        assert_eq!(guarded(&mut instance, Call::SetReal, |_| Ok(Status::Ok)), Status::Fatal);
        assert_eq!(guarded(&mut instance, Call::Reset, Instance::reset), Status::Fatal);
    }

    #[test]
    fn the_reason_of_a_panic_is_told() {
        let text = catch_unwind(|| panic!("reason {}", 7)).unwrap_err();
        assert_eq!(panic_reason(text.as_ref()), "reason 7");
        let literal = catch_unwind(|| panic!("reason")).unwrap_err();
        assert_eq!(panic_reason(literal.as_ref()), "reason");
    }
}
