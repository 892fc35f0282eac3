//! Every function in every state, against the table of the standard (2.0.4, 4.2.4).

use std::ptr::{null, null_mut};

use crate::functions::*;
use crate::host::{Instance, call, reference};
use crate::unit::{INDICATOR_COUNT, STATE_COUNT};

/// The states that a synchronous FMU can be in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum State {
    Instantiated,
    InitializationMode,
    StepComplete,
    StepFailed,
    Terminated,
    Error,
}
use State::*;

const STATES: [State; 6] = [Instantiated, InitializationMode, StepComplete, StepFailed, Terminated, Error];
const NONE: &[State] = &[];
/// `fmi2GetXXX`, `fmi2GetDirectionalDerivative`.
const GET: &[State] = &[InitializationMode, StepComplete, StepFailed, Terminated, Error];
/// `fmi2SetXXX`, `fmi2SetRealInputDerivatives`.
const SET: &[State] = &[Instantiated, InitializationMode, StepComplete];
/// `fmi2GetXXXStatus`.
const STATUS: &[State] = &[StepComplete, StepFailed, Terminated];

/// A function, the states in which it is legal, and a call that is valid except for the state.
pub type Row = (&'static str, &'static [State], fn(&Instance) -> Status);

pub const TABLE: &[Row] = &[
    ("fmi2SetDebugLogging", &STATES, |i| call!(i, set_debug_logging, 0, 0, null())),
    ("fmi2SetupExperiment", &[Instantiated], |i| i.setup(Some(1e-6), 0.0, Some(20.0))),
    ("fmi2EnterInitializationMode", &[Instantiated], |i| call!(i, enter_initialization_mode)),
    ("fmi2ExitInitializationMode", &[InitializationMode], |i| call!(i, exit_initialization_mode)),
    ("fmi2Terminate", &[StepComplete, StepFailed], |i| call!(i, terminate)),
    ("fmi2Reset", &STATES, |i| call!(i, reset)),
    ("fmi2GetReal", GET, |i| call!(i, get_real, &reference("theta"), 1, &mut 0.0)),
    ("fmi2GetInteger", GET, |i| call!(i, get_integer, &reference("regime"), 1, &mut 0)),
    ("fmi2GetBoolean", GET, |i| call!(i, get_boolean, &reference("separated"), 1, &mut 0)),
    ("fmi2GetString", GET, |i| call!(i, get_string, null(), 0, null_mut())),
    ("fmi2SetReal", SET, |i| call!(i, set_real, &reference("a_gx"), 1, &0.25)),
    ("fmi2SetInteger", SET, |i| call!(i, set_integer, null(), 0, null())),
    ("fmi2SetBoolean", SET, |i| call!(i, set_boolean, null(), 0, null())),
    ("fmi2SetString", SET, |i| call!(i, set_string, null(), 0, null())),
    ("fmi2GetFMUstate", &STATES, |i| {
        let mut state = null_mut();
        let status = call!(i, get_fmu_state, &mut state);
        if status == OK {
            i.free(state);
        }
        status
    }),
    ("fmi2SetFMUstate", &STATES, |i| with_state(i, |state| call!(i, set_fmu_state, state))),
    ("fmi2FreeFMUstate", &STATES, |i| call!(i, free_fmu_state, &mut null_mut())),
    ("fmi2SerializedFMUstateSize", &STATES, |i| with_state(i, |state| call!(i, serialized_size, state, &mut 0))),
    ("fmi2SerializeFMUstate", &STATES, |i| {
        with_state(i, |state| {
            let mut room = [0; 1 << 14];
            call!(i, serialize, state, room.as_mut_ptr(), room.len())
        })
    }),
    ("fmi2DeSerializeFMUstate", &STATES, |i| {
        with_state(i, |state| {
            let bytes = i.serialize(state);
            let mut read = null_mut();
            let status = call!(i, deserialize, bytes.as_ptr(), bytes.len(), &mut read);
            i.free(read);
            status
        })
    }),
    ("fmi2GetDirectionalDerivative", GET, |i| {
        let (unknown, known) = (reference("theta_ddot"), reference("a_gx"));
        call!(i, get_directional_derivative, &unknown, 1, &known, 1, &1.0, &mut 0.0)
    }),
    ("fmi2SetRealInputDerivatives", SET, |i| call!(i, set_real_input_derivatives, &reference("a_gx"), 1, &1, &0.5)),
    ("fmi2GetRealOutputDerivatives", &[StepComplete, StepFailed, Terminated, Error], |i| {
        call!(i, get_real_output_derivatives, &reference("theta"), 1, &1, &mut 0.0)
    }),
    ("fmi2DoStep", &[StepComplete], |i| i.try_step(1.0, 0.01)),
    // Legal only while a step is in progress, which never happens in a synchronous FMU.
    ("fmi2CancelStep", NONE, |i| call!(i, cancel_step)),
    ("fmi2GetStatus", STATUS, |i| call!(i, get_status, DO_STEP_STATUS, &mut 0)),
    ("fmi2GetRealStatus", STATUS, |i| call!(i, get_real_status, LAST_SUCCESSFUL_TIME, &mut 0.0)),
    ("fmi2GetBooleanStatus", STATUS, |i| call!(i, get_boolean_status, TERMINATED, &mut 0)),
    ("fmi2EnterEventMode", NONE, |i| call!(i, enter_event_mode)),
    ("fmi2NewDiscreteStates", NONE, |i| call!(i, new_discrete_states, &mut EventInfo::default())),
    ("fmi2EnterContinuousTimeMode", NONE, |i| call!(i, enter_continuous_time_mode)),
    ("fmi2CompletedIntegratorStep", NONE, |i| call!(i, completed_integrator_step, 1, &mut 0, &mut 0)),
    ("fmi2SetTime", NONE, |i| call!(i, set_time, 1.0)),
    ("fmi2SetContinuousStates", NONE, |i| call!(i, set_continuous_states, [0.01; STATE_COUNT].as_ptr(), STATE_COUNT)),
    ("fmi2GetDerivatives", NONE, |i| call!(i, get_derivatives, [0.0; STATE_COUNT].as_mut_ptr(), STATE_COUNT)),
    ("fmi2GetEventIndicators", NONE, |i| {
        call!(i, get_event_indicators, [0.0; INDICATOR_COUNT].as_mut_ptr(), INDICATOR_COUNT)
    }),
    ("fmi2GetContinuousStates", NONE, |i| {
        call!(i, get_continuous_states, [0.0; STATE_COUNT].as_mut_ptr(), STATE_COUNT)
    }),
    ("fmi2GetNominalsOfContinuousStates", NONE, |i| {
        call!(i, get_nominals, [0.0; STATE_COUNT].as_mut_ptr(), STATE_COUNT)
    }),
];

/// Functions that act on no instance, end it, or are never answered.
const ELSEWHERE: [&str; 6] = [
    "fmi2GetTypesPlatform",
    "fmi2GetVersion",
    "fmi2Instantiate",
    "fmi2FreeInstance",
    "fmi2GetIntegerStatus",
    "fmi2GetStringStatus",
];

fn with_state(instance: &Instance, act: impl FnOnce(SavedState) -> Status) -> Status {
    let state = instance.save();
    let status = act(state);
    instance.free(state);
    status
}

/// An instance in a state, at t = 1 s in those after the first step.
fn instance_in(state: State) -> Instance {
    let instance = Instance::new("block");
    instance.set("pulse.shape", 2.0);
    instance.set("pulse.amplitude", 6.0);
    if state == StepFailed {
        instance.set("on_separation", 1.0);
    }
    if state == Instantiated {
        return instance;
    }
    assert_eq!(instance.setup(Some(1e-6), 0.0, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    if state == InitializationMode {
        return instance;
    }
    assert_eq!(call!(instance, exit_initialization_mode), OK);
    instance.go(0.0, 1.0, 0.1);
    match state {
        Instantiated | InitializationMode | StepComplete => {}
        StepFailed => {
            // Thrown up faster than it falls.
            instance.set("a_gz", -50.0);
            assert_eq!(instance.try_step(1.0, 1.0), DISCARD);
        }
        Terminated => assert_eq!(call!(instance, terminate), OK),
        Error => {
            instance.set("a_gx", 1e300);
            assert_eq!(instance.try_step(1.0, 0.1), ERROR);
        }
    }
    instance.messages();
    instance
}

/// Returns the complete state as bytes, which is legal in every state.
pub fn all_of(instance: &Instance) -> Vec<std::ffi::c_char> {
    let state = instance.save();
    let bytes = instance.serialize(state);
    instance.free(state);
    bytes
}

fn name_of(state: State) -> String {
    let name = format!("{state:?}");
    name[..1].to_lowercase() + &name[1..]
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
    for state in STATES {
        for &(name, allowed, act) in TABLE {
            let instance = instance_in(state);
            let before = all_of(&instance);
            let status = act(&instance);
            let messages = instance.messages();
            if allowed.contains(&state) {
                if status != OK {
                    wrong.push(format!("{name} in {state:?}: {status}, {messages:?}"));
                }
                continue;
            }
            let is_logged = messages.len() == 1
                && messages[0].text.starts_with(name)
                && (allowed.is_empty() || messages[0].text.contains(&name_of(state)));
            if status != ERROR || !is_logged || all_of(&instance) != before {
                wrong.push(format!("{name} should be refused in {state:?}: {status}, {messages:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The two statuses that no synchronous FMU has are refused in every state.
#[test]
fn integer_and_string_statuses_are_refused() {
    for state in STATES {
        let instance = instance_in(state);
        assert_eq!(call!(instance, get_integer_status, PENDING_STATUS, &mut 0), ERROR, "{state:?}");
        let status = call!(instance, get_string_status, PENDING_STATUS, &mut null());
        assert!(status >= DISCARD, "{state:?}");
        // Discarded calls are logged in debug mode only (2.1.3).
        assert_eq!(instance.messages().len(), if status == DISCARD { 1 } else { 2 }, "{state:?}");
    }
}

/// A refused call changes neither the values read after it nor the rest of the run, bit by bit.
#[test]
fn refused_calls_do_not_change_the_run() {
    let run = |disturbed: bool| {
        let instance = instance_in(StepComplete);
        let mut trace = Vec::new();
        for i in 10..40 {
            for &(_, allowed, act) in TABLE.iter().filter(|row| disturbed && !row.1.contains(&StepComplete)) {
                let before = instance.bits();
                assert_eq!(act(&instance), ERROR);
                assert_eq!(instance.bits(), before, "{allowed:?}");
            }
            instance.messages();
            let time = f64::from(i) * 0.1;
            instance.step(time, f64::from(i + 1) * 0.1 - time);
            trace.push(instance.bits());
        }
        trace
    };
    assert_eq!(run(true), run(false));
}

#[test]
fn a_whole_life_twice() {
    let instance = Instance::new("block");
    let run = || {
        instance.set_paper_block();
        instance.set("initial.theta", 0.1);
        instance.initialize(None);
        let start = instance.bits();
        instance.go(0.0, 2.0, 0.05);
        let bits = instance.bits();
        assert_eq!(call!(instance, terminate), OK);
        assert_eq!(instance.bits(), bits, "the standard, 4.2.4: final values can be read after fmi2Terminate");
        (start, bits)
    };
    let first = run();
    assert_eq!(call!(instance, reset), OK);
    assert_eq!(run(), first);
}

/// A function without an instance returns an error (standard, 2.1.5).
#[test]
fn every_function_refuses_a_null_instance() {
    let f = &crate::host::FMU.functions;
    let nobody: Component = null_mut();
    // SAFETY: the test is about NULL; without an instance no other pointer is followed.
    let answers = unsafe {
        (f.free_instance)(nobody);
        [
            (f.set_debug_logging)(nobody, 0, 0, null()),
            (f.setup_experiment)(nobody, 0, 0.0, 0.0, 0, 0.0),
            (f.enter_initialization_mode)(nobody),
            (f.exit_initialization_mode)(nobody),
            (f.terminate)(nobody),
            (f.reset)(nobody),
            (f.get_real)(nobody, null(), 0, null_mut()),
            (f.get_integer)(nobody, null(), 0, null_mut()),
            (f.get_boolean)(nobody, null(), 0, null_mut()),
            (f.get_string)(nobody, null(), 0, null_mut()),
            (f.set_real)(nobody, null(), 0, null()),
            (f.set_integer)(nobody, null(), 0, null()),
            (f.set_boolean)(nobody, null(), 0, null()),
            (f.set_string)(nobody, null(), 0, null()),
            (f.get_fmu_state)(nobody, &mut null_mut()),
            (f.set_fmu_state)(nobody, null_mut()),
            (f.free_fmu_state)(nobody, &mut null_mut()),
            (f.serialized_size)(nobody, null_mut(), &mut 0),
            (f.serialize)(nobody, null_mut(), null_mut(), 0),
            (f.deserialize)(nobody, null(), 0, &mut null_mut()),
            (f.get_directional_derivative)(nobody, null(), 0, null(), 0, null(), null_mut()),
            (f.enter_event_mode)(nobody),
            (f.new_discrete_states)(nobody, null_mut()),
            (f.enter_continuous_time_mode)(nobody),
            (f.completed_integrator_step)(nobody, 0, &mut 0, &mut 0),
            (f.set_time)(nobody, 0.0),
            (f.set_continuous_states)(nobody, null(), 0),
            (f.get_derivatives)(nobody, null_mut(), 0),
            (f.get_event_indicators)(nobody, null_mut(), 0),
            (f.get_continuous_states)(nobody, null_mut(), 0),
            (f.get_nominals)(nobody, null_mut(), 0),
            (f.set_real_input_derivatives)(nobody, null(), 0, null(), null()),
            (f.get_real_output_derivatives)(nobody, null(), 0, null(), null_mut()),
            (f.do_step)(nobody, 0.0, 0.1, 1),
            (f.cancel_step)(nobody),
            (f.get_status)(nobody, 0, &mut 0),
            (f.get_real_status)(nobody, 2, &mut 0.0),
            (f.get_integer_status)(nobody, 0, &mut 0),
            (f.get_boolean_status)(nobody, 3, &mut 0),
            (f.get_string_status)(nobody, 1, &mut null()),
        ]
    };
    assert_eq!(answers, [ERROR; 40]);
}
