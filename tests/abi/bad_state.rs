//! Refused serialized states: an error, and an unchanged instance.

use std::ffi::c_char;
use std::ptr::null_mut;

use crate::functions::*;
use crate::host::{Instance, call};

fn rocking() -> Instance {
    let instance = Instance::new("block");
    instance.set("initial.theta", 0.1);
    instance.initialize(None);
    instance.go(0.0, 1.0, 0.1);
    instance
}

fn bytes_of(instance: &Instance) -> Vec<c_char> {
    let state = instance.save();
    let bytes = instance.serialize(state);
    instance.free(state);
    bytes
}

#[track_caller]
fn refused(instance: &Instance, bytes: &[c_char], words: &[&str]) {
    let mut state = null_mut();
    let status = call!(instance, deserialize, bytes.as_ptr(), bytes.len(), &mut state);
    instance.refuses(status, words);
    assert!(state.is_null());
}

#[test]
fn cut_bytes_are_refused() {
    let instance = rocking();
    let (bytes, before) = (bytes_of(&instance), instance.bits());
    for length in (0..bytes.len()).step_by(13).chain([1, 7, 8, bytes.len() - 1]) {
        refused(&instance, &bytes[..length], &["fmi2DeSerializeFMUstate", "serialized state refused"]);
    }
    assert_eq!(instance.bits(), before);
    assert_eq!(bytes_of(&instance), bytes);
}

/// Flips one bit, or all bits, of each byte in turn.
#[test]
fn altered_bytes_are_refused() {
    let instance = rocking();
    let (bytes, before) = (bytes_of(&instance), instance.bits());
    for position in 0..bytes.len() {
        for turned in [1 << (position % 8), 0xff_u8] {
            let mut altered = bytes.clone();
            altered[position] ^= turned.cast_signed();
            refused(&instance, &altered, &["fmi2DeSerializeFMUstate", "serialized state refused"]);
        }
    }
    assert_eq!(instance.bits(), before);
    assert_eq!(bytes_of(&instance), bytes);
}

#[test]
fn foreign_bytes_are_refused() {
    let instance = rocking();
    for bytes in [&[0; 4096][..], &[-1; 4096], &[0x7f; 3]] {
        refused(&instance, bytes, &["serialized state refused"]);
    }
    let status = call!(instance, deserialize, std::ptr::null(), 100, &mut null_mut());
    instance.refuses(status, &["serializedState", "NULL"]);
}

/// The version follows the magic number; the error names a later one.
#[test]
fn another_version_is_refused() {
    let instance = rocking();
    let mut bytes = bytes_of(&instance);
    let version = bytes[8];
    bytes[8] += 1;
    refused(&instance, &bytes, &[&format!("version {}", version + 1), &format!("expected {version}")]);
}

#[test]
fn too_little_room_is_refused() {
    let instance = rocking();
    let state = instance.save();
    let size = instance.serialize(state).len();
    let mut room: Vec<c_char> = vec![0; size - 1];
    let status = call!(instance, serialize, state, room.as_mut_ptr(), room.len());
    instance.refuses(status, &["fmi2SerializeFMUstate", &size.to_string(), &(size - 1).to_string()]);
    assert!(room.iter().all(|&byte| byte == 0));
    let status = call!(instance, serialize, state, null_mut(), size);
    instance.refuses(status, &["serializedState", "NULL"]);
    instance.free(state);
}

#[test]
fn calls_without_a_state_are_refused() {
    let instance = rocking();
    let before = instance.bits();
    instance.refuses(call!(instance, set_fmu_state, null_mut()), &["fmi2SetFMUstate", "NULL"]);
    instance.refuses(call!(instance, get_fmu_state, null_mut()), &["fmi2GetFMUstate", "NULL"]);
    instance.refuses(call!(instance, serialized_size, null_mut(), &mut 0), &["fmi2SerializedFMUstateSize", "NULL"]);
    instance.refuses(call!(instance, serialize, null_mut(), &mut 0, 1), &["fmi2SerializeFMUstate", "NULL"]);
    let bytes = bytes_of(&instance);
    let status = call!(instance, deserialize, bytes.as_ptr(), bytes.len(), null_mut());
    instance.refuses(status, &["fmi2DeSerializeFMUstate", "NULL"]);
    // The standard, 2.1.8: freeing NULL is no error.
    assert_eq!(call!(instance, free_fmu_state, &mut null_mut()), OK);
    assert_eq!(call!(instance, free_fmu_state, null_mut()), OK);
    assert_eq!(instance.bits(), before);
}
