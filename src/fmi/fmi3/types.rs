//! The C types of the standard's headers (fmi3PlatformTypes.h, fmi3FunctionTypes.h, version 3.0.1).

#![allow(non_camel_case_types, reason = "the names are the standard's")]

use std::ffi::{c_char, c_int, c_void};

pub use crate::fmi::Status;

/// The importer's handle of an instance.
pub type fmi3Instance = *mut c_void;
/// The importer's own pointer, passed back with each callback.
pub type fmi3InstanceEnvironment = *mut c_void;
/// The importer's handle of a saved state.
pub type fmi3FMUState = *mut c_void;
/// Value reference of a variable.
pub type fmi3ValueReference = u32;
/// A real number.
pub type fmi3Float64 = f64;
/// A real number of single precision; no variable here has this type.
pub type fmi3Float32 = f32;
/// An integer; no variable here has this type.
pub type fmi3Int8 = i8;
/// An integer; no variable here has this type.
pub type fmi3UInt8 = u8;
/// An integer; no variable here has this type.
pub type fmi3Int16 = i16;
/// An integer; no variable here has this type.
pub type fmi3UInt16 = u16;
/// An integer.
pub type fmi3Int32 = i32;
/// An integer; no variable here has this type.
pub type fmi3UInt32 = u32;
/// An item of an enumeration.
pub type fmi3Int64 = i64;
/// The size of an array.
pub type fmi3UInt64 = u64;
/// `bool` of C, one byte. Any byte may come in, so it is not a `bool` in Rust; 0 is false.
pub type fmi3Boolean = u8;
/// A tick of a clock; no variable here has this type.
pub type fmi3Clock = u8;
/// A character.
pub type fmi3Char = c_char;
/// A string that ends with 0.
pub type fmi3String = *const fmi3Char;
/// A byte of a serialized state.
pub type fmi3Byte = u8;
/// Bytes; no variable here has this type.
pub type fmi3Binary = *const fmi3Byte;
/// An enumeration that goes out to C.
pub type fmi3Status = c_int;
/// `fmi3DependencyKind`.
pub type fmi3DependencyKind = c_int;
/// `fmi3IntervalQualifier`, of clocks.
pub type fmi3IntervalQualifier = c_int;

/// Yes.
pub const FMI3_TRUE: fmi3Boolean = 1;
/// No.
pub const FMI3_FALSE: fmi3Boolean = 0;

/// `fmi3Dependent` of `fmi3DependencyKind`.
pub const FMI3_DEPENDENT: fmi3DependencyKind = 5;

/// The importer's logger. It should not unwind, but unwinding is not undefined behaviour; see [`crate::fmi::boundary`].
pub type fmi3LogMessageCallback = unsafe extern "C-unwind" fn(
    environment: fmi3InstanceEnvironment,
    status: fmi3Status,
    category: fmi3String,
    message: fmi3String,
);

/// The importer's intermediate update; see the standard, 4.2.2 (Intermediate Update Mode).
pub type fmi3IntermediateUpdateCallback = unsafe extern "C-unwind" fn(
    environment: fmi3InstanceEnvironment,
    time: fmi3Float64,
    set_requested: fmi3Boolean,
    get_allowed: fmi3Boolean,
    step_finished: fmi3Boolean,
    can_return_early: fmi3Boolean,
    early_return_requested: *mut fmi3Boolean,
    early_return_time: *mut fmi3Float64,
);

/// Of Scheduled Execution; never called.
pub type fmi3ClockUpdateCallback = unsafe extern "C-unwind" fn(environment: fmi3InstanceEnvironment);

/// Of Scheduled Execution; never called.
pub type fmi3PreemptionCallback = unsafe extern "C-unwind" fn();
