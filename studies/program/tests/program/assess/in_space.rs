//! Reports on an object in space: their numbers equal those of the single commands.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::json;
use crate::program::{Table, fails, files, program, refusal, stdout};

const STUDY: &str = "\
[study]
design = \"grid\"
azimuths = [0, 40, 90]
levels = { im = \"PGV.RotD50\", values = [0.2, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6] }
[parameters]
width = 0.3
height = 1.4
depth = 0.5
eta = 50
xi_v = [0.15, 0.3]
kappa = 1
[[records]]
x = \"a.csv\"
y = \"b.csv\"
unit = \"m/s2\"
";

const ASSESS: &str = "\
[assess]
title = \"Stone\"
pulse_periods = [0.4]
states = [{ name = \"twists\", limit = \"twist:0.01\" }, { name = \"rocks\", limit = 0.8 }, { name = \"passes\", limit = \"balance\" }, { name = \"overturns\", limit = \"overturned\" }]
variants = [{ name = \"softer\", parameters = { kappa = 0.5 } }, { name = \"wider\", width = 1.2 }]
sensitivity = { friction = [0.2, 0.6] }
";

fn folder(study: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, amplitude, frequency) in [("a", 4.0, 9.0), ("b", 3.0, 7.0)] {
        let row = |i: i32| {
            let t = f64::from(i) * 0.01;
            let fade = (t / 2.4 * std::f64::consts::PI).sin();
            format!("{t},{}\n", amplitude * fade * (frequency * t).sin())
        };
        let text = format!("t,a\n{}", (0..240).map(row).collect::<String>());
        fs::write(folder.path().join(format!("{name}.csv")), text).unwrap();
    }
    fs::write(folder.path().join("study.toml"), study).unwrap();
    folder
}

/// The number of rows of a sweep that overturn.
fn overturned(folder: &Path, study: &str) -> u64 {
    fs::write(folder.join("other.toml"), study).unwrap();
    stdout(folder, &["sweep", "other.toml", "--csv", "other.csv", "--force"]);
    let table = Table::read(&folder.join("other.csv"));
    (0..table.rows.len()).filter(|&row| table.get(row, "outcome") == "overturned").count() as u64
}

/// Curves are those of `fragility`, variants and ends of ranges those of sweeps, and pulses those of `search` along x and y.
#[test]
fn the_numbers_in_space_are_those_of_the_single_commands() {
    let folder = folder(&format!("{STUDY}{ASSESS}"));
    let folder = folder.path();
    let report = json(folder, &["assess", "study.toml", "--out", "report"]);
    stdout(folder, &["sweep", "study.toml", "--csv", "runs.csv"]);
    assert_eq!(fs::read(folder.join("runs.csv")).unwrap(), fs::read(folder.join("report/runs.csv")).unwrap());
    let table = Table::read(&folder.join("runs.csv"));
    let (twists, ends) = (table.column("peak.twist"), |row: usize| table.get(row, "outcome") == "overturned");
    let twisted = twists.iter().enumerate().filter(|(row, twist)| ends(*row) || **twist > 0.01).count();
    assert_eq!(report["states"][0]["runs"]["exceeded"], twisted);
    for (state, limit) in [(1, "0.8"), (2, "balance"), (3, "overturned")] {
        let state = &report["states"][state];
        let alone =
            json(folder, &["fragility", "runs.csv", "--im", "PGV.RotD50", "--limit", limit, "--plot-polar", "p.svg"]);
        assert_eq!(state["limit"], alone["limit"]);
        assert_eq!(state["runs"]["exceeded"].as_f64(), alone["rows"]["exceeded"].as_f64(), "{limit}");
        for key in ["median", "median_interval", "beta", "AUC"] {
            assert_eq!(state["curve"][key], alone["measures"][0][key], "{limit}: {key}");
        }
    }
    assert_eq!(report["states"][2]["limit"], "tilt/alpha>1");
    assert_eq!(report["compared_state"], 3);
    let softer = overturned(folder, &STUDY.replace("kappa = 1", "kappa = 0.5"));
    assert_eq!(report["variants"][1]["runs"]["exceeded"], softer);
    assert_eq!(report["variants"][0]["runs"]["exceeded"], overturned(folder, STUDY));
    for (end, friction) in [(0, 0.2), (1, 0.6)] {
        let study = STUDY.replace("kappa = 1", &format!("kappa = 1\nfriction = {friction}"));
        assert_eq!(report["sensitivity"][0]["ends"][end]["runs"]["exceeded"], overturned(folder, &study));
    }
    // tan α_edge = b/h grows with the base; a variant keeps the friction of the object.
    let alphas = [0, 2].map(|variant| report["variants"][variant]["alpha"].as_f64().unwrap().tan());
    assert!((alphas[1] / alphas[0] - 1.2).abs() < 1e-14 && report["variants"][2]["friction"].is_null());
    let by_direction = report["directions"].as_array().unwrap();
    assert_eq!(by_direction.iter().map(|direction| &direction["azimuth"]).collect::<Vec<_>>(), [0.0, 40.0, 90.0]);
    let sum: f64 = by_direction.iter().map(|direction| direction["exceeded"].as_f64().unwrap()).sum();
    assert_eq!(Some(sum), report["variants"][0]["runs"]["exceeded"].as_f64());
    for (pulse, azimuth) in [(0, "0"), (1, "90")] {
        let block = "--width 0.3 --height 1.4 --depth 0.5 --eta 50 --xi-v 0.3 --kappa 1 --period 0.4 --azimuth";
        let arguments: Vec<&str> = "search overturning".split(' ').chain(block.split(' ')).chain([azimuth]).collect();
        let found = json(folder, &arguments);
        assert_eq!(report["pulses"][pulse]["amplitude"], found["least"], "{azimuth}");
        assert_eq!(report["pulses"][pulse]["azimuth"].as_f64(), azimuth.parse().ok());
    }
    let body: &Value = &report["object"];
    assert_eq!((&body["base"], body["depth"].as_f64(), &body["feet"]), (&"rectangle".into(), Some(0.5), &4.into()));
    assert!(body["gamma"].is_null() && body["R0"].is_number(), "{body}");
    let made = files(&folder.join("report"));
    assert!(made.contains(&"directions.png".into()) && !made.contains(&"spectrum.png".into()), "{made:?}");
}

/// The page speaks of tilts, directions and feet, counts a pair once, and has no words of the plane.
#[test]
fn the_page_is_one_of_an_object_in_space() {
    let folder = folder(&format!("{STUDY}{ASSESS}"));
    let printed = stdout(folder.path(), &["assess", "study.toml", "--out", "report"]);
    assert!(
        printed.contains("under 1 ground motion in 3 directions with a peak ground velocity (PGV.RotD50)"),
        "{printed}"
    );
    assert!(printed.contains("A base of 0.3 m × 0.5 m and a centre of mass 0.7 m up"), "{printed}");
    let page = fs::read_to_string(folder.path().join("report/report.html")).unwrap();
    for has in [
        "α_edge",
        "<h2>Directions</h2>",
        "PGV.RotD50 (m/s)",
        "rolls over corners",
        "rocking search overturning --pulse",
    ] {
        assert!(page.contains(has), "{has}");
    }
    for lacks in ["|θ|/α", "<h2>Rocking spectra</h2>", "rocks in one plane", "restitution ε", "Tied to a wall"] {
        assert!(!page.contains(lacks), "{lacks}");
    }
}

/// A hazard curve names the measure without its components, and the page says how it was read.
#[test]
fn a_hazard_of_one_component_is_read_with_a_remark() {
    let folder = folder(&format!("{STUDY}{ASSESS}hazard = {{ file = \"hazard.csv\" }}\n"));
    let hazard = "PGV [m/s],rate [1/year]\n0.05,2e-2\n0.1,5e-3\n0.2,1e-3\n0.5,9e-5\n1,1.2e-5\n2,9e-7\n";
    fs::write(folder.path().join("hazard.csv"), hazard).unwrap();
    let report = json(folder.path(), &["assess", "study.toml", "--out", "report"]);
    let remarks = report["remarks"].as_array().unwrap();
    let is_said = |remark: &Value| remark.as_str().unwrap().contains("was taken as one of PGV.RotD50");
    assert!(report["states"][2]["rate"]["rate"].is_number() && remarks.iter().any(is_said), "{remarks:?}");
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "runs.csv"]);
    let rate = json(folder.path(), &["rate", "hazard.csv", "--table", "runs.csv", "--im", "PGV.RotD50"]);
    assert_eq!(report["states"][2]["rate"]["rate"], rate["rate"]);
    let wrong = refusal(folder.path(), &["rate", "hazard.csv", "--table", "runs.csv", "--im", "PGA.RotD50"]);
    assert!(wrong.contains("found a hazard curve of PGV; expected one of PGA.RotD50"), "{wrong}");
}

#[test]
fn what_an_assessment_in_space_has_not_is_refused_by_name() {
    for (old, new, expected) in [
        (
            "limit = 0.8",
            "limit = \"plastic:0.1\"",
            "a limit for a block in the plane; expected overturned, or one in space",
        ),
        ("width = 1.2", "ties = 10", "wider: ties is for a block in the plane; expected a change without it"),
        ("width = 1.2", "dampers = 0.1", "wider: dampers is for a block in the plane"),
        (
            "{ kappa = 0.5 }",
            "{ epsilon = 0.5 }",
            "epsilon is for a block in the plane; in space feet land on their dashpots",
        ),
        ("friction = [0.2, 0.6]", "\"tie_1.stiffness\" = [1, 2]", "tie_1.stiffness is for a block in the plane"),
        ("title", "im = \"PGV\"\ntitle", "im = \"PGV\"; expected one of PGA.larger"),
    ] {
        assert!(ASSESS.contains(old), "{old}");
        let folder = folder(&format!("{STUDY}{}", ASSESS.replacen(old, new, 1)));
        let message = fails(&mut program(folder.path(), &[&["assess", "study.toml", "--out", "report"]]));
        assert!(message.contains(expected), "{new}: {message}");
        assert!(!folder.path().join("report").exists());
    }
}
