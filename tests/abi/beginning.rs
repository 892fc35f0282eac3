//! Derivatives of the initial unknowns in Initialization Mode, with respect to inputs and parameters.

use std::f64::consts::FRAC_PI_2;

use proptest::test_runner::TestRunner;

use crate::differences::draw::{Draw, KNOWNS};
use crate::differences::{Host, Pairs, compare, declared, real_unknowns};
use crate::functions::*;
use crate::host::{FMU, Instance, call, reference};

/// Samples of a record in parts of g, every `record.dt`.
const RECORD: &str = "0.1\n0.3\n-0.2\n0.25\n0.1\n";

impl Host for Instance {
    fn set(&mut self, name: &str, value: f64) {
        Instance::set(self, name, value);
    }

    fn get(&mut self, name: &str) -> f64 {
        Instance::get(self, name)
    }

    fn derivatives(&mut self, unknowns: &[&str], known: &str) -> Vec<f64> {
        let unknowns: Vec<Reference> = unknowns.iter().map(|name| reference(name)).collect();
        let mut found = vec![f64::NAN; unknowns.len()];
        let (known, count) = (reference(known), unknowns.len());
        let status =
            call!(self, get_directional_derivative, unknowns.as_ptr(), count, &known, 1, &1.0, found.as_mut_ptr());
        assert_eq!(status, OK, "{:?}", self.messages());
        found
    }
}

/// An instance in Initialization Mode with these values.
fn begin(values: &[(&str, f64)]) -> Instance {
    let instance = Instance::new("beginning");
    values.iter().for_each(|(name, value)| instance.set(name, *value));
    assert_eq!(instance.setup(None, 0.0, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    instance
}

#[test]
fn derivatives_match_differences_of_the_values() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("record.txt");
    std::fs::write(&path, RECORD).unwrap();
    let declared = declared(&FMU.xml);
    let (mut runner, mut pairs) = (TestRunner::deterministic(), Pairs::new());
    for i in 0..100 {
        let draw = Draw::next(&mut runner);
        let mut instance = begin(&draw.values);
        if i % 2 == 0 {
            instance.set_text("record.horizontal", path.to_str().unwrap());
            instance.set_text("record.horizontal_unit", "g");
        }
        compare(&mut instance, &draw, &declared, &mut pairs);
    }
    for unknown in real_unknowns(&declared) {
        for known in KNOWNS.iter().filter(|known| declared[unknown].contains(known.name)) {
            let found = pairs[&(unknown.to_string(), known.name.to_string())];
            assert!(found.compared > 0, "d{unknown}/d{}", known.name);
        }
    }
}

/// α = atan(width/height): closed forms, in a direction of several knowns.
#[test]
fn directions_add_up() {
    let instance = begin(&[("parameterization", 2.0), ("physical.width", 3.0), ("physical.height", 4.0)]);
    let (unknowns, knowns) =
        (["derived.alpha", "derived.R0"].map(reference), ["physical.width", "physical.height"].map(reference));
    let mut found = [f64::NAN; 2];
    let direction = [0.1, -0.2];
    let (at, along) = (unknowns.as_ptr(), knowns.as_ptr());
    let status = call!(instance, get_directional_derivative, at, 2, along, 2, direction.as_ptr(), found.as_mut_ptr());
    assert_eq!(status, OK);
    let expected = [(4.0 * 0.1 + 3.0 * 0.2) / 25.0, 0.5 * (3.0 * 0.1 - 4.0 * 0.2) / 5.0];
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-15, "{found}, not {expected}");
    }
}

/// Derivatives with respect to parameters that are not read, or that do not act, are zero.
#[test]
fn unused_parameters_have_no_effect() {
    let mut instance = begin(&[("initial.theta", 0.1)]);
    let declared = declared(&FMU.xml);
    let unknowns = real_unknowns(&declared);
    for known in ["physical.width", "physical.K", "restitution_factor", "initial.v", "pulse.amplitude", "record.start"]
    {
        assert!(instance.derivatives(&unknowns, known).iter().all(|derivative| *derivative == 0.0), "{known}");
    }
}

/// A block at rest is at many kinks: `|H|`, the larger of two equal reactions, the sign of a zero rotation.
///
/// A peak grows in either direction; the other outputs have the derivative of the block's side.
#[test]
fn derivatives_at_a_kink_are_one_sided() {
    let mut rigid = begin(&[("foundation", 2.0), ("initial.theta", 0.0)]);
    let couple = 0.5 / 3.640549260430305 * 2.0;
    let [left, right, peak] = rigid.derivatives(&["N_L", "N_R", "peak.N"], "M_y")[..] else { panic!() };
    assert!((left + couple).abs() < 1e-12 && (right - couple).abs() < 1e-12, "{left} {right}");
    assert!((peak - couple).abs() < 1e-12, "{peak}");
    assert_eq!(rigid.derivatives(&["peak.theta", "peak.H", "H"], "initial.theta"), [1.0, 0.0, 0.0]);
    let [shear, peak] = rigid.derivatives(&["H", "peak.H"], "a_gx")[..] else { panic!() };
    assert_eq!([shear, peak], [1000.0, 1000.0]);
    // On supports so soft no corner lifts, beyond the range of the arc sine.
    let mut soft = begin(&[("dimensionless.eta", 1.0)]);
    assert_eq!(soft.get("derived.theta_separation"), FRAC_PI_2);
    assert_eq!(soft.derivatives(&["derived.theta_separation"], "dimensionless.eta"), [0.0]);
}

/// A scale of zero erases the record, which is read again for its derivative.
#[test]
fn a_record_can_be_scaled_from_zero() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("record.txt");
    std::fs::write(&path, RECORD).unwrap();
    let mut instance = begin(&[("record.scale", 0.0), ("record.dt", 0.5), ("record.start", -0.75), ("g", 10.0)]);
    instance.set_text("record.horizontal", path.to_str().unwrap());
    instance.set_text("record.horizontal_unit", "g");
    let [shear, peak] = instance.derivatives(&["u_ddot", "record.PGA"], "record.scale")[..] else { panic!() };
    // Halfway from 0.3 g to −0.2 g; the largest sample is 0.3 g.
    let whole = instance.derivatives(&["u_ddot"], "a_gx")[0] * 0.5;
    assert!((shear - whole).abs() < 1e-15 && (peak - 3.0).abs() < 1e-15, "{shear}, not {whole}; {peak}");
    std::fs::remove_file(&path).unwrap();
    let (mut found, known) = (f64::NAN, reference("record.scale"));
    let status = call!(instance, get_directional_derivative, &reference("u_ddot"), 1, &known, 1, &1.0, &mut found);
    instance.refuses(status, &["record.horizontal", "record.txt"]);
}

/// Records in g and in tenths of g have samples in proportion to g, others none.
#[test]
fn derivatives_with_respect_to_gravity_count_the_unit_of_the_record() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("record.txt");
    std::fs::write(&path, RECORD).unwrap();
    for (unit, expected) in [("g", 0.3), ("g/10", 0.03), ("m/s2", 0.0), ("cm/s2", 0.0), ("mm/s2", 0.0)] {
        let mut instance = begin(&[("record.dt", 0.5)]);
        instance.set_text("record.horizontal", path.to_str().unwrap());
        instance.set_text("record.horizontal_unit", unit);
        let [found] = instance.derivatives(&["record.PGA"], "g")[..] else { panic!() };
        assert!((found - expected).abs() < 1e-15, "{unit}: {found}");
    }
}

#[test]
fn undeclared_dependencies_are_refused() {
    let instance = Instance::with_start_values(CO_SIMULATION, "beginning", None, false);
    assert_eq!(instance.setup(None, 0.0, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    let refuses = |unknown: u32, known: u32, direction: f64, words: &[&str]| {
        let mut found = -1.5;
        let status = call!(instance, get_directional_derivative, &unknown, 1, &known, 1, &direction, &mut found);
        instance.refuses(status, words);
        assert_eq!(found, -1.5, "nothing is written");
    };
    let [theta, alpha, a_gx] = ["theta", "dimensionless.alpha", "a_gx"].map(reference);
    refuses(alpha, alpha, 1.0, &["dimensionless.alpha is a parameter", "an output or a calculated parameter"]);
    refuses(a_gx, alpha, 1.0, &["a_gx is an input", "an output or a calculated parameter"]);
    refuses(reference("regime"), alpha, 1.0, &["regime", "Integer"]);
    refuses(theta, theta, 1.0, &["theta is an output", "an input or a parameter"]);
    refuses(theta, reference("derived.p"), 1.0, &["derived.p is a calculated parameter", "an input or a parameter"]);
    refuses(theta, reference("foundation"), 1.0, &["foundation", "Integer"]);
    refuses(theta, reference("record.horizontal"), 1.0, &["record.horizontal", "String"]);
    let none = FMU.description.variables.len() as u32 + 1;
    let words = format!("{none} does not exist");
    refuses(theta, none, 1.0, &[&words]);
    refuses(none, alpha, 1.0, &[&words]);
    refuses(theta, alpha, f64::NAN, &["NaN", "dimensionless.alpha", "finite"]);
    // Invalid block parameters have no derivatives.
    instance.set("parameterization", 2.0);
    instance.set("physical.width", 0.0);
    refuses(theta, alpha, 1.0, &["width = 0"]);
    // After initialization only inputs and states are directions.
    for (name, value) in [("physical.width", 3.0), ("physical.height", 9.0), ("physical.K", 1e6), ("physical.C", 5e3)] {
        instance.set(name, value);
    }
    assert_eq!(call!(instance, exit_initialization_mode), OK);
    refuses(reference("theta_ddot"), alpha, 1.0, &["dimensionless.alpha is a parameter", "expected an input"]);
    refuses(reference("derived.p"), a_gx, 1.0, &["derived.p is a calculated parameter", "expected an output"]);
}

/// Reading derivatives has no side effect.
#[test]
fn reading_derivatives_has_no_side_effect() {
    let (mut asked, other) = (begin(&[("initial.theta", 0.1)]), begin(&[("initial.theta", 0.1)]));
    let before = asked.bits();
    asked.derivatives(&["N_L", "derived.p"], "dimensionless.alpha");
    assert_eq!(asked.bits(), before);
    for instance in [&asked, &other] {
        assert_eq!(call!(instance, exit_initialization_mode), OK);
        instance.step(0.0, 0.3);
    }
    assert_eq!(asked.bits(), other.bits());
}
