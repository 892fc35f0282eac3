//! Pointers from C → references; panics and faults → a status and a message. For all versions of FMI.
//!
//! Pointers are handled only here, in [`arrays`](crate::fmi::arrays), and in the `boundary` of each version. Section numbers are
//! those of FMI 2.0.4 unless 3.0.1 is named. The importer's obligations by the standards:
//!
//! - an instance is used only between instantiation and `FreeInstance` (2.1.5; 3.0.1, 2.3.1), and by one thread at a time;
//! - arrays have the given number of elements (2.1.7; 3.0.1, 2.2.6), strings end with 0 (2.1.2; 3.0.1, 2.2.1), and neither
//!   changes during a call;
//! - a saved state was made by this FMU and has not been freed (2.1.8; 3.0.1, 2.2.7).
//!
//! Handled here:
//!
//! - **Calls within a call.** The logger may call functions of an instance that is in use. Such a call returns the error status
//!   without a message and changes nothing; freeing does nothing. Only the intermediate updates of FMI 3.0 admit calls; see
//!   [`call_in_pieces`]. A call by another thread meanwhile is refused likewise, but two threads that begin a call at the same moment
//!   are not told apart: that would take a read-modify-write operation in each call, and 8 % of the time of a short step.
//! - **Uninitialized memory.** Results go into [`OutputArray`]s, which are never read.
//! - **Overlapping arrays,** such as a direction and its sensitivities in one array: inputs are read before results are
//!   written.
//! - **Panics** are caught, and the instance refuses every later call.
//!
//! **Exceptions** must not leave a callback, since C has none. One that does (of C++, or a panic of a Rust host) is not undefined
//! behaviour, since callbacks are called as `extern "C-unwind"` and unwinding is caught here: it ends the process with a message
//! or, if the library and the host share a Rust runtime, makes the instance unusable. A `longjmp` out of a callback is undefined
//! behaviour and forbidden: it would skip the clean-up of the frames in between.

use std::ffi::c_void;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU8, Ordering};

use crate::fmi::arrays::{OutputArray, single_output};
use crate::fmi::calls::Call;
use crate::fmi::instance::{Answer, Instance};
use crate::fmi::{Status, Version};
use crate::unit::fault::Fault;
use crate::unit::fmu::Fmu;
use crate::unit::life_cycle::Phase;

/// No call is in progress.
const FREE: u8 = 0;
/// A call has the instance.
const BUSY: u8 = 1;
/// A step is in progress and has released the instance for an intermediate update.
const RELEASED: u8 = 2;

/// The target of the importer's handle.
struct Outer<V: Version> {
    /// [`FREE`], [`BUSY`] or [`RELEASED`]. The only field that a call reads while another one is in progress.
    turn: AtomicU8,
    instance: Instance<V>,
}

/// The right to use an instance, for one call at a time.
struct Turn<'a> {
    turn: &'a AtomicU8,
    /// Its value after this call.
    after: u8,
}

impl Turn<'_> {
    /// Takes the turn, or returns `None` if it is in none of the states `from`.
    #[inline]
    fn take<'a>(turn: &'a AtomicU8, from: &[u8]) -> Option<Turn<'a>> {
        let after = turn.load(Ordering::Acquire);
        from.contains(&after).then(|| {
            turn.store(BUSY, Ordering::Relaxed);
            Turn { turn, after }
        })
    }

    /// Runs `act` while other calls may use the instance.
    ///
    /// Waits for a call that another thread has not ended by then, which no standard allows.
    fn release<R>(&self, act: impl FnOnce() -> R) -> R {
        self.turn.store(RELEASED, Ordering::Release);
        let result = act();
        while self.turn.load(Ordering::Acquire) != RELEASED {
            std::hint::spin_loop();
        }
        self.turn.store(BUSY, Ordering::Relaxed);
        result
    }
}

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        self.turn.store(self.after, Ordering::Release);
    }
}

/// Runs a call on an instance after checks of handle, turn and state. Faults and panics become a status and a message.
///
/// # Safety
/// `handle` is null or comes from [`create`] for the same version and has not been freed. One thread at a time calls.
pub unsafe fn call<V: Version>(
    handle: *mut c_void,
    call: V::Call,
    act: impl FnOnce(&mut Instance<V>) -> Answer,
) -> Status {
    let outer = handle.cast::<Outer<V>>();
    if outer.is_null() {
        return Status::Error;
    }
    // SAFETY: not null, so by contract a live instance (standard, 2.1.5). The reference is to `turn` alone, which all calls
    // share and never borrow mutably.
    let turn = unsafe { &(*outer).turn };
    let Some(_turn) = Turn::take(turn, &[FREE, RELEASED]) else { return Status::Error };
    // SAFETY: as before; until `_turn` is dropped, neither a call within this one nor `free` gets this far, and by contract no other
    // thread calls now, so that this is the only reference to the field `instance`.
    let instance = unsafe { &mut (*outer).instance };
    guarded(instance, call, act)
}

/// Runs a call in pieces, each as [`call`] does.
///
/// `piece` ends the call or makes a request, which `between` answers. The instance is not borrowed during `between`, so that
/// other calls are admitted if its state allows them.
///
/// # Safety
/// As for [`call`].
pub unsafe fn call_in_pieces<V: Version, Request, Reply>(
    handle: *mut c_void,
    call: V::Call,
    mut piece: impl FnMut(&mut Instance<V>, Option<Reply>) -> Result<ControlFlow<Status, Request>, Fault>,
    between: impl Fn(Request) -> Reply,
) -> Status {
    let outer = handle.cast::<Outer<V>>();
    if outer.is_null() {
        return Status::Error;
    }
    // SAFETY: as in `call`.
    let turn = unsafe { &(*outer).turn };
    let Some(turn) = Turn::take(turn, &[FREE, RELEASED]) else { return Status::Error };
    let mut reply = None;
    let mut admitted = false;
    loop {
        let mut requested = None;
        // SAFETY: as in `call`; this reference is dropped before the turn is released below.
        let instance = unsafe { &mut (*outer).instance };
        let act = |instance: &mut Instance<V>| {
            Ok(match piece(instance, reply.take())? {
                ControlFlow::Break(status) => status,
                ControlFlow::Continue(request) => {
                    requested = Some(request);
                    Status::Ok
                }
            })
        };
        // From the second piece on, the state is that of an intermediate update, where the call itself is illegal.
        let status = if admitted { guarded_always(instance, call, act) } else { guarded(instance, call, act) };
        admitted = true;
        let Some(requested) = requested else { return status };
        match turn.release(|| catch_unwind(AssertUnwindSafe(|| between(requested)))) {
            Ok(answer) => reply = Some(answer),
            Err(panic) => {
                let failed = |_: &mut Instance<V>| -> Answer { std::panic::resume_unwind(panic) };
                // SAFETY: as above.
                return guarded_always(unsafe { &mut (*outer).instance }, call, failed);
            }
        }
    }
}

/// Runs `act` if the state allows the call, and catches panics.
pub(crate) fn guarded<V: Version>(
    instance: &mut Instance<V>,
    call: V::Call,
    act: impl FnOnce(&mut Instance<V>) -> Answer,
) -> Status {
    guarded_always(instance, call, |instance| {
        instance.admit(call)?;
        act(instance)
    })
}

/// Runs `act` and catches panics.
fn guarded_always<V: Version>(
    instance: &mut Instance<V>,
    call: V::Call,
    act: impl FnOnce(&mut Instance<V>) -> Answer,
) -> Status {
    if instance.is_fatal() {
        return Status::Fatal;
    }
    match catch_unwind(AssertUnwindSafe(|| act(instance))) {
        Ok(Ok(status)) => status,
        Ok(Err(fault)) => failed(instance, call, Ok(fault)),
        Err(panic) => failed(instance, call, Err(panic)),
    }
}

/// Logs a fault or a panic and returns its status. Not generic over the call, so that it is compiled once for each version.
#[cold]
fn failed<V: Version>(instance: &mut Instance<V>, call: V::Call, reason: std::thread::Result<Fault>) -> Status {
    let (status, message) = match reason {
        Ok(Fault(message)) => (Status::Error, message),
        Err(panic) => {
            instance.unit.set_phase(Phase::Fatal);
            (Status::Fatal, format!("internal error: {}", panic_reason(panic.as_ref())))
        }
    };
    let logged = catch_unwind(AssertUnwindSafe(|| {
        instance.log.status(status, &format!("{}: {message}", call.name()));
    }));
    match logged {
        Ok(()) => status,
        // The logger panicked.
        Err(_) => {
            instance.unit.set_phase(Phase::Fatal);
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

/// Makes an instance's handle, or null if `make` refuses or panics.
pub fn create<V: Version>(make: impl FnOnce() -> Option<Instance<V>>) -> *mut c_void {
    let created = catch_unwind(AssertUnwindSafe(|| {
        make().map(|instance| Box::new(Outer { turn: AtomicU8::new(FREE), instance }))
    }));
    match created {
        Ok(Some(outer)) => Box::into_raw(outer).cast(),
        Ok(None) | Err(_) => std::ptr::null_mut(),
    }
}

/// Frees an instance. Does nothing for null or from within a call on the instance.
///
/// # Safety
/// As for [`call`]; unless a call is in progress, the handle is invalid afterwards.
pub unsafe fn free<V: Version>(handle: *mut c_void) {
    let outer = handle.cast::<Outer<V>>();
    if outer.is_null() {
        return;
    }
    // SAFETY: not null, so by contract a live instance (standard, 2.1.5); as in `call`, a reference to `turn` alone.
    let Some(turn) = Turn::take(unsafe { &(*outer).turn }, &[FREE]) else { return };
    // The turn is not returned: it is freed with the instance.
    std::mem::forget(turn);
    // SAFETY: `create` made it from a box, no call is in progress, and by contract none follows (standard, 2.1.5).
    drop(unsafe { Box::from_raw(outer) });
}

/// Saves the state: as a new one, or over the state that `*state` points to.
///
/// # Safety
/// `state` is null or points to null or to a state of this FMU that has not been freed (standard, 2.1.8).
///
/// # Errors
/// `state` is null.
pub unsafe fn get_state<V: Version>(instance: &Instance<V>, state: *mut *mut c_void) -> Answer {
    // SAFETY: by contract memory that nothing else uses meanwhile (standard, 2.1.8).
    let output = unsafe { single_output("FMUstate", state) }?;
    // SAFETY: not null (see `single_output`), and by contract set to null or a state (standard, 2.1.8).
    let saved = unsafe { state.read() }.cast::<V::Unit>();
    // SAFETY: by contract null or a state that has not been freed (standard, 2.1.8); no other call holds a reference to it, since
    // no reference outlives its call.
    match unsafe { saved.as_mut() } {
        Some(saved) => *saved = instance.unit.clone(),
        None => output.put(Box::into_raw(Box::new(instance.unit.clone())).cast()),
    }
    Ok(Status::Ok)
}

/// Returns a saved state.
///
/// # Safety
/// `state` is null or a state of this FMU that is not freed or written meanwhile (standard, 2.1.8).
///
/// # Errors
/// `state` is null.
pub unsafe fn state<'a, U: Fmu>(state: *mut c_void) -> Result<&'a U, Fault> {
    // SAFETY: by contract null or a live state (standard, 2.1.8).
    unsafe { state.cast::<U>().as_ref() }.ok_or_else(|| Fault::new("FMUstate is NULL; expected a saved state"))
}

/// Frees a state and sets its pointer to null. Does nothing for null.
///
/// # Safety
/// `state` is null or points to null or to a state of this FMU that has not been freed (standard, 2.1.8).
pub unsafe fn free_state<U: Fmu>(state: *mut *mut c_void) -> Status {
    if state.is_null() {
        return Status::Ok;
    }
    // SAFETY: by contract an initialized pointer that nothing else uses meanwhile (standard, 2.1.8).
    let saved = unsafe { state.replace(std::ptr::null_mut()) }.cast::<U>();
    if !saved.is_null() {
        // SAFETY: `get_state` or `give_state` made it from a box, and by contract it has not been freed (standard, 2.1.8).
        drop(unsafe { Box::from_raw(saved) });
    }
    Status::Ok
}

/// Writes the pointer of a deserialized state to the importer's memory.
pub fn give_state<U: Fmu>(output: OutputArray<*mut c_void>, unit: U) -> Status {
    output.put(Box::into_raw(Box::new(unit)).cast());
    Status::Ok
}

#[cfg(test)]
mod tests;
