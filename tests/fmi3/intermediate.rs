//! Intermediate updates: inputs that vary within a communication step, outputs read within it, and early return.

use std::cell::RefCell;
use std::rc::Rc;

use crate::functions::OK;
use crate::host::{Instance, OnUpdate, Stepped, Update, Wanted, call, reference};

const BLOCK: [(&str, f64); 2] = [("epsilon", 0.3), ("on_separation", 3.0)];

/// A ground acceleration with corners every 0.005 s only, and linear in between.
fn ground(time: f64) -> f64 {
    let at = |i: f64| 6.0 * (5.0 * 0.005 * i).sin();
    let i = (time / 0.005 + 1e-9).floor();
    at(i) + (at(i + 1.0) - at(i)) * (time / 0.005 - i)
}

fn setting() -> OnUpdate {
    Box::new(|instance, update| {
        if update.set_requested {
            instance.set("a_gx", ground(update.time));
        }
        None
    })
}

fn instance(early_return: bool, on_update: OnUpdate) -> Instance {
    let instance = Instance::new(Wanted {
        event_mode: early_return,
        early_return,
        intermediate: &["a_gx", "theta", "theta_ddot"],
        on_update: Some(on_update),
        ..Wanted::default()
    });
    instance.set_all(&BLOCK);
    instance.initialize(early_return);
    instance
}

/// Runs under the FMU's own record, which is followed exactly.
fn by_record() -> Instance {
    let samples: Vec<f64> = (0..=400).map(|i| ground(0.005 * f64::from(i))).collect();
    let instance = Instance::new(Wanted::default());
    instance.set_all(&BLOCK);
    instance.set("record.dt", 0.005);
    instance.ok(call!(instance, enter_configuration_mode));
    instance.set("record.samples", samples.len() as f64);
    instance.ok(call!(instance, exit_configuration_mode));
    let array = reference("record.horizontal_samples");
    instance.ok(call!(instance, set_float64, &array, 1, samples.as_ptr(), samples.len()));
    instance.initialize(false);
    instance
}

#[test]
fn inputs_inside_a_step_are_followed() {
    let expected = by_record();
    expected.step(0.0, 2.0);
    for steps in [1, 4] {
        let block = instance(false, setting());
        for i in 0..steps {
            let (here, there) = (2.0 * f64::from(i) / f64::from(steps), 2.0 * f64::from(i + 1) / f64::from(steps));
            block.step(here, there - here);
        }
        let (theta, found) = (expected.get("theta"), block.get("theta"));
        assert!(expected.get("peak.theta") > 1e-3 && expected.get("events.liftoffs") >= 1.0, "{theta}");
        // Both integrate the same motion, with their own round-off.
        assert!((theta - found).abs() < 1e-9, "{found}, not {theta}");
        assert_eq!(block.get("events.liftoffs"), expected.get("events.liftoffs"));
        assert_eq!(block.get("a_gx"), ground(2.0));
    }
}

#[test]
fn leaving_steps_at_events_keeps_the_bits() {
    let whole = instance(false, setting());
    whole.step(0.0, 1.0);
    whole.step(1.0, 1.0);
    let stopped = instance(true, setting());
    let mut events = stopped.step_by_events(0.0, 1.0, true);
    events.extend(stopped.step_by_events(1.0, 2.0, true));
    assert!(events.len() >= 3, "{events:?}");
    assert_eq!(whole.output_bits(), stopped.output_bits());
}

#[test]
fn updates_follow_the_standard() {
    let seen: Rc<RefCell<Vec<(Update, f64, f64)>>> = Rc::default();
    let log = Rc::clone(&seen);
    let block = instance(
        true,
        Box::new(move |instance, update| {
            let (theta, time) = if update.get_allowed {
                (instance.get("theta"), update.time)
            } else {
                instance.set("a_gx", ground(update.time));
                (f64::NAN, f64::NAN)
            };
            log.borrow_mut().push((update, theta, time));
            None
        }),
    );
    assert!(!block.step(0.0, 0.02).early);
    let seen = seen.take();
    assert_eq!(seen.len(), 8);
    for (pair, i) in seen.chunks(2).zip(1..) {
        let time = 0.005 * f64::from(i);
        let (ask, look) = (pair[0].0, pair[1].0);
        assert!((ask.time - time).abs() < 1e-15 && look.time == ask.time);
        let flags =
            |update: Update| [update.set_requested, update.get_allowed, update.step_finished, update.can_return_early];
        assert_eq!((flags(ask), flags(look)), ([true, false, false, false], [false, true, true, true]));
    }
    assert_eq!(seen[7].1, block.get("theta"));
    assert_eq!(seen[7].0.time, 0.02);
}

#[test]
fn the_importer_leaves_a_step() {
    let block = instance(true, Box::new(|_, update| (update.time > 0.0099).then_some(0.0)));
    let stepped = block.step(0.0, 0.1);
    assert!(stepped.early && !stepped.event && !stepped.terminates, "{stepped:?}");
    assert!((stepped.reached - 0.01).abs() < 1e-15, "{stepped:?}");
    // The importer asks to leave at a later time.
    let block = instance(true, Box::new(|_, update| (update.time > 0.0099).then_some(0.0123)));
    assert_eq!(block.step(0.0, 0.1).reached, 0.0123);
    // Without permission at instantiation the request is ignored.
    let block = instance(false, Box::new(|_, _| Some(0.0)));
    let stepped = block.step(0.0, 0.1);
    assert!(!stepped.early && stepped.reached == 0.1);
}

#[test]
fn calls_illegal_during_an_update_are_refused() {
    let block = instance(
        true,
        Box::new(|instance, update| {
            let refused = |status, words: &[&str]| instance.refuses(status, words);
            if update.set_requested {
                refused(instance.try_get("theta").unwrap_err(), &["fmi3GetFloat64", "Intermediate Update Mode"]);
                refused(instance.try_set("a_gz", 1.0), &["value reference 2", "requiredIntermediateVariables"]);
                refused(instance.try_set("theta", 1.0), &["theta is no input"]);
                refused(instance.try_set("a_gx", f64::NAN), &["a_gx = NaN"]);
            } else {
                refused(instance.try_set("a_gx", 1.0), &["fmi3SetFloat64", "Intermediate Update Mode"]);
                refused(instance.try_get("v").unwrap_err(), &["requiredIntermediateVariables"]);
            }
            refused(instance.try_step(0.0, 0.1).0, &["fmi3DoStep", "Intermediate Update Mode"]);
            refused(call!(instance, reset), &["fmi3Reset"]);
            refused(call!(instance, terminate), &["fmi3Terminate"]);
            // Freeing does nothing: the step still uses the instance.
            call!(instance, free_instance);
            None
        }),
    );
    block.step(0.0, 0.02);
    assert_eq!(call!(block, terminate), OK);
    // These variables cannot be read inside a step.
    for name in ["regime", "mass", "time"] {
        // SAFETY: as in `Instance::new`; the instance is refused.
        let handle = unsafe {
            (crate::host::FMU.functions.instantiate_co_simulation)(
                c"block".as_ptr(),
                crate::host::FMU.token.as_ptr(),
                std::ptr::null(),
                false,
                false,
                false,
                false,
                &reference(name),
                1,
                std::ptr::null_mut(),
                None,
                None,
            )
        };
        assert!(handle.is_null(), "{name}");
    }
}

fn counted(
    intermediate: &'static [&'static str],
    values: &[(&str, f64)],
    start: f64,
) -> (Instance, Rc<RefCell<Vec<f64>>>) {
    let looks: Rc<RefCell<Vec<f64>>> = Rc::default();
    let log = Rc::clone(&looks);
    let on_update = Box::new(move |_: &Instance, update: Update| {
        if update.get_allowed {
            log.borrow_mut().push(update.time);
        }
        None
    });
    let block = Instance::new(Wanted { intermediate, on_update: Some(on_update), ..Wanted::default() });
    block.set_all(values);
    block.ok(call!(block, enter_initialization_mode, false, 0.0, start, false, 0.0));
    block.ok(call!(block, exit_initialization_mode));
    (block, looks)
}

/// Near 1e11 s the clock resolves 1.5e-5 s.
#[test]
fn an_interval_below_the_resolution_of_the_clock_goes_on() {
    let start = 1e11;
    let (block, looks) = counted(&["a_gx"], &[("intermediate.interval", 1e-6)], start);
    assert_eq!(block.step(start, 1e-3).reached, start + 1e-3);
    let looks = looks.take();
    assert!(looks.windows(2).all(|pair| pair[0] < pair[1]), "{looks:?}");
    assert_eq!(looks.last(), Some(&(start + 1e-3)));
}

#[test]
fn updates_of_a_block_at_rest() {
    let (block, looks) = counted(&["theta"], &[], 0.0);
    block.step(0.0, 1e6);
    assert_eq!(looks.take(), [1e6]);
    // A later pulse follows.
    let pulse = [("pulse.shape", 2.0), ("pulse.amplitude", 1.0), ("pulse.start", 0.5)];
    let (block, looks) = counted(&["theta"], &pulse, 0.0);
    block.step(0.0, 1.0);
    assert_eq!(looks.take().len(), 200);
    // Inputs may move it at any time, but there are at most a million updates in a step.
    let (block, looks) = counted(&["a_gx"], &[], 0.0);
    block.step(0.0, 1e4);
    assert!((999_000..=1_000_000).contains(&looks.take().len()));
}

/// Calls `fmi3DoStep` for a block at rest after a pulse, and under a constant push below that of lift-off.
#[test]
fn a_block_at_rest_takes_a_step_of_any_length() {
    for foundation in [1.0, 2.0] {
        for (pulse, push) in [(6.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            let block = Instance::new(Wanted::default());
            block.set_all(&[("foundation", foundation), ("pulse.shape", 2.0), ("pulse.amplitude", pulse)]);
            block.initialize(false);
            block.set("a_gx", push);
            assert_eq!(block.step(0.0, 1e6).reached, 1e6);
            assert_eq!([block.get("overturned"), block.get("theta_dot")], [0.0, 0.0]);
            let before = block.output_bits();
            let stepped = block.step(1e6, 1e300);
            assert_eq!(stepped, Stepped { event: false, terminates: false, early: false, reached: 1e300 });
            assert_eq!(block.output_bits(), before, "foundation {foundation}, pulse {pulse}, push {push}");
        }
    }
    let (block, looks) = counted(&["theta"], &[], 0.0);
    block.step(0.0, 1e300);
    assert_eq!(looks.take(), [1e300]);
}

#[test]
fn a_step_with_null_results_is_refused() {
    let block = Instance::new(Wanted::default());
    block.set_all(&[("initial.theta", 0.1), ("foundation", 2.0)]);
    block.initialize(false);
    let before = block.output_bits();
    for missing in 0..4 {
        let [mut event, mut terminates, mut early] = [false; 3];
        let mut reached = f64::NAN;
        let [event, terminates, early] = [&raw mut event, &raw mut terminates, &raw mut early];
        let place = |i, place| if i == missing { std::ptr::null_mut() } else { place };
        let last = if missing == 3 { std::ptr::null_mut() } else { &raw mut reached };
        let status =
            call!(block, do_step, 0.0, 0.5, true, place(0, event), place(1, terminates), place(2, early), last);
        let name = ["eventHandlingNeeded", "terminateSimulation", "earlyReturn", "lastSuccessfulTime"][missing];
        block.refuses(status, &["fmi3DoStep", name, "NULL"]);
        assert_eq!(block.output_bits(), before, "{name}");
    }
    assert_eq!(block.step(0.0, 0.5).reached, 0.5);
}
