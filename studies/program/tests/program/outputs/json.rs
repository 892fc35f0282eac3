//! `--json`: one object, with the numbers of the tables and of the text.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::outputs::{SEARCH, SPECTRUM, STUDY, folder};
use crate::program::{Table, fails_with, program, succeeds, text};

/// A pulse that makes the block lift, land and come to rest.
const ROCKS: [&str; 11] =
    ["simulate", "--alpha", "0.25", "--p", "1", "--pulse", "one-sine", "--amplitude", "5", "--period", "1.25"];

/// Returns the object, which must be alone on standard output.
#[track_caller]
fn object(folder: &Path, arguments: &[&[&str]]) -> Value {
    let (out, err) = succeeds(&mut program(folder, &[&arguments.concat(), &["--json"]]));
    assert_eq!((out.lines().count(), err.as_str()), (1, ""));
    serde_json::from_str(&out).unwrap()
}

#[test]
fn the_summary_of_a_run_has_the_numbers_of_its_table() {
    let folder = folder();
    let path = folder.path();
    let files = ["--csv", "run.csv", "--plot", "run.svg"];
    let json = object(path, &[&ROCKS, &files, &["--events"]]);
    let (text, _) = succeeds(&mut program(path, &[&ROCKS, &files, &["--events"]]));
    let number =
        |pointer: &str| json.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}: {json}"));
    let table = Table::read(&path.join("run.csv"));
    let at_end = |name: &str| table.number(table.rows.len() - 1, name);
    let greatest = |name: &str| table.column(name).into_iter().map(f64::abs).fold(0.0, f64::max);

    assert_eq!((json["command"].as_str(), json["outcome"].as_str()), (Some("simulate"), Some("completed")));
    assert_eq!(number("/end_time"), at_end("t"));
    for name in ["total", "kinetic", "input", "dashpots", "impacts", "constraint", "residual"] {
        assert_eq!(number(&format!("/energy/{name}")), at_end(&format!("energy.{name}")), "{name}");
    }
    assert_eq!(number("/energy/greatest_total"), greatest("energy.total"));
    // Peaks are also found between rows.
    let n = greatest("N_L").max(greatest("N_R"));
    let uplift = greatest("uplift_L").max(greatest("uplift_R"));
    for (pointer, of_rows) in [("theta", greatest("theta")), ("N", n), ("H", greatest("H")), ("uplift", uplift)] {
        let peak = number(&format!("/peak/{pointer}"));
        assert!(peak >= of_rows && peak < 1.05 * of_rows, "{pointer}: {peak}, of the rows {of_rows}");
    }
    let (alpha, over) = (number("/block/alpha"), json["peak"]["theta/alpha"].as_f64().unwrap());
    assert_eq!(alpha, 0.25);
    assert_eq!(over, number("/peak/theta") / alpha);
    assert!(text.contains(&format!("|θ|/α = {over:.4}")), "{text}");

    let events = json["events"]["list"].as_array().unwrap();
    assert!(events.len() > 4);
    let kind = |name: &str| events.iter().filter(|event| event["event"] == name).count() as f64;
    assert_eq!(kind("lift-off"), number("/events/liftoffs"));
    assert_eq!(kind("landing"), number("/events/impacts"));
    assert_eq!(events.last().unwrap()["t"], json["events"]["last_time"]);
    for event in events {
        let (t, corner) = (event["t"].as_f64().unwrap(), event["corner"].as_str().unwrap());
        assert!(text.contains(&format!("t = {t:.9} s")) && ["L", "R"].contains(&corner), "{event}");
        assert_ne!(event["before"], event["after"]);
    }
    assert_eq!(json["written"], serde_json::json!({ "csv": "run.csv", "plot": "run.svg" }));
    assert_eq!(json["warnings"], serde_json::json!([]));
    assert!(object(path, &[&ROCKS, &files])["events"]["list"].is_null());
    let embedded = object(path, &[&["simulate", "--duration", "1"]]);
    assert!(embedded["warnings"][0].as_str().unwrap().contains("embedded"), "{embedded}");
}

#[test]
fn a_run_that_ends_early_says_how_and_when() {
    let folder = folder();
    let arguments = ["--amplitude", "6.2622", "--period", "1.2566370614359172", "--eta", "60", "--epsilon", "0.4"];
    let json = object(folder.path(), &[&ROCKS[..7], &arguments, &["--csv", "run.csv"]]);
    // From the reference case sine_separates.
    assert_eq!((json["outcome"].as_str(), json["has_come_down"].as_bool()), (Some("separated"), Some(false)));
    assert!((json["end_time"].as_f64().unwrap() - 1.3900586035017384).abs() < 1e-6, "{json}");
}

#[test]
fn studies_and_searches_have_the_numbers_of_their_tables() {
    let folder = folder();
    let path = folder.path();
    let json = object(path, &[&SPECTRUM, &["--csv", "spectrum.csv", "--plot", "spectrum.svg"]]);
    assert_eq!(
        (json["rows"].as_u64(), json["rows_before"].as_u64(), json["failed"].as_u64()),
        (Some(10), Some(0), Some(0))
    );
    assert!(json["excitation"].as_str().unwrap().contains("one-sine pulse"));
    assert_eq!(Table::read(&path.join("spectrum.csv")).rows.len(), 10);
    let json = object(path, &[&SPECTRUM, &["--csv", "spectrum.csv", "--resume"]]);
    assert_eq!((json["rows"].as_u64(), json["rows_before"].as_u64()), (Some(10), Some(10)));

    let json = object(path, &[&["sweep", "study.toml", "--csv", "sweep.csv"]]);
    assert_eq!((json["command"].as_str(), json["rows"].as_u64()), (Some("sweep"), Some(6)));
    assert_eq!(json["written"], serde_json::json!({ "csv": "sweep.csv" }));

    let json = object(path, &[&SEARCH, &["--csv", "search.csv"]]);
    let table = Table::read(&path.join("search.csv"));
    let stretches = json["stretches"].as_array().unwrap();
    assert_eq!(stretches.len(), table.rows.len());
    for (row, stretch) in stretches.iter().enumerate() {
        for name in ["from", "to"] {
            assert_eq!(stretch[name].as_f64(), Some(table.number(row, name)));
        }
        assert_eq!(stretch["outcome"], table.get(row, "outcome"));
    }
    assert_eq!(json["least"], stretches[1]["from"]);
    assert_eq!((json["parameter"].as_str(), json["unit"].as_str()), (Some("xi_v"), Some("1")));
}

/// Failed runs are a warning in the object, and still an error.
#[test]
fn failed_runs_are_counted() {
    let folder = folder();
    let path = folder.path();
    // No block can follow the second factor.
    let study = STUDY.replace("duration = 2", "duration = 2\nscales = [1, 1e300]");
    fs::write(path.join("hard.toml"), study).unwrap();
    let output = program(path, &[&["sweep", "hard.toml", "--csv", "hard.csv", "--json"]]).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((json["rows"].as_u64(), json["failed"].as_u64()), (Some(12), Some(6)));
    let warnings: Vec<&str> = json["warnings"].as_array().unwrap().iter().map(|text| text.as_str().unwrap()).collect();
    let [scale, failed] = warnings[..] else { panic!("{warnings:?}") };
    assert!(scale.contains("is scaled by up to 1.0e300; expected at most 20"), "{scale}");
    assert!(failed.contains("6 of 12 runs failed"), "{failed}");
    assert!(warnings.iter().all(|warning| text(&output.stderr).contains(warning)));
}

/// A table occupies standard output; the object goes to standard error.
#[test]
fn the_object_leaves_standard_output_to_a_table() {
    let folder = folder();
    let path = folder.path();
    for command in [&ROCKS[..], &SPECTRUM, &SEARCH, &["sweep", "study.toml"]] {
        let (table, object) = succeeds(&mut program(path, &[command, &["--csv", "-", "--json"]]));
        assert!(!table.contains('{') && table.lines().count() > 2, "{table}");
        let object: Value = serde_json::from_str(&object).unwrap();
        assert_eq!((object["command"].as_str(), object["written"]["csv"].as_str()), (Some(command[0]), Some("-")));
    }
    // An error prints no object.
    fails_with(&mut program(path, &[&["simulate", "--alpha", "2", "--json"]]), &["alpha = 2"]);
}
