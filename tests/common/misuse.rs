//! Illegal calls of an importer, each with its required status.

use std::ptr::{null, null_mut};

use rocking_block::fmi::fmi2::exports::*;
use rocking_block::fmi::fmi2::types::*;
use rocking_block::unit::variables::{Causality, GUID, Kind, Metadata, VARIABLES};

use crate::fmu::{DISCARD, ERROR, Fmu, OK, reference, references};

/// State of an instance, by the table of 4.2.4 in the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    Instantiated,
    Initialization,
    Complete,
    Failed,
    Terminated,
    /// The integration failed.
    Error,
}

use Phase::{Complete, Failed, Initialization, Instantiated};

/// Number of kinds of [`misuse`].
pub const KINDS: u32 = 16;

/// Makes a call that is illegal in this state and checks its status.
///
/// `choice` selects a variant; `time` is the time of the instance.
pub fn misuse(fmu: &mut Fmu, phase: Phase, time: f64, kind: u32, choice: u32) {
    let (status, expected) = match kind % KINDS {
        0 => (unknown_reference(fmu, choice), ERROR),
        1 => (wrong_type(fmu, choice), ERROR),
        2 => (unfit_value(fmu, choice), ERROR),
        3 => (not_settable(fmu, phase, choice), ERROR),
        4 => (half_wrong(fmu, choice), ERROR),
        5 => (null_array(fmu, choice), ERROR),
        6 => (wrong_time(fmu, time, choice), ERROR),
        7 => (wrong_state(fmu, phase, choice), ERROR),
        8 => (model_exchange(fmu.component, choice), ERROR),
        9 => (broken_state(fmu, choice), ERROR),
        10 => (wrong_logging(fmu.component, choice), ERROR),
        11 => (wrong_derivative(fmu, phase, choice), ERROR),
        12 => wrong_status_kind(fmu.component, phase, choice),
        13 => (wrong_experiment(fmu, choice), ERROR),
        14 => (no_instance(choice), ERROR),
        _ => (not_for_this_fmu(choice), ERROR),
    };
    assert_eq!(status, expected, "misuse {} variant {choice} in {phase:?} at t = {time}", kind % KINDS);
}

fn pick<T: Copy>(choice: u32, from: &[T]) -> T {
    from[choice as usize % from.len()]
}

fn unknown_reference(fmu: &mut Fmu, choice: u32) -> fmi2Status {
    let c = fmu.component;
    let unknown = pick(choice, &[0, VARIABLES.len() as u32 + 1, 1000, i32::MAX as u32, u32::MAX]);
    let vr = &raw const unknown;
    let (mut real, mut integer, mut text) = (0.0, 0, null());
    // SAFETY: the instance lives, and each pointer is to one element.
    unsafe {
        match choice / 4 % 9 {
            0 => fmi2GetReal(c, vr, 1, &raw mut real),
            1 => fmi2GetInteger(c, vr, 1, &raw mut integer),
            2 => fmi2GetBoolean(c, vr, 1, &raw mut integer),
            3 => fmi2GetString(c, vr, 1, &raw mut text),
            4 => fmi2SetReal(c, vr, 1, &raw const real),
            5 => fmi2SetInteger(c, vr, 1, &raw const integer),
            6 => fmi2SetBoolean(c, vr, 1, &raw const integer),
            7 => fmi2SetString(c, vr, 1, &raw const text),
            _ => fmi2SetRealInputDerivatives(c, vr, 1, &raw const integer, &raw const real),
        }
    }
}

fn wrong_type(fmu: &mut Fmu, choice: u32) -> fmi2Status {
    let c = fmu.component;
    let of = |kind| pick(choice, &references(|_, k| k == kind));
    let (real, integer, boolean) = (of(Kind::Real), of(Kind::Integer), of(Kind::Boolean));
    let (mut x, mut i, mut text) = (0.25, 1, c"".as_ptr());
    // SAFETY: the instance lives, and each pointer is to one element.
    unsafe {
        match choice % 8 {
            0 => fmi2GetReal(c, &raw const integer, 1, &raw mut x),
            1 => fmi2GetInteger(c, &raw const boolean, 1, &raw mut i),
            2 => fmi2GetBoolean(c, &raw const real, 1, &raw mut i),
            3 => fmi2GetString(c, &raw const real, 1, &raw mut text),
            4 => fmi2SetReal(c, &raw const boolean, 1, &raw const x),
            5 => fmi2SetInteger(c, &raw const real, 1, &raw const i),
            6 => fmi2SetBoolean(c, &raw const integer, 1, &raw const i),
            _ => fmi2SetString(c, &raw const boolean, 1, &raw const text),
        }
    }
}

fn unfit_value(fmu: &mut Fmu, choice: u32) -> fmi2Status {
    let not_finite = pick(choice, &[f64::NAN, f64::INFINITY, f64::NEG_INFINITY]);
    if choice.is_multiple_of(2) {
        let settable =
            |causality, kind| matches!(causality, Causality::Input | Causality::Parameter) && kind == Kind::Real;
        return fmu.set(pick(choice / 2, &references(settable)), not_finite);
    }
    let (name, value) = pick(
        choice / 2,
        &[
            ("dimensionless.alpha", 1.6),
            ("dimensionless.alpha", 0.0),
            ("dimensionless.xi_v", -1e-9),
            ("epsilon", 1.0 + 1e-12),
            ("g", 0.0),
            ("mass", -1.0),
            ("foundation", 3.0),
            ("on_separation", 0.0),
            ("pulse.shape", -1.0),
            ("pulse.period", 0.0),
            ("physical.K", -1.0),
            ("initial.theta", 1.6),
        ],
    );
    fmu.set(reference(name), value)
}

fn not_settable(fmu: &mut Fmu, phase: Phase, choice: u32) -> fmi2Status {
    let fixed = |causality| {
        matches!(causality, Causality::Output | Causality::CalculatedParameter)
            || causality == Causality::Parameter && !matches!(phase, Instantiated | Initialization)
    };
    let reference = pick(choice, &references(|causality, _| fixed(causality)));
    fmu.set(reference, Metadata::of(reference).unwrap().start.unwrap_or(0.0))
}

/// Names one valid and one invalid variable: neither may be set, and no output array written.
fn half_wrong(fmu: &mut Fmu, choice: u32) -> fmi2Status {
    let a_gx = reference("a_gx");
    let mut room = [7.5; 2];
    let status = match choice % 4 {
        0 => fmu.set_reals(&[a_gx, u32::MAX], &[123.0, 0.0]),
        1 => fmu.set_reals(&[a_gx, a_gx], &[123.0, f64::NAN]),
        2 => fmu.set_rates(&[a_gx, a_gx], &[1, 2], &[123.0, 0.0]),
        _ => fmu.reals(&[a_gx, u32::MAX], &mut room),
    };
    assert_eq!(room, [7.5; 2]);
    status
}

fn null_array(fmu: &mut Fmu, choice: u32) -> fmi2Status {
    let (c, vr, n) = (fmu.component, reference("a_gx"), 1 + choice as usize % 5);
    let vr = &raw const vr;
    let (order, mut x) = (1, 0.0);
    // SAFETY: the instance lives; a null pointer is refused before the other arrays are read, and with a count above 1 the others
    // are null too.
    unsafe {
        match choice / 5 % 17 {
            0 => fmi2GetReal(c, null(), n, null_mut()),
            1 => fmi2GetReal(c, vr, 1, null_mut()),
            2 => fmi2GetInteger(c, null(), n, null_mut()),
            3 => fmi2GetBoolean(c, null(), n, null_mut()),
            4 => fmi2GetString(c, null(), n, null_mut()),
            5 => fmi2SetReal(c, null(), n, null()),
            6 => fmi2SetReal(c, vr, 1, null()),
            7 => fmi2SetInteger(c, null(), n, null()),
            8 => fmi2SetBoolean(c, null(), n, null()),
            9 => fmi2SetString(c, null(), n, null()),
            10 => fmi2SetRealInputDerivatives(c, vr, 1, null(), &raw const x),
            11 => fmi2SetRealInputDerivatives(c, vr, 1, &raw const order, null()),
            12 => fmi2GetRealOutputDerivatives(c, null(), n, null(), null_mut()),
            13 => fmi2GetDirectionalDerivative(c, null(), n, vr, 1, &raw const x, &raw mut x),
            14 => fmi2GetDirectionalDerivative(c, null(), 0, vr, 1, null(), &raw mut x),
            15 => fmi2GetFMUstate(c, null_mut()),
            _ => fmi2DeSerializeFMUstate(c, null(), n, null_mut()),
        }
    }
}

fn wrong_time(fmu: &mut Fmu, time: f64, choice: u32) -> fmi2Status {
    let (time, step) = pick(
        choice,
        &[
            (time + 1.0, 0.1),
            (time - 1.0, 0.1),
            (time + 1e-6, 0.01),
            (f64::NAN, 0.1),
            (f64::INFINITY, 0.1),
            (f64::NEG_INFINITY, f64::INFINITY),
            (time, 0.0),
            (time, -0.1),
            (time, f64::NAN),
            (time, f64::INFINITY),
            (time, f64::NEG_INFINITY),
            (time + f64::MAX, f64::MAX),
        ],
    );
    fmu.step(time, step)
}

fn wrong_state(fmu: &mut Fmu, phase: Phase, choice: u32) -> fmi2Status {
    let (theta, a_gx) = (reference("theta"), reference("a_gx"));
    let stepped = !matches!(phase, Instantiated | Initialization);
    let settable = matches!(phase, Instantiated | Initialization | Complete);
    let mut refused: Vec<fn(&mut Fmu, u32, u32) -> fmi2Status> = Vec::new();
    if phase != Instantiated {
        refused
            .extend([(|fmu, _, _| fmu.setup(None, 0.0, None)) as fn(&mut Fmu, u32, u32) -> _, |fmu, _, _| fmu.enter()]);
    } else {
        refused.push(|fmu, theta, _| fmu.reals(&[theta], &mut [0.0]));
        refused.push(|fmu, theta, a_gx| fmu.directional(&[theta], &[a_gx], &[1.0], &mut [0.0]));
    }
    if phase != Initialization {
        refused.push(|fmu, _, _| fmu.exit());
    }
    if !matches!(phase, Complete | Failed) {
        refused.push(|fmu, _, _| fmu.terminate());
    }
    if !settable {
        refused.push(|fmu, _, a_gx| fmu.set(a_gx, 1.0));
        refused.push(|fmu, _, a_gx| fmu.set_rates(&[a_gx], &[1], &[1.0]));
    }
    if !stepped {
        refused.push(|fmu, theta, _| fmu.rates(&[theta], &[1], &mut [0.0]));
        // SAFETY: the instance lives, and there is a place for the result.
        refused.push(|fmu, _, _| unsafe { fmi2GetRealStatus(fmu.component, 2, &mut 0.0) });
        // SAFETY: the instance lives, and there is a place for the result.
        refused.push(|fmu, _, _| unsafe { fmi2GetBooleanStatus(fmu.component, 3, &mut 0) });
        // SAFETY: the instance lives, and there is a place for the result.
        refused.push(|fmu, _, _| unsafe { fmi2GetStatus(fmu.component, 0, &mut 0) });
    }
    if phase != Complete {
        refused.push(|fmu, _, _| fmu.step(0.0, 0.1));
    }
    pick(choice, &refused)(fmu, theta, a_gx)
}

fn model_exchange(c: fmi2Component, choice: u32) -> fmi2Status {
    let mut x = [0.0; 4];
    // SAFETY: the instance lives, and arrays are as long as their counts.
    unsafe {
        match choice % 11 {
            0 => fmi2EnterEventMode(c),
            1 => fmi2NewDiscreteStates(c, null_mut()),
            2 => fmi2EnterContinuousTimeMode(c),
            3 => fmi2CompletedIntegratorStep(c, 1, &mut 0, &mut 0),
            4 => fmi2SetTime(c, f64::NAN),
            5 => fmi2SetContinuousStates(c, x.as_ptr(), 4),
            6 => fmi2GetDerivatives(c, x.as_mut_ptr(), 4),
            7 => fmi2GetEventIndicators(c, null_mut(), 4),
            8 => fmi2GetContinuousStates(c, x.as_mut_ptr(), 4),
            9 => fmi2GetNominalsOfContinuousStates(c, x.as_mut_ptr(), 4),
            _ => fmi2CancelStep(c),
        }
    }
}

/// Uses a missing, truncated, altered or invented state.
fn broken_state(fmu: &mut Fmu, choice: u32) -> fmi2Status {
    let slot = fmu.states.len();
    assert_eq!(fmu.save(slot), OK);
    let mut bytes = fmu.serialize(slot).unwrap();
    assert_eq!(fmu.free(slot), OK);
    // The slot is empty now.
    let (c, at) = (fmu.component, choice as usize / 8 % bytes.len());
    let status = match choice % 8 {
        0 => fmu.restore(slot),
        1 => fmu.serialize(slot).map_or_else(|status| status, |_| OK),
        2 | 3 => fmu.deserialize(&bytes[..at]),
        4 | 5 => {
            bytes[at] ^= 1 << (choice % 7);
            fmu.deserialize(&bytes)
        }
        6 => fmu.deserialize(&(0..at as u32).map(|i| (i.wrapping_mul(choice | 1) >> 3) as u8).collect::<Vec<_>>()),
        _ => {
            // SAFETY: the instance lives, and the pointer for the state is null.
            unsafe { fmi2DeSerializeFMUstate(c, bytes.as_ptr().cast(), bytes.len(), null_mut()) }
        }
    };
    fmu.states.truncate(slot);
    status
}

fn wrong_logging(c: fmi2Component, choice: u32) -> fmi2Status {
    let unknown = pick(choice, &[c"logAll".as_ptr(), c"%s%n".as_ptr(), c"\xff\xfe".as_ptr(), c"".as_ptr(), null()]);
    // SAFETY: the instance lives, and the category is one text or null.
    unsafe {
        match choice % 2 {
            0 => fmi2SetDebugLogging(c, 1, 1, &raw const unknown),
            _ => fmi2SetDebugLogging(c, 1, 2, null()),
        }
    }
}

fn wrong_derivative(fmu: &mut Fmu, phase: Phase, choice: u32) -> fmi2Status {
    let [theta, a_gx, alpha, regime] = ["theta", "a_gx", "dimensionless.alpha", "regime"].map(reference);
    let order = pick(choice, &[0, 2, -1, i32::MAX]);
    // During initialization a parameter is a valid known and a state is not; later the reverse holds.
    let unfit = if phase == Initialization { theta } else { alpha };
    match choice % 9 {
        0 => fmu.set_rates(&[a_gx], &[order], &[1.0]),
        1 => fmu.set_rates(&[theta], &[1], &[1.0]),
        2 => fmu.set_rates(&[a_gx], &[1], &[f64::NAN]),
        3 => fmu.rates(&[theta], &[order], &mut [0.0]),
        4 => fmu.rates(&[a_gx], &[1], &mut [0.0]),
        5 => fmu.rates(&[regime], &[1], &mut [0.0]),
        6 => fmu.directional(&[theta], &[unfit], &[1.0], &mut [0.0]),
        7 => fmu.directional(&[a_gx], &[a_gx], &[1.0], &mut [0.0]),
        _ => fmu.directional(&[theta], &[a_gx], &[f64::INFINITY], &mut [0.0]),
    }
}

fn wrong_status_kind(c: fmi2Component, phase: Phase, choice: u32) -> (fmi2Status, fmi2Status) {
    let unknown = pick(choice, &[4, -1, i32::MAX, i32::MIN]);
    // By the standard, no status is a string, and without a pending step none can be queried.
    let pending = if matches!(phase, Instantiated | Initialization | Phase::Error) { ERROR } else { DISCARD };
    // SAFETY: the instance lives, and there is a place for each result, or null.
    unsafe {
        match choice / 4 % 8 {
            0 => (fmi2GetStatus(c, unknown, &mut 0), ERROR),
            1 => (fmi2GetStatus(c, 3, &mut 0), ERROR),
            2 => (fmi2GetRealStatus(c, 0, &mut 0.0), ERROR),
            3 => (fmi2GetRealStatus(c, 2, null_mut()), ERROR),
            4 => (fmi2GetBooleanStatus(c, 2, &mut 0), ERROR),
            5 => (fmi2GetIntegerStatus(c, choice as i32 % 5, &mut 0), ERROR),
            6 => (fmi2GetStringStatus(c, unknown, &mut null()), ERROR),
            _ => (fmi2GetStringStatus(c, 1, &mut null()), pending),
        }
    }
}

fn wrong_experiment(fmu: &mut Fmu, choice: u32) -> fmi2Status {
    let (tolerance, start, stop) = pick(
        choice,
        &[
            (None, f64::NAN, None),
            (None, f64::NEG_INFINITY, None),
            (None, 0.0, Some(0.0)),
            (None, 1.0, Some(-1.0)),
            (None, 0.0, Some(f64::NAN)),
            (None, 0.0, Some(f64::INFINITY)),
            (Some(0.0), 0.0, None),
            (Some(-1e-6), 0.0, None),
            (Some(f64::NAN), 0.0, None),
            (Some(f64::INFINITY), 0.0, None),
        ],
    );
    fmu.setup(tolerance, start, stop)
}

fn no_instance(choice: u32) -> fmi2Status {
    let c = null_mut();
    // SAFETY: a null instance is refused before other arguments are read; nothing needs freeing.
    unsafe {
        fmi2FreeInstance(c);
        match choice % 7 {
            0 => fmi2DoStep(c, 0.0, 0.1, 1),
            1 => fmi2GetReal(c, null(), 0, null_mut()),
            2 => fmi2GetFMUstate(c, null_mut()),
            3 => fmi2FreeFMUstate(c, null_mut()),
            4 => fmi2Reset(c),
            5 => fmi2SetDebugLogging(c, 1, 0, null()),
            _ => fmi2EnterEventMode(c),
        }
    }
}

/// Requests an unsupported instance and returns `ERROR` for a null result.
fn not_for_this_fmu(choice: u32) -> fmi2Status {
    let guid = std::ffi::CString::new(GUID).unwrap();
    let functions = fmi2CallbackFunctions {
        logger: None,
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        environment: null_mut(),
    };
    let (guid, functions, wrong) = (guid.as_ptr(), &raw const functions, c"{0}".as_ptr());
    let (name, kind, guid, functions) = match choice % 7 {
        0 => (null(), 1, guid, functions),
        1 => (c"".as_ptr(), 1, guid, functions),
        2 => (c"block".as_ptr(), 2, guid, functions),
        3 => (c"block".as_ptr(), i32::MIN, guid, functions),
        4 => (c"block".as_ptr(), 1, wrong, functions),
        5 => (c"block".as_ptr(), 1, null(), functions),
        _ => (c"block".as_ptr(), 1, guid, null()),
    };
    // SAFETY: texts end with 0 or are null, and the callbacks live during the call or are null.
    let component = unsafe { fmi2Instantiate(name, kind, guid, null(), functions, 0, 0) };
    if component.is_null() { ERROR } else { OK }
}
