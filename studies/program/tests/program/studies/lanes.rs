//! `--lanes`: the same bytes for any number of lanes.

use std::path::Path;

use crate::program::{Table, rocking, stdout, text};

/// A folder with a study and two records, the horizontal one strong enough for flights and overturning.
fn folder(study: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let text = |a: f64, f: f64| {
        let at = |i: i32| f64::from(i) * 0.01;
        (0..300).map(|i| format!("{}\n", a * (f * at(i)).sin() * (0.7 * at(i)).cos())).collect::<String>()
    };
    std::fs::write(folder.path().join("h.csv"), text(7.0, 6.0)).unwrap();
    std::fs::write(folder.path().join("v.csv"), text(5.0, 19.0)).unwrap();
    std::fs::write(folder.path().join("study.toml"), study).unwrap();
    folder
}

/// Runs a study with all numbers of lanes and threads; returns the table, which must have both outcomes.
#[track_caller]
fn the_same_bytes(folder: &Path, arguments: &[&str], ends: [&str; 2]) -> Table {
    let name = |lanes: &str, threads: &str| format!("{lanes}-{threads}.csv");
    let bytes = |name: &str| std::fs::read(folder.join(name)).unwrap();
    for lanes in ["1", "2", "4", "8"] {
        for threads in ["1", "2"] {
            let csv = name(lanes, threads);
            stdout(folder, &[arguments, &["--csv", &csv, "--lanes", lanes, "--threads", threads]].concat());
            assert!(bytes(&csv) == bytes("1-1.csv"), "{lanes} lanes, {threads} threads");
        }
    }
    stdout(folder, &[arguments, &["--csv", "usual.csv"]].concat());
    assert!(bytes("usual.csv") == bytes("1-1.csv"));
    let table = Table::read(&folder.join("1-1.csv"));
    let outcomes: Vec<&str> = (0..table.rows.len()).map(|row| table.get(row, "outcome")).collect();
    for outcome in ends {
        assert!(outcomes.contains(&outcome), "none {outcome}");
    }
    table
}

const STOOD_AND_FELL: [&str; 2] = ["completed", "overturned"];

const SPECTRUM: [&str; 16] = [
    "spectrum",
    "--record",
    "h.csv",
    "--vertical",
    "v.csv",
    "--also-horizontal",
    "--unit",
    "m/s2",
    "--dt",
    "0.01",
    "--points",
    "17",
    "--p-max",
    "6",
    "--foundation",
    "40,0.1,0",
];

#[test]
fn a_spectrum_with_flights_and_overturnings() {
    let folder = folder("");
    let arguments = [&SPECTRUM[..], &["--foundation", "90,0.1,0.4", "--foundation", "rigid"]].concat();
    let table = the_same_bytes(folder.path(), &arguments, STOOD_AND_FELL);
    let flights = (0..table.rows.len()).filter(|&row| table.number(row, "flights [1]") > 1.0).count();
    assert!(flights > 5, "{flights} blocks flew");
}

#[test]
fn a_spectrum_whose_runs_end_at_separation() {
    let folder = folder("");
    let arguments = [&SPECTRUM[..], &["--foundation", "90,0.1,0.4", "--on-separation", "terminate"]].concat();
    let table = the_same_bytes(folder.path(), &arguments, STOOD_AND_FELL);
    assert!((0..table.rows.len()).any(|row| table.get(row, "outcome") == "separated"));
}

#[test]
fn a_sweep_of_samples_with_an_ensemble() {
    let folder = folder(
        r#"
[study]
design = "latin-hypercube"
samples = 12
seed = 7
scales = [0.5, 1.3]
ensemble = { scale = 0.1, samples = 3, limits = [0.5] }

[parameters]
dimensionless.alpha = { from = 0.1, to = 0.4 }
dimensionless.p = { from = 0.8, to = 5 }
dimensionless.eta = { from = 20, to = 100 }
epsilon = { from = 0, to = 0.5 }

[[records]]
horizontal = "h.csv"
unit = "m/s2"
dt = 0.01

[[records]]
horizontal = "h.csv"
vertical = "v.csv"
unit = "m/s2"
dt = 0.01
"#,
    );
    let table = the_same_bytes(folder.path(), &["sweep", "study.toml"], STOOD_AND_FELL);
    assert!((0..table.rows.len()).any(|row| table.number(row, "flights [1]") > 1.0));
}

/// Some blocks overturn on an island, some above a level, some at none.
#[test]
fn a_sweep_of_least_levels() {
    let folder = folder(
        r#"
[study]
design = "grid"
least = { im = "PGA", from = 1, to = 14, points = 40, resolution = 1e-4 }

[parameters]
dimensionless.alpha = [0.15, 0.3]
dimensionless.p = [0.9, 2, 4]
epsilon = [0, 0.4]

[[records]]
horizontal = "h.csv"
vertical = "v.csv"
unit = "m/s2"
dt = 0.01
"#,
    );
    let table = the_same_bytes(folder.path(), &["sweep", "study.toml"], STOOD_AND_FELL);
    let ranges = |row| table.number(row, "overturning_ranges [1]");
    assert!((0..table.rows.len()).any(|row| ranges(row) > 1.0));
}

#[test]
fn a_search_under_a_record() {
    let folder = folder("");
    let record = ["--record", "h.csv", "--vertical", "v.csv", "--unit", "m/s2", "--dt", "0.01"];
    let scan = ["--alpha", "0.15", "--p", "2", "--from", "0.1", "--to", "2", "--points", "60"];
    the_same_bytes(folder.path(), &[&["search", "overturning"], &record[..], &scan].concat(), STOOD_AND_FELL);
}

/// In free vibration, in which a block separates unless the damping is large enough.
#[test]
fn a_search_of_damping() {
    let folder = folder("");
    the_same_bytes(
        folder.path(),
        &["search", "damping", "--alpha", "0.25", "--p", "1", "--to", "0.4", "--points", "40"],
        ["separated", "completed"],
    );
}

#[test]
fn other_numbers_are_refused() {
    let folder = folder("");
    let output = rocking(folder.path(), &[&SPECTRUM[..], &["--csv", "a.csv", "--lanes", "3"]].concat());
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("expected 1, 2, 4 or 8"));
}

/// Friction, a tie and an eccentric centre of mass: such blocks are stepped alone.
const HELD: [&str; 6] = [
    "--friction",
    "0.35",
    "--eccentricity-ratio",
    "0.2",
    "--tie-ratio",
    "block_z=1.5,ground_x=2,stiffness=0.3,slack=0.02,damping=0.01,strength=0.06",
];

#[test]
fn a_spectrum_of_held_blocks() {
    let folder = folder("");
    let arguments = [&SPECTRUM[..10], &HELD, &["--points", "7", "--foundation", "rigid"]].concat();
    let table = the_same_bytes(folder.path(), &arguments, STOOD_AND_FELL);
    let some = |column: &str| (0..table.rows.len()).filter(|&row| table.number(row, column) > 0.0).count();
    assert!(some("peak.slip [m]") > 3 && some("peak.tie_1.tension [N]") > 3);
}

/// Plain blocks in lanes beside blocks that are stepped alone.
#[test]
fn a_sweep_of_plain_and_held_blocks() {
    let folder = folder(
        r#"
[study]
design = "grid"

[parameters]
dimensionless.alpha = [0.2, 0.35]
dimensionless.p = [1, 2.5]
friction = ["none", 0.3]
eccentricity = [0, 0.05]
tie_1.block_z = [1]
tie_1.ground_x = [2]
tie_1.stiffness = [0, 2e3]

[[records]]
horizontal = "h.csv"
vertical = "v.csv"
unit = "m/s2"
dt = 0.01
"#,
    );
    let table = the_same_bytes(folder.path(), &["sweep", "study.toml"], STOOD_AND_FELL);
    let some = |column: &str| (0..table.rows.len()).filter(|&row| table.number(row, column) > 0.0).count();
    assert_eq!(table.rows.len(), 32);
    assert!(some("peak.slip [m]") > 3 && some("peak.tie_1.tension [N]") > 3);
}

#[test]
fn searches_of_a_held_block() {
    let folder = folder("");
    let held = ["--alpha", "0.25", "--p", "1", "--friction", "0.4", "--eccentricity", "0.1", "--mass", "1000"];
    let tie = ["--tie", "block_z=2,ground_x=3,stiffness=2e3,slack=0.01"];
    let damping = [&["search", "damping", "--to", "0.4", "--points", "40"], &held[..], &tie].concat();
    the_same_bytes(folder.path(), &damping, ["separated", "completed"]);
    let pulse = ["--period", "1.5", "--to", "12", "--points", "60"];
    the_same_bytes(folder.path(), &[&["search", "overturning"], &held[..], &tie, &pulse].concat(), STOOD_AND_FELL);
}
