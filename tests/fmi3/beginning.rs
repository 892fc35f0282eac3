//! Derivatives of the initial unknowns in Initialization Mode, with respect to inputs, parameters, a record in arrays and time.

use proptest::test_runner::TestRunner;
use roxmltree::Document;

use crate::differences::draw::{Draw, KNOWNS};
use crate::differences::{Declared, Host, Pairs, Sizes, compare, real_unknowns};
use crate::functions::OK;
use crate::host::{FMU, Instance, Wanted, call, reference};

const SAMPLES: [[f64; 5]; 2] = [[1.0, 3.0, -2.0, 2.5, 1.0], [2.0, -1.0, -2.2, 1.5, 1.0]];
const ARRAYS: [&str; 2] = ["record.horizontal_samples", "record.vertical_samples"];

/// The initial unknowns of FMI 3.0.
fn declared() -> Declared {
    let text = std::str::from_utf8(&FMU.files["modelDescription.xml"]).unwrap();
    let document = Document::parse(text).unwrap();
    let name = |reference: &str| {
        let reference: u32 = reference.parse().unwrap();
        FMU.variables.iter().find(|(_, variable)| variable.reference == reference).unwrap().0.clone()
    };
    document
        .descendants()
        .filter(|node| node.has_tag_name("InitialUnknown"))
        .map(|node| {
            let dependencies = node.attribute("dependencies").unwrap().split_whitespace().map(name);
            (name(node.attribute("valueReference").unwrap()), dependencies.collect())
        })
        .collect()
}

impl Host for Instance {
    fn set(&mut self, name: &str, value: f64) {
        Instance::set(self, name, value);
    }

    fn get(&mut self, name: &str) -> f64 {
        Instance::get(self, name)
    }

    fn derivatives(&mut self, unknowns: &[&str], known: &str) -> Vec<f64> {
        directional(self, unknowns, &[known], &[1.0])
    }
}

fn references(names: &[&str]) -> Vec<u32> {
    names.iter().map(|name| reference(name)).collect()
}

fn directional(instance: &Instance, unknowns: &[&str], knowns: &[&str], seed: &[f64]) -> Vec<f64> {
    let (unknowns, knowns) = (references(unknowns), references(knowns));
    let mut found = vec![f64::NAN; unknowns.len()];
    instance.ok(call!(
        instance,
        get_directional_derivative,
        unknowns.as_ptr(),
        unknowns.len(),
        knowns.as_ptr(),
        knowns.len(),
        seed.as_ptr(),
        seed.len(),
        found.as_mut_ptr(),
        found.len()
    ));
    found
}

/// Returns `count` derivatives of the weighted sum.
fn adjoint(instance: &Instance, unknowns: &[&str], knowns: &[&str], seed: &[f64], count: usize) -> Vec<f64> {
    let (unknowns, knowns) = (references(unknowns), references(knowns));
    let mut found = vec![f64::NAN; count];
    instance.ok(call!(
        instance,
        get_adjoint_derivative,
        unknowns.as_ptr(),
        unknowns.len(),
        knowns.as_ptr(),
        knowns.len(),
        seed.as_ptr(),
        seed.len(),
        found.as_mut_ptr(),
        count
    ));
    found
}

fn set_samples(instance: &Instance, samples: &[[f64; 5]; 2]) {
    for (name, samples) in ARRAYS.into_iter().zip(samples) {
        instance.ok(call!(instance, set_float64, &reference(name), 1, samples.as_ptr(), samples.len()));
    }
}

/// An instance in Initialization Mode with these values and records, at this time.
fn begin(values: &[(&'static str, f64)], samples: &[[f64; 5]; 2], time: f64) -> Instance {
    let instance = Instance::new(Wanted::default());
    instance.ok(call!(instance, enter_configuration_mode));
    instance.set("record.samples", 5.0);
    instance.ok(call!(instance, exit_configuration_mode));
    instance.set_all(values);
    set_samples(&instance, samples);
    instance.ok(call!(instance, enter_initialization_mode, false, 0.0, time, false, 0.0));
    instance
}

#[test]
fn derivatives_match_differences_of_the_values() {
    let declared = declared();
    let (mut runner, mut pairs) = (TestRunner::deterministic(), Pairs::new());
    for i in 0..100 {
        let draw = Draw::next(&mut runner);
        let samples = if i % 2 == 0 { SAMPLES } else { [[0.0; 5]; 2] };
        compare(&mut begin(&draw.values, &samples, 0.0), &draw, &declared, &mut pairs);
    }
    for unknown in real_unknowns(&declared) {
        for known in KNOWNS.iter().filter(|known| declared[unknown].contains(known.name)) {
            let found = pairs[&(unknown.to_string(), known.name.to_string())];
            assert!(found.compared > 0, "d{unknown}/d{}", known.name);
        }
    }
}

/// Only the samples around the start act, and linearly, so a difference over 1 m/s² is exact up to round-off.
#[test]
fn samples_are_directions() {
    let declared = declared();
    let unknowns =
        ["theta_ddot", "v_ddot", "N_L", "H", "power.input", "record.PGA", "record.PGA_vertical", "record.end", "u_dot"];
    let (mut runner, mut nonzero) = (TestRunner::deterministic(), 0);
    for _ in 0..20 {
        let draw = Draw::next(&mut runner);
        let mut instance = begin(&draw.values, &SAMPLES, 0.0);
        let sizes = Sizes::of(&mut instance);
        let values = |instance: &Instance| unknowns.map(|unknown| instance.get(unknown));
        for (place, array) in ARRAYS.into_iter().enumerate() {
            for i in 0..5 {
                let mut seed = [0.0; 5];
                seed[i] = 1.0;
                let found = directional(&instance, &unknowns, &[array], &seed);
                let [ahead, behind] = [1e-3, -1e-3].map(|shift| {
                    let mut samples = SAMPLES;
                    samples[place][i] += shift;
                    set_samples(&instance, &samples);
                    values(&instance)
                });
                set_samples(&instance, &SAMPLES);
                for (k, unknown) in unknowns.into_iter().enumerate() {
                    let expected = (ahead[k] - behind[k]) / 2e-3;
                    let size = sizes.unknown(unknown, ahead[k]);
                    assert!((found[k] - expected).abs() <= 1e-10 * size, "{unknown}, {array}[{i}]: {draw:?}");
                    nonzero += u32::from(found[k].abs() > 1e-6 * size);
                    assert!(found[k] == 0.0 || declared[unknown].contains(array), "{unknown}, {array}");
                }
            }
        }
        assert_eq!(directional(&instance, &unknowns, &["intermediate.interval"], &[1.0]), [0.0; 9]);
    }
    assert!(nonzero > 100, "{nonzero}");
}

/// The start time acts only through the pulse and the records.
#[test]
fn time_is_a_direction() {
    let declared = declared();
    let unknowns = real_unknowns(&declared);
    let mut runner = TestRunner::deterministic();
    let mut dependent = std::collections::BTreeSet::new();
    for _ in 0..40 {
        let draw = Draw::next(&mut runner);
        let mut here = begin(&draw.values, &SAMPLES, 0.0);
        let sizes = Sizes::of(&mut here);
        let found = here.derivatives(&unknowns, "time");
        let values = |time: f64| {
            let instance = begin(&draw.values, &SAMPLES, time);
            (unknowns.iter().map(|name| instance.get(name)).collect::<Vec<f64>>(), instance.get("regime"))
        };
        let [ahead, behind, near_ahead, near_behind] = [1e-4, -1e-4, 5e-5, -5e-5].map(values);
        if ahead.1 != behind.1 {
            continue;
        }
        for (i, unknown) in unknowns.iter().enumerate() {
            if unknown.contains("peak") || unknown.contains("friction") {
                continue;
            }
            let wide = (ahead.0[i] - behind.0[i]) / 2e-4;
            let expected = (4.0 * (near_ahead.0[i] - near_behind.0[i]) / 1e-4 - wide) / 3.0;
            let size = sizes.unknown(unknown, ahead.0[i]);
            assert!((found[i] - expected).abs() <= 1e-9 * expected.abs() + 1e-9 * size, "{unknown}: {draw:?}");
            assert!(found[i] == 0.0 || declared[*unknown].contains("time"), "{unknown}");
            if found[i].abs() > 1e-6 * size {
                dependent.insert(unknown.to_string());
            }
        }
    }
    // Time merely decides whether a foot slides at the start, and with it these.
    const DECIDED: [&str; 15] = [
        "u_dot",
        "energy.kinetic",
        "energy.potential",
        "energy.total",
        "slip_rate",
        "power.ties",
        "tie_1.tension",
        "tie_2.tension",
        "power.dampers",
        "damper_1.force",
        "damper_2.force",
        "tie_1.plastic",
        "tie_2.plastic",
        "damper_1.plastic",
        "damper_2.plastic",
    ];
    let all = unknowns.iter().filter(|name| declared[**name].contains("time") && !DECIDED.contains(name));
    let smooth = all.filter(|name| !name.contains("peak") && !name.contains("friction"));
    assert_eq!(dependent, smooth.map(|name| name.to_string()).collect());
}

/// `seed^T J direction` is the same from both derivatives, with samples of a record among the knowns.
#[test]
fn adjoint_and_directional_derivatives_belong_together() {
    let mut runner = TestRunner::deterministic();
    let knowns = ["dimensionless.alpha", ARRAYS[0], "initial.theta", "gamma", "a_gz", "time", ARRAYS[1]];
    let unknowns = ["N_L", "theta_ddot", "derived.R0", "record.PGA", "energy.total", "events.last_time"];
    let direction: Vec<f64> = (0..15).map(|i| (1.3 * f64::from(i)).sin()).collect();
    for _ in 0..40 {
        let draw = Draw::next(&mut runner);
        let instance = begin(&draw.values, &SAMPLES, 0.0);
        let seed: Vec<f64> = (0..6).map(|i| (0.7 + f64::from(i)).cos()).collect();
        let forward = directional(&instance, &unknowns, &knowns, &direction);
        let backward = adjoint(&instance, &unknowns, &knowns, &seed, 15);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let absolute = |x: &[f64]| x.iter().map(|x| x.abs()).collect::<Vec<f64>>();
        let (one, other) = (dot(&seed, &forward), dot(&direction, &backward));
        let size = dot(&absolute(&direction), &absolute(&backward)) + dot(&absolute(&seed), &absolute(&forward));
        assert!(one.abs() > 0.0 && (one - other).abs() <= 1e-12 * size, "{one}, {other}: {draw:?}");
    }
}

#[test]
fn undeclared_dependencies_are_refused() {
    let instance = begin(&[("record.dt", 0.3)], &SAMPLES, 0.0);
    let refuses = |unknown: &str, known: &str, count: usize, words: &[&str]| {
        let (unknown, known, seed) = (reference(unknown), reference(known), vec![1.0; count]);
        let (mut found, mut gradient) = (-1.5, vec![-1.5; count]);
        let status =
            call!(instance, get_directional_derivative, &unknown, 1, &known, 1, seed.as_ptr(), count, &mut found, 1);
        instance.refuses(status, words);
        let status =
            call!(instance, get_adjoint_derivative, &unknown, 1, &known, 1, &1.0, 1, gradient.as_mut_ptr(), count);
        instance.refuses(status, words);
        assert_eq!(found, -1.5, "nothing is written");
    };
    refuses(
        "dimensionless.alpha",
        "gamma",
        1,
        &["dimensionless.alpha", "expected an output or a calculated parameter"],
    );
    refuses("theta", "theta", 1, &["theta", "expected an input or a parameter"]);
    refuses("theta", "foundation", 1, &["foundation"]);
    refuses("theta", "record.samples", 1, &["record.samples", "UInt64"]);
    refuses("theta", "indicator.L", 1, &["indicator.L", "expected an input or a parameter"]);
    refuses("indicator.L", "gamma", 1, &["indicator.L", "no output"]);
    refuses("theta", ARRAYS[0], 4, &["= 4", "expected 5"]);
    assert_eq!(call!(instance, exit_initialization_mode), OK);
    refuses("theta", "gamma", 1, &["gamma", "expected an input"]);
    refuses("theta", ARRAYS[0], 5, &["does not exist"]);
}
