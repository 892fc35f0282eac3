//! Calls and exceptions of an importer's logger.

use std::cell::{Cell, RefCell};
use std::ffi::{CString, c_int};
use std::ptr::{null, null_mut};

use crate::functions::*;
use crate::host::{FMU, reference};

/// The logger's environment.
struct Meddler {
    component: Cell<Component>,
    /// A saved state of the instance.
    saved: Cell<SavedState>,
    meddles: Cell<bool>,
    /// Messages so far.
    messages: Cell<usize>,
    /// Statuses of the calls from the logger.
    answers: RefCell<Vec<(&'static str, Status)>>,
}

/// Calls every function of the instance that it logs for.
unsafe extern "C" fn meddle(environment: Environment, _: Text, _: Status, _: Text, _: Text) {
    // SAFETY: the environment is the `Meddler` that outlives the instance, and is shared only.
    let meddler = unsafe { &*environment.cast::<Meddler>() };
    meddler.messages.set(meddler.messages.get() + 1);
    if !meddler.meddles.get() {
        return;
    }
    let (c, saved) = (meddler.component.get(), meddler.saved.get());
    let f = &FMU.functions;
    let (vr, order) = ([reference("a_gx")], [1]);
    let theta = [reference("theta")];
    let (mut real, mut integer, mut state, mut size) = ([f64::NAN], c_int::MIN, saved, usize::MAX);
    let mut bytes = [0; 8];
    let (logs, text) = ([c"logSteps".as_ptr()], null::<Text>());
    // SAFETY: the instance lives, arrays hold the number of values that their counts state; the test is about calls during another call.
    let answers = unsafe {
        [
            ("fmi2SetDebugLogging", (f.set_debug_logging)(c, 0, 1, logs.as_ptr())),
            ("fmi2SetupExperiment", (f.setup_experiment)(c, 0, 0.0, 0.0, 0, 0.0)),
            ("fmi2EnterInitializationMode", (f.enter_initialization_mode)(c)),
            ("fmi2ExitInitializationMode", (f.exit_initialization_mode)(c)),
            ("fmi2Terminate", (f.terminate)(c)),
            ("fmi2Reset", (f.reset)(c)),
            ("fmi2GetReal", (f.get_real)(c, theta.as_ptr(), 1, real.as_mut_ptr())),
            ("fmi2GetInteger", (f.get_integer)(c, &reference("regime"), 1, &mut integer)),
            ("fmi2GetBoolean", (f.get_boolean)(c, &reference("separated"), 1, &mut integer)),
            ("fmi2GetString", (f.get_string)(c, null(), 0, null_mut())),
            ("fmi2SetReal", (f.set_real)(c, vr.as_ptr(), 1, [7.0].as_ptr())),
            ("fmi2SetInteger", (f.set_integer)(c, null(), 0, null())),
            ("fmi2SetBoolean", (f.set_boolean)(c, null(), 0, null())),
            ("fmi2SetString", (f.set_string)(c, null(), 0, text)),
            ("fmi2GetFMUstate", (f.get_fmu_state)(c, &mut state)),
            ("fmi2SetFMUstate", (f.set_fmu_state)(c, saved)),
            ("fmi2FreeFMUstate", (f.free_fmu_state)(c, &mut state)),
            ("fmi2SerializedFMUstateSize", (f.serialized_size)(c, saved, &mut size)),
            ("fmi2SerializeFMUstate", (f.serialize)(c, saved, bytes.as_mut_ptr(), bytes.len())),
            ("fmi2DeSerializeFMUstate", (f.deserialize)(c, bytes.as_ptr(), bytes.len(), &mut state)),
            (
                "fmi2GetDirectionalDerivative",
                (f.get_directional_derivative)(c, theta.as_ptr(), 1, vr.as_ptr(), 1, [1.0].as_ptr(), real.as_mut_ptr()),
            ),
            (
                "fmi2SetRealInputDerivatives",
                (f.set_real_input_derivatives)(c, vr.as_ptr(), 1, order.as_ptr(), [7.0].as_ptr()),
            ),
            (
                "fmi2GetRealOutputDerivatives",
                (f.get_real_output_derivatives)(c, theta.as_ptr(), 1, order.as_ptr(), real.as_mut_ptr()),
            ),
            ("fmi2DoStep", (f.do_step)(c, 0.0, 0.1, 1)),
            ("fmi2CancelStep", (f.cancel_step)(c)),
            ("fmi2GetStatus", (f.get_status)(c, DO_STEP_STATUS, &mut integer)),
            ("fmi2GetRealStatus", (f.get_real_status)(c, LAST_SUCCESSFUL_TIME, real.as_mut_ptr())),
            ("fmi2GetBooleanStatus", (f.get_boolean_status)(c, TERMINATED, &mut integer)),
        ]
    };
    // SAFETY: the instance lives; the call must not free it.
    unsafe { (f.free_instance)(c) };
    assert!(real[0].is_nan() && integer == c_int::MIN && size == usize::MAX && state == saved, "nothing is written");
    meddler.answers.borrow_mut().extend(answers);
}

/// Runs with all categories logged. Returns the numbers of messages and of statuses, and all outputs.
fn run(meddles: bool) -> (usize, Vec<(&'static str, Status)>, Vec<u64>) {
    let f = &FMU.functions;
    let meddler = Meddler {
        component: Cell::new(null_mut()),
        saved: Cell::new(null_mut()),
        meddles: Cell::new(false),
        messages: Cell::new(0),
        answers: RefCell::new(Vec::new()),
    };
    let callbacks = Callbacks {
        logger: Some(meddle),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        environment: std::ptr::from_ref(&meddler).cast_mut().cast(),
    };
    let guid = CString::new(FMU.description.guid.as_str()).unwrap();
    let mut seen = Vec::new();
    // SAFETY: texts end with 0, the callbacks and the meddler outlive the instance, arrays are as long as their counts.
    unsafe {
        let c = (f.instantiate)(c"block".as_ptr(), CO_SIMULATION, guid.as_ptr(), null(), &callbacks, 0, 1);
        assert!(!c.is_null());
        meddler.component.set(c);
        assert_eq!((f.set_real)(c, &reference("initial.theta"), 1, &0.1), OK);
        // A parameter that is not read causes a warning during the call.
        assert_eq!((f.set_real)(c, &reference("physical.width"), 1, &5.0), OK);
        let mut saved = null_mut();
        assert_eq!((f.get_fmu_state)(c, &mut saved), OK);
        meddler.saved.set(saved);
        meddler.meddles.set(meddles);
        assert_eq!((f.setup_experiment)(c, 1, 1.0, 0.0, 0, 0.0), WARNING, "a tolerance beyond the limits");
        assert_eq!((f.enter_initialization_mode)(c), OK);
        assert_eq!((f.exit_initialization_mode)(c), WARNING);
        let outputs: Vec<Reference> =
            FMU.description.outputs().filter(|v| v.kind == "Real").map(|v| v.reference).collect();
        let mut values = vec![f64::NAN; outputs.len()];
        for i in 0..50 {
            assert_eq!((f.do_step)(c, 0.1 * f64::from(i), 0.1, 1), OK, "step {i}");
            assert_eq!((f.get_real)(c, outputs.as_ptr(), outputs.len(), values.as_mut_ptr()), OK);
            seen.extend(values.iter().map(|value| value.to_bits()));
        }
        // The message of a refused call follows it.
        assert_eq!((f.set_real)(c, &reference("theta"), 1, &0.0), ERROR);
        assert_eq!((f.free_fmu_state)(c, &mut saved), OK);
        meddler.saved.set(null_mut());
        meddler.meddles.set(false);
        (f.free_instance)(c);
    }
    (meddler.messages.get(), meddler.answers.into_inner(), seen)
}

/// Every call of the logger on its own instance returns `fmi2Error`, logs nothing and changes nothing.
#[test]
fn calls_from_within_the_logger_are_refused() {
    let (messages, none, alone) = run(false);
    assert!(messages > 50 && none.is_empty(), "{messages} messages");
    let (as_many, answers, meddled) = run(true);
    assert_eq!(as_many, messages, "a refused call logs nothing");
    assert_eq!(answers.len(), messages * 28);
    for (function, status) in answers {
        assert_eq!(status, ERROR, "{function}");
    }
    assert_eq!(meddled, alone);
}

/// The logger of an instance may call another instance.
#[test]
fn another_instance_can_be_called_from_within_the_logger() {
    /// The other instance and its statuses.
    type Other = (Component, Cell<Option<Status>>);
    unsafe extern "C" fn read_other(environment: Environment, _: Text, _: Status, _: Text, _: Text) {
        // SAFETY: the environment is an `Other` that outlives the instance.
        let (other, answer) = unsafe { &*environment.cast::<Other>() };
        let mut theta = f64::NAN;
        // SAFETY: another instance, which is not in use.
        answer.set(Some(unsafe { (FMU.functions.get_real)(*other, &reference("theta"), 1, &mut theta) }));
        assert_eq!(theta, 0.1);
    }
    let other = crate::host::Instance::new("other");
    other.set("initial.theta", 0.1);
    other.initialize(None);
    let environment: Other = (other.component, Cell::new(None));
    let callbacks = Callbacks {
        logger: Some(read_other),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        environment: std::ptr::from_ref(&environment).cast_mut().cast(),
    };
    let guid = CString::new(FMU.description.guid.as_str()).unwrap();
    let f = &FMU.functions;
    // SAFETY: texts end with 0; the callbacks and their data outlive the instance.
    unsafe {
        let c = (f.instantiate)(c"block".as_ptr(), CO_SIMULATION, guid.as_ptr(), null(), &callbacks, 0, 1);
        assert_eq!((f.do_step)(c, 0.0, 0.1, 1), ERROR, "not initialized");
        (f.free_instance)(c);
    }
    assert_eq!(environment.1.get(), Some(OK));
}

/// Set for the process in which the logger throws.
const THROWS: &str = "ROCKING_BLOCK_TEST_THROWS";

/// An exception that leaves the logger ends the process with a message, as documented.
///
/// This program's panic is foreign to the library, which has its own Rust runtime, as an exception of C++ is.
#[test]
fn an_exception_from_the_logger_ends_the_process() {
    unsafe extern "C-unwind" fn throw(_: Environment, _: Text, _: Status, _: Text, _: Text, _: Text) {
        panic!("thrown by the logger");
    }
    if std::env::var_os(THROWS).is_some() {
        // SAFETY: the types differ in whether the function may unwind, which is the point.
        let logger: Logger = unsafe { std::mem::transmute(throw as *const ()) };
        let callbacks = Callbacks {
            logger: Some(logger),
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            environment: null_mut(),
        };
        let guid = CString::new(FMU.description.guid.as_str()).unwrap();
        // SAFETY: texts end with 0, and the callbacks outlive the instance.
        let status = unsafe {
            let instantiate = FMU.functions.instantiate;
            let c = instantiate(c"block".as_ptr(), CO_SIMULATION, guid.as_ptr(), null(), &callbacks, 0, 1);
            (FMU.functions.do_step)(c, 0.0, 0.1, 1)
        };
        unreachable!("status {status}");
    }
    let output = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "callbacks::an_exception_from_the_logger_ends_the_process", "--nocapture"])
        .env(THROWS, "1")
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    #[cfg(unix)]
    assert_eq!(std::os::unix::process::ExitStatusExt::signal(&output.status), Some(libc::SIGABRT), "{message}");
    assert!(
        message.contains("thrown by the logger") && message.contains("cannot catch foreign exceptions"),
        "{message}"
    );
}
