//! Misuse: a message names it, and nothing changes.

use std::ffi::CString;
use std::ptr::{null, null_mut};

use crate::functions::*;
use crate::host::{FMU, Instance, Wanted, call, reference};

fn ready() -> Instance {
    let block = Instance::new(Wanted::default());
    block.initialize(false);
    block
}

#[test]
fn wrong_tokens_and_interfaces_are_refused() {
    let other = CString::new("{00000000-0000-0000-0000-000000000000}").unwrap();
    let token = FMU.token.as_ptr();
    for (name, token) in [
        (null(), token),
        (c"".as_ptr(), token),
        (c" ".as_ptr(), token),
        (c"block".as_ptr(), null()),
        (c"block".as_ptr(), other.as_ptr()),
    ] {
        // SAFETY: texts end with 0 or are null.
        let handle = unsafe {
            let instantiate = FMU.functions.instantiate_co_simulation;
            instantiate(name, token, null(), false, false, true, true, null(), 0, null_mut(), None, None)
        };
        assert!(handle.is_null());
    }
    // SAFETY: as before.
    unsafe {
        let name = c"block".as_ptr();
        let functions = &FMU.functions;
        let model_exchange = functions.instantiate_model_exchange;
        assert!(model_exchange(name, other.as_ptr(), null(), false, false, null_mut(), None).is_null());
        let scheduled = functions.instantiate_scheduled_execution;
        assert!(scheduled(name, token, null(), false, false, null_mut(), None, None, None, None).is_null());
        (functions.free_instance)(null_mut());
        assert_eq!((functions.reset)(null_mut()), ERROR);
    }
}

#[test]
fn variables_have_one_type_each() {
    let block = ready();
    let (theta, regime, impacts) = (reference("theta"), reference("regime"), reference("events.impacts"));
    let (mut float, mut int32, mut int64) = (0.0, 0, 0);
    let wrong = call!(block, get_float64, &regime, 1, &mut float, 1);
    block.refuses(wrong, &["regime", "Enumeration (Int64); expected Float64"]);
    block.refuses(call!(block, get_int32, &regime, 1, &mut int32, 1), &["regime", "expected Int32"]);
    block.refuses(
        call!(block, get_int64, &impacts, 1, &mut int64, 1),
        &["events.impacts", "Int32; expected Enumeration"],
    );
    block.refuses(call!(block, get_int64, &theta, 1, &mut int64, 1), &["theta", "Float64; expected Enumeration"]);
    block.refuses(call!(block, get_float32, &theta, 1, &mut 0.0, 1), &["theta", "Float64; expected Float32"]);
    block.refuses(call!(block, get_uint64, &theta, 1, &mut 0, 1), &["theta", "expected UInt64"]);
    for unknown in [0, FMU.variables.len() as u32 + 1, u32::MAX] {
        let words: &[&str] = &[&unknown.to_string(), "does not exist"];
        block.refuses(call!(block, get_float64, &unknown, 1, &mut float, 1), words);
        block.refuses(call!(block, get_int8, &unknown, 1, &mut 0, 1), words);
    }
    block.refuses(call!(block, get_binary, &theta, 1, null_mut(), null_mut(), 0), &["theta", "expected Binary"]);
    // An empty list of variables is valid for every type.
    block.ok(call!(block, get_float32, null(), 0, null_mut(), 0));
    block.ok(call!(block, set_uint16, null(), 0, null(), 0));
    block.refuses(call!(block, get_float64, &theta, 1, null_mut(), 0), &["nValues = 0", "expected 1"]);
    block.refuses(call!(block, get_float64, &theta, 1, null_mut(), 1), &["values is NULL"]);
    block.refuses(call!(block, get_float64, null(), 1, &mut float, 1), &["valueReferences is NULL"]);
}

#[test]
fn calls_out_of_place_are_refused() {
    let block = ready();
    block.refuses(block.try_set("mass", 2.0), &["mass is a fixed parameter"]);
    block.refuses(block.try_set("theta", 2.0), &["theta is an output"]);
    block.refuses(block.try_set("time", 2.0), &["time"]);
    block.refuses(block.try_set("a_gx", f64::INFINITY), &["a_gx = inf"]);
    block.refuses(block.try_step(1.0, 0.1).0, &["currentCommunicationPoint = 1.0"]);
    block.refuses(block.try_step(0.0, -0.1).0, &["communicationStepSize = -0.1"]);
    block.refuses(
        call!(block, do_step, 0.0, 0.1, true, null_mut(), null_mut(), null_mut(), null_mut()),
        &["eventHandlingNeeded is NULL"],
    );
    block.refuses(call!(block, set_fmu_state, null_mut()), &["is NULL; expected a saved state", "fmi3SetFMUState"]);
    let block = Instance::new(Wanted::default());
    block.refuses(block.try_set("on_separation", 4.0), &["on_separation = 4", "3 Fly"]);
    block.refuses(call!(block, enter_initialization_mode, true, -1.0, 0.0, false, 0.0), &["tolerance = -1"]);
    block.refuses(call!(block, enter_initialization_mode, false, 0.0, 1.0, true, 1.0), &["stopTime = 1"]);
    block.ok(call!(block, enter_initialization_mode, false, 0.0, 1.0, true, 2.0));
}

#[test]
fn unsupported_functions_are_refused_with_a_reason() {
    let block = ready();
    let mut byte = false;
    block.refuses(call!(block, get_clock, null(), 0, &mut byte), &["fmi3GetClock", "no clocks"]);
    block.refuses(call!(block, activate_model_partition, 0, 0.0), &["no clocks"]);
    block.refuses(call!(block, evaluate_discrete_states), &["providesEvaluateDiscreteStates"]);
    block.refuses(call!(block, get_number_of_variable_dependencies, 0, &mut 0), &["providesPerElementDependencies"]);
    let other = "found an instance for Co-Simulation; expected one for Model Exchange";
    block.refuses(call!(block, set_time, 0.0), &["fmi3SetTime", other]);
    block.refuses(call!(block, get_number_of_continuous_states, &mut 0), &[other]);
}

#[test]
fn altered_states_are_refused() {
    let block = ready();
    let mut state = null_mut();
    block.ok(call!(block, get_fmu_state, &mut state));
    let mut size = 0;
    block.ok(call!(block, serialized_fmu_state_size, state, &mut size));
    let mut bytes = vec![0; size];
    let short = call!(block, serialize_fmu_state, state, bytes.as_mut_ptr(), size - 1);
    block.refuses(short, &["room for", "expected"]);
    block.ok(call!(block, serialize_fmu_state, state, bytes.as_mut_ptr(), size));
    block.ok(call!(block, free_fmu_state, &mut state));
    for place in (0..size).step_by(7) {
        bytes[place] ^= 1;
        let status = call!(block, deserialize_fmu_state, bytes.as_ptr(), size, &mut state);
        block.refuses(status, &["serialized state refused"]);
        assert!(state.is_null());
        bytes[place] ^= 1;
    }
}
