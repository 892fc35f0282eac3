//! The common part of the C interfaces: an instance with its statuses and messages, pointers → slices, panics → a status.
//!
//! A [`Version`] adds the functions of its standard: the table of calls, callbacks and types.

pub mod arrays;
pub mod boundary;
pub mod fmi2;
pub mod fmi3;
pub mod instance;
pub mod log;
mod status;

use crate::fmi::log::Messenger;
use crate::unit::instance::Interface;
use crate::unit::life_cycle::Phase;
pub use status::Status;

/// The type of the standard's counts; the crate `libc` has none for WebAssembly.
#[allow(non_camel_case_types, reason = "the name is that of C")]
pub type size_t = usize;

/// A version of the standard, and the fields that it adds to an instance.
pub trait Version {
    /// The functions that act on an instance.
    type Call: Call;
    /// The importer's logger.
    type Messenger: Messenger;
}

/// A function of the interface that acts on an instance.
pub trait Call: Copy {
    /// Returns its name in the standard.
    fn name(self) -> &'static str;

    /// Refuses a call that is illegal in this state.
    ///
    /// # Errors
    /// The states in which the call is legal.
    fn admitted_in(self, phase: Phase, interface: Interface) -> Result<(), String>;

    /// Whether an instance of this interface type can reach this state.
    fn lead_to(phase: Phase, interface: Interface) -> bool;
}
