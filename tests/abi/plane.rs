//! Tests of steps and outputs that only the planar unit passes: it rests, and stands on a rigid base.

use crate::functions::*;
use crate::host::{Instance, call, reference};

/// Calls `fmi2DoStep` for a block at rest after a pulse, and under a constant push below that of lift-off.
#[test]
fn a_block_at_rest_takes_a_step_of_any_length() {
    for foundation in [1.0, 2.0] {
        for (pulse, push) in [(6.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            let instance = Instance::new("block");
            instance.set("foundation", foundation);
            instance.set("pulse.shape", 2.0);
            instance.set("pulse.amplitude", pulse);
            instance.initialize(None);
            instance.set("a_gx", push);
            instance.step(0.0, 1e6);
            assert_eq!([instance.get("overturned"), instance.get("theta_dot")], [0.0, 0.0]);
            let before = instance.output_bits();
            instance.step(1e6, 1e300);
            assert_eq!(instance.real_status(LAST_SUCCESSFUL_TIME), Ok(1e6 + 1e300));
            assert_eq!(instance.output_bits(), before, "foundation {foundation}, pulse {pulse}, push {push}");
        }
    }
}

/// Found by fuzzing: at time zero the clock resolves steps of any size, so a step took 10¹⁶ of them.
#[test]
fn an_input_that_no_step_can_follow_is_an_error_at_time_zero_too() {
    // The pulse begins so soon that the clock's resolution there underflows.
    for (start, pulse) in [(2.0, 0.0), (0.0, 0.0), (0.0, 1.2e-309)] {
        let instance = Instance::new("block");
        instance.set("pulse.shape", 2.0);
        instance.set("pulse.start", pulse);
        assert_eq!(instance.setup(None, start, None), OK);
        assert_eq!(call!(instance, enter_initialization_mode), OK);
        assert_eq!(call!(instance, exit_initialization_mode), OK);
        instance.set("a_gz", 2e141);
        instance.refuses(instance.try_step(start, 0.5), &["step size fell to", "cannot be met"]);
    }
}

/// Outputs follow the ramp to the end of the step: at rest on the rigid base, `H = M a_gx`.
#[test]
fn outputs_at_the_end_of_a_step_see_the_input_of_that_time() {
    let instance = Instance::new("block");
    instance.set("foundation", 2.0);
    instance.set("a_gx", 0.5);
    instance.initialize(None);
    instance.set_rate("a_gx", 1.0);
    instance.step(0.0, 0.5);
    assert_eq!(instance.get("H"), 1000.0 * 1.0);
    instance.set("a_gx", 0.25);
    assert_eq!(instance.get("H"), 1000.0 * 0.25, "an input set between steps acts at once");
}

/// Outputs in Initialization Mode follow the present inputs, independent of earlier reads.
#[test]
fn inputs_act_at_once_in_initialization_mode() {
    let instance = Instance::new("block");
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    for a_gx in [2.0, -1.0, 0.5] {
        instance.set("a_gx", a_gx);
        // For a block at rest on its supports, only the moment of H turns it.
        let (h, u_ddot) = (instance.get("H"), instance.get("u_ddot"));
        assert!((h - instance.get("mass") * (u_ddot + a_gx)).abs() < 1e-9 * h.abs(), "H = {h} N at {a_gx} m/s2");
        let mut derivative = f64::NAN;
        let (of, to) = (reference("H"), reference("a_gx"));
        assert_eq!(call!(instance, get_directional_derivative, &of, 1, &to, 1, &1.0, &mut derivative), OK);
        assert!((derivative * a_gx - h).abs() < 1e-9 * h.abs(), "dH/da_gx = {derivative} at {a_gx} m/s2");
    }
}

/// In Initialization Mode the outputs follow the inputs as they are set: in full contact
/// `θ̈ = −h a_gx/(i0 + h²)`.
#[test]
fn outputs_follow_the_inputs_in_initialization_mode() {
    let instance = Instance::new("block");
    assert_eq!(instance.setup(None, 0.0, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    let r0 = 0.75 * 9.81;
    let (h, i0) = (r0 * 0.25_f64.cos(), r0 * r0 / 3.0);
    for a_gx in [1.0, -2.0, 0.0, 1.5] {
        instance.set("a_gx", a_gx);
        let exact = -h * a_gx / (i0 + h * h);
        let found = instance.get("theta_ddot");
        assert!((found - exact).abs() < 1e-12, "a_gx = {a_gx}: theta_ddot = {found} instead of {exact}");
    }
}
