//! The result of a call, as a number that all versions share.

use std::ffi::c_int;

/// Status of a call. The numbers are the same in all versions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(i32)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// Done, with a message for the user.
    Warning = 1,
    /// Not done, or only in part; the instance can be read.
    Discard = 2,
    /// Refused or failed.
    Error = 3,
    /// The instance is unusable.
    Fatal = 4,
}

impl Status {
    /// Returns the number in the standard.
    pub fn code(self) -> c_int {
        self as c_int
    }
}
