//! What the C interfaces of all versions of FMI share: an instance with its answers and messages, pointers → slices,
//! panics → a status.
//!
//! A [`Version`] adds the functions of its standard: their table of calls, its callbacks, its types.

pub mod arrays;
pub mod boundary;
pub mod fmi2;
pub mod fmi3;
pub mod instance;
pub mod log;

use crate::fmi::log::Messenger;
use crate::unit::instance::Interface;
use crate::unit::life_cycle::Phase;

/// A version of the standard, and what an instance has of it alone.
pub trait Version {
    /// The functions that act on an instance.
    type Call: Call;
    /// The importer's logger.
    type Messenger: Messenger;
}

/// A function of the interface that acts on an instance.
pub trait Call: Copy {
    /// Its name in the standard.
    fn name(self) -> &'static str;

    /// Whether the state of an instance for this interface allows the call; if not, a sentence that says what would.
    fn admitted_in(self, phase: Phase, interface: Interface) -> Result<(), String>;

    /// Whether calls lead an instance for this interface into this state.
    fn lead_to(phase: Phase, interface: Interface) -> bool;
}

/// What a call answers; the numbers are the same in all versions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(i32)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// Done, and something is to be looked at.
    Warning = 1,
    /// Not done, or not to the end; the instance can be read.
    Discard = 2,
    /// Refused or failed.
    Error = 3,
    /// The instance is unusable.
    Fatal = 4,
}

impl Status {
    /// The number of the standard.
    pub fn code(self) -> libc::c_int {
        self as libc::c_int
    }
}
