//! Pointers from C → references, slices and strings; panics and faults → a status and a message.
//!
//! All that the exported functions do with pointers is here. What the standard (2.0.4) has the importer answer for:
//!
//! - an instance is used between `fmi2Instantiate` and `fmi2FreeInstance` only (2.1.5);
//! - arrays hold as many elements as their counts say (2.1.7), texts end with 0 (2.1.2), and both stay as they are during a
//!   call;
//! - a state that is handed over was made by this FMU and not freed (2.1.8).
//!
//! What is not left to the importer:
//!
//! - **Calls within a call.** The logger, the one callback that is ever called, may call functions of its own instance,
//!   and so may another thread. While a call is under way, any other on the same instance gets `fmi2Error`, without a
//!   message, and changes nothing; `fmi2FreeInstance` does nothing. See `Turn`.
//! - **Memory that was never written.** Results go into [`Room`]s, of which nothing is read.
//! - **Arrays that overlap,** such as a direction and its sensitivities in one array: all is read before anything is
//!   written.
//! - **Panics** are caught here, and the instance refuses every call from then on.
//!
//! **Exceptions** must not leave the logger: C has none. One that does (of C++, say, or a panic of a Rust host) is no
//! undefined behaviour, since the logger is called as `extern "C-unwind"` and unwinding is caught here: it ends the process with a
//! message, or where this library and the host share a Rust runtime, the instance. A `longjmp` out of the logger is undefined
//! behaviour and forbidden: it would skip what the frames in between have to put back.

use std::borrow::Cow;
use std::ffi::{CStr, CString};
use std::marker::PhantomData;
use std::mem::MaybeUninit;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

use libc::size_t;

use crate::fmi2::calls::Call;
use crate::fmi2::instance::{Answer, Instance};
use crate::fmi2::log::Log;
use crate::fmi2::types::{
    FMI2_CO_SIMULATION, FMI2_FALSE, FMI2_MODEL_EXCHANGE, Status, fmi2Boolean, fmi2CallbackFunctions, fmi2Component,
    fmi2FMUstate, fmi2Status, fmi2String, fmi2Type,
};
use crate::model::fault::Fault;
use crate::model::unit::{Interface, Unit};
use crate::model::variables::GUID;

/// What the importer's `fmi2Component` points to.
struct Outer {
    /// Whether a call is under way. The only part that two calls may look at at once.
    busy: AtomicBool,
    instance: Instance,
}

/// The right to use an instance, for one call at a time.
struct Turn<'a>(&'a AtomicBool);

impl Turn<'_> {
    /// `None` while another call has it.
    fn take(busy: &AtomicBool) -> Option<Turn<'_>> {
        if busy.swap(true, Ordering::Acquire) { None } else { Some(Turn(busy)) }
    }
}

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Release);
    }
}

/// Runs a call on an instance: null check, its turn, state check, and whatever goes wrong told and turned into a status.
///
/// # Safety
/// `component` is null or comes from [`instantiate`] and was not freed.
pub unsafe fn call(component: fmi2Component, call: Call, act: impl FnOnce(&mut Instance) -> Answer) -> fmi2Status {
    let outer = component.cast::<Outer>();
    if outer.is_null() {
        return Status::Error.code();
    }
    // SAFETY: not null, so by contract an instance that lives (standard, 2.1.5). The reference is to `busy` alone, which is
    // shared by all calls and never borrowed in another way.
    let busy = unsafe { &(*outer).busy };
    let Some(_turn) = Turn::take(busy) else { return Status::Error.code() };
    // SAFETY: as before, and until `_turn` is dropped no other call comes as far as here, nor does `free_instance`, so that
    // this is the only reference to the part `instance` (standard, 2.1: one instance need not be safe for threads).
    let instance = unsafe { &mut (*outer).instance };
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
    let (status, message) = match outcome {
        Ok(Ok(status)) => return status,
        Ok(Err(Fault(message))) => (Status::Error, message),
        Err(panic) => {
            instance.unit.fail_fatally();
            (Status::Fatal, format!("internal error: {}", panic_reason(panic.as_ref())))
        }
    };
    let told = catch_unwind(AssertUnwindSafe(|| {
        instance.log.status(status, &format!("{}: {message}", call.name()));
    }));
    match told {
        Ok(()) => status,
        // The logger panicked.
        Err(_) => {
            instance.unit.fail_fatally();
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
/// Texts are null or end with 0; `functions` is null or points to the importer's callbacks, whose logger may be called as
/// long as the instance lives (standard, 2.1.5).
pub unsafe fn instantiate(
    name: fmi2String,
    kind: fmi2Type,
    guid: fmi2String,
    functions: *const fmi2CallbackFunctions,
    logging: fmi2Boolean,
) -> fmi2Component {
    // SAFETY: null or, by contract, the importer's structure with all its members set (standard, 2.1.5).
    let Some(&callbacks) = (unsafe { functions.as_ref() }) else { return std::ptr::null_mut() };
    // SAFETY: by contract the logger that the standard describes (2.1.5), to be called as long as the instance lives.
    let messenger = unsafe { Messenger::new(callbacks) };
    let created = catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: by contract null or a text that ends with 0 (standard, 2.1.2) and stays during this call.
        let (name, guid) = unsafe { (text(name), text(guid)) };
        let shown = name.filter(|name| !name.is_empty()).unwrap_or(c"?");
        let log = Log::new(messenger, CString::from(shown), is_true(logging));
        match fit(name, kind, guid) {
            Ok(interface) => {
                Some(Box::new(Outer { busy: AtomicBool::new(false), instance: Instance::new(log, interface) }))
            }
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

fn fit(name: Option<&CStr>, kind: fmi2Type, guid: Option<&CStr>) -> Result<Interface, String> {
    if name.is_none_or(CStr::is_empty) {
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
        Some(guid) if guid == GUID => Ok(interface),
        Some(guid) => Err(format!("fmuGUID = {guid:?}; expected {GUID:?}")),
        None => Err(format!("fmuGUID is missing; expected {GUID:?}")),
    }
}

/// `fmi2FreeInstance`: nothing for null, and nothing from within a call on the instance, which goes on using it.
///
/// # Safety
/// As for [`call`]; unless a call is under way the instance is gone afterwards.
pub unsafe fn free_instance(component: fmi2Component) {
    let outer = component.cast::<Outer>();
    if outer.is_null() {
        return;
    }
    // SAFETY: not null, so by contract an instance that lives (standard, 2.1.5); as in `call`, of `busy` alone.
    let Some(turn) = Turn::take(unsafe { &(*outer).busy }) else { return };
    // The turn is not given back: it goes with the instance.
    std::mem::forget(turn);
    // SAFETY: `instantiate` made it from a box, no call is under way, and by contract none follows (standard, 2.1.5).
    drop(unsafe { Box::from_raw(outer) });
}

/// The importer's logger, and what it wants to be handed back.
#[derive(Debug)]
pub struct Messenger(fmi2CallbackFunctions);

impl Messenger {
    /// # Safety
    /// The logger, if there is one, is a function as the standard (2.1.5) describes it, and may be called with
    /// `environment` as long as this lives.
    unsafe fn new(callbacks: fmi2CallbackFunctions) -> Messenger {
        Messenger(callbacks)
    }

    /// Hands a message over; it is the argument of the format `%s`, never a format.
    pub fn send(&self, instance: &CStr, status: Status, category: &CStr, message: &CStr) {
        let Messenger(fmi2CallbackFunctions { logger, environment, .. }) = *self;
        if let Some(logger) = logger {
            let (instance, category, message) = (instance.as_ptr(), category.as_ptr(), message.as_ptr());
            // SAFETY: by the contract of `new` the importer's logger, which takes these arguments and one text for `%s`
            // (standard, 2.1.5); all texts end with 0 and outlive the call. The instance is in use meanwhile, but
            // whatever the logger calls on it is refused before it is touched; see `Turn`.
            unsafe { logger(environment, instance, status.code(), category, c"%s".as_ptr(), message) };
        }
    }
}

/// Whether a Boolean of C is true.
pub fn is_true(value: fmi2Boolean) -> bool {
    value != FMI2_FALSE
}

/// Refuses what cannot be an array of `count` elements.
fn usable<T>(name: &str, pointer: *const T, count: size_t) -> Result<(), Fault> {
    if pointer.is_null() {
        return Err(Fault::new(format!("{name} is NULL; expected {count} elements")));
    }
    if !pointer.is_aligned() {
        let multiple = align_of::<T>();
        return Err(Fault::new(format!("{name} is at {pointer:p}; expected a multiple of {multiple}")));
    }
    if count > isize::MAX as usize / size_of::<T>() {
        return Err(Fault::new(format!("{name} has {count} elements; expected what fits into memory")));
    }
    Ok(())
}

/// An array that is only read.
///
/// # Safety
/// `pointer` is null or points to `count` elements that nothing changes meanwhile (standard, 2.1.7).
pub unsafe fn read<'a, T>(name: &str, pointer: *const T, count: size_t) -> Result<&'a [T], Fault> {
    if count == 0 {
        return Ok(&[]);
    }
    usable(name, pointer, count)?;
    // SAFETY: not null, aligned and of a length that exists; by contract as many elements as it says (standard, 2.1.7).
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// Room for results in the importer's memory. Nothing is read of it: the importer need not have written it.
pub struct Room<'a, T> {
    pointer: *mut T,
    count: usize,
    memory: PhantomData<&'a mut [MaybeUninit<T>]>,
}

/// An array that is only written.
///
/// # Safety
/// `pointer` is null or points to room for `count` elements that nothing else touches meanwhile (standard, 2.1.7), but for
/// arrays that are read by [`Room::read_beside`].
pub unsafe fn room<'a, T>(name: &str, pointer: *mut T, count: size_t) -> Result<Room<'a, T>, Fault> {
    if count > 0 {
        usable(name, pointer, count)?;
    }
    Ok(Room { pointer, count, memory: PhantomData })
}

impl<'a, T> Room<'a, T> {
    /// An array that is read while this room is written: itself, or a copy of it where the two share memory.
    ///
    /// # Safety
    /// As for [`read`].
    pub unsafe fn read_beside<U: Copy>(
        &self,
        name: &str,
        pointer: *const U,
        count: size_t,
    ) -> Result<Cow<'a, [U]>, Fault> {
        // SAFETY: by contract; where it shares memory with this room the slice is gone before anything is written.
        let array = unsafe { read(name, pointer, count) }?;
        let (here, there) = (self.pointer.addr(), array.as_ptr().addr());
        let apart = here + self.count * size_of::<T>() <= there || there + size_of_val(array) <= here;
        Ok(if apart || self.count == 0 { Cow::Borrowed(array) } else { Cow::Owned(array.to_vec()) })
    }

    /// The elements.
    pub fn places(&mut self) -> &mut [MaybeUninit<T>] {
        if self.count == 0 {
            return &mut [];
        }
        // SAFETY: not null, aligned and of a length that exists (see `room`); by its contract room for as many elements
        // (standard, 2.1.7), of which nothing is assumed, and by that of `read_beside` no slice shares it.
        unsafe { std::slice::from_raw_parts_mut(self.pointer.cast(), self.count) }
    }

    /// Writes the one element of a room for one.
    pub fn put(mut self, value: T) {
        if let [place] = self.places() {
            place.write(value);
        }
    }
}

impl Room<'_, u8> {
    /// Copies bytes to the beginning of the room.
    pub fn copy(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let (found, needed) = (self.count, bytes.len());
        let places = self.places().get_mut(..needed);
        let places = places.ok_or_else(|| Fault::new(format!("room for {found} bytes; the state takes {needed}")))?;
        places.write_copy_of_slice(bytes);
        Ok(())
    }
}

/// A single place for a result.
///
/// # Safety
/// As for [`room()`], with one element.
pub unsafe fn place<'a, T>(name: &str, pointer: *mut T) -> Result<Room<'a, T>, Fault> {
    if pointer.is_null() {
        return Err(Fault::new(format!("{name} is NULL; expected a place for the result")));
    }
    // SAFETY: by contract.
    unsafe { room(name, pointer, 1) }
}

/// A text of C.
///
/// # Safety
/// `pointer` is null or points to a text that ends with 0 (standard, 2.1.2) and that nothing changes meanwhile.
unsafe fn text<'a>(pointer: fmi2String) -> Option<&'a CStr> {
    // SAFETY: not null here, and by contract a text that ends with 0 (standard, 2.1.2).
    (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) })
}

/// The texts of an array.
///
/// # Safety
/// As for [`read`], and each element is null or points to a text that ends with 0 (standard, 2.1.2) and stays meanwhile.
pub unsafe fn texts<'a>(name: &str, pointer: *const fmi2String, count: size_t) -> Result<Vec<&'a str>, Fault> {
    // SAFETY: by contract an array of as many pointers (standard, 2.1.5).
    let pointers = unsafe { read(name, pointer, count) }?;
    pointers
        .iter()
        .map(|&pointer| {
            // SAFETY: by contract null or a text that ends with 0 (standard, 2.1.2).
            let text =
                unsafe { text(pointer) }.ok_or_else(|| Fault::new(format!("{name} holds NULL; expected texts")))?;
            text.to_str().map_err(|_| Fault::new(format!("{name} holds {text:?}; expected UTF-8")))
        })
        .collect()
}

/// `fmi2GetFMUstate`: a new state, or the present one written over the state that `*state` points to.
///
/// # Safety
/// `state` is null or points to null or to a state of this FMU that was not freed (standard, 2.1.8).
pub unsafe fn get_state(instance: &mut Instance, state: *mut fmi2FMUstate) -> Answer {
    // SAFETY: by contract a place that nothing else touches meanwhile (standard, 2.1.8).
    let place = unsafe { place("FMUstate", state) }?;
    // SAFETY: not null (see `place`), and by contract set to null or a state (standard, 2.1.8).
    let saved = unsafe { state.read() }.cast::<Unit>();
    // SAFETY: by contract null or a state that was not freed (standard, 2.1.8); no other call holds a reference to it, since
    // none lasts longer than its call.
    match unsafe { saved.as_mut() } {
        Some(saved) => *saved = instance.unit.clone(),
        None => place.put(Box::into_raw(Box::new(instance.unit.clone())).cast()),
    }
    Ok(Status::Ok)
}

/// A saved state.
///
/// # Safety
/// `state` is null or a state of this FMU that is not freed or written meanwhile (standard, 2.1.8).
pub unsafe fn state<'a>(state: fmi2FMUstate) -> Result<&'a Unit, Fault> {
    // SAFETY: by contract null or a state that lives (standard, 2.1.8).
    unsafe { state.cast::<Unit>().as_ref() }.ok_or_else(|| Fault::new("FMUstate is NULL; expected a saved state"))
}

/// `fmi2FreeFMUstate`: frees the state and forgets the pointer; nothing for null.
///
/// # Safety
/// `state` is null or points to null or to a state of this FMU that was not freed (standard, 2.1.8).
pub unsafe fn free_state(state: *mut fmi2FMUstate) -> Answer {
    if state.is_null() {
        return Ok(Status::Ok);
    }
    // SAFETY: by contract a pointer that is set and that nothing else touches meanwhile (standard, 2.1.8).
    let saved = unsafe { state.replace(std::ptr::null_mut()) }.cast::<Unit>();
    if !saved.is_null() {
        // SAFETY: made from a box by `get_state` or `give_state`, and by contract not freed before (standard, 2.1.8).
        drop(unsafe { Box::from_raw(saved) });
    }
    Ok(Status::Ok)
}

/// Puts a state that was read from bytes where the importer wants it.
pub fn give_state(place: Room<fmi2FMUstate>, unit: Unit) -> Answer {
    place.put(Box::into_raw(Box::new(unit)).cast());
    Ok(Status::Ok)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmi2::types::fmi2CallbackLogger;

    const SILENT: fmi2CallbackFunctions = fmi2CallbackFunctions {
        logger: None,
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        environment: std::ptr::null_mut(),
    };

    fn instance(callbacks: fmi2CallbackFunctions) -> Instance {
        Instance::new(Log::new(Messenger(callbacks), c"block".into(), false), Interface::CoSimulation)
    }

    #[test]
    fn a_panic_is_caught_and_the_instance_refuses_from_then_on() {
        let mut instance = instance(SILENT);
        assert_eq!(guarded(&mut instance, Call::SetReal, |_| panic!("broken")), Status::Fatal);
        assert_eq!(guarded(&mut instance, Call::SetReal, |_| Ok(Status::Ok)), Status::Fatal);
        assert_eq!(guarded(&mut instance, Call::Reset, Instance::reset), Status::Fatal);
    }

    /// Of a host that shares this library's Rust runtime; others are tests/abi/callbacks.rs's.
    #[test]
    fn a_panic_of_the_logger_is_caught_too() {
        unsafe extern "C-unwind" fn panicking() {
            panic!("broken logger");
        }
        // SAFETY: a function that looks at no argument can be called with any.
        let logger: fmi2CallbackLogger = unsafe { std::mem::transmute(panicking as *const ()) };
        let mut instance = instance(fmi2CallbackFunctions { logger: Some(logger), ..SILENT });
        assert_eq!(guarded(&mut instance, Call::SetReal, |_| Err(Fault::new("refused"))), Status::Fatal);
        assert_eq!(guarded(&mut instance, Call::SetReal, |_| Ok(Status::Ok)), Status::Fatal);
    }

    #[test]
    fn the_reason_of_a_panic_is_told() {
        let text = catch_unwind(|| panic!("reason {}", 7)).unwrap_err();
        assert_eq!(panic_reason(text.as_ref()), "reason 7");
        let literal = catch_unwind(|| panic!("reason")).unwrap_err();
        assert_eq!(panic_reason(literal.as_ref()), "reason");
    }

    /// A call within a call is refused, one after it is not, and an instance in use is not freed.
    #[test]
    fn calls_take_turns() {
        let outer = Outer { busy: AtomicBool::new(false), instance: instance(SILENT) };
        let component: fmi2Component = Box::into_raw(Box::new(outer)).cast();
        for _ in 0..2 {
            // SAFETY: made as `instantiate` does, and freed only below.
            let status = unsafe {
                call(component, Call::SetReal, |_| {
                    assert_eq!(call(component, Call::SetReal, |_| panic!("reached")), Status::Error.code());
                    free_instance(component);
                    assert_eq!(call(component, Call::SetReal, |_| panic!("reached")), Status::Error.code());
                    Ok(Status::Ok)
                })
            };
            assert_eq!(status, Status::Ok.code());
        }
        // SAFETY: not used any more.
        unsafe { free_instance(component) };
    }

    /// Whatever shares memory with the room is read before it is written.
    #[test]
    fn arrays_may_overlap() {
        let mut memory = [1.0, 2.0, 3.0, 4.0, 5.0];
        let start = memory.as_mut_ptr();
        for shift in [0, 1, 2] {
            memory = [1.0, 2.0, 3.0, 4.0, 5.0];
            let start = memory.as_mut_ptr();
            // SAFETY: within the memory.
            let mut room = unsafe { room("room", start.add(shift), 5 - shift) }.unwrap();
            // SAFETY: as before.
            let array = unsafe { room.read_beside("array", start.cast_const(), 5 - shift) }.unwrap();
            assert!(matches!(array, Cow::Owned(_)));
            room.places().iter_mut().zip(array.iter()).for_each(|(place, &value)| _ = place.write(10.0 * value));
            let tenfold: Vec<f64> = (1..=5 - shift).map(|i| 10.0 * i as f64).collect();
            assert_eq!(memory[shift..], tenfold);
        }
        // SAFETY: two parts of the memory that touch and do not overlap.
        let array = unsafe {
            let room = room("room", start.add(2), 3).unwrap();
            room.read_beside("array", start.cast_const(), 2).unwrap()
        };
        assert!(matches!(array, Cow::Borrowed([..])));
    }

    #[test]
    fn what_cannot_be_an_array_is_refused() {
        let number = 1.0_f64;
        let pointer = &raw const number;
        let refuse = |pointer: *const f64, count, words: &str| {
            let fault = usable("value", pointer, count).unwrap_err();
            assert!(fault.0.contains(words), "{fault}");
        };
        refuse(std::ptr::null(), 1, "value is NULL; expected 1 elements");
        refuse(pointer.wrapping_byte_add(4), 1, "expected a multiple of 8");
        refuse(pointer, usize::MAX / 8, "expected what fits into memory");
        usable("value", pointer, isize::MAX as usize / 8).unwrap();
    }
}
