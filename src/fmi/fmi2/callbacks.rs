//! FMI 2.0: the importer's logger.

use std::ffi::CStr;

use crate::fmi::fmi2::types::{Status, fmi2CallbackFunctions};
use crate::fmi::log::{self, Category, Wanted};

/// The importer's logger and its environment.
#[derive(Debug)]
pub struct Messenger(fmi2CallbackFunctions);

impl Messenger {
    /// Takes the callbacks of the importer.
    ///
    /// # Safety
    /// The logger, if any, is a function of the standard's type (2.1.5), and may be called with `environment` during the life of
    /// this value.
    pub unsafe fn new(callbacks: fmi2CallbackFunctions) -> Messenger {
        Messenger(callbacks)
    }
}

impl log::Messenger for Messenger {
    /// A message is the format of `printf`, and a single `#` would begin a variable's number (standard, 2.1.3).
    const DOUBLED: &[char] = &['%', '#'];

    /// With `logging`, the listed categories, or all; otherwise warnings and errors.
    ///
    /// The switch of FMI 2.0 is for debug logging (standard, 2.1.5), and only discarded steps are messages of the debug mode
    /// (2.1.3).
    fn wanted(_: Wanted, logging: bool, listed: Option<&[Category]>) -> Wanted {
        Category::ALL.map(|category| match (logging, listed) {
            (true, None) => true,
            (true, Some(listed)) => listed.contains(&category),
            (false, _) => !category.is_of_debugging(),
        })
    }

    /// Passes the message as a format without arguments. Loggers that cannot read variadic arguments, as of ctypes or C#, show it, too.
    fn send(&self, instance: &CStr, status: Status, category: &CStr, message: &CStr) {
        let Messenger(fmi2CallbackFunctions { logger, environment, .. }) = *self;
        if let Some(logger) = logger {
            let (instance, category, message) = (instance.as_ptr(), category.as_ptr(), message.as_ptr());
            // SAFETY: by the contract of `new` the importer's logger, which takes these arguments and those that the format asks for,
            // none, since each `%` stands twice (standard, 2.1.5); all strings end with 0 and outlive the call. The instance is in use meanwhile, but calls of
            // the logger on it are refused before they access it; see [`crate::fmi::boundary`].
            unsafe { logger(environment, instance, status.code(), category, message) };
        }
    }
}
