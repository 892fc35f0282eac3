//! Parameters of the unit → a block: measured bodies, ties, and parameters without effect.

use rocking_block::unit::instance::{Interface, Unit};
use rocking_block::unit::variables::{Metadata, VARIABLES};

fn metadata(name: &str) -> &'static Metadata {
    VARIABLES.iter().find(|metadata| metadata.name == name).unwrap_or_else(|| panic!("no {name}"))
}

fn unit(values: &[(&str, f64)]) -> Unit {
    let mut unit = Unit::new(Interface::CoSimulation);
    for (name, value) in values {
        let metadata = metadata(name);
        unit.set(metadata.kind.base(), &[metadata.reference()], &[*value], |value| value).unwrap();
    }
    unit
}

fn get(unit: &mut Unit, name: &str) -> f64 {
    let metadata = metadata(name);
    unit.get(metadata.kind.base(), metadata.reference()).unwrap()
}

/// The start values are a stone that a crane can lift, in both groups of parameters alike.
#[test]
fn the_start_values_are_a_real_object() {
    let physical = ["derived.width", "derived.height", "derived.K", "derived.C"];
    let [mut one, mut other] = [1.0, 2.0].map(|group| unit(&[("parameterization", group)]));
    for name in physical.iter().chain(&["derived.alpha", "derived.p", "derived.eta", "derived.xi_v"]) {
        let [by_ratios, by_sizes] = [&mut one, &mut other].map(|unit| get(unit, name));
        assert!((by_ratios / by_sizes - 1.0).abs() < 1e-14, "{name} = {by_ratios} and {by_sizes}");
    }
    let [width, height, stiffness, _] = physical.map(|name| get(&mut one, name));
    let mass = metadata("mass").start.unwrap();
    assert!((1.0..2.0).contains(&height), "{height} m high");
    let depth = mass / (2600.0 * width * height);
    assert!((width..2.0 * width).contains(&depth), "{depth} m deep, of 2600 kg/m³");
    let sinking = mass * 9.81 / (2.0 * stiffness);
    assert!((1e-4..2e-3).contains(&sinking), "sinks in by {sinking} m");
}

/// Why initialization cannot end with these values.
fn refusal(values: &[(&str, f64)]) -> String {
    let mut unit = unit(values);
    unit.enter_initialization_mode();
    unit.exit_initialization_mode().unwrap_err().to_string()
}

/// The parameters that were set but are not read, each with the setting that it needs.
fn unread(values: &[(&str, f64)]) -> Vec<(&'static str, &'static str)> {
    let mut unit = unit(values);
    unit.enter_initialization_mode();
    unit.exit_initialization_mode().unwrap()
}

const MEASURED: [(&str, f64); 9] = [
    ("parameterization", 2.0),
    ("physical.width", 1.2),
    ("physical.center_height", 1.4),
    ("physical.inertia", 900.0),
    ("physical.K", 1e6),
    ("physical.C", 2e3),
    ("mass", 800.0),
    ("eccentricity", 0.2),
    ("foundation", 1.0),
];

/// Any plane body with a flat base, defined by its measured sizes: angles, radius, frequency and restitution in closed form.
#[test]
fn a_measured_body_is_given_by_its_sizes() {
    let mut unit = unit(&MEASURED);
    let (b, h, e, mass, inertia, g): (f64, f64, f64, f64, f64, f64) = (0.6, 1.4, 0.2, 800.0, 900.0, 9.81);
    let squared = b * b + h * h;
    let radius_of_gyration = inertia / mass;
    // On a landing on I: (I0/M + h² − b_L b_R)/(I0/M + h² + b_I²).
    let restitution = |corner: f64| {
        let (near, far) = (b + corner * e, b - corner * e);
        (radius_of_gyration + h * h - near * far) / (radius_of_gyration + h * h + near * near)
    };
    for (name, expected) in [
        ("derived.alpha", (b / h).atan()),
        ("derived.alpha_L", ((b + e) / h).atan()),
        ("derived.alpha_R", ((b - e) / h).atan()),
        ("derived.R0", squared.sqrt()),
        ("derived.I0", inertia),
        ("derived.p", (mass * g * squared.sqrt() / (inertia + mass * squared)).sqrt()),
        ("derived.e", restitution(1.0).min(restitution(-1.0))),
        ("derived.width", 2.0 * b),
        ("derived.height", 2.0 * h),
    ] {
        let found = get(&mut unit, name);
        assert!((found / expected - 1.0).abs() < 1e-14, "{name} = {found}, not {expected}");
    }
}

/// A centre of mass at half the height, and the moment of inertia that follows from gamma, change no bit.
#[test]
fn zeros_mean_a_rectangle() {
    let sizes = [("parameterization", 2.0), ("physical.width", 1.2), ("physical.height", 2.8), ("physical.K", 1e6)];
    let mut plain = unit(&sizes);
    let mut same = unit(&[&sizes[..], &[("physical.center_height", 1.4)]].concat());
    for metadata in VARIABLES.iter().filter(|metadata| metadata.name.starts_with("derived")) {
        let [plain, same] = [&mut plain, &mut same].map(|unit| get(unit, metadata.name));
        assert_eq!(plain.to_bits(), same.to_bits(), "{}", metadata.name);
    }
}

#[test]
fn parameters_without_effect_are_named_with_their_condition() {
    let with = |others: &[(&'static str, f64)]| unread(&[&MEASURED[..], others].concat());
    assert_eq!(with(&[]), []);
    assert_eq!(with(&[("gamma", 2.0)]), [("gamma", "physical.inertia = 0")]);
    assert_eq!(with(&[("physical.height", 2.8)]), [("physical.height", "physical.center_height = 0")]);
    assert_eq!(with(&[("tie_2.ground_z", -1.0)]), [("tie_2.ground_z", "tie_2.stiffness")]);
    assert_eq!(with(&[("damper_1.yield_force", 1.0)]), [("damper_1.yield_force", "damper_1.stiffness")]);
    assert_eq!(with(&[("damper_1.damping", 1e3), ("damper_1.ground_z", -1.0), ("damper_1.strength", 1e4)]), []);
    let yields = [("damper_1.damping", 1e3), ("damper_1.ground_z", -1.0), ("damper_1.yield_force", 1.0)];
    assert_eq!(with(&yields), [("damper_1.yield_force", "damper_1.stiffness")]);
    assert_eq!(with(&[("tie_1.damping", 1e3)]), [("tie_1.damping", "tie_1.stiffness")]);
    assert_eq!(with(&[("tie_1.hardening", 0.1)]), [("tie_1.hardening", "tie_1.yield_force")]);
    assert_eq!(with(&[("tie_1.stiffness", 1e3), ("tie_1.ground_z", -1.0), ("tie_1.strength", 1e4)]), []);
    assert_eq!(unread(&[("physical.inertia", 1.0)]), [("physical.inertia", "parameterization = Physical")]);
    assert_eq!(unread(&[("gamma", 2.0), ("eccentricity", 0.1), ("friction", 0.5)]), []);
}

#[test]
fn invalid_blocks_are_refused_with_the_reason() {
    for (values, words) in [
        (&[("eccentricity", -2.0)][..], &["eccentricity = -2 m", "0.174"][..]),
        (&[("tie_2.stiffness", 1e3)], &["distance of the ends of tie_2 = 0", "expected one above 0 m"]),
        (&[("damper_1.damping", 1e3)], &["distance of the ends of damper_1 = 0"]),
        (&[("friction", 1.5), ("foundation", 2.0)], &["friction = 1.5", "rigid base", "1.333"]),
    ] {
        let refusal = refusal(values);
        assert!(words.iter().all(|word| refusal.contains(word)), "{refusal}");
    }
}

/// A pretension above the strength, and one that presses the block past its anchor, are refused at the end of initialization, by the name of
/// the tie.
#[test]
fn impossible_pretensions_are_refused_by_the_name_of_the_tie() {
    for (changes, words) in [
        (
            &[("tie_1.strength", 1e3)] as &[_],
            "pretension of tie_1 = 5000000 is not valid; expected a force (N) up to the strength",
        ),
        (
            &[],
            "found no balance of the block at the start; expected a pretension of tie_1 that does not press it past the anchor",
        ),
    ] {
        let start = [
            ("dimensionless.alpha", 0.25),
            ("dimensionless.p", 1.0),
            ("tie_1.stiffness", 1e4),
            ("tie_1.pretension", 5e6),
            ("tie_1.ground_z", -2.0),
            ("tie_1.block_z", 0.0),
        ];
        assert_eq!(refusal(&[&start, changes].concat()), words);
    }
}
