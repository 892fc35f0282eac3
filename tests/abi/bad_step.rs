//! Refused steps, and the accepted rounding of a master's clock.

use crate::functions::*;
use crate::host::{Instance, call};

/// An instance at t = 2 s whose run stops at 10 s.
fn at_two() -> Instance {
    let instance = Instance::new("block");
    instance.set("initial.theta", 0.1);
    assert_eq!(instance.setup(None, 0.0, Some(10.0)), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    assert_eq!(call!(instance, exit_initialization_mode), OK);
    instance.go(0.0, 2.0, 0.5);
    instance
}

#[test]
fn impossible_steps_are_refused_with_both_times_and_change_nothing() {
    let (nan, infinite) = (f64::NAN, f64::INFINITY);
    let bad: [(f64, f64, &[&str]); 16] = [
        (1.5, 0.5, &["currentCommunicationPoint", "1.5", "2.0"]),
        (2.5, 0.5, &["currentCommunicationPoint", "2.5", "2.0"]),
        (0.0, 0.5, &["currentCommunicationPoint", "0.0", "2.0"]),
        (-2.0, 0.5, &["currentCommunicationPoint", "-2.0", "2.0"]),
        (nan, 0.5, &["currentCommunicationPoint", "NaN", "2.0"]),
        (infinite, 0.5, &["currentCommunicationPoint", "inf", "2.0"]),
        // A clock off by more than 1e-9 of max(h, |t|).
        (2.0 + 5e-9, 0.5, &["currentCommunicationPoint", "2.000000005", "2.0"]),
        (2.0 - 5e-9, 0.5, &["currentCommunicationPoint", "1.999999995", "2.0"]),
        (2.0, 0.0, &["communicationStepSize", "0", "2"]),
        (2.0, -0.0, &["communicationStepSize", "0", "2"]),
        (2.0, -0.5, &["communicationStepSize", "-0.5", "2"]),
        (2.0, nan, &["communicationStepSize", "NaN", "2"]),
        (2.0, infinite, &["communicationStepSize", "inf", "2"]),
        (2.0, 8.5, &["stopTime", "10.5", "10.0"]),
        (2.0, 8.0 + 5e-8, &["stopTime", "10.00000005", "10.0"]),
        (2.0, 1e-17, &["communicationStepSize", "1e-17", "2.0"]),
    ];
    let undisturbed = at_two();
    let instance = at_two();
    for (time, step, words) in bad {
        instance.refuses(instance.try_step(time, step), words);
        assert_eq!(instance.bits(), undisturbed.bits(), "a step of {step} s at {time} s");
    }
    for i in [&instance, &undisturbed] {
        i.go(2.0, 10.0, 0.5);
    }
    assert_eq!(instance.bits(), undisturbed.bits());
    instance.refuses(instance.try_step(10.0, 0.5), &["stopTime", "10.5", "10.0"]);
}

/// Masters sum up their steps: an error of 1e-9 max(h, |t|) is accepted, and the master's time becomes the instance's.
#[test]
fn a_clock_off_by_rounding_is_accepted_and_adopted() {
    for (time, step) in [(2.0 + 1.9e-9, 0.5), (2.0 - 1.9e-9, 0.5), (2.0 + 4.9e-9, 5.0), (2.0_f64.next_up(), 1e-3)] {
        let instance = at_two();
        instance.step(time, step);
        assert_eq!(instance.real_status(LAST_SUCCESSFUL_TIME), Ok(time + step));
        // The next step begins at the new time, not at the exact end of the last one.
        instance.step(time + step, 0.5);
    }
}

/// At large times 1e-9 |t| may be longer than the step.
#[test]
fn a_clock_never_skips_more_than_a_thousandth_of_a_step() {
    let start = 1e9;
    for (off, step, accepted) in [(0.5, 1.0, false), (1.1e-3, 1.0, false), (-1.1e-3, 1.0, false), (0.9e-3, 1.0, true)] {
        let instance = Instance::new("block");
        assert_eq!(instance.setup(None, start, Some(start + 10.0)), OK);
        assert_eq!(call!(instance, enter_initialization_mode), OK);
        assert_eq!(call!(instance, exit_initialization_mode), OK);
        let status = instance.try_step(start + off, step);
        if accepted {
            assert_eq!(status, OK, "{off} s");
        } else {
            instance.refuses(status, &["currentCommunicationPoint"]);
            // A step may not pass the stop time by more, either.
            instance.refuses(instance.try_step(start, 10.0 + 0.02), &["stopTime"]);
            instance.step(start, 10.0);
        }
    }
}

#[test]
fn a_stop_time_overshot_by_rounding_is_accepted() {
    let instance = at_two();
    instance.step(2.0, 8.0 + 9e-9);
    assert_eq!(instance.real_status(LAST_SUCCESSFUL_TIME), Ok(2.0 + (8.0 + 9e-9)));
}

/// 100 000 steps of 1e-4 s, the master's time summed up as 0.0001 + 0.0001 + …: its stop is off by 2e-9 s in the end.
#[test]
fn a_summed_clock_reaches_its_stop() {
    let instance = Instance::new("block");
    assert_eq!(instance.setup(None, 0.0, Some(1.0)), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    assert_eq!(call!(instance, exit_initialization_mode), OK);
    let mut time = 0.0;
    for _ in 0..10_000 {
        instance.step(time, 1e-4);
        time += 1e-4;
    }
    assert!(time != 1.0 && (time - 1.0).abs() < 1e-9);
}

/// A failed integration reports its reason, and the instance can be read and reset.
#[test]
fn an_overflow_is_an_error_with_the_time_of_the_last_good_state() {
    let instance = at_two();
    instance.set("a_gx", 1e300);
    instance.refuses(instance.try_step(2.0, 0.5), &["fmi2DoStep", "t = 2"]);
    assert!(instance.get("theta").is_finite());
    instance.refuses(instance.try_step(2.0, 0.5), &["fmi2DoStep", "error"]);
    assert_eq!(call!(instance, reset), OK);
    instance.initialize(None);
    instance.step(0.0, 0.5);
}

#[test]
fn a_step_to_no_finite_time_is_refused() {
    let instance = Instance::new("block");
    assert_eq!(instance.setup(None, 1e308, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    assert_eq!(call!(instance, exit_initialization_mode), OK);
    instance.refuses(instance.try_step(1e308, 1e308), &["communicationStepSize = 1e308", "a finite time"]);
    assert_eq!(instance.real_status(LAST_SUCCESSFUL_TIME), Ok(1e308));
}
