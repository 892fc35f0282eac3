//! The common part of the C interfaces: an instance with its statuses and messages, pointers → slices, panics → a status.
//!
//! A [`Version`] adds the functions of its standard: the table of calls, callbacks and types.

pub mod arrays;
pub mod boundary;
pub mod calls;
pub mod fmi2;
pub mod fmi3;
pub mod instance;
pub mod log;
mod status;

use crate::fmi::calls::Call;
use crate::fmi::log::Messenger;
use crate::unit::fmu::Fmu;
use crate::unit::life_cycle::{Interface, Phase};
pub use status::Status;

/// The type of the standard's counts; the crate `libc` has none for WebAssembly.
#[allow(non_camel_case_types, reason = "the name is that of C")]
pub type size_t = usize;

/// A version of the standard, and the fields that it adds to an instance.
pub trait Version {
    /// The unit behind the interface.
    type Unit: Fmu;
    /// The functions that act on an instance.
    type Call: Call;
    /// The importer's logger.
    type Messenger: Messenger;

    /// Returns the states that instances of this interface type reach, as bits of [`Phase`].
    fn reached(interface: Interface) -> u16;

    /// Returns the standard's name of a state.
    fn state(phase: Phase) -> &'static str;

    /// Returns the reason why a function is never legal.
    fn missing(call: Self::Call) -> &'static str;
}
