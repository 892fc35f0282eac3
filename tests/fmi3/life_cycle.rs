//! Modes and saved states: the same bits after a reset and from a saved state, and in interleaved instances.

use std::ptr::{null, null_mut};

use crate::functions::{ERROR, OK, Text};
use crate::host::{Environment, FMU, Instance, Wanted, call, logger};

const ROCKING: [(&str, f64); 5] = [
    ("pulse.shape", 2.0),
    ("pulse.amplitude", 6.2622),
    ("pulse.period", 1.2566370614359172),
    ("on_separation", 3.0),
    ("epsilon", 0.3),
];

fn new() -> Instance {
    let instance = Instance::new(Wanted { event_mode: true, early_return: true, ..Wanted::default() });
    instance.set_all(&ROCKING);
    instance
}

#[test]
fn a_state_saved_before_an_unhandled_event_continues_with_the_same_bits() {
    let block = new();
    block.initialize(true);
    let stepped = block.step(0.0, 3.0);
    assert!(stepped.event);
    let mut state = null_mut();
    assert_eq!(call!(block, get_fmu_state, &mut state), OK);
    let go_on = || {
        assert_eq!(call!(block, enter_event_mode), OK);
        block.handle_event();
        block.step_by_events(stepped.reached, 3.0, true);
        block.output_bits()
    };
    let bits = go_on();
    assert_eq!(call!(block, set_fmu_state, state), OK);
    assert_eq!(go_on(), bits);
    assert_eq!(call!(block, free_fmu_state, &mut state), OK);
}

#[test]
fn a_reset_in_any_mode_gives_a_new_instance() {
    let block = new();
    block.initialize(true);
    block.step_by_events(0.0, 2.0, true);
    let bits = block.output_bits();
    let through: [fn(&Instance); 5] = [
        |_| {},
        |block| block.ok(call!(block, enter_configuration_mode)),
        |block| block.ok(call!(block, enter_initialization_mode, false, 0.0, 0.0, false, 0.0)),
        |block| {
            block.set_paper_block();
            block.set_all(&ROCKING);
            block.initialize(true);
            assert!(block.step(0.0, 2.0).event);
            block.ok(call!(block, enter_event_mode));
        },
        |block| {
            block.initialize(true);
            block.ok(call!(block, terminate));
        },
    ];
    for act in through {
        block.ok(call!(block, reset));
        assert_eq!(block.get("epsilon"), 0.0);
        act(&block);
    }
    block.ok(call!(block, reset));
    block.set_paper_block();
    block.set_all(&ROCKING);
    block.initialize(true);
    block.step_by_events(0.0, 2.0, true);
    assert_eq!(block.output_bits(), bits);
}

/// Each mode refuses the functions that are illegal in it.
#[test]
fn each_mode_admits_the_calls_of_the_standard() {
    let block = new();
    type Act = fn(&Instance) -> i32;
    let acts: [(&str, Act); 8] = [
        ("fmi3EnterConfigurationMode", |block| call!(block, enter_configuration_mode)),
        ("fmi3ExitConfigurationMode", |block| call!(block, exit_configuration_mode)),
        ("fmi3EnterInitializationMode", |block| call!(block, enter_initialization_mode, false, 0.0, 0.0, false, 0.0)),
        ("fmi3ExitInitializationMode", |block| call!(block, exit_initialization_mode)),
        ("fmi3EnterEventMode", |block| call!(block, enter_event_mode)),
        ("fmi3EnterStepMode", |block| call!(block, enter_step_mode)),
        ("fmi3DoStep", |block| block.try_step(0.0, 0.1).0),
        ("fmi3Terminate", |block| call!(block, terminate)),
    ];
    // The calls that lead to each mode, and the functions legal there.
    let modes: [(&[usize], &[usize], &str); 6] = [
        (&[], &[0, 2], "Instantiated"),
        (&[0], &[1], "Configuration Mode"),
        (&[2], &[3], "Initialization Mode"),
        (&[2, 3], &[5, 7], "Event Mode"),
        (&[2, 3, 5], &[4, 6, 7], "Step Mode"),
        (&[2, 3, 5, 7], &[], "Terminated"),
    ];
    for (way, admitted, mode) in modes {
        for (number, (name, act)) in acts.iter().enumerate() {
            block.ok(call!(block, reset));
            way.iter().for_each(|&step| block.ok(acts[step].1(&block)));
            let status = act(&block);
            if admitted.contains(&number) {
                block.ok(status);
            } else {
                block.refuses(status, &[name, "not allowed in", mode]);
            }
        }
    }
}

#[test]
fn event_mode_must_be_requested() {
    let block = Instance::new(Wanted::default());
    block.initialize(false);
    block.refuses(call!(block, enter_event_mode), &["fmi3EnterEventMode", "eventModeUsed was false"]);
}

#[test]
fn interleaved_instances_do_not_touch_one_another() {
    let [one, other] = [(), ()].map(|()| new());
    for block in [&one, &other] {
        block.initialize(true);
    }
    for i in 0..20 {
        let (here, there) = (f64::from(i) * 0.1, f64::from(i + 1) * 0.1);
        one.step_by_events(here, there, true);
        other.step_by_events(here, there, true);
    }
    let alone = new();
    alone.initialize(true);
    for i in 0..20 {
        alone.step_by_events(f64::from(i) * 0.1, f64::from(i + 1) * 0.1, true);
    }
    assert_eq!(one.output_bits(), alone.output_bits());
    assert_eq!(other.output_bits(), alone.output_bits());
}

#[test]
fn log_categories_are_selected() {
    let block = Instance::new(Wanted { logging: true, ..Wanted::default() });
    block.set_all(&ROCKING);
    block.initialize(false);
    block.step(0.0, 2.0);
    let lines = block.messages();
    let of = |category: &str| lines.iter().filter(|line| line.1 == category).count() as f64;
    assert_eq!(of("logSteps"), 1.0);
    assert!(of("logEvents") >= block.get("events.impacts") + block.get("events.liftoffs"));
    assert!(lines.iter().all(|line| line.0 == OK));
    let events = c"logEvents";
    block.ok(call!(block, set_debug_logging, false, 0, std::ptr::null()));
    block.ok(call!(block, set_debug_logging, true, 1, &events.as_ptr()));
    block.step(2.0, 6.0);
    let lines = block.messages();
    assert!(!lines.is_empty() && lines.iter().all(|line| line.1 == "logEvents"), "{lines:?}");
    block.ok(call!(block, set_debug_logging, true, 0, std::ptr::null()));
    let unknown = c"logAll";
    block.refuses(call!(block, set_debug_logging, true, 1, &unknown.as_ptr()), &["logAll", "does not exist"]);
    block.ok(call!(block, set_debug_logging, false, 0, std::ptr::null()));
    block.step(8.0, 2.0);
    assert!(block.messages().is_empty());
    block.refuses(call!(block, exit_initialization_mode), &["fmi3ExitInitializationMode"]);
}

/// Without `loggingOn` refused calls have their message; categories are then switched one by one.
#[test]
fn without_logging_errors_are_logged() {
    let environment = Environment::default();
    let place = std::ptr::from_ref(&environment).cast_mut().cast();
    let of = |token: Text| {
        let instantiate = FMU.functions.instantiate_co_simulation;
        let name = c"block".as_ptr();
        // SAFETY: texts end with 0, and the environment lives as long as the instance.
        unsafe { instantiate(name, token, null(), false, false, false, false, null(), 0, place, Some(logger), None) }
    };
    assert!(of(c"{no token}".as_ptr()).is_null());
    let [(status, category, text)] = &*std::mem::take(&mut *environment.messages.lock().unwrap()) else {
        panic!("a refused instantiation has one message")
    };
    assert_eq!((*status, category.as_str()), (ERROR, "logStatusError"), "{text}");
    let handle = of(FMU.token.as_ptr());
    assert!(!handle.is_null());
    let refused = || {
        // SAFETY: a live instance.
        let status = unsafe { (FMU.functions.exit_initialization_mode)(handle) };
        assert_eq!(status, ERROR);
        environment.messages.lock().unwrap().len()
    };
    let choose = |logging, category: &std::ffi::CStr| {
        // SAFETY: a live instance, and one text.
        let status = unsafe { (FMU.functions.set_debug_logging)(handle, logging, 1, &category.as_ptr()) };
        assert_eq!(status, OK);
    };
    assert_eq!(refused(), 1);
    choose(true, c"logEvents");
    assert_eq!(refused(), 2);
    choose(false, c"logStatusError");
    assert_eq!(refused(), 2);
    choose(false, c"logEvents");
    assert_eq!(refused(), 2);
    choose(true, c"logStatusError");
    assert_eq!(refused(), 3);
    // SAFETY: not used afterwards.
    unsafe { (FMU.functions.free_instance)(handle) }
}
