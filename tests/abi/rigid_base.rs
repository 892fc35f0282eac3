//! The rigid base: no output ever shows a corner that is pulled down.

use crate::functions::*;
use crate::host::{FMU, Instance, call, reference};

const MASS: f64 = 1000.0;
const G: f64 = 9.81;
/// Three times the acceleration that lifts the default block.
const PUSH: f64 = 7.27;

fn rigid() -> Instance {
    let instance = Instance::new("block");
    instance.set("foundation", 2.0);
    instance
}

/// The block turns to the left about L: `θ̈ = −p² (cos α a_gx/g − sin α)`, `N_L = M (g + b |θ̈|)`.
#[track_caller]
fn turns(instance: &Instance) {
    let (alpha, p) = (0.25_f64, 1.0);
    let size = p * p * (alpha.cos() * PUSH / G - alpha.sin());
    let b = 0.75 * G / (p * p) * alpha.sin();
    assert_eq!([instance.get("regime"), instance.get("theta"), instance.get("N_R")], [-1.0, 0.0, 0.0]);
    for (name, exact) in [("theta_ddot", -size), ("v_ddot", b * size), ("N_L", MASS * (G + b * size))] {
        assert!((instance.get(name) / exact - 1.0).abs() < 1e-12, "{name} = {} instead of {exact}", instance.get(name));
    }
}

#[track_caller]
fn rests(instance: &Instance) {
    assert_eq!([instance.get("regime"), instance.get("theta_ddot")], [0.0; 2]);
    assert_eq!([instance.get("N_L"), instance.get("N_R")], [0.5 * MASS * G; 2]);
}

fn derivative(instance: &Instance, of: &str, to: &str) -> f64 {
    let mut result = f64::NAN;
    let status = call!(instance, get_directional_derivative, &reference(of), 1, &reference(to), 1, &1.0, &mut result);
    assert_eq!(status, OK, "{:?}", instance.messages());
    result
}

/// In Initialization Mode, after it and between steps, the outputs follow the present inputs.
#[test]
fn a_block_that_must_lift_has_lifted_in_the_outputs_of_that_instant() {
    let instance = rigid();
    assert_eq!(instance.setup(None, 0.0, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    rests(&instance);
    instance.set("a_gx", PUSH);
    turns(&instance);
    assert_eq!(call!(instance, exit_initialization_mode), OK);
    turns(&instance);
    for time in [0.0, 0.1] {
        instance.set("a_gx", 0.0);
        rests(&instance);
        instance.set("F_x", -MASS * PUSH);
        turns(&instance);
        instance.set("F_x", 0.0);
        rests(&instance);
        instance.step(time, 0.1);
    }
    // Inputs that were only previewed leave no peak, except at the first instant.
    assert_eq!([instance.get("events.liftoffs"), instance.get("events.last_time")], [0.0; 2]);
    assert!((instance.get("peak.N") - 10_667.0).abs() < 1.0, "{}", instance.get("peak.N"));
}

/// The next step counts the jump as an event and its reaction as a peak; the push decreases.
#[test]
fn a_jump_at_a_communication_point_is_an_event_of_the_next_step() {
    let instance = rigid();
    instance.initialize(None);
    instance.step(0.0, 0.2);
    assert_eq!(instance.get("peak.N"), 0.5 * MASS * G);
    instance.set("a_gx", PUSH);
    instance.set_rate("a_gx", -5.0);
    turns(&instance);
    let first = instance.get("N_L");
    assert_eq!([instance.get("events.liftoffs"), instance.get("peak.N")], [0.0, 0.5 * MASS * G]);
    instance.step(0.2, 1e-3);
    assert_eq!([instance.get("events.liftoffs"), instance.get("events.last_time")], [1.0, 0.2]);
    assert_eq!([instance.get("regime"), instance.get("peak.N")], [-1.0, first]);
}

/// Derivatives at such an instant are those of the outputs shown, by differences to both sides.
#[test]
fn derivatives_are_those_of_the_lifted_block() {
    let instance = rigid();
    instance.initialize(None);
    instance.set("a_gx", PUSH);
    for output in FMU.description.real_outputs() {
        let name = output.name.as_str();
        for (input, size) in [("a_gx", 1.0), ("a_gz", 1.0), ("F_x", MASS), ("F_z", MASS), ("M_y", MASS)] {
            let value = instance.get(input);
            let shifted = |shift: f64| {
                instance.set(input, value + shift * size);
                instance.get(name)
            };
            let difference = (shifted(1e-3) - shifted(-1e-3)) / (2e-3 * size);
            instance.set(input, value);
            let found = derivative(&instance, name, input);
            let error = (found - difference).abs() * size;
            assert!(error <= 1e-6 * instance.get(name).abs().max(1.0), "d{name}/d{input} = {found} or {difference}");
        }
    }
}

/// Ground that falls faster than the block, with each of the three choices.
#[test]
fn a_block_separates_from_ground_that_falls_faster() {
    for choice in [1.0, 2.0, 3.0] {
        let instance = rigid();
        instance.set("on_separation", choice);
        instance.initialize(None);
        instance.step(0.0, 0.5);
        instance.set("a_gz", -1.5 * G);
        assert_eq!([instance.get("regime"), instance.get("N_L"), instance.get("N_R")], [2.0, 0.0, 0.0]);
        assert!((instance.get("v_ddot") - 0.5 * G).abs() < 1e-12);
        assert_eq!([instance.get("separated"), instance.get("v_dot")], [0.0; 2]);
        let status = instance.try_step(0.5, 0.1);
        assert_eq!(instance.get("regime"), 2.0);
        if choice == 1.0 {
            assert_eq!(status, DISCARD);
            assert_eq!(instance.real_status(LAST_SUCCESSFUL_TIME), Ok(0.5));
            assert_eq!([instance.get("separated"), instance.get("overturned")], [1.0, 0.0]);
            assert!((instance.get("v_ddot") - 0.5 * G).abs() < 1e-12);
            continue;
        }
        assert_eq!(status, OK);
        instance.set("a_gz", 0.0);
        if choice == 2.0 {
            assert_eq!([instance.get("separated"), instance.get("v"), instance.get("v_ddot")], [1.0, 0.0, 0.0]);
        } else {
            assert!((instance.get("v") - 0.25 * G * 0.01).abs() < 1e-12, "{}", instance.get("v"));
            let state = instance.save();
            let bytes = instance.serialize(state);
            instance.step(0.6, 0.5);
            rests(&instance);
            assert_eq!([instance.get("separated"), instance.get("events.impacts")], [0.0, 2.0]);
            let landed = instance.bits();
            // A flight above the rigid base can be resumed from bytes.
            let mut again = std::ptr::null_mut();
            assert_eq!(call!(instance, deserialize, bytes.as_ptr(), bytes.len(), &mut again), OK);
            instance.restore(again);
            instance.step(0.6, 0.5);
            assert_eq!(instance.bits(), landed);
            instance.free(state);
            instance.free(again);
        }
    }
}

#[test]
fn the_restitution_factor() {
    let housner = 1.0 - 1.5 * 0.25_f64.sin().powi(2);
    let instance = rigid();
    instance.set("restitution_factor", 1.05);
    instance.initialize(None);
    assert!((instance.get("derived.e") / (1.05 * housner) - 1.0).abs() < 1e-14);
    assert!((instance.get("derived.e_max") / housner - 1.0).abs() < 1e-14);

    let instance = rigid();
    instance.set("restitution_factor", 1.2);
    assert_eq!(instance.setup(None, 0.0, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    let e = housner.to_string();
    let product = (1.2 * housner).to_string();
    let words = ["restitution_factor = 1.2", &e[..12], &product[..12], "at most 1"];
    instance.refuses(call!(instance, exit_initialization_mode), &words);
    instance.set("restitution_factor", 0.9);
    assert_eq!(call!(instance, exit_initialization_mode), OK);

    // Supports do not use it.
    let instance = Instance::new("block");
    instance.set("restitution_factor", 0.9);
    assert_eq!(instance.setup(None, 0.0, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    assert_eq!(call!(instance, exit_initialization_mode), WARNING);
    let messages = instance.messages();
    assert!(messages.len() == 1, "{messages:?}");
    for words in ["restitution_factor", "set, but not read"] {
        assert!(messages[0].text.contains(words), "{messages:?}");
    }
    assert!((instance.get("derived.e") / housner - 1.0).abs() < 1e-14);
    let instance = rigid();
    instance.refuses(instance.try_set("restitution_factor", -0.1), &["restitution_factor = -0.1", "at least 0"]);
}
