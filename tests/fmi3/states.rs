//! Model Exchange: every function in every state, against the state machines of the standard (3.0.2, 2.3 and 3.2).

use std::ptr::{null, null_mut};

use crate::functions::*;
use crate::host::{Instance, call, reference};

/// The states, each with its letter in the table.
const STATES: [(char, &str); 7] = [
    ('I', "Instantiated"),
    ('C', "Configuration Mode"),
    ('M', "Initialization Mode"),
    ('E', "Event Mode"),
    ('K', "Continuous-Time Mode"),
    ('T', "Terminated"),
    ('X', "Terminated by an error"),
];

/// A function, the states in which it is legal, and a call that is valid except for the state.
///
/// No letter: never legal, since the FMU lacks the feature. A dash: a function of Co-Simulation.
type Row = (&'static str, &'static str, fn(&Instance) -> Status);

/// The standard's table, with some harmless additions.
///
/// Values and the numbers of states and indicators can be read in every state. The time can also be set in Event Mode, as
/// importers do before the first step.
const TABLE: &[Row] = &[
    ("fmi3SetDebugLogging", "ICMEKTX", |b| call!(b, set_debug_logging, true, 0, null())),
    ("fmi3EnterConfigurationMode", "I", |b| call!(b, enter_configuration_mode)),
    ("fmi3ExitConfigurationMode", "C", |b| call!(b, exit_configuration_mode)),
    ("fmi3EnterInitializationMode", "I", |b| call!(b, enter_initialization_mode, false, 0.0, 0.0, false, 0.0)),
    ("fmi3ExitInitializationMode", "M", |b| call!(b, exit_initialization_mode)),
    ("fmi3EnterEventMode", "K", |b| call!(b, enter_event_mode)),
    ("fmi3Terminate", "EK", |b| call!(b, terminate)),
    ("fmi3Reset", "ICMEKTX", |b| call!(b, reset)),
    ("fmi3GetFloat64", "ICMEKTX", |b| call!(b, get_float64, &reference("theta"), 1, &mut 0.0, 1)),
    ("fmi3GetFloat32", "ICMEKTX", |b| call!(b, get_float32, null(), 0, null_mut(), 0)),
    ("fmi3GetInt8", "ICMEKTX", |b| call!(b, get_int8, null(), 0, null_mut(), 0)),
    ("fmi3GetUInt8", "ICMEKTX", |b| call!(b, get_uint8, null(), 0, null_mut(), 0)),
    ("fmi3GetInt16", "ICMEKTX", |b| call!(b, get_int16, null(), 0, null_mut(), 0)),
    ("fmi3GetUInt16", "ICMEKTX", |b| call!(b, get_uint16, null(), 0, null_mut(), 0)),
    ("fmi3GetInt32", "ICMEKTX", |b| call!(b, get_int32, null(), 0, null_mut(), 0)),
    ("fmi3GetUInt32", "ICMEKTX", |b| call!(b, get_uint32, null(), 0, null_mut(), 0)),
    ("fmi3GetInt64", "ICMEKTX", |b| call!(b, get_int64, null(), 0, null_mut(), 0)),
    ("fmi3GetBoolean", "ICMEKTX", |b| call!(b, get_boolean, null(), 0, null_mut(), 0)),
    ("fmi3GetUInt64", "ICMEKTX", |b| call!(b, get_uint64, &reference("record.samples"), 1, &mut 0, 1)),
    ("fmi3GetString", "ICMEKTX", |b| call!(b, get_string, null(), 0, null_mut(), 0)),
    ("fmi3GetBinary", "ICMEKTX", |b| call!(b, get_binary, null(), 0, null_mut(), null_mut(), 0)),
    ("fmi3SetFloat64", "IMEK", |b| call!(b, set_float64, &reference("a_gx"), 1, &0.25, 1)),
    ("fmi3SetFloat32", "IME", |b| call!(b, set_float32, null(), 0, null(), 0)),
    ("fmi3SetInt8", "IME", |b| call!(b, set_int8, null(), 0, null(), 0)),
    ("fmi3SetUInt8", "IME", |b| call!(b, set_uint8, null(), 0, null(), 0)),
    ("fmi3SetInt16", "IME", |b| call!(b, set_int16, null(), 0, null(), 0)),
    ("fmi3SetUInt16", "IME", |b| call!(b, set_uint16, null(), 0, null(), 0)),
    ("fmi3SetInt32", "IME", |b| call!(b, set_int32, null(), 0, null(), 0)),
    ("fmi3SetUInt32", "IME", |b| call!(b, set_uint32, null(), 0, null(), 0)),
    ("fmi3SetInt64", "IME", |b| call!(b, set_int64, null(), 0, null(), 0)),
    ("fmi3SetBoolean", "IME", |b| call!(b, set_boolean, null(), 0, null(), 0)),
    ("fmi3SetUInt64", "C", |b| call!(b, set_uint64, &reference("record.samples"), 1, &3, 1)),
    ("fmi3SetString", "IME", |b| call!(b, set_string, null(), 0, null(), 0)),
    ("fmi3SetBinary", "IME", |b| call!(b, set_binary, null(), 0, null(), null(), 0)),
    ("fmi3GetFMUState", "ICMEKTX", |b| with_state(b, |_| OK)),
    ("fmi3SetFMUState", "ICMEKTX", |b| with_state(b, |state| call!(b, set_fmu_state, state))),
    ("fmi3FreeFMUState", "ICMEKTX", |b| call!(b, free_fmu_state, &mut null_mut())),
    ("fmi3SerializedFMUStateSize", "ICMEKTX", |b| {
        with_state(b, |state| call!(b, serialized_fmu_state_size, state, &mut 0))
    }),
    ("fmi3SerializeFMUState", "ICMEKTX", |b| with_bytes(b, |_| OK)),
    ("fmi3DeserializeFMUState", "ICMEKTX", |b| {
        with_bytes(b, |bytes| {
            let mut state = null_mut();
            let status = call!(b, deserialize_fmu_state, bytes.as_ptr(), bytes.len(), &mut state);
            call!(b, free_fmu_state, &mut state);
            status
        })
    }),
    ("fmi3GetDirectionalDerivative", "MEKTX", |b| {
        let (unknown, known) = (reference("theta_ddot"), reference("a_gx"));
        call!(b, get_directional_derivative, &unknown, 1, &known, 1, &1.0, 1, &mut 0.0, 1)
    }),
    ("fmi3GetAdjointDerivative", "MEKTX", |b| {
        let (unknown, known) = (reference("theta_ddot"), reference("a_gx"));
        call!(b, get_adjoint_derivative, &unknown, 1, &known, 1, &1.0, 1, &mut 0.0, 1)
    }),
    ("fmi3UpdateDiscreteStates", "E", update),
    ("fmi3EnterContinuousTimeMode", "E", |b| call!(b, enter_continuous_time_mode)),
    ("fmi3CompletedIntegratorStep", "K", |b| call!(b, completed_integrator_step, true, &mut false, &mut false)),
    ("fmi3SetTime", "EK", |b| call!(b, set_time, 0.0)),
    ("fmi3SetContinuousStates", "K", |b| call!(b, set_continuous_states, [0.01; 11].as_ptr(), 11)),
    ("fmi3GetContinuousStateDerivatives", "MEKTX", |b| {
        call!(b, get_continuous_state_derivatives, [0.0; 11].as_mut_ptr(), 11)
    }),
    ("fmi3GetEventIndicators", "MEKTX", |b| call!(b, get_event_indicators, [0.0; 22].as_mut_ptr(), 22)),
    ("fmi3GetContinuousStates", "MEKTX", |b| call!(b, get_continuous_states, [0.0; 11].as_mut_ptr(), 11)),
    ("fmi3GetNominalsOfContinuousStates", "MEKTX", |b| {
        call!(b, get_nominals_of_continuous_states, [0.0; 11].as_mut_ptr(), 11)
    }),
    ("fmi3GetNumberOfEventIndicators", "ICMEKTX", |b| call!(b, get_number_of_event_indicators, &mut 0)),
    ("fmi3GetNumberOfContinuousStates", "ICMEKTX", |b| call!(b, get_number_of_continuous_states, &mut 0)),
    ("fmi3EvaluateDiscreteStates", "", |b| call!(b, evaluate_discrete_states)),
    ("fmi3GetNumberOfVariableDependencies", "", |b| call!(b, get_number_of_variable_dependencies, 0, &mut 0)),
    ("fmi3GetVariableDependencies", "", |b| {
        let places = (null_mut(), null_mut(), null_mut(), null_mut());
        call!(b, get_variable_dependencies, 0, places.0, places.1, places.2, places.3, 0)
    }),
    ("fmi3GetClock", "", |b| call!(b, get_clock, null(), 0, null_mut())),
    ("fmi3SetClock", "", |b| call!(b, set_clock, null(), 0, null())),
    ("fmi3GetIntervalDecimal", "", |b| call!(b, get_interval_decimal, null(), 0, null_mut(), null_mut())),
    ("fmi3GetIntervalFraction", "", |b| call!(b, get_interval_fraction, null(), 0, null_mut(), null_mut(), null_mut())),
    ("fmi3GetShiftDecimal", "", |b| call!(b, get_shift_decimal, null(), 0, null_mut())),
    ("fmi3GetShiftFraction", "", |b| call!(b, get_shift_fraction, null(), 0, null_mut(), null_mut())),
    ("fmi3SetIntervalDecimal", "", |b| call!(b, set_interval_decimal, null(), 0, null())),
    ("fmi3SetIntervalFraction", "", |b| call!(b, set_interval_fraction, null(), 0, null(), null())),
    ("fmi3SetShiftDecimal", "", |b| call!(b, set_shift_decimal, null(), 0, null())),
    ("fmi3SetShiftFraction", "", |b| call!(b, set_shift_fraction, null(), 0, null(), null())),
    ("fmi3ActivateModelPartition", "", |b| call!(b, activate_model_partition, 0, 0.0)),
    ("fmi3EnterStepMode", "-", |b| call!(b, enter_step_mode)),
    ("fmi3DoStep", "-", |b| b.try_step(0.0, 0.1).0),
    ("fmi3GetOutputDerivatives", "-", |b| call!(b, get_output_derivatives, &reference("theta"), 1, &1, &mut 0.0, 1)),
];

/// Functions that make or free instances.
const ELSEWHERE: [&str; 5] = [
    "fmi3GetVersion",
    "fmi3InstantiateModelExchange",
    "fmi3InstantiateCoSimulation",
    "fmi3InstantiateScheduledExecution",
    "fmi3FreeInstance",
];

fn with_state(block: &Instance, act: impl FnOnce(Handle) -> Status) -> Status {
    let mut state = null_mut();
    let saved = call!(block, get_fmu_state, &mut state);
    let status = if saved == OK { act(state) } else { saved };
    block.ok(call!(block, free_fmu_state, &mut state));
    status
}

fn with_bytes(block: &Instance, act: impl FnOnce(&[u8]) -> Status) -> Status {
    with_state(block, |state| {
        let mut size = 0;
        block.ok(call!(block, serialized_fmu_state_size, state, &mut size));
        let mut bytes = vec![0; size];
        let status = call!(block, serialize_fmu_state, state, bytes.as_mut_ptr(), size);
        if status == OK { act(&bytes) } else { status }
    })
}

fn all_of(block: &Instance) -> Vec<u8> {
    let mut all = Vec::new();
    with_bytes(block, |bytes| {
        all = bytes.to_vec();
        OK
    });
    all
}

const TO_CONTINUOUS_TIME_MODE: [fn(&Instance) -> Status; 3] = [
    |b| call!(b, enter_initialization_mode, false, 0.0, 0.0, false, 0.0),
    |b| call!(b, exit_initialization_mode),
    |b| call!(b, enter_continuous_time_mode),
];

fn update(block: &Instance) -> Status {
    let [mut more, mut ends, mut nominals, mut values, mut defined] = [false; 5];
    let mut time = 0.0;
    call!(block, update_discrete_states, &mut more, &mut ends, &mut nominals, &mut values, &mut defined, &mut time)
}

fn block_in(state: char) -> Instance {
    let block = Instance::exchanged();
    if state == 'X' {
        block.set("on_separation", 3.0);
        for step in &TO_CONTINUOUS_TIME_MODE {
            block.ok(step(&block));
        }
        // No regime persists in such a state.
        block.ok(call!(
            block,
            set_continuous_states,
            [0.1, -1e155, 0.0, 1e200, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0].as_ptr(),
            11
        ));
        block.ok(call!(block, enter_event_mode));
        assert_eq!(update(&block), ERROR);
        block.messages();
        return block;
    }
    if state == 'C' {
        block.ok(call!(block, enter_configuration_mode));
        return block;
    }
    let place = "IMEKT".find(state).unwrap();
    TO_CONTINUOUS_TIME_MODE.iter().take(place).for_each(|step| block.ok(step(&block)));
    if state == 'T' {
        block.ok(call!(block, terminate));
    }
    block
}

#[test]
fn the_table_names_every_function() {
    let mut named: Vec<&str> = TABLE.iter().map(|row| row.0).chain(ELSEWHERE).collect();
    let mut all = NAMES.to_vec();
    named.sort_unstable();
    all.sort_unstable();
    assert_eq!(named, all);
}

#[test]
fn legality_of_every_call_in_every_state() {
    let mut wrong = Vec::new();
    for (letter, state) in STATES {
        for &(name, states, act) in TABLE {
            let block = block_in(letter);
            let before = all_of(&block);
            let status = act(&block);
            let messages = block.messages();
            let word = match states {
                "" => "",
                "-" => "expected one for Co-Simulation",
                _ => state,
            };
            let is_logged = messages.len() == 1 && messages[0].2.contains(name) && messages[0].2.contains(word);
            let right = match states.contains(letter) {
                // After the error the results of the states that led to it are not finite.
                true => status == OK || (letter == 'X' && status == DISCARD && messages[0].2.contains("not finite")),
                false => status == ERROR && is_logged && all_of(&block) == before,
            };
            if !right {
                wrong.push(format!("{name} in {state}: {status}, {messages:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
