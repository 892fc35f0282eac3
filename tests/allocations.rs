//! `fmi2DoStep` and `fmi3DoStep` allocate no memory, even with events, the end of a run, logging and intermediate updates.
//!
//! The library inside the FMU has its own allocator, invisible from outside. The tests therefore call the exported functions in
//! the crate, under a counting allocator.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::ffi::{CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};

use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::fmi::fmi2::exports::*;
use rocking_block::fmi::fmi2::types::{fmi2CallbackFunctions, fmi2CallbackLogger, fmi2Component};
use rocking_block::fmi::fmi3::exports::*;
use rocking_block::run::{OnSeparation, Settings};
use rocking_block::space::{
    DirectedPulse, SpaceBody, SpaceInitial, SpaceInputs, SpaceParameters, SpaceRun, SpaceSetup,
};
use rocking_block::unit::attributes::Kind;
use rocking_block::unit::fmu::Fmu;
use rocking_block::unit::in_space::SpaceUnit;
use rocking_block::unit::in_space::variables::Variable as SpaceVariable;
use rocking_block::unit::life_cycle::Interface;
use rocking_block::unit::variables::{GUID, TOKEN, VARIABLES};

struct Counting;

thread_local! {
    /// Calls of the allocator by this thread, without those of the test harness.
    static CALLS: Cell<u64> = const { Cell::new(0) };
    static LINES: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    CALLS.set(CALLS.get() + 1);
}

// SAFETY: all calls go on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's contract.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: the caller's contract.
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count();
        // SAFETY: the caller's contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Counts log lines. On the supported platforms named and variadic arguments are passed alike.
unsafe extern "C" fn logger(
    _: *mut c_void,
    _: *const c_char,
    _: c_int,
    _: *const c_char,
    _: *const c_char,
    _: *const c_char,
) {
    LINES.set(LINES.get() + 1);
}

fn reference(name: &str) -> u32 {
    VARIABLES.iter().find(|metadata| metadata.name == name).unwrap().reference()
}

struct Outcome {
    /// Calls of the allocator in all steps.
    calls: u64,
    /// Calls of the allocator while setting inputs and their derivatives.
    setting: u64,
    steps: u64,
    /// Log lines of these steps.
    lines: u64,
    events: i32,
    last: c_int,
}

/// Runs ten seconds in steps of 0.01 s under a pulse, setting inputs and their rates before each step.
fn run(integers: &[(&str, c_int)], reals: &[(&str, f64)], logging: bool) -> Outcome {
    let (name, guid) = (c"block", CString::new(GUID).unwrap());
    // SAFETY: the pointers differ in the variadic argument only; see `logger`.
    let logger: fmi2CallbackLogger = unsafe { std::mem::transmute(logger as *const ()) };
    let callbacks = fmi2CallbackFunctions {
        logger: Some(logger),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        environment: null_mut(),
    };
    let a_gx = reference("a_gx");
    // SAFETY: a live instance used by this thread only, arrays of one element, texts that end with 0.
    unsafe {
        let block: fmi2Component =
            fmi2Instantiate(name.as_ptr(), 1, guid.as_ptr(), null(), &callbacks, 0, logging.into());
        assert!(!block.is_null());
        for (name, value) in integers {
            assert_eq!(fmi2SetInteger(block, &reference(name), 1, value), 0, "{name}");
        }
        for (name, value) in reals {
            assert_eq!(fmi2SetReal(block, &reference(name), 1, value), 0, "{name}");
        }
        assert_eq!(fmi2EnterInitializationMode(block), 0);
        assert_eq!(fmi2ExitInitializationMode(block), 0);
        let mut outcome = Outcome { calls: 0, setting: 0, steps: 0, lines: 0, events: 0, last: 0 };
        let lines = LINES.get();
        while outcome.steps < 1000 && outcome.last == 0 {
            let time = outcome.steps as f64 * 0.01;
            let before = CALLS.get();
            assert_eq!(fmi2SetReal(block, &a_gx, 1, &(0.3 * time.sin())), 0);
            assert_eq!(fmi2SetRealInputDerivatives(block, &a_gx, 1, &1, &(0.3 * time.cos())), 0);
            outcome.setting += CALLS.get() - before;
            let before = CALLS.get();
            outcome.last = fmi2DoStep(block, time, 0.01, 1);
            outcome.calls += CALLS.get() - before;
            outcome.steps += 1;
        }
        outcome.lines = LINES.get() - lines;
        for counter in ["events.impacts", "events.liftoffs"] {
            let mut count = 0;
            assert_eq!(fmi2GetInteger(block, &reference(counter), 1, &mut count), 0);
            outcome.events += count;
        }
        fmi2FreeInstance(block);
        outcome
    }
}

/// The paper's block, and a pulse that rocks it.
const PULSE: [(&str, f64); 4] = [
    ("dimensionless.alpha", 0.25),
    ("dimensionless.p", 1.0),
    ("pulse.amplitude", 6.2622),
    ("pulse.period", 1.2566370614359172),
];

#[test]
fn the_allocator_counts() {
    let before = CALLS.get();
    drop(std::hint::black_box(Box::new(1)));
    assert_eq!(CALLS.get() - before, 2);
}

#[test]
fn steps_with_events_allocate_nothing() {
    for logging in [false, true] {
        let rocking = run(&[("pulse.shape", 2)], &PULSE, logging);
        assert_eq!((rocking.calls, rocking.steps, rocking.last), (0, 1000, 0));
        assert_eq!(rocking.setting, 0, "setting inputs between the steps allocates");
        assert!(rocking.events >= 5);
        assert_eq!(rocking.lines > 1005, logging, "{} lines", rocking.lines);
    }
}

#[test]
fn steps_on_the_rigid_base_allocate_nothing() {
    let rocking = run(&[("pulse.shape", 2), ("foundation", 2)], &PULSE, true);
    assert_eq!((rocking.calls, rocking.steps), (0, 1000));
    assert!(rocking.events >= 3);
}

#[test]
fn the_step_that_ends_the_run_allocates_nothing() {
    let reals = [PULSE.as_slice(), &[("epsilon", 0.4), ("dimensionless.eta", 60.0)]].concat();
    let ended = run(&[("pulse.shape", 2)], &reals, true);
    assert_eq!((ended.calls, ended.last), (0, 2));
    let held = run(&[("pulse.shape", 2), ("on_separation", 2)], &reals, true);
    assert_eq!((held.calls, held.steps, held.last), (0, 1000, 0));
    let flown = run(&[("pulse.shape", 2), ("on_separation", 3)], &reals, true);
    assert_eq!((flown.calls, flown.steps, flown.last), (0, 1000, 0));
    assert!(flown.events > held.events + 2);
}

unsafe extern "C-unwind" fn logger_of_fmi3(_: *mut c_void, _: c_int, _: *const c_char, _: *const c_char) {
    LINES.set(LINES.get() + 1);
}

thread_local! {
    static BLOCK: Cell<*mut c_void> = const { Cell::new(null_mut()) };
    static LOOKS: Cell<u64> = const { Cell::new(0) };
}

/// Sets a_gx when inputs are allowed, and otherwise reads theta.
unsafe extern "C-unwind" fn update(
    _: *mut c_void,
    time: f64,
    set_requested: u8,
    _: u8,
    _: u8,
    _: u8,
    _: *mut u8,
    _: *mut f64,
) {
    LOOKS.set(LOOKS.get() + 1);
    // SAFETY: the instance lives and is lent to the callback; arrays of one element.
    let status = unsafe {
        if set_requested != 0 {
            fmi3SetFloat64(BLOCK.get(), &reference("a_gx"), 1, &(2.0 * time.sin()), 1)
        } else {
            fmi3GetFloat64(BLOCK.get(), &reference("theta"), 1, &mut 0.0, 1)
        }
    };
    assert_eq!(status, 0);
}

#[test]
fn steps_of_fmi_3_allocate_nothing() {
    let token = CString::new(TOKEN).unwrap();
    let required = [reference("a_gx"), reference("theta")];
    // SAFETY: a live instance used by this thread only, arrays of one element, texts that end with 0.
    unsafe {
        let (name, token) = (c"block".as_ptr(), token.as_ptr());
        let (logger, update) = (Some(logger_of_fmi3 as _), Some(update as _));
        let block = fmi3InstantiateCoSimulation(
            name,
            token,
            null(),
            0,
            1,
            1,
            1,
            required.as_ptr(),
            2,
            null_mut(),
            logger,
            update,
        );
        assert!(!block.is_null());
        BLOCK.set(block);
        for (choice, value) in [("pulse.shape", 2), ("on_separation", 3)] {
            assert_eq!(fmi3SetInt64(block, &reference(choice), 1, &value, 1), 0);
        }
        for (name, value) in PULSE {
            assert_eq!(fmi3SetFloat64(block, &reference(name), 1, &value, 1), 0);
        }
        assert_eq!(fmi3EnterInitializationMode(block, 0, 0.0, 0.0, 0, 0.0), 0);
        assert_eq!(fmi3ExitInitializationMode(block), 0);
        assert_eq!(fmi3EnterStepMode(block), 0);
        let (mut time, mut events, before, lines) = (0.0, 0, CALLS.get(), LINES.get());
        while time < 10.0 {
            let (mut event, mut terminate, mut early, mut reached) = (0, 0, 0, 0.0);
            let status = fmi3DoStep(block, time, 10.0 - time, 1, &mut event, &mut terminate, &mut early, &mut reached);
            assert_eq!((status, terminate), (0, 0));
            time = reached;
            if event != 0 {
                events += 1;
                let mut flags = [0; 5];
                let [more, ended, nominals, values, defined] = &mut flags;
                assert_eq!(fmi3EnterEventMode(block), 0);
                let update = fmi3UpdateDiscreteStates(block, more, ended, nominals, values, defined, &mut 0.0);
                assert_eq!((update, fmi3EnterStepMode(block)), (0, 0));
            }
        }
        assert_eq!(CALLS.get() - before, 0);
        assert!(events >= 3 && LINES.get() > lines, "{events} events");
        // Two every 5 ms: the rest of a step continues after an early return.
        assert_eq!(LOOKS.get(), 4000);
        fmi3FreeInstance(block);
    }
}

/// A block in space at the beginning of a pulse that rocks it.
fn block_in_space() -> SpaceRun {
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 4.5, period: 1.2, ..Pulse::NONE };
    let setup = SpaceSetup {
        body: SpaceBody::new(&SpaceParameters { friction: 0.5, ..SpaceParameters::default() }).unwrap(),
        settings: Settings { on_separation: OnSeparation::Fly, ..Settings::default() },
        pulses: [DirectedPulse::horizontal(pulse, 0.6), DirectedPulse::NONE, DirectedPulse::NONE],
    };
    SpaceRun::new(setup, &SpaceInitial { vertical: Some([0.0; 2]), ..SpaceInitial::default() }, 0.0)
}

/// Steps of a block in space with events allocate nothing, and neither does the end of the run.
#[test]
fn steps_in_space_allocate_nothing() {
    let mut run = block_in_space();
    let (mut events, before) = (0, CALLS.get());
    for part in 1..=300 {
        run.advance(0.02 * f64::from(part), &SpaceInputs::default(), &mut |_| events += 1).unwrap();
    }
    assert_eq!(CALLS.get() - before, 0);
    assert!(events > 10 && run.state().counts.landings > 2, "{events} events");
}

/// Derivatives, indicators, the end of each step and events allocate nothing under Heun's method.
#[test]
fn model_exchange_in_space_allocates_nothing() {
    let (mut run, inputs) = (block_in_space(), SpaceInputs::default());
    run.begin_exchange();
    let mut states = [0.0; 28];
    let (mut events, before, size) = (0, CALLS.get(), 5e-4);
    for step in 1..=6000 {
        states.copy_from_slice(run.continuous_states());
        let mut rates = [0.0; 28];
        rates.copy_from_slice(run.derivatives(&inputs));
        run.set_outside_time(size * f64::from(step));
        run.set_continuous_states(&std::array::from_fn::<_, 28, _>(|i| states[i] + size * rates[i]));
        let later = run.derivatives(&inputs);
        let end: [f64; 28] = std::array::from_fn(|i| states[i] + 0.5 * size * (rates[i] + later[i]));
        run.set_continuous_states(&end);
        run.complete_step(&inputs);
        if run.indicators(&inputs).iter().any(|&indicator| indicator <= 0.0) {
            run.pass_events(&inputs, &mut |_| events += 1).unwrap();
        }
    }
    assert_eq!(CALLS.get() - before, 0);
    assert!(events > 10 && run.peak_tilt() > 0.1, "{events} events, {} rad", run.peak_tilt());
}

/// Outputs are read between the steps, which leave their memory alone.
#[test]
fn steps_of_the_unit_in_space_allocate_nothing() {
    let mut unit = SpaceUnit::new(Interface::CoSimulation);
    let reference = |variable: SpaceVariable| variable as u32 + 1;
    let real = |value: f64| value;
    unit.set(Kind::Integer, &[reference(SpaceVariable::PulseShape)], &[2.0], real).unwrap();
    let pulse = [SpaceVariable::PulseAmplitude, SpaceVariable::PulsePeriod, SpaceVariable::PulseAzimuth];
    unit.set(Kind::Real, &pulse.map(reference), &[6.2622, 1.2566, 0.4], real).unwrap();
    let of_block =
        [SpaceVariable::DimensionlessAlpha, SpaceVariable::DimensionlessP, SpaceVariable::DimensionlessDepthRatio];
    unit.set(Kind::Real, &of_block.map(reference), &[0.25, 1.0, 1.0], real).unwrap();
    unit.enter_initialization_mode();
    unit.exit_initialization_mode().unwrap();
    let [tilt, energy, landings] =
        [SpaceVariable::Tilt, SpaceVariable::EnergyTotal, SpaceVariable::EventsLandings].map(reference);
    let (mut calls, mut seen) = (0, Vec::new());
    for i in 0..100 {
        let (here, there) = (0.05 * f64::from(i), 0.05 * f64::from(i + 1));
        let before = CALLS.get();
        unit.set(Kind::Real, &[1], &[0.1 * f64::from(i % 3)], real).unwrap();
        unit.advance(here, there - here, &mut |_| {}).unwrap();
        calls += CALLS.get() - before;
        seen.push([unit.get(Kind::Real, tilt).unwrap(), unit.get(Kind::Real, energy).unwrap()]);
    }
    assert!(unit.get(Kind::Integer, landings).unwrap() > 2.0);
    assert!(
        seen.windows(2).all(|pair| pair[0][0] != pair[1][0] && pair[0][1] != pair[1][1]),
        "outputs are those of each step"
    );
    assert_eq!(calls, 0);
}
