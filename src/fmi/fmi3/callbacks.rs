//! FMI 3.0: the importer's logger and its intermediate updates.

use std::ffi::CStr;

use crate::fmi::fmi3::types::*;
use crate::fmi::log::{self, Category, Wanted};

/// The importer's logger and its environment.
#[derive(Debug)]
pub struct Messenger {
    logger: Option<fmi3LogMessageCallback>,
    environment: fmi3InstanceEnvironment,
}

impl Messenger {
    /// Takes the logger of the importer, if any.
    ///
    /// # Safety
    /// The logger, if any, may be called with `environment` during the life of this value (standard, 2.3.1).
    pub unsafe fn new(logger: Option<fmi3LogMessageCallback>, environment: fmi3InstanceEnvironment) -> Messenger {
        Messenger { logger, environment }
    }
}

impl log::Messenger for Messenger {
    /// A single `#` would begin a variable's number (standard, 2.3.1).
    const DOUBLED: &[char] = &['#'];

    /// Switches the listed categories, or all. Without `logging` warnings and errors remain, as in FMI 2.0, unless they are listed: the
    /// switch is for debug logging (standard, 2.3.1).
    fn wanted(before: Wanted, logging: bool, listed: Option<&[Category]>) -> Wanted {
        Category::ALL.map(|category| match listed {
            Some(listed) if !listed.contains(&category) => before[category as usize],
            Some(_) => logging,
            None => logging || !category.is_of_debugging(),
        })
    }

    fn send(&self, _: &CStr, status: Status, category: &CStr, message: &CStr) {
        if let Some(logger) = self.logger {
            // SAFETY: by the contract of `new` the importer's logger, which may be called (standard, 2.3.1); both strings
            // end with 0 and outlive the call. The instance is in use meanwhile, but calls of the logger on it are
            // refused before they access it; see [`crate::fmi::boundary`].
            unsafe { logger(self.environment, status.code(), category.as_ptr(), message.as_ptr()) };
        }
    }
}

/// The importer's callback for intermediate updates and its environment.
#[derive(Clone, Copy, Debug)]
pub struct Updater {
    callback: fmi3IntermediateUpdateCallback,
    environment: fmi3InstanceEnvironment,
}

impl Updater {
    /// Takes the callback of the importer.
    ///
    /// # Safety
    /// The callback may be called with `environment` during the life of this value and its copies (standard, 2.3.1).
    pub unsafe fn new(callback: fmi3IntermediateUpdateCallback, environment: fmi3InstanceEnvironment) -> Updater {
        Updater { callback, environment }
    }

    /// Calls the importer's `intermediateUpdate`.
    pub fn call(update: IntermediateUpdate) -> UpdateReply {
        let IntermediateUpdate { updater, time, requests_inputs, can_return_early } = update;
        let Updater { callback, environment } = updater;
        let (mut requested, mut return_time) = (FMI3_FALSE, time);
        // SAFETY: by the contract of `new` the importer's function, which may be called (standard, 2.3.1); both results are initialized.
        // Calls on the instance are admitted meanwhile, and there is no reference to it; see `crate::fmi::boundary::call_in_pieces`.
        unsafe {
            callback(
                environment,
                time,
                requests_inputs.into(),
                (!requests_inputs).into(),
                (!requests_inputs).into(),
                (can_return_early && !requests_inputs).into(),
                &raw mut requested,
                &raw mut return_time,
            );
        }
        let returns = is_true(requested) && can_return_early && !requests_inputs;
        UpdateReply { early_return: returns.then_some(return_time) }
    }
}

/// An intermediate update: the importer sets inputs or reads outputs inside a step.
#[derive(Clone, Copy, Debug)]
pub struct IntermediateUpdate {
    /// The importer's callback.
    pub updater: Updater,
    /// Its time (s).
    pub time: f64,
    /// Whether inputs at this time are requested. Otherwise the time has been reached, and outputs can be read.
    pub requests_inputs: bool,
    /// Whether the step may be left.
    pub can_return_early: bool,
}

/// The importer's answer.
#[derive(Clone, Copy, Debug)]
pub struct UpdateReply {
    /// The time at which it wants to leave the step (s).
    pub early_return: Option<f64>,
}

/// Whether a Boolean of C is true.
pub fn is_true(value: fmi3Boolean) -> bool {
    value != FMI3_FALSE
}
