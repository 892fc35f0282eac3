//! Blocks in space: runs of the references through the program, outputs that name the model, refusals.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::program::{RECORD, Table, files, refusal, stdout};
use crate::skipped::skip;
use crate::studies::labels;

/// Folder of the references.
fn references() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference_space")
}

/// Returns a case of the references.
fn case(name: &str) -> Value {
    let cases: Vec<Value> =
        serde_json::from_str(&std::fs::read_to_string(references().join("cases.json")).unwrap()).unwrap();
    cases.into_iter().find(|case| case["name"] == name).unwrap()
}

/// Runs a case and compares rows, peak and the events of each foot.
fn compare(name: &str, folder: &Path, arguments: &str, names: &[&str]) {
    let case = case(name);
    let number = |value: &Value| value.as_f64().unwrap();
    let parameters = &case["parameters"];
    let alpha = number(&parameters["alpha"]);
    let of_block = ["alpha", "p", "eta", "xi_v", "kappa", "friction"];
    let mut line = format!("simulate --mass 1 --tolerance 1e-10 --step 0.01 --csv run.csv --json --events {arguments}");
    for name in of_block {
        line += &format!(" --{} {}", name.replace('_', "-"), number(&parameters[name]));
    }
    line += &format!(" --duration {}", number(&case["t_asked"]));
    let printed = stdout(folder, &line.split_whitespace().collect::<Vec<_>>());
    let summary: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(summary["model"], "block in space");

    let table = Table::read(&folder.join("run.csv"));
    let expected = Table::read(&references().join(format!("{name}.csv")));
    let t_final = number(&case["t_final"]);
    let rows = (0..expected.rows.len()).filter(|&row| expected.number(row, "t") < t_final - 1e-9);
    for row in rows {
        for column in ["t", "tilt_x", "tilt_y", "twist", "touching", "sliding"] {
            let error = (table.number(row, column) - expected.number(row, column)).abs();
            assert!(error <= 1e-7 * alpha, "{name}: {column} in row {row} is off by {error:e}");
        }
        for (foot, name) in names.iter().enumerate() {
            let error =
                (table.number(row, &format!("N_{name}")) - expected.number(row, &format!("N_{foot}"))).abs() / 9.81;
            assert!(error <= 1e-5, "N_{name} in row {row} is off by {error:e} M g");
        }
    }
    let peak = number(&summary["peak"]["tilt"]);
    let end = if case["end"] == "overturned" { TAU / 4.0 } else { number(&case["peak_tilt"]) };
    assert!((peak - end).abs() < 1e-3 * alpha && peak > end - 1e-7 * alpha, "{name}: a peak of {peak}, not {end}");
    for (key, expected) in case["energy"].as_object().unwrap().iter().filter(|(key, _)| *key != "E") {
        let error = (number(&summary["energy"][key]) - number(expected)).abs();
        assert!(error < 1e-7 * 9.81 * 3.0, "{name}: {key} is off by {error:e} J");
    }

    // Feet share events without an order.
    let mut of_feet: BTreeMap<String, Vec<(String, f64)>> = BTreeMap::new();
    for event in summary["events"]["list"].as_array().unwrap() {
        let foot = event["foot"].as_str().unwrap_or("none").to_string();
        of_feet.entry(foot).or_default().push((event["event"].as_str().unwrap().into(), number(&event["t"])));
    }
    let mut expected: BTreeMap<String, Vec<(String, f64)>> = BTreeMap::new();
    for event in case["events"].as_array().unwrap() {
        let foot = usize::try_from(event["foot"].as_i64().unwrap()).map_or("none", |foot| names[foot]);
        expected.entry(foot.into()).or_default().push((event["kind"].as_str().unwrap().into(), number(&event["t"])));
    }
    assert_eq!(of_feet.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (foot, found) in &of_feet {
        assert_eq!(found.len(), expected[foot].len(), "{name}, foot {foot}");
        for (found, expected) in found.iter().zip(&expected[foot]) {
            assert!(found.0 == expected.0 && (found.1 - expected.1).abs() < 1e-7, "{found:?}, not {expected:?}");
        }
    }
}

const CORNERS: [&str; 4] = ["SW", "NW", "SE", "NE"];

#[test]
fn a_pulse_along_a_diagonal_overturns_the_block_as_in_the_reference() {
    let folder = tempfile::tempdir().unwrap();
    let (amplitude, period) = (3.5 * 2.0_f64.sqrt(), TAU / 5.0);
    let pulse = format!("--depth-ratio 1 --pulse one-sine --amplitude {amplitude} --period {period} --azimuth 45");
    compare("diagonal_overturns", folder.path(), &pulse, &CORNERS);
}

#[test]
fn a_block_released_over_a_corner_moves_as_in_the_reference() {
    let folder = tempfile::tempdir().unwrap();
    compare("corner_release", folder.path(), "--depth-ratio 1 --tilt-x 0.15 --tilt-y 0.16 --omega-z 0.3", &CORNERS);
}

#[test]
fn a_cylinder_wobbles_as_in_the_reference() {
    let folder = tempfile::tempdir().unwrap();
    let names: Vec<String> = (1..=16).map(|foot| foot.to_string()).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let released = "--base circle --feet 16 --tilt-x 0.1 --omega-x -0.243 --omega-z 1.6079";
    compare("cylinder_16", folder.path(), released, &names);
}

/// A pair of recorded components, from the time of the reference on.
#[test]
fn a_block_moves_under_a_pair_of_records_as_in_the_reference() {
    let folder = tempfile::tempdir().unwrap();
    let records = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/records");
    let motion = &case("rinaldi")["excitation"];
    for (axis, name) in [("a_gx", "x.csv"), ("a_gy", "y.csv")] {
        let path = records.join(motion[axis]["file"].as_str().unwrap());
        if !path.exists() {
            return skip(&format!("the pair of records of the program: {} is missing", path.display()));
        }
        let record = rocking_records::read(&path, &rocking_records::ReadOptions::default()).unwrap();
        let first = (motion[axis]["start"].as_f64().unwrap() / record.time_step).round() as usize;
        let rows = record.acceleration[first..].iter().enumerate();
        let rows: String = rows.map(|(i, a)| format!("{:.2},{a}\n", i as f64 * record.time_step)).collect();
        std::fs::write(folder.path().join(name), format!("time [s],acceleration [m/s2]\n{rows}")).unwrap();
    }
    let pair = "--depth-ratio 1.2 --record x.csv --record-y y.csv --scale 0.6 --unit m/s2";
    compare("rinaldi", folder.path(), pair, &CORNERS);
}

/// Text, JSON, table and picture say that the block is one in space.
#[test]
fn every_output_names_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let line =
        "simulate --depth 0.6 --alpha 0.2 --p 2 --eta 60 --tilt-x 0.05 --tilt-y 0.03 --csv run.csv --plot run.svg";
    let printed = stdout(folder.path(), &line.split(' ').collect::<Vec<_>>());
    assert!(printed.contains("block         in space, 0.73085 m × 0.6 m, h = "), "{printed}");
    assert!(printed.contains(": the block is at rest"), "{printed}");
    let table = std::fs::read_to_string(folder.path().join("run.csv")).unwrap();
    assert!(table.starts_with("# block in space on 4 feet\nt [s],tilt [rad],"), "{}", &table[..80]);
    let svg = std::fs::read_to_string(folder.path().join("run.svg")).unwrap();
    for label in ["block in space", "direction of the tilt", "twist (°)", "foot NE", "slip (mm)", "time (s)"] {
        assert!(svg.contains(label), "{label} is not in the picture");
    }
}

/// Without excitation the embedded record acts along x, and blocks fly.
#[test]
fn a_block_in_space_without_excitation_has_the_embedded_record() {
    let folder = tempfile::tempdir().unwrap();
    let line = "simulate --depth-ratio 1 --alpha 0.15 --p 2 --xi-v 0.2 --duration 5 --json --csv run.csv";
    let summary: Value = serde_json::from_str(&stdout(folder.path(), &line.split(' ').collect::<Vec<_>>())).unwrap();
    assert!(summary["warnings"][0].as_str().unwrap().contains("embedded record"), "{summary}");
    assert_eq!(summary["outcome"], "undecided");
    let table = Table::read(&folder.path().join("run.csv"));
    assert!(table.column("tilt_y").iter().all(|tilt| tilt.abs() < 1e-12));
    assert!(table.column("tilt_x").iter().any(|tilt| tilt.abs() > 1e-3));
}

/// The plan names what it shows, in one scale.
#[test]
fn a_plan_shows_the_paths_over_the_base() {
    let folder = tempfile::tempdir().unwrap();
    let line = "simulate --depth-ratio 1.5 --alpha 0.2 --p 2 --xi-v 0.2 --friction 0.3 --duration 12 --quiet --plot-plan plan.svg";
    stdout(folder.path(), &line.split(' ').collect::<Vec<_>>());
    assert_eq!(files(folder.path()), ["plan.svg"]);
    let drawn = labels(&std::fs::read_to_string(folder.path().join("plan.svg")).unwrap());
    for label in ["base at rest", "base at the end", "centre of mass", "middle of the base", "x (m)", "y (m)"] {
        assert!(drawn.iter().any(|found| found == label), "{label} is not in the picture: {drawn:?}");
    }
}

/// A block whose feet are in a table.
const LIST: &str = "--center-height 2 --mass 1000 --inertia-tensor 1e3,1e3,5e2 --omega-v 60 --feet";

const WITHOUT_SPACE: &str = "without one of --depth, --depth-ratio, --base, --feet, which make a block in space";

/// Mistakes, and the beginnings of their messages.
const MISTAKES: &[(&str, &str)] = &[
    ("--depth 0", "--depth = 0; expected a length > 0 m"),
    ("--depth -1", "--depth = -1; expected a length > 0 m"),
    ("--base circle --feet 2", "feet = 2 is not valid; expected 3 to 64"),
    ("--base circle --feet 65", "feet = 65 is not valid; expected 3 to 64"),
    ("{list} two.csv", "feet = 2 is not valid; expected 3 to 64"),
    ("{list} line.csv", "feet: the 3 feet without a gap stand on a line; expected a base with an area"),
    ("{list} gaps.csv", "foot_gap leaves 2 feet without a gap; expected at least 3"),
    (
        "{list} aside.csv",
        "feet: foot 2 at (2 m, -1 m) from the centre of mass carries -4905 N at rest; expected a centre of mass so far inside the base \
             that all feet without a gap carry",
    ),
    ("--depth 1 --eccentricity 0.9 --width 1 --height 4 --eta 50", "eccentricity"),
    ("--depth 1 --mass 1000 --inertia-tensor 100,100,300", "inertia has the principal moments ["),
    ("--depth 1 --xi-h 0", "--xi-h = 0; expected a number > 0"),
    ("--depth 1 --xi-v 0", "xi_v = 0 is not valid; expected"),
    ("--depth 1 --kappa 0", "--kappa = 0; expected a number > 0"),
    (
        "--depth 1 --foundation rigid",
        "--foundation rigid is for a block in the plane; in space a block stands on feet; expected --eta of 100 to 300 for a hard base",
    ),
    ("--depth 1 --epsilon 0.5", "--epsilon is for a block in the plane; in space feet land on"),
    ("--depth 1 --restitution-factor 0.9", "--restitution-factor is for a block in the plane"),
    (
        "--depth 1 --tie block_z=2,ground_x=3,stiffness=1e5 --mass 1000",
        "--tie is for a block in the plane; expected it without --depth, --base and --feet",
    ),
    ("--depth 1 --damper block_z=2,ground_x=3,stiffness=1e5 --mass 1000", "--damper is for a block in the plane"),
    ("--depth 1 --theta 0.1", "--theta is for a block in the plane; expected --tilt-x"),
    ("--depth 1 --theta-dot 0.1", "--theta-dot is for a block in the plane; expected --omega-y"),
    ("--depth 1 --gradients alpha", "--gradients is for a block in the plane"),
    ("--depth 1 --friction-demand 0.5", "--friction-demand is for a block in the plane"),
    ("--depth 1 --plot-loops loops.svg", "--plot-loops is for a block in the plane"),
    ("--depth 1 --plot-plan plan.pdf", "plan.pdf: found .pdf; expected a picture as .svg or .png"),
    (
        "--depth 1 --inertia 1000 --width 1 --height 4 --mass 1000 --eta 50",
        "--inertia is for a block in the plane; in space it has six numbers; expected --inertia-tensor",
    ),
    ("--depth 1 --tilt-x 2", "--tilt-x = 2; expected a tilt, with --tilt-y, within 1.57 rad"),
    ("--depth 1 --record-y y.csv", "--record-y without --record; expected both horizontal components"),
    (
        "--depth 1 --record x.csv --record-y x.csv",
        "--record-y has the samples of --record; expected each component once",
    ),
    (
        "--depth 1 --record x.csv --record-y coarse.csv",
        "--record-y has a time step of 0.02 s; expected that of --record, 0.01 s; --resample gives all components one step",
    ),
    (
        "--depth 1 --record x.csv --record-y short.csv",
        "--record-y has 150 samples; expected the 200 samples of --record; cut the components to the samples that all have",
    ),
    (
        "--depth 1 --vertical x.csv --azimuth 30",
        "--azimuth has no effect without a horizontal record or a pulse, which it turns",
    ),
    ("--record x.csv --record-y y.csv", "--record-y has no effect {space}"),
    ("--pulse one-sine --amplitude 3 --azimuth 30", "--azimuth has no effect {space}"),
    ("--kappa 2 --theta 0.1", "--kappa has no effect {space}"),
    ("--tilt-x 0.1", "--tilt-x has no effect {space}"),
    ("{list} feet.csv --alpha 0.2", "--alpha has no effect with a table of --feet"),
    ("{list} missing.csv", "--feet: missing.csv: cannot be read"),
];

/// Each mistake is named with the variable, the value and the expected one, and leaves no file.
#[test]
fn mistakes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let record = |step: f64, count: usize, factor: f64| -> String {
        let row = |i: usize| format!("{},{}\n", i as f64 * step, factor * (i as f64 * 0.3).sin());
        format!("t [s],a [m/s2]\n{}", (0..count).map(row).collect::<String>())
    };
    write("x.csv", &record(0.01, 200, 1.0));
    write("y.csv", &record(0.01, 200, 2.0));
    write("coarse.csv", &record(0.02, 100, 2.0));
    write("short.csv", &record(0.01, 150, 2.0));
    write("line.csv", "-1,0\n0,0\n1,0\n");
    write("two.csv", "-1,0\n1,0\n");
    write("aside.csv", "1,-1\n2,-1\n1,1\n2,1\n");
    write("gaps.csv", "-1,-1,0\n1,-1,0\n1,1,0.1\n-1,1,0.1\n");
    write("feet.csv", "-1,-1\n1,-1\n1,1\n-1,1\n");
    let before = files(folder.path());
    for (line, message) in MISTAKES {
        let (line, message) = (line.replace("{list}", LIST), message.replace("{space}", WITHOUT_SPACE));
        let arguments: Vec<&str> = "simulate --csv run.csv --plot run.png".split(' ').chain(line.split(' ')).collect();
        let found = refusal(folder.path(), &arguments);
        assert!(found.starts_with(&message), "{line}: {found}, not {message}");
        assert_eq!(files(folder.path()), before, "{line} left a file");
    }
}

#[test]
fn feet_of_a_table_are_those_of_a_rectangle() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("feet.csv"), "-1,-1\n1,-1\n1,1\n-1,1\n").unwrap();
    let run = |line: &str| {
        let arguments: Vec<&str> =
            "simulate --csv run.csv --duration 1 --tilt-x 0.05".split(' ').chain(line.split(' ')).collect();
        stdout(folder.path(), &arguments);
        Table::read(&folder.path().join("run.csv")).column("tilt")
    };
    let (of_list, of_rectangle) = (
        run(&format!("{LIST} feet.csv")),
        run("--depth 2 --width 2 --center-height 2 --mass 1000 --inertia-tensor 1e3,1e3,5e2 --omega-v 60"),
    );
    for (a, b) in of_list.iter().zip(&of_rectangle) {
        assert!((a - b).abs() < 1e-9, "{a}, {b}");
    }
}

/// A component alone is a motion along the azimuth: one along 90° shakes the block along y as a square one along x.
#[test]
fn an_azimuth_turns_a_record_alone() {
    let folder = tempfile::tempdir().unwrap();
    let run = |azimuth: &str, column: &str| {
        let block =
            "simulate --depth-ratio 1 --alpha 0.2 --p 2 --xi-v 0.2 --csv run.csv --duration 3 --scale 4 --record";
        let arguments: Vec<&str> = block.split(' ').chain([RECORD, "--azimuth", azimuth]).collect();
        stdout(folder.path(), &arguments);
        Table::read(&folder.path().join("run.csv")).column(column)
    };
    let (along_x, along_y) = (run("0", "tilt_x"), run("90", "tilt_y"));
    assert!(along_x.iter().any(|tilt| tilt.abs() > 0.01));
    let apart = along_x.iter().zip(&along_y).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-6, "{apart}");
    let across = run("90", "tilt_x");
    assert!(across.iter().all(|tilt| tilt.abs() < 1e-6));
}

#[test]
fn a_record_alone_acts_along_x() {
    let folder = tempfile::tempdir().unwrap();
    let line = ["simulate", "--depth", "1", "--record", RECORD, "--duration", "1", "--csv", "run.csv"];
    assert!(stdout(folder.path(), &line).contains("excitation    x np01002p_4225a_a.smc"));
}
