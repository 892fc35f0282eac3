//! Blocks with an eccentric centre of mass, friction and ties: options, columns, limits.

use std::path::Path;

use serde_json::Value;

use crate::program::{Table, program, refused, stdout, text};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn json(folder: &Path, arguments: &str) -> Value {
    let arguments: Vec<&str> = arguments.split_whitespace().chain(["--json", "--csv", "run.csv"]).collect();
    serde_json::from_str(&stdout(folder, &arguments)).unwrap()
}

#[test]
fn a_measured_body_has_its_own_angles_and_moment_of_inertia() {
    let folder = folder();
    let body =
        "--width 1.2 --center-height 1.4 --inertia 900 --mass 800 --stiffness 1e6 --damping 2e3 --eccentricity 0.2";
    let json = json(folder.path(), &format!("simulate --theta 0.05 {body}"));
    let number = |pointer: &str| json.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}"));
    // γ = M R0²/I0, α_L = arctan((b + e_x)/h).
    for (pointer, expected) in [
        ("/block/gamma", 800.0 * (0.36 + 1.96) / 900.0),
        ("/block/alpha_L", (0.8_f64 / 1.4).atan()),
        ("/block/alpha_R", (0.4_f64 / 1.4).atan()),
        ("/block/height", 2.8),
    ] {
        assert!((number(pointer) / expected - 1.0).abs() < 1e-14, "{pointer}: {}", number(pointer));
    }
}

/// The mirror image of a block under the mirror image of a pulse moves as its mirror image.
#[test]
fn mirror_images_move_as_mirror_images() {
    let folder = folder();
    let column = |sign: f64| {
        let run = format!(
            "simulate --pulse one-sine --amplitude {} --period 1 --alpha 0.2 --p 2 --eccentricity {}",
            sign * 3.0,
            sign * 0.1
        );
        json(folder.path(), &run);
        Table::read(&folder.path().join("run.csv")).column("theta")
    };
    let (one, other) = (column(1.0), column(-1.0));
    assert!(one.len() > 100 && one.iter().any(|theta| theta.abs() > 0.02));
    assert!(one.iter().zip(&other).all(|(one, other)| *one == -other));
}

/// Tables have columns for slip and tensions if the block has friction or ties.
#[test]
fn columns_follow_the_block() {
    let folder = folder();
    let own = |options: &str| -> Vec<String> {
        let json = json(folder.path(), &format!("simulate --theta 0.1 --duration 0.1 --mass 1000 {options}"));
        let table = Table::read(&folder.path().join("run.csv"));
        let fixed = table.headers.iter().position(|name| name == "a_gz [m/s2]").unwrap() + 1;
        assert_eq!(json["slip"].is_object(), options.contains("friction"));
        assert_eq!(json["ties"].as_array().map_or(0, Vec::len), options.matches("--tie").count());
        table.headers.iter().skip(fixed).map(String::from).collect()
    };
    assert_eq!(own(""), Vec::<String>::new());
    assert_eq!(own("--friction 0.4"), ["slip [m]", "slip_rate [m/s]", "energy.friction [J]"]);
    let ties = "--tie block_x=1,stiffness=1e3 --tie block_x=-1,stiffness=1e3";
    assert_eq!(own(ties), ["tie_1.tension [N]", "tie_2.tension [N]", "energy.ties [J]"]);
}

/// An invalid tie is an error of the command line, with status 2.
#[test]
fn an_invalid_tie_is_refused() {
    let folder = folder();
    for (tie, words) in [
        ("block_x=1", "expected a stiffness > 0"),
        ("stiffness=1e3", "length of a tie = 0"),
        ("stiffness=1e3,block=2", "found key `block`; expected one of block_x"),
    ] {
        let arguments = ["simulate", "--theta", "0.1", "--mass", "5", "--csv", "run.csv", "--tie", tie];
        let output = program(folder.path(), &[&arguments]).output().unwrap();
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("--tie") && message.contains(words), "{message}");
    }
}

#[test]
fn invalid_options_are_refused() {
    let folder = folder();
    for (options, words) in [
        ("--eccentricity -2", &["eccentricity = -2 m", "half the width"][..]),
        ("--friction -1", &["friction = -1"]),
        ("--friction 1.4 --foundation rigid", &["friction = 1.4", "rigid base", "1.33"]),
        ("--tie block_x=1,stiffness=1e3", &["--tie without --mass"]),
        ("--inertia 5", &["--inertia has no effect without --width"]),
        ("--center-height 5", &["--center-height has no effect without --width"]),
        ("--width 1 --center-height 2 --height 4 --foundation rigid", &["--height has no effect with --center-height"]),
        (
            "--width 1 --height 4 --inertia 9 --mass 3 --gamma 2 --foundation rigid",
            &["--gamma has no effect with --inertia"],
        ),
        ("--width 1 --height 4 --inertia 9 --foundation rigid", &["--inertia without --mass"]),
    ] {
        let arguments: Vec<&str> = "simulate --theta 0.1 --csv run.csv".split(' ').chain(options.split(' ')).collect();
        refused(folder.path(), &arguments, words);
    }
}

/// The search begins where the side with less base would lift; with ties, which may pull a block aside, it begins at zero.
#[test]
fn the_search_begins_at_the_weaker_side() {
    let folder = folder();
    let from = |options: &str| -> f64 {
        let search = "search overturning --foundation rigid --period 1 --p 2 --points 3 --resolution 1 --csv s.csv";
        let arguments: Vec<&str> = search.split(' ').chain(options.split_whitespace()).collect();
        stdout(folder.path(), &arguments);
        Table::read(&folder.path().join("s.csv")).number(0, "from")
    };
    let even = 9.81 * 0.25_f64.tan();
    assert!((from("") / even - 1.0).abs() < 1e-14);
    // R0 = 3/4 g/p².
    let (b, h) = (0.75 * 9.81 / 4.0 * 0.25_f64.sin(), 0.75 * 9.81 / 4.0 * 0.25_f64.cos());
    assert!((from("--eccentricity -0.2") / (9.81 * (b - 0.2) / h) - 1.0).abs() < 1e-14);
    assert_eq!(from("--mass 1000 --tie block_z=1,ground_x=2,stiffness=1e3"), 0.0);
}

/// A sweep accepts the parameters of the FMU and limits on the slip; its columns cover the features of any of its blocks.
#[test]
fn a_sweep_has_columns_for_slip_and_tensions() {
    let folder = folder();
    let study = "[study]\ndesign = \"grid\"\nensemble = { samples = 3, p = 0.1, limits = [0.5, \"slip:0.1\"] }\n\
                 [parameters]\np = 2\nfriction = [0, 0.4]\neccentricity = 0.05\npulse.shape = \"OneSine\"\n\
                 pulse.amplitude = 4\nmass = 1000\ntie_1.block_x = 0.4\ntie_1.stiffness = 1e3\n";
    std::fs::write(folder.path().join("study.toml"), study).unwrap();
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    let table = Table::read(&folder.path().join("s.csv"));
    let names: Vec<&str> = table.headers.iter().collect();
    for name in ["peak.slip [m]", "peak.tie_1.tension [N]", "P(theta/alpha>0.5) [1]", "P(slip>0.1) [1]"] {
        assert!(names.contains(&name), "{name}: {names:?}");
    }
    assert!(!names.contains(&"peak.tie_2.tension [N]"));
    for (old, new, words) in [
        ("tie_1.block_x = 0.4", "tie_1.block_x = 0", "study.toml:11: tie_1 = 0"),
        ("slip:0.1", "slip:no", "study.toml:3: limits = \"slip:no\""),
        ("tie_1.block_x = 0.4", "tie_1.block_x = 0.4\ntie_2.block_x = 1", "tie_2.block_x is read by no block"),
        ("eccentricity = 0.05", "eccentricity = 5", "study.toml:7: eccentricity = 5 m"),
    ] {
        std::fs::write(folder.path().join("study.toml"), study.replace(old, new)).unwrap();
        refused(folder.path(), &["sweep", "study.toml", "--csv", "t.csv"], &[words]);
    }
}
