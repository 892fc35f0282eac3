//! Values and derivatives equal those of FMI 2.0, which tests/abi compares with closed forms and references.

use rocking_block::unit::instance::{Interface, Unit};
use rocking_block::unit::variables::{Causality, FMI3_VARIABLES, Kind, VARIABLES};

use crate::functions::OK;
use crate::host::{FMU, Instance, Wanted, call, reference};

const ROCKING: [(&str, f64); 6] = [
    ("dimensionless.alpha", 0.25),
    ("dimensionless.p", 1.0),
    ("pulse.shape", 2.0),
    ("pulse.amplitude", 6.2622),
    ("pulse.period", 1.2566370614359172),
    ("on_separation", 3.0),
];

fn fmi3() -> Instance {
    let block = Instance::new(Wanted::default());
    block.set_all(&ROCKING);
    block.initialize(false);
    block
}

/// Makes the same run without C interface.
fn unit() -> Unit {
    let mut unit = Unit::new(Interface::CoSimulation);
    for (name, value) in ROCKING {
        let metadata = VARIABLES.iter().find(|metadata| metadata.name == name).unwrap();
        unit.set(metadata.kind.base(), &[metadata.reference()], &[value], |value| value).unwrap();
    }
    unit.enter_initialization_mode();
    unit.exit_initialization_mode().unwrap();
    unit
}

#[test]
fn outputs_are_those_of_fmi_2() {
    let (block, mut unit) = (fmi3(), unit());
    for i in 0..50 {
        let (here, there) = (f64::from(i) * 0.1, f64::from(i + 1) * 0.1);
        block.step(here, there - here);
        unit.advance(here, there - here, &mut |_| {}).unwrap();
        for metadata in VARIABLES.iter().filter(|metadata| metadata.kind != Kind::String) {
            let expected = unit.get(metadata.kind.base(), metadata.reference()).unwrap();
            assert_eq!(block.get(metadata.name).to_bits(), expected.to_bits(), "{}", metadata.name);
        }
    }
}

/// `seed^T J direction` is the same from both derivatives.
#[test]
fn adjoint_and_directional_derivatives_belong_together() {
    let block = fmi3();
    block.step(0.0, 0.7);
    let outputs = ["theta_ddot", "v_ddot", "N_L", "N_R", "H", "theta"].map(reference);
    let inputs = ["a_gx", "a_gz", "F_x", "F_z", "M_y"].map(reference);
    let (seed, direction) = ([0.3, -2.0, 0.01, 0.02, -0.03, 5.0], [1.0, -0.5, 200.0, 30.0, -7.0]);
    let (mut forward, mut backward) = ([f64::NAN; 6], [f64::NAN; 5]);
    let status = call!(
        block,
        get_directional_derivative,
        outputs.as_ptr(),
        6,
        inputs.as_ptr(),
        5,
        direction.as_ptr(),
        5,
        forward.as_mut_ptr(),
        6
    );
    assert_eq!(status, OK);
    let status = call!(
        block,
        get_adjoint_derivative,
        outputs.as_ptr(),
        6,
        inputs.as_ptr(),
        5,
        seed.as_ptr(),
        6,
        backward.as_mut_ptr(),
        5
    );
    assert_eq!(status, OK);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (one, other) = (dot(&seed, &forward), dot(&direction, &backward));
    // Rounding of sums of some thirty terms.
    assert!(one.abs() > 0.1 && (one - other).abs() < 1e-12 * dot(&seed.map(f64::abs), &forward.map(f64::abs)));
    // Accelerations are linear in the inputs, so a difference is exact up to round-off.
    let before = block.get("theta_ddot");
    block.set("a_gx", 1e-3);
    let difference = (block.get("theta_ddot") - before) / 1e-3;
    block.set("a_gx", 0.0);
    let mut derivative = f64::NAN;
    assert_eq!(
        call!(block, get_directional_derivative, &outputs[0], 1, &inputs[0], 1, &1.0, 1, &mut derivative, 1),
        OK
    );
    assert!((difference - derivative).abs() < 1e-9 * derivative.abs(), "{difference}, not {derivative}");
    let wrong = call!(block, get_adjoint_derivative, &outputs[0], 1, &inputs[0], 1, &1.0, 2, &mut derivative, 1);
    block.refuses(wrong, &["= 2", "expected 1"]);
}

#[test]
fn derivatives_in_time_are_rates() {
    let block = fmi3();
    block.step(0.0, 0.7);
    let (references, orders) = ([reference("theta"), reference("theta_dot")], [1, 1]);
    let mut rates = [f64::NAN; 2];
    let status = call!(block, get_output_derivatives, references.as_ptr(), 2, orders.as_ptr(), rates.as_mut_ptr(), 2);
    assert_eq!(status, OK);
    assert_eq!(rates, [block.get("theta_dot"), block.get("theta_ddot")]);
}

#[test]
fn the_file_lists_the_variables_of_the_code() {
    for metadata in &VARIABLES {
        let variable = &FMU.variables[metadata.name];
        assert_eq!(variable.reference, metadata.reference());
        let kind = match metadata.kind {
            Kind::Real => "Float64",
            Kind::Integer => "Int32",
            Kind::Boolean => "Boolean",
            Kind::Enumeration => "Enumeration",
            Kind::String => "String",
        };
        assert_eq!(variable.kind, kind, "{}", metadata.name);
        let settable = matches!(metadata.causality, Causality::Input | Causality::Parameter);
        assert_eq!(variable.attributes.contains_key("start") || kind == "String", settable, "{}", metadata.name);
    }
    assert_eq!(FMU.variables.len(), VARIABLES.len() + FMI3_VARIABLES.len());
}

/// Importers that take the references of dependencies for positions, as in FMI 2.0, find the same variables.
#[test]
fn references_are_positions() {
    let document =
        roxmltree::Document::parse(std::str::from_utf8(&FMU.files["modelDescription.xml"]).unwrap()).unwrap();
    let list = document.descendants().find(|node| node.has_tag_name("ModelVariables")).unwrap();
    let references: Vec<&str> = list.children().filter_map(|node| node.attribute("valueReference")).collect();
    let positions: Vec<String> = (1..=FMU.variables.len()).map(|position| position.to_string()).collect();
    assert_eq!(references, positions);
}
