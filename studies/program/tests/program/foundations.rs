//! Friction, restitution and supports with their sources.

use serde_json::Value;

use crate::program::{refusal, refused, rocking, stdout, text};

fn json(arguments: &[&str]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let output = rocking(folder.path(), &[&["foundations"], arguments, &["--json"]].concat());
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Each value has a kind and a source, and the table shows all of them.
#[test]
fn pairs_have_their_sources() {
    let folder = tempfile::tempdir().unwrap();
    let printed = stdout(folder.path(), &["foundations"]);
    let values = json(&[]);
    let pairs = values["pairs"].as_array().unwrap();
    assert!(pairs.len() > 20 && values["command"] == "foundations", "{values}");
    for pair in pairs {
        let field = |name: &str| pair[name].as_str().unwrap();
        let (name, citation) = (pair["source"]["name"].as_str().unwrap(), pair["source"]["citation"].as_str().unwrap());
        let row = printed.lines().find(|line| line.contains(field("surfaces")) && line.ends_with(name));
        assert!(row.is_some_and(|row| row.contains(field("kind")) && row.starts_with(field("quantity"))), "{pair}");
        assert!(printed.contains(citation), "{citation}");
        assert!(pair["low"].as_f64().unwrap() <= pair["high"].as_f64().unwrap(), "{pair}");
    }
    let steel = printed.lines().find(|line| line.contains("steel on concrete or grout")).unwrap();
    assert!(steel.contains("  0.57 to 0.7 ") && steel.contains("Rabbat and Russell (1985)"), "{steel}");
}

/// The paper's pads: K = 4710 MN/m, omega_v = 116 rad/s, eta = 305 under the tower of 700 t.
#[test]
fn pads_are_those_of_the_paper() {
    let pad = ["pad", "--diameter", "2", "--shape-factor", "5", "--shear-modulus", "1e6"];
    let block = ["--mass", "700000", "--p", "0.38"];
    let values = json(&[&pad[..], &block].concat());
    let number = |name: &str| values[name].as_f64().unwrap();
    assert!((number("K") / 4.712e9 - 1.0).abs() < 1e-4 && values["C"].is_null(), "{values}");
    assert!((number("omega_v") - 116.0).abs() < 0.1 && (number("eta") - 305.0).abs() < 0.5, "{values}");
    let folder = tempfile::tempdir().unwrap();
    let printed = stdout(folder.path(), &[&["foundations"], &pad[..]].concat());
    assert!(
        printed.contains("4.7124e9 N/m") && printed.contains("eq. (36)") && !printed.contains("omega_v"),
        "{printed}"
    );
    let softer = json(&[&pad[..], &["--bulk-modulus", "2e9"]].concat());
    // 6 G S² = 150 MPa compared with 2000 MPa.
    assert!((softer["K"].as_f64().unwrap() / number("K") - 1.0 / 1.075).abs() < 1e-12, "{softer}");
}

/// K of soil makes a block with the eta that the command states.
#[test]
fn supports_of_soil_make_a_block() {
    let soil = "soil --width 2 --length 3 --shear-wave-velocity 200 --density 1800 --poisson 0.3 --mass 40000 --p 1.5";
    let values = json(&soil.split(' ').collect::<Vec<_>>());
    let of = |name: &str| values[name].as_f64().unwrap().to_string();
    let folder = tempfile::tempdir().unwrap();
    let (stiffness, damping) = (of("K"), of("C"));
    let size = ["--width", "2", "--height", "8", "--mass", "40000", "--stiffness", &stiffness, "--damping", &damping];
    let output = rocking(folder.path(), &[&["sketch", "--json"], &size[..]].concat());
    let block: Value = serde_json::from_slice(&output.stdout).unwrap();
    let block = |name: &str| block["block"][name].as_f64().unwrap();
    let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
    assert!(close(block("eta") * block("p"), values["omega_v"].as_f64().unwrap()), "{values}");
    assert!(close(block("xi_v"), values["xi_v"].as_f64().unwrap()), "{values}");
    assert!(close(values["eta"].as_f64().unwrap() * 1.5, values["omega_v"].as_f64().unwrap()), "{values}");
}

#[test]
fn values_out_of_range_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let pad = ["foundations", "pad", "--diameter", "2", "--shape-factor", "5", "--shear-modulus"];
    refused(folder.path(), &[&pad[..], &["0"]].concat(), &["shear_modulus = 0 is not valid; expected a number > 0"]);
    let block = [&pad[..], &["1e6", "--mass", "-1"]].concat();
    assert_eq!(refusal(folder.path(), &block), "--mass = -1; expected a mass > 0 kg");
    let output = rocking(folder.path(), &[&pad[..], &["1e6", "--p", "1"]].concat());
    assert!(!output.status.success() && text(&output.stderr).contains("--mass"), "{}", text(&output.stderr));
}
