//! The cases of tests/reference and tests/reference_more, and further ones.

use std::f64::consts::TAU;
use std::path::Path;

use rocking_block::block::restraints::{LinkKind, Tie};
use rocking_block::block::{Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::Initial;
use rocking_gradients::Parameters;
use rocking_records::{ReadOptions, Unit};
use serde_json::Value;

use crate::run::Run;

fn root() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A record of the project, every 5 ms.
fn record() -> Ground {
    let path = root().join("studies/program/records/np01002p_4225a_a.smc");
    let bytes = std::fs::read(path).unwrap();
    let record = rocking_records::parse("record", &bytes, &ReadOptions::default()).unwrap();
    Ground { horizontal: Some(rocking_records::Record { start_time: 0.0, ..record }), vertical: None }
}

fn case(folder: &str, name: &str) -> Value {
    let text = std::fs::read_to_string(root().join("tests").join(folder).join("cases.json")).unwrap();
    let cases: Value = serde_json::from_str(&text).unwrap();
    cases.as_array().unwrap().iter().find(|case| case["name"] == name).unwrap().clone()
}

/// A reference case that is driven by a pulse or starts from an initial state.
pub fn reference(folder: &str, name: &str) -> Run {
    let case = case(folder, name);
    let or = |value: &Value, default: f64| value.as_f64().unwrap_or(default);
    let of = |key: &str, default: f64| or(&case[key], default);
    let motion = &case["a_gx"];
    let shape = match motion["kind"].as_str() {
        Some("sine") => PulseShape::OneSine,
        Some("cosine") => PulseShape::OneCosine,
        _ => PulseShape::None,
    };
    let mass = of("M", 1.0);
    let pair = |value: &Value| [value[0].as_f64().unwrap(), value[1].as_f64().unwrap()];
    let links = ["ties", "links"].into_iter().filter_map(|key| case[key].as_array()).flatten();
    let ties = links.map(|tie| Tie {
        block: pair(&tie["block"]),
        ground: pair(&tie["ground"]),
        stiffness: mass * or(&tie["stiffness"], 0.0),
        pretension: mass * or(&tie["pretension"], 0.0),
        slack: or(&tie["slack"], 0.0),
        damping: mass * or(&tie["damping"], 0.0),
        strength: mass * or(&tie["strength"], 0.0),
        yield_force: mass * or(&tie["yield_force"], 0.0),
        hardening: or(&tie["hardening"], 0.0),
        kind: if tie["kind"] == "damper" { LinkKind::Damper } else { LinkKind::Tie },
    });
    let foundation = if case["foundation"] == "rigid" { Foundation::Rigid } else { Foundation::Viscoelastic };
    let initial = &case["initial"];
    let supports = Supports::of(foundation, Ratios { eta: of("eta", 40.0), xi_v: of("xi_v", 0.1) });
    let common = Common {
        mass,
        gamma: of("gamma", 3.0),
        epsilon: of("epsilon", 0.0),
        gravity: of("g", 9.81),
        eccentricity: of("eccentricity", 0.0),
        friction: of("friction", 0.0),
    };
    Run {
        name: name.into(),
        parameters: Parameters {
            block: Dimensionless { alpha: of("alpha", 0.0), p: of("p", 1.0), supports }.with(&common),
            ties: ties.collect(),
            initial: Initial {
                theta: or(&initial["theta"], 0.0),
                theta_dot: or(&initial["theta_dot"], 0.0),
                vertical: None,
            },
            pulse: Pulse {
                shape,
                amplitude: or(&motion["a_p"], 0.0),
                period: TAU / or(&motion["omega_p"], TAU),
                start: 0.0,
                ..Pulse::NONE
            },
            scale: None,
        },
        ground: Ground::default(),
        flies: false,
        tolerance: 1e-13,
        step: 0.1,
        rows: 60,
        difference: 2e-4,
    }
}

/// A reference case under a record of the project.
pub fn under_record(folder: &str, name: &str, scale: f64) -> Run {
    let mut run = reference(folder, name);
    run.parameters.pulse = Pulse::NONE;
    run.parameters.scale = Some(scale);
    Run { name: format!("{name} under a record"), ground: record(), ..run }
}

/// A reference case under its own records; none where they are not at hand.
pub fn under_its_records(folder: &str, name: &str) -> Option<Run> {
    let case = case(folder, name);
    let record = |motion: &Value| {
        let (file, dt) = match motion["record"].as_str()? {
            "rinaldi" => ("paper/NGA_no_1063_RRS228.AT2", None),
            "erzincan" => ("paper_derived/ERZ-NS_unrotated.AT2", None),
            "sylmar052" => ("paper/SCS052.AT2", Some(0.005)),
            "sylmar_up" => ("paper/SCSUP.AT2", Some(0.005)),
            other => panic!("unknown record {other}"),
        };
        let options = ReadOptions { unit: dt.map(|_| Unit::G), time_step: dt, gravity: 9.81, ..ReadOptions::default() };
        let record = rocking_records::read(&root().join("../shared/records").join(file), &options).ok()?;
        Some(rocking_records::Record { start_time: 0.0, ..record })
    };
    let ground = Ground { horizontal: Some(record(&case["a_gx"])?), vertical: record(&case["a_gz"]) };
    let mut run = Run { ground, ..reference(folder, name) };
    run.parameters.scale = case["a_gx"]["scale"].as_f64();
    Some(run)
}
