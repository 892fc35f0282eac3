//! `rocking simulate --gradients`.

use std::path::Path;

use serde_json::Value;

use crate::program::{Table, refused, stdout};

/// A run under a sine of this period (s), as JSON.
fn run(folder: &Path, period: f64, more: &[&str]) -> Value {
    let period = period.to_string();
    let of = ["simulate", "--alpha", "0.25", "--p", "1", "--pulse", "one-sine", "--amplitude", "6.2622"];
    let shown = ["--tolerance", "1e-13", "--events", "--json", "--csv", "run.csv"];
    serde_json::from_str(&stdout(folder, &[&of[..], &["--period", &period, "--duration", "5"], &shown, more].concat()))
        .unwrap()
}

/// The summary of a run with a period nearby, and its column θ.
type Neighbour = (Value, Vec<f64>);

/// The derivatives of table, peaks and events are those of runs with other periods.
#[test]
fn derivatives_are_those_of_neighbouring_runs() {
    let folder = tempfile::tempdir().unwrap();
    let (period, h) = (1.2566, 1e-4);
    let found = run(folder.path(), period, &["--gradients", "eta,pulse.period"]);
    let table = Table::read(&folder.path().join("run.csv"));
    let gradient = &found["gradients"][1];
    assert_eq!((gradient["parameter"].as_str(), gradient["unit"].as_str()), (Some("pulse.period"), Some("s")));
    let sides = [h, -h].map(|h| {
        let run = run(folder.path(), period + h, &[]);
        (run, Table::read(&folder.path().join("run.csv")).column("theta"))
    });
    let same = |what: &str, ours: f64, of: &dyn Fn(&Neighbour) -> f64| {
        let expected = (of(&sides[0]) - of(&sides[1])) / (2.0 * h);
        assert!((ours - expected).abs() <= 1e-6 * expected.abs().max(0.1), "{what}: {ours}, {expected} by differences");
    };
    same("peak", gradient["peak"]["theta"].as_f64().unwrap(), &|run| run.0["peak"]["theta"].as_f64().unwrap());
    let times = gradient["event_times"].as_array().unwrap();
    assert_eq!(times.len(), found["events"]["list"].as_array().unwrap().len());
    for (i, ours) in times.iter().enumerate() {
        same("event", ours.as_f64().unwrap(), &|run| run.0["events"]["list"][i]["t"].as_f64().unwrap());
    }
    let derivative = table.column("d(theta)/d(pulse.period)");
    for row in [50, 200, 300, 480] {
        same("theta", derivative[row], &|run| run.1[row]);
    }
    assert!(table.headers.iter().any(|name| name == "d(theta)/d(pulse.period) [(rad)/(s)]"), "{:?}", table.headers);
    assert!(!table.headers.iter().any(|name| name.starts_with("d(energy.input)") || name.starts_with("d(regime)")));
}

/// Only parameters that the run reads have derivatives.
#[test]
fn other_parameters_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (options, name) in [
        ("--theta 0.1 --foundation rigid", "eta"),
        ("--theta 0.1", "pulse.period"),
        ("--theta 0.1", "scale"),
        ("--theta 0.1", "friction"),
        ("--theta 0.1", "K"),
        ("--theta 0.1", "nonsense"),
    ] {
        let arguments = format!("simulate {options} --csv run.csv --gradients alpha,{name}");
        let expected = format!("gradients: {name} is no real parameter of this run; expected one of alpha, p");
        refused(folder.path(), &arguments.split_whitespace().collect::<Vec<_>>(), &[&expected]);
    }
    refused(
        folder.path(),
        &["simulate", "--theta", "0.1", "--csv", "run.csv", "--gradients", "p,p"],
        &["p is given twice; expected it once"],
    );
}
