//! `rocking fit`.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{Table, refused, stdout};

const STUDY: &str = "\
[fit]
free = [\"p\", \"restitution_factor\"]
starts = 4
[parameters]
foundation = \"rigid\"
alpha = 0.2
p = 2.2
[[tests]]
data = \"run.csv\"
noise = 1e-3
initial.theta = 0.15
";

/// The tilted block whose run takes the place of a test.
fn folder(study: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let block = ["simulate", "--foundation", "rigid", "--alpha", "0.2", "--p", "2.5", "--restitution-factor", "0.95"];
    let shown = ["--theta", "0.15", "--duration", "4", "--step", "0.02", "--csv", "run.csv", "--quiet"];
    stdout(folder.path(), &[&block[..], &shown].concat());
    fs::write(folder.path().join("study.toml"), study).unwrap();
    folder
}

/// A table of `rocking simulate` is a test without errors: the fit returns the options of that run.
#[test]
fn a_run_of_the_program_is_a_test() {
    let folder = folder(STUDY);
    let outputs = ["--csv", "estimates.csv", "--residuals", "residuals.csv", "--plot", "fit.svg", "--json"];
    let summary = stdout(folder.path(), &[&["fit", "study.toml"], &outputs[..]].concat());
    let json: Value = serde_json::from_str(&summary).unwrap();
    for (i, (name, planted)) in [("p", 2.5), ("restitution_factor", 0.95)].into_iter().enumerate() {
        let estimate = &json["estimates"][i];
        assert_eq!(estimate["name"].as_str(), Some(name));
        assert!((estimate["value"].as_f64().unwrap() / planted - 1.0).abs() < 1e-5, "{estimate}");
    }
    let estimates = Table::read(&folder.path().join("estimates.csv"));
    assert_eq!(estimates.column("value")[0], json["estimates"][0]["value"].as_f64().unwrap());
    assert_eq!(estimates.column("low")[1], json["estimates"][1]["interval"][0].as_f64().unwrap());
    let (residuals, run) = ("residuals.csv", "run.csv");
    let [residuals, run] = [residuals, run].map(|name| Table::read(&folder.path().join(name)));
    assert_eq!(residuals.column("measured"), run.column("theta"));
    let picture = fs::read_to_string(folder.path().join("fit.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.len() > 10_000);
}

#[test]
fn a_drifted_delayed_table_in_degrees_is_read() {
    let folder = folder("");
    let run = Table::read(&folder.path().join("run.csv"));
    let rows = run.column("t").into_iter().zip(run.column("theta"));
    let rows = rows.map(|(t, theta)| format!("{},{}\n", t + 0.3, theta.to_degrees() + 0.5));
    let table: String = std::iter::once("seconds,tilt [deg]\n".into()).chain(rows).collect();
    fs::write(folder.path().join("camera.csv"), table).unwrap();
    let of_test = "data = \"camera.csv\"\ntime = 1\ncolumn = \"tilt\"\nfactor = 0.017453292519943295\nzero = 0.01\ndelay = 0.25\n\
                   free = [\"zero\", \"delay\"]";
    fs::write(folder.path().join("study.toml"), STUDY.replace("data = \"run.csv\"", of_test)).unwrap();
    let summary = stdout(folder.path(), &["fit", "study.toml"]);
    for line in ["p                  2.5", "test_1.zero        0.00872", "test_1.delay       0.3"] {
        assert!(summary.contains(line), "{summary}");
    }
}

#[test]
fn errors_name_the_line() {
    let cases: [(&str, &str, &[&str]); 9] = [
        (
            "free = [\"p\", ",
            "free = [\"eta\", ",
            &["study.toml:1: eta is no real parameter of this block; expected one of alpha, p"],
        ),
        ("starts = 4", "starts = 0", &["study.toml:3: starts = 0; expected a whole number from 1"]),
        (
            "starts = 4",
            "bounds = { alpha = [0.1, 0.3] }",
            &["study.toml:3: bounds of alpha, which is not free; expected one of p"],
        ),
        ("alpha = 0.2", "eta = 20", &["study.toml:6:", "eta is not read; expected foundation = Viscoelastic"]),
        ("alpha = 0.2", "alpha = [0.2, 0.3]", &["study.toml:6: alpha has several values; expected one"]),
        (
            "data = \"run.csv\"",
            "data = \"run.csv\"\ncolumn = \"tilt\"",
            &["study.toml:9: run.csv: there is no column tilt; expected one of t [s], theta"],
        ),
        (
            "data = \"run.csv\"",
            "data = \"run.csv\"\ncolumn = \"v\"",
            &["study.toml:9: run.csv: column v [m] is in m; expected rad, or the factor"],
        ),
        ("data = \"run.csv\"", "data = \"none.csv\"", &["study.toml:9: none.csv:", "No such file"]),
        ("initial.theta = 0.15", "scale = 2.0", &["study.toml:11: scale = 2.0; expected a record"]),
    ];
    let folder = folder(STUDY);
    for (old, new, words) in cases {
        assert!(STUDY.contains(old));
        fs::write(folder.path().join("study.toml"), STUDY.replace(old, new)).unwrap();
        refused(folder.path(), &["fit", "study.toml"], words);
    }
}

/// Minus signs are those that other programs read, and the weakest combination has its changes in units.
#[test]
fn numbers_of_the_summary_can_be_read() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let summary = stdout(root, &["fit", "examples/fit/release.toml"]);
    assert!(summary.contains("test_2.zero          -0.00144") && !summary.contains('\u{2212}'), "{summary}");
    let weakest = "one standard deviation of the data is a joint change of width by +0.62 %, height by +0.32 % and test_1.delay by +0.002 s";
    assert!(summary.contains(weakest), "{summary}");
}

/// The example of docs/studies/fit.md: the planted values of examples/python/release_test.py lie within the intervals.
#[test]
fn the_example_finds_the_planted_block() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let json: Value = serde_json::from_str(&stdout(root, &["fit", "examples/fit/release.toml", "--json"])).unwrap();
    for (i, planted) in [0.288, 0.90, 0.97].into_iter().enumerate() {
        let interval = &json["estimates"][i]["interval"];
        assert!(
            interval[0].as_f64() < Some(planted) && Some(planted) < interval[1].as_f64(),
            "{}",
            json["estimates"][i]
        );
    }
}
