//! The lateral force over a slow rotation.

use serde_json::Value;

use crate::program::{refused, rocking, stdout, text};

const BLOCK: [&str; 9] = ["pushover", "--alpha", "0.25", "--p", "1", "--foundation", "rigid", "--mass", "1000"];
const DAMPER: &str = "block_x=-1.8,ground_x=-1.8,ground_z=-2,stiffness=1e6,yield_force=1000";

/// On a rigid base the force is M g tan(α − θ), and a damper adds its force times its arm over the height of the centre of mass.
#[test]
fn the_landmarks_and_the_cycle_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    let options = [&BLOCK[..], &["--damper", DAMPER, "--amplitude", "0.02", "--csv", "curve.csv"]].concat();
    let printed = stdout(folder.path(), &[&options[..], &["--cycle-csv", "cycle.csv", "--plot", "curve.svg"]].concat());
    for line in ["  L lifts\n", "  damper 1 yields, greatest force\n", "  end\n"] {
        assert!(printed.contains(line), "{line}: {printed}");
    }
    assert!(
        printed.contains("written       curve.csv\nwritten       cycle.csv\nwritten       curve.svg\n"),
        "{printed}"
    );
    let json: Value = serde_json::from_str(&stdout(folder.path(), &[&options[..], &["--json"]].concat())).unwrap();
    let landmarks = json["landmarks"].as_array().unwrap();
    assert_eq!((&json["command"], &landmarks[0]["name"]), (&"pushover".into(), &"at rest".into()));
    let lifts = &landmarks[1];
    let weight = 1000.0 * 9.81;
    assert!((lifts["force"].as_f64().unwrap() - weight * 0.25_f64.tan()).abs() < 1e-9 * weight, "{lifts}");
    let lost = json["energy"]["damper_1"].as_f64().unwrap();
    let [ratio, damping] = ["recentring_ratio", "equivalent_damping"].map(|name| json[name].as_f64().unwrap());
    assert!(lost > 0.0 && damping > 0.0 && ratio > 1.0 && json["residual_theta"] == 0.0, "{json}");
    let table = std::fs::read_to_string(folder.path().join("cycle.csv")).unwrap();
    assert!(table.starts_with("theta [rad],u [m],v [m],moment [N.m],force [N],force/weight [1],N_L [N],"), "{table}");
    let thetas: Vec<f64> = table.lines().skip(1).map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
    assert_eq!((thetas[0], thetas[thetas.len() - 1]), (0.0, 0.02));
    assert!(thetas.contains(&-0.02));
    let svg = std::fs::read_to_string(folder.path().join("curve.svg")).unwrap();
    assert!(svg.contains("slow rotation") && svg.contains("cycle of ±0.02 rad"), "{svg}");
}

#[test]
fn mistakes_are_named() {
    let folder = tempfile::tempdir().unwrap();
    for (options, expected) in [
        (&["--to", "2"][..], "to = 2 rad; expected a rotation above 0 and below pi/2 rad"),
        (&["--amplitude", "0"], "amplitude = 0 rad; expected"),
        (&["--cycle-csv", "cycle.csv"], "--cycle-csv has no effect without --amplitude"),
        (&["--amplitude", "0.3", "--friction", "0.1"], "where the block slides; expected a smaller amplitude"),
        (&["--csv", "a.csv", "--cycle-csv", "a.csv", "--amplitude", "0.1"], "a.csv"),
    ] {
        refused(folder.path(), &[&BLOCK[..], options].concat(), &[expected]);
    }
    let output = rocking(folder.path(), &[&BLOCK[..], &["--side", "LEFT"]].concat());
    assert!(text(&output.stdout).contains("R lifts"), "{output:?}");
}
