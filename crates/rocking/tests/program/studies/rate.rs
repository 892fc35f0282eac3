//! Annual rates: the numbers of text, JSON, table and picture, and refusals.

use std::fs;

use serde_json::Value;

use crate::program::{Table, refused, rocking, stdout, text};
use crate::studies::labels;

const HAZARD: &str = "PGV [cm/s],rate [1/year]\n5,2e-2\n10,5e-3\n20,1e-3\n50,9e-5\n100,1.2e-5\n200,9e-7\n";

/// Three levels of four rows; more rows exceed the limit at each greater level.
const TABLE: &str = "row,record,PGV [m/s],p PGV/(g tan alpha) [1],outcome,peak.theta/alpha [1]\n0,a,0.2,0.3,completed,0.2\n\
    1,b,0.2,0.3,completed,0.2\n2,c,0.2,0.3,completed,0.2\n3,d,0.2,0.3,completed,0.2\n4,a,0.4,0.6,completed,0.3\n\
    5,b,0.4,0.6,overturned,6\n6,c,0.4,0.6,completed,0.3\n7,d,0.4,0.6,completed,0.3\n8,a,0.8,1.2,overturned,6\n\
    9,b,0.8,1.2,overturned,6\n10,c,0.8,1.2,completed,0.4\n11,d,0.8,1.2,overturned,6\n";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("hazard.csv"), HAZARD).unwrap();
    fs::write(folder.path().join("table.csv"), TABLE).unwrap();
    folder
}

#[track_caller]
fn json(arguments: &[&str]) -> Value {
    let folder = folder();
    let output = rocking(folder.path(), &[&["rate", "hazard.csv"], arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[track_caller]
fn near(value: &Value, exact: f64) {
    let value = value.as_f64().unwrap();
    assert!((value / exact - 1.0).abs() < 1e-12, "{value}, exactly {exact}");
}

#[test]
fn a_step_has_the_rate_of_the_hazard_and_its_probability_in_some_years() {
    let found = json(&["--median", "20", "--beta", "0", "--im", "PGV [cm/s]", "--years", "10,475"]);
    near(&found["rate"], 1e-3);
    near(&found["return_period"], 1000.0);
    near(&found["probabilities"][1]["probability"], 1.0 - (-0.475_f64).exp());
    assert_eq!(found["hazard"]["im"], "PGV [m/s]");
}

#[test]
fn text_table_and_picture_have_the_rate_of_the_json() {
    let folder = folder();
    let arguments =
        ["rate", "hazard.csv", "--table", "table.csv", "--im", "PGV", "--csv", "parts.csv", "--plot", "rate.svg"];
    let output = rocking(folder.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let found = json(&arguments[2..]);
    let rate = found["rate"].as_f64().unwrap();
    let table = Table::read(&folder.path().join("parts.csv"));
    let sum: f64 = table.column("rate").iter().sum();
    assert!((sum / rate - 1.0).abs() < 1e-12, "{sum} {rate}");
    assert_eq!((table.get(0, "from"), table.get(6, "to")), ("0.0", ""));
    let printed = text(&output.stdout);
    assert!(printed.contains(&format!("rate          {rate:.2e} per year (95 % interval ")), "{printed}");
    let above = 100.0 * found["extrapolated"]["above_rows"].as_f64().unwrap();
    let warned = text(&output.stderr);
    assert!(
        warned.contains(&format!("{above:.1} % of the rate")) && warned.contains("above 0.8000, the greatest value"),
        "{warned}"
    );
    assert_eq!(found["warnings"].as_array().unwrap().len(), warned.lines().count());
    let drawn = labels(&fs::read_to_string(folder.path().join("rate.svg")).unwrap());
    assert!(drawn.iter().any(|label| label.contains("PGV (m/s)")), "{drawn:?}");
}

/// The fractions 0, 1/4 and 3/4 at 0.2, 0.4 and 0.8 m/s, summed by Simpson's rule over the hazard.
#[test]
fn a_table_gives_its_own_probabilities() {
    let found = json(&["--table", "table.csv", "--im", "PGV", "--empirical"]);
    let levels = [(0.05, 2e-2), (0.1, 5e-3), (0.2, 1e-3), (0.5, 9e-5), (1.0, 1.2e-5), (2.0, 9e-7)]
        .map(|(m, h): (f64, f64)| (m.ln(), h.ln()));
    let hazard = |x: f64| {
        let i = levels[1..5].iter().filter(|level| level.0 <= x).count();
        let ((x0, y0), (x1, y1)) = (levels[i], levels[i + 1]);
        ((y0 + (x - x0) * (y1 - y0) / (x1 - x0)).exp(), (y0 - y1) / (x1 - x0))
    };
    let probability = |x: f64| {
        let part = (x - 0.2_f64.ln()) / 2.0_f64.ln();
        if part < 1.0 { 0.25 * part } else { (0.25 + 0.5 * (part - 1.0)).min(0.75) }
    };
    let ends = [0.2_f64, 0.4, 0.5, 0.8].map(f64::ln);
    let mut sum = 0.75 * hazard(0.8_f64.ln()).0;
    for pair in ends.windows(2) {
        let h = (pair[1] - pair[0]) / 200.0;
        let density = |i: u32| {
            // Just inside of the piece, where the slopes are its own.
            let x = (pair[0] + h * f64::from(i)).clamp(pair[0] + 1e-13, pair[1] - 1e-13);
            let (rate, slope) = hazard(x);
            probability(x) * slope * rate
        };
        let weight = |i: u32| {
            if i == 0 || i == 200 {
                1.0
            } else if i % 2 == 1 {
                4.0
            } else {
                2.0
            }
        };
        sum += h / 3.0 * (0..=200).map(|i| weight(i) * density(i)).sum::<f64>();
    }
    let rate = found["rate"].as_f64().unwrap();
    assert!((rate / sum - 1.0).abs() < 1e-9, "{rate} {sum}");
    assert_eq!(found["fragility"]["levels"], 3);
}

#[test]
fn measures_relative_to_a_block_scale_the_hazard() {
    let relative = ["--table", "table.csv", "--im", "p PGV/(g tan alpha)", "--alpha", "0.15", "--p"];
    // The columns of the table differ by the factor p/(g tan alpha) = 1.5.
    let p = (1.5 * 9.81 * 0.15_f64.tan()).to_string();
    let found = json(&[&relative[..], &[&p]].concat());
    let base = json(&["--table", "table.csv", "--im", "PGV"]);
    let (found, base) = (found["rate"].as_f64().unwrap(), base["rate"].as_f64().unwrap());
    assert!((found / base - 1.0).abs() < 1e-9, "{found} {base}");
}

#[test]
fn incomplete_or_contradictory_options_are_refused() {
    let folder = folder();
    let refused = |arguments: &[&str], words: &[&str]| {
        refused(folder.path(), &[&["rate", "hazard.csv"], arguments].concat(), words);
    };
    refused(&[], &["no fragility curve", "--table and --im, or --median and --beta"]);
    refused(&["--table", "table.csv"], &["--table without --im"]);
    refused(
        &["--median", "1", "--beta", "0.3", "--im", "PGA [g]"],
        &["hazard.csv", "a hazard curve of PGV", "expected one of PGA"],
    );
    refused(&["--median", "1", "--beta", "0.3", "--im", "PGV [g]"], &["--im PGV in g", "m/s"]);
    refused(&["--median", "1", "--beta", "-1"], &["the dispersion -1"]);
    refused(&["--median", "1", "--beta", "0.3", "--link", "logit"], &["--link has no effect without --table"]);
    refused(&["--median", "1", "--beta", "0.3", "--years", "0"], &["--years = 0"]);
    refused(&["--median", "1", "--beta", "0.3", "--alpha", "0.1"], &["--alpha has no effect"]);
    refused(&["--table", "table.csv", "--im", "p PGV/(g tan alpha)", "--p", "2"], &["no --alpha", "of the block"]);
    refused(
        &["--table", "table.csv", "--im", "PGV", "--empirical", "--ci", "0.9"],
        &["--ci has no effect with --empirical"],
    );
    let printed = stdout(folder.path(), &["rate", "hazard.csv", "--median", "1", "--beta", "0.3"]);
    assert!(printed.starts_with("hazard        hazard.csv: PGV [m/s], 6 levels from 0.0500 to 2.0000"), "{printed}");
}
