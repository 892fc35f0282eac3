//! Saved states: a restored run gives the same bits (standard, 2.1.8).

use std::ptr::null_mut;

use crate::functions::*;
use crate::host::{Instance, call};

/// A rocking block that uses all parts of a state: rates of inputs, a pulse, creeping supports.
fn prepared() -> Instance {
    let instance = Instance::new("block");
    instance.set("pulse.shape", 4.0);
    instance.set("pulse.amplitude", 5.0);
    instance.set("pulse.start", 0.3);
    instance.set("epsilon", 0.05);
    instance.set("on_separation", 2.0);
    instance
}

/// Runs from t = 0, and returns the outputs after each step from `first` on.
fn go_on(instance: &Instance, first: i32) -> Vec<Vec<u64>> {
    (first..80)
        .map(|i| {
            let (here, there) = (0.05 * f64::from(i), 0.05 * f64::from(i + 1));
            if i % 4 == 0 {
                instance.set_rate("a_gx", 1.5 * f64::from(i % 3 - 1));
            }
            instance.step(here, there - here);
            instance.bits()
        })
        .collect()
}

fn to_step(instance: &Instance, steps: i32) {
    for i in 0..steps {
        let (here, there) = (0.05 * f64::from(i), 0.05 * f64::from(i + 1));
        if i % 4 == 0 {
            instance.set_rate("a_gx", 1.5 * f64::from(i % 3 - 1));
        }
        instance.step(here, there - here);
    }
}

#[test]
fn going_back_to_any_step_gives_the_same_bits() {
    let mut uplifted = 0;
    for steps in [0, 1, 7, 12, 20, 33, 50] {
        let instance = prepared();
        instance.initialize(None);
        to_step(&instance, steps);
        // A rate that is not yet used is part of the state.
        instance.set_rate("F_x", 100.0);
        uplifted += i32::from(instance.get("uplift_L") > 0.0 || instance.get("uplift_R") > 0.0);
        let (state, seen) = (instance.save(), instance.bits());
        let first = go_on(&instance, steps);
        for _ in 0..2 {
            instance.restore(state);
            assert_eq!(instance.bits(), seen, "at step {steps}");
            assert_eq!(go_on(&instance, steps), first, "from step {steps}");
        }
        instance.free(state);
    }
    assert!(uplifted >= 2, "some of the states are in the middle of an uplift");
}

#[test]
fn a_state_is_saved_and_restored_in_every_phase() {
    let instance = prepared();
    let before_setup = instance.save();
    assert_eq!(instance.setup(Some(1e-9), 0.0, None), OK);
    let set_up = instance.save();
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    instance.set("initial.theta", 0.06);
    let initializing = instance.save();
    assert_eq!(call!(instance, exit_initialization_mode), OK);
    let initialized = instance.save();
    let run = go_on(&instance, 0);
    assert_eq!(call!(instance, terminate), OK);
    let terminated = instance.save();

    instance.restore(initialized);
    assert_eq!(go_on(&instance, 0), run);
    instance.restore(initializing);
    assert_eq!(instance.get("initial.theta"), 0.06);
    assert_eq!(call!(instance, exit_initialization_mode), OK);
    assert_eq!(go_on(&instance, 0), run);
    for early in [before_setup, set_up] {
        instance.restore(early);
        instance.refuses(instance.try_step(0.0, 0.05), &["fmi2DoStep", "instantiated"]);
        if early == before_setup {
            assert_eq!(instance.setup(Some(1e-9), 0.0, None), OK);
        }
        instance.set("initial.theta", 0.06);
        assert_eq!(call!(instance, enter_initialization_mode), OK);
        assert_eq!(call!(instance, exit_initialization_mode), OK);
        assert_eq!(go_on(&instance, 0), run);
    }
    instance.restore(terminated);
    assert_eq!(instance.bits(), *run.last().unwrap());
    instance.refuses(instance.try_step(4.0, 0.05), &["fmi2DoStep", "terminated"]);
    // Restores after a reset and after an error, too.
    assert_eq!(call!(instance, reset), OK);
    instance.restore(initialized);
    instance.set("a_gx", 1e300);
    assert_eq!(instance.try_step(0.0, 0.05), ERROR);
    instance.messages();
    instance.restore(initialized);
    assert_eq!(go_on(&instance, 0), run);
    for state in [before_setup, set_up, initializing, initialized, terminated] {
        instance.free(state);
    }
}

#[test]
fn a_serialized_state_continues_in_another_instance_with_the_same_bits() {
    let one = prepared();
    one.initialize(Some(1e-9));
    to_step(&one, 17);
    one.set_rate("M_y", 500.0);
    let state = one.save();
    let bytes = one.serialize(state);
    one.free(state);
    let bits = one.bits();
    let run = go_on(&one, 17);
    drop(one);

    let other = Instance::new("another name");
    let mut state = null_mut();
    // The importer's buffer may be longer than the state.
    let mut padded = bytes.clone();
    padded.extend([42; 100]);
    assert_eq!(call!(other, deserialize, padded.as_ptr(), padded.len(), &mut state), OK, "{:?}", other.messages());
    assert_eq!(other.serialize(state), bytes);
    other.restore(state);
    other.free(state);
    assert_eq!(other.bits(), bits);
    assert_eq!(go_on(&other, 17), run);
}

#[test]
fn an_existing_state_is_overwritten() {
    let instance = prepared();
    instance.initialize(None);
    let mut state = instance.save();
    let address = state;
    to_step(&instance, 9);
    assert_eq!(call!(instance, get_fmu_state, &mut state), OK);
    assert_eq!(state, address, "the standard, 2.1.8: an existing state is reused");
    let run = go_on(&instance, 9);
    instance.restore(state);
    assert_eq!(go_on(&instance, 9), run);
    instance.free(state);
}

/// A saved state is a copy, which neither the instance nor another state changes.
#[test]
fn states_do_not_depend_on_each_other() {
    let instance = prepared();
    instance.initialize(None);
    let first = instance.save();
    let bytes = instance.serialize(first);
    to_step(&instance, 30);
    let second = instance.save();
    assert_ne!(instance.serialize(second), bytes);
    instance.free(second);
    assert_eq!(instance.serialize(first), bytes);
    assert_eq!(call!(instance, reset), OK);
    assert_eq!(instance.serialize(first), bytes);
    // A state survives a reset (standard, 2.1.8).
    instance.restore(first);
    instance.step(0.0, 0.05);
    instance.free(first);
}

/// The logged categories are not part of a state.
#[test]
fn a_state_does_not_turn_logging_on_or_off() {
    let instance = prepared();
    instance.initialize(None);
    let state = instance.save();
    assert_eq!(call!(instance, set_debug_logging, 1, 0, std::ptr::null()), OK);
    instance.restore(state);
    instance.step(0.0, 0.05);
    assert!(instance.messages().iter().any(|message| message.category == "logSteps"));
    instance.free(state);
}
