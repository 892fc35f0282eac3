//! An instance of FMI 3.0 behind a resource: arguments and results without pointers, callbacks as imports.

use std::ffi::{CStr, CString, c_char};
use std::mem::MaybeUninit;

use rocking_block::fmi::fmi3::boundary::{self, Request, Stepping};
use rocking_block::fmi::fmi3::calls::Call;
use rocking_block::fmi::fmi3::instance::Answer;
use rocking_block::fmi::fmi3::types::*;
use rocking_block::unit::fault::Fault;
pub use rocking_block::unit::instance::Unit as State;

use crate::bindings::fmi::fmi3::callbacks::log_message;
use crate::bindings::fmi::fmi3::types::{DiscreteStatesInfo, Status};

/// The instance of the C interface.
pub type Unit = rocking_block::fmi::fmi3::instance::Instance<State>;

/// An instance, freed when the importer drops the resource.
pub struct Instance {
    handle: fmi3Instance,
    /// The name, to which the environment of the callbacks points.
    _name: Box<CString>,
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: a live instance, which is not used after this (standard, 2.3.1).
        unsafe { boundary::free_instance::<State>(self.handle) }
    }
}

impl Instance {
    /// Makes an instance: for Co-Simulation with `stepping`, otherwise for Model Exchange.
    pub fn new(
        function: &str,
        name: String,
        token: String,
        logging: bool,
        stepping: Option<Stepping>,
    ) -> Option<Instance> {
        let text = |argument: &str, text: String| {
            CString::new(text).map_err(|error| {
                let message = format!("{function}: {argument} holds a 0 at {}; expected none", error.nul_position());
                log_message("?", Status::Error, "logStatusError", &message);
            })
        };
        let name = Box::new(text("instance-name", name).ok()?);
        let token = text("instantiation-token", token).ok()?;
        let request = Request {
            name: name.as_ptr(),
            token: token.as_ptr(),
            logging: logging.into(),
            environment: (&raw const *name).cast_mut().cast(),
            logger: Some(log),
        };
        // SAFETY: the texts end with 0. The logger may be called with the environment, a box that is dropped after the instance; the
        // contract of `stepping` is its maker's (standard, 2.3.1).
        let handle = unsafe { boundary::instantiate::<State>(function, &request, stepping) };
        (!handle.is_null()).then_some(Instance { handle, _name: name })
    }

    /// Runs a call, and turns faults into a status and a message.
    pub fn call(&self, call: Call, act: impl FnOnce(&mut Unit) -> Answer) -> Status {
        // SAFETY: a live instance (standard, 2.3.1).
        status(unsafe { boundary::call(self.handle, call, act) })
    }

    /// Runs a call that returns a result.
    pub fn ask<T>(&self, call: Call, act: impl FnOnce(&mut Unit) -> Result<T, Fault>) -> Result<T, Status> {
        let mut result = None;
        let status = self.call(call, |unit| {
            result = Some(act(unit)?);
            Ok(rocking_block::fmi::Status::Ok)
        });
        result.ok_or(status)
    }

    /// Runs a call that writes `count` values.
    pub fn get<T: Copy + Default>(
        &self,
        call: Call,
        count: impl FnOnce(&Unit) -> usize,
        act: impl FnOnce(&mut Unit, &mut [MaybeUninit<T>]) -> Answer,
    ) -> Result<Vec<T>, Status> {
        let mut values = Vec::new();
        let status = self.call(call, |unit| {
            let count = count(unit);
            let room = values.try_reserve_exact(count);
            room.map_err(|_| Fault::new(format!("{count} values; expected a number that fits into memory")))?;
            values.resize(count, MaybeUninit::new(T::default()));
            act(unit, &mut values)
        });
        match status {
            // SAFETY: all are initialized from the beginning.
            Status::Ok | Status::Warning => Ok(values.iter().map(|value| unsafe { value.assume_init() }).collect()),
            Status::Discard | Status::Error | Status::Fatal => Err(status),
        }
    }

    /// Applies an event.
    pub fn update(&self) -> Result<DiscreteStatesInfo, Status> {
        self.ask(Call::UpdateDiscreteStates, |unit| {
            let after = unit.update_discrete_states()?;
            Ok(DiscreteStatesInfo {
                new_discrete_states_needed: false,
                terminate_simulation: after.ended,
                nominals_of_continuous_states_changed: false,
                values_of_continuous_states_changed: after.states_changed,
                next_event_time_defined: after.next_time.is_some(),
                next_event_time: after.next_time.unwrap_or(0.0),
            })
        })
    }

    /// Refuses a call that is never legal.
    pub fn refuse(&self, call: Call) -> Status {
        self.call(call, |_| Err(Fault::new("not offered")))
    }

    #[cfg(not(feature = "model-exchange"))]
    pub fn handle(&self) -> fmi3Instance {
        self.handle
    }
}

/// Returns the status with a number of the standard.
pub fn status(code: fmi3Status) -> Status {
    match code {
        0 => Status::Ok,
        1 => Status::Warning,
        2 => Status::Discard,
        3 => Status::Error,
        _ => Status::Fatal,
    }
}

/// `fmi3LogMessageCallback`: passes a message to the importer.
unsafe extern "C-unwind" fn log(
    environment: fmi3InstanceEnvironment,
    code: fmi3Status,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: the environment is the name that the instance keeps, and the texts end with 0 (standard, 2.3.1).
    let [name, category, message] = unsafe {
        [(*environment.cast::<CString>()).as_c_str(), CStr::from_ptr(category), CStr::from_ptr(message)]
            .map(CStr::to_string_lossy)
    };
    log_message(&name, status(code), &category, &message);
}
