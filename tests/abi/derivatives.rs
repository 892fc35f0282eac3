//! Derivatives of the outputs, compared with finite differences.

use std::ffi::c_int;

use crate::functions::*;
use crate::host::{FMU, Instance, call, reference};

const MASS: f64 = 1000.0;
const G: f64 = 9.81;
/// R0 of the default block: gamma/(1 + gamma) g/p².
const R0: f64 = 0.75 * G;

/// The inputs, each with the size of a weight, or of a weight with the lever R0.
pub const INPUTS: [(&str, f64); 5] =
    [("a_gx", G), ("a_gz", G), ("F_x", MASS * G), ("F_z", MASS * G), ("M_y", MASS * G * R0)];

/// Parameters that lead to a regime, and the regime.
pub type Scene = (&'static str, &'static [(&'static str, f64)], f64);

/// Little friction, so that the foot slides, two ties that pull all the time, and two dampers that yield.
macro_rules! tied {
    ($($own:expr),*) => {
        &[
            ("friction", 5e-4),
            ("tie_1.block_x", -1.5),
            ("tie_1.block_z", 10.0),
            ("tie_1.ground_x", -6.0),
            ("tie_1.stiffness", 2e3),
            ("tie_1.pretension", 4e3),
            ("tie_1.damping", 300.0),
            ("tie_1.yield_force", 3.9e3),
            ("tie_2.block_x", 1.0),
            ("tie_2.block_z", 6.0),
            ("tie_2.ground_x", 5.0),
            ("tie_2.stiffness", 3e3),
            ("tie_2.pretension", 3e3),
            ("tie_2.damping", 200.0),
            ("tie_2.yield_force", 2.9e3),
            ("tie_2.hardening", 0.2),
            // So stiff that it yields under the weight of the ties.
            ("damper_1.block_x", 0.5),
            ("damper_1.ground_x", 0.7),
            ("damper_1.ground_z", -1.0),
            ("damper_1.stiffness", 2e6),
            ("damper_1.damping", 200.0),
            ("damper_1.yield_force", 20.0),
            ("damper_1.hardening", 0.1),
            ("damper_2.block_x", -0.5),
            ("damper_2.ground_x", -0.8),
            ("damper_2.ground_z", -1.0),
            ("damper_2.stiffness", 2e6),
            ("damper_2.damping", 200.0),
            ("damper_2.yield_force", 20.0),
            $($own),*
        ]
    };
}

pub const SCENES: [Scene; 11] = [
    ("full contact", &[("initial.theta", 0.001)], 0.0),
    ("tilting left", &[("initial.theta", -0.1)], -1.0),
    ("tilting right", &[("initial.theta", 0.1)], 1.0),
    ("in flight", &[("on_separation", 3.0), ("initial.settled", 0.0), ("initial.theta", 0.1), ("initial.v", 2.0)], 2.0),
    ("rocking to the left on the rigid base", &[("foundation", 2.0), ("initial.theta", -0.1)], -1.0),
    ("rocking to the right on the rigid base", &[("foundation", 2.0), ("initial.theta", 0.1)], 1.0),
    ("sliding on both corners under two ties", tied!(("initial.theta", 0.001)), 0.0),
    ("sliding on a corner under two ties", tied!(("initial.theta", 0.1), ("initial.theta_dot", 0.15)), 1.0),
    (
        "sliding on the left corner of the rigid base under two ties",
        tied!(("initial.theta", -0.1), ("initial.theta_dot", -0.15), ("foundation", 2.0)),
        -1.0,
    ),
    ("sliding on a corner of the rigid base under two ties", tied!(("initial.theta", 0.1), ("foundation", 2.0)), 1.0),
    ("at rest on the rigid base", &[("foundation", 2.0)], 0.0),
];

const START: f64 = 0.05;

/// Returns a block in this regime at t = 0.05 s, with all inputs changing.
pub fn set_up(scene: &Scene) -> Instance {
    let instance = Instance::new(scene.0);
    for (name, value) in scene.1 {
        instance.set(name, *value);
    }
    for (i, (input, size)) in INPUTS.into_iter().enumerate() {
        instance.set(input, 0.002 * (i as f64 + 1.0) * size);
    }
    instance.initialize(Some(1e-12));
    ramp(&instance);
    instance.step(0.0, START);
    assert_eq!(instance.get("regime"), scene.2, "{}", scene.0);
    instance
}

/// All inputs continue to change, by a weight in a few seconds.
fn ramp(instance: &Instance) {
    for (i, (input, size)) in INPUTS.into_iter().enumerate() {
        instance.set_rate(input, (0.1 - 0.07 * i as f64) * size);
    }
}

/// Returns the scale of an output in this scene, for relative errors.
fn size(output: &str) -> f64 {
    match output {
        "N_L" | "N_R" | "H" | "peak.N" | "peak.H" => MASS * G,
        _ if output.ends_with(".tension") || output.ends_with(".force") => MASS * G,
        _ if output.starts_with("power") => MASS * G,
        "M_base" => MASS * G * R0,
        _ if output.starts_with("energy") => MASS * G * R0,
        _ if output.ends_with("_ddot") => G,
        _ => 1.0,
    }
}

/// Returns the derivatives of an output in a direction of inputs.
fn exact(instance: &Instance, output: &str, direction: &[(&str, f64)]) -> f64 {
    let known: Vec<Reference> = direction.iter().map(|(input, _)| reference(input)).collect();
    let along: Vec<f64> = direction.iter().map(|(_, component)| *component).collect();
    let mut result = f64::NAN;
    let status = call!(
        instance,
        get_directional_derivative,
        &reference(output),
        1,
        known.as_ptr(),
        known.len(),
        along.as_ptr(),
        &mut result
    );
    assert_eq!(status, OK, "{:?}", instance.messages());
    result
}

/// Returns the output with an input changed by `shift`, and restores the input.
fn shifted(instance: &Instance, output: &str, input: &str, shift: f64) -> f64 {
    let value = instance.get(input);
    instance.set(input, value + shift);
    let moved = instance.get(output);
    instance.set(input, value);
    moved
}

/// All outputs but the friction demand, a quotient, are linear in the inputs. Differences over 1e-3 and 5e-4 of a weight,
/// extrapolated (error of fourth order), are accurate to 1e-11 for the friction demand and to round-off, 1e-16/1e-3, for the
/// others.
#[test]
fn directional_derivatives_match_differences_of_the_outputs() {
    for scene in &SCENES {
        let instance = set_up(scene);
        for output in FMU.description.real_outputs() {
            for (input, weight) in INPUTS {
                let name = output.name.as_str();
                let difference = |part: f64| {
                    let ahead = shifted(&instance, name, input, part * weight);
                    (ahead - shifted(&instance, name, input, -part * weight)) / (2.0 * part)
                };
                let expected = (4.0 * difference(5e-4) - difference(1e-3)) / 3.0;
                let found = exact(&instance, name, &[(input, weight)]);
                let error = (found - expected).abs();
                assert!(
                    error <= 1e-8 * expected.abs() + 1e-11 * size(name),
                    "{}: d{name}/d{input} = {found:e} instead of {expected:e}",
                    scene.0
                );
                if !output.dependencies.iter().any(|dependency| dependency == input) {
                    assert_eq!(found, 0.0, "{}: ModelStructure says that {name} does not depend on {input}", scene.0);
                }
            }
        }
    }
}

#[test]
fn directions_add_up() {
    for scene in &SCENES {
        let instance = set_up(scene);
        for output in FMU.description.real_outputs() {
            let of = |direction: &[(&str, f64)]| exact(&instance, &output.name, direction);
            let parts = INPUTS.map(|(input, weight)| 0.3 * of(&[(input, weight)]));
            let together = of(&INPUTS.map(|(input, weight)| (input, 0.3 * weight)));
            let scale = parts.iter().map(|part| part.abs()).sum::<f64>();
            // A sliding foot has a constant friction demand, apart from round-off.
            let close = 1e-13 * scale + 1e-15 * size(&output.name);
            assert!((together - parts.iter().sum::<f64>()).abs() <= close, "{}: {}", scene.0, output.name);
            assert_eq!(of(&[]), 0.0, "{}: no direction, no derivative", output.name);
            assert_eq!(of(&[("a_gx", 1.0), ("a_gx", 1.0)]), of(&[("a_gx", 2.0)]), "a direction named twice adds up");
        }
    }
}

/// Reading derivatives changes nothing.
#[test]
fn reading_derivatives_has_no_side_effect() {
    for scene in &SCENES {
        let (asked, other) = (set_up(scene), set_up(scene));
        let before = asked.bits();
        for output in FMU.description.real_outputs() {
            exact(&asked, &output.name, &INPUTS);
            rate(&asked, &output.name);
        }
        assert_eq!(asked.bits(), before);
        for instance in [&asked, &other] {
            instance.step(START, 0.2);
        }
        assert_eq!(asked.bits(), other.bits());
    }
}

/// Returns the time derivative of an output.
fn rate(instance: &Instance, output: &str) -> f64 {
    let (order, mut result): (c_int, f64) = (1, f64::NAN);
    let status = call!(instance, get_real_output_derivatives, &reference(output), 1, &order, &mut result);
    assert_eq!(status, OK, "{output}: {:?}", instance.messages());
    result
}

/// Four steps of 1e-4 s and the five-point difference at the middle one. Its error is d⁴/30 of the fifth derivative, (40 rad/s ·
/// 1e-4 s)⁴/30 = 1e-11 of the first one in the fastest motion here, the vertical one with ω_v = 40 rad/s. Rounding adds
/// 1e-16/1e-4 = 1e-12 of the quantities whose difference is the output.
#[test]
fn output_derivatives_match_differences_in_time() {
    const STEP: f64 = 1e-4;
    let mut wrong = Vec::new();
    for scene in &SCENES {
        let instance = set_up(scene);
        let outputs: Vec<&str> = FMU.description.real_outputs().map(|output| output.name.as_str()).collect();
        let read = || -> Vec<f64> { outputs.iter().map(|output| instance.get(output)).collect() };
        let mut samples = vec![read()];
        let mut rates = Vec::new();
        let events = instance.get("events.last_time");
        for i in 0..4 {
            ramp(&instance);
            let (here, there) = (START + f64::from(i) * STEP, START + f64::from(i + 1) * STEP);
            instance.step(here, there - here);
            samples.push(read());
            if i == 1 {
                rates = outputs.iter().map(|output| rate(&instance, output)).collect();
            }
        }
        assert_eq!(instance.get("events.last_time"), events, "{}: no event between", scene.0);
        for (k, name) in outputs.iter().enumerate() {
            let y = |i: usize| samples[i][k];
            let expected = (y(0) - 8.0 * y(1) + 8.0 * y(3) - y(4)) / (12.0 * STEP);
            let error = (rates[k] - expected).abs();
            if error > 1e-8 * expected.abs() + 1e-9 * size(name) {
                wrong.push(format!("{}: rate of {name} is {:e} instead of {expected:e}", scene.0, rates[k]));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
