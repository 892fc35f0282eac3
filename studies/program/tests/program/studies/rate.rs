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
    assert_eq!((table.get(0, "from"), table.get(6, "to")), ("0", ""));
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

/// A table in cm/s has the rate and the export of the same table in m/s; without a unit in its heading it is refused.
#[test]
fn the_unit_of_a_heading_reaches_rates_and_exports() {
    let folder = folder();
    let in_cm = TABLE
        .replace("PGV [m/s]", "PGV [cm/s]")
        .replace(",0.2,", ",20,")
        .replace(",0.4,", ",40,")
        .replace(",0.8,", ",80,");
    let in_cm = in_cm.replace("PGV [cm/s],p PGV/(g tan alpha) [1]", "PGV [cm/s],twin [1]");
    fs::write(folder.path().join("cm.csv"), in_cm).unwrap();
    fs::write(folder.path().join("none.csv"), TABLE.replace("PGV [m/s]", "PGV")).unwrap();
    let rate = |table: &str| {
        let arguments = ["rate", "hazard.csv", "--table", table, "--im", "PGV", "--json"];
        let found: Value = serde_json::from_str(&stdout(folder.path(), &arguments)).unwrap();
        found["rate"].as_f64().unwrap()
    };
    assert!((rate("cm.csv") / rate("table.csv") - 1.0).abs() < 1e-9);
    let exported = |table: &str, program: &str, file: &str| {
        let arguments = ["fragility", table, "--im", "PGV", "--export", program, "--export-to", "to"];
        stdout(folder.path(), &arguments);
        let text = fs::read_to_string(folder.path().join(file)).unwrap();
        let number = text.split_once(if program == "pelicun" { "lognormal," } else { "mean=\"" }).unwrap().1;
        let number: f64 = number.split([',', '"']).next().unwrap().parse().unwrap();
        fs::remove_dir_all(folder.path().join("to")).or_else(|_| fs::remove_file(folder.path().join("to"))).unwrap();
        number
    };
    for (program, file) in [("pelicun", "to/fragility.csv"), ("openquake", "to")] {
        let [cm, m] = ["cm.csv", "table.csv"].map(|table| exported(table, program, file));
        assert!((cm / m - 1.0).abs() < 1e-9, "{program}: {cm} {m}");
    }
    let of_none = ["PGV without a unit", "such as PGV [m/s]"];
    refused(folder.path(), &["rate", "hazard.csv", "--table", "none.csv", "--im", "PGV"], &of_none);
    let export = ["fragility", "none.csv", "--im", "PGV", "--export", "pelicun", "--export-to", "to"];
    refused(folder.path(), &export, &of_none);
}

/// A median of 0.4 g beside a hazard in g is that of 0.4 × 9.81 m/s², and the summary has the unit.
#[test]
fn a_median_in_g_is_one() {
    let folder = folder();
    fs::write(folder.path().join("pga.csv"), "PGA [g],rate [1/year]\n0.1,1e-2\n0.4,2e-4\n1.6,2e-6\n").unwrap();
    let arguments = ["rate", "pga.csv", "--median", "0.4", "--beta", "0", "--im", "PGA [g]"];
    let printed = stdout(folder.path(), &arguments);
    assert!(printed.contains("2.00e-4 per year") && printed.contains("over PGA [m/s2], median 3.924"), "{printed}");
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
    refused(&["--median", "1", "--beta", "0.3", "--im", "PGV [g]"], &["--im", "PGV in g", "m/s"]);
    refused(&["--median", "1", "--beta", "0.3", "--im", "PGV"], &["PGV without a unit", "PGV [m/s]"]);
    refused(&["--median", "1", "--beta", "0.3"], &["--median without --im", "the unit of the median"]);
    refused(&["--median", "1", "--beta", "-1", "--im", "PGV [m/s]"], &["the dispersion -1"]);
    refused(&["--median", "1", "--beta", "0.3", "--link", "logit"], &["--link has no effect without --table"]);
    refused(&["--median", "1", "--beta", "0.3", "--years", "0"], &["--years = 0"]);
    refused(&["--median", "1", "--beta", "0.3", "--im", "PGV [m/s]", "--alpha", "0.1"], &["--alpha has no effect"]);
    refused(&["--table", "table.csv", "--im", "p PGV/(g tan alpha)", "--p", "2"], &["no --alpha", "of the block"]);
    refused(
        &["--table", "table.csv", "--im", "PGV", "--empirical", "--ci", "0.9"],
        &["--ci has no effect with --empirical"],
    );
    let printed = stdout(folder.path(), &["rate", "hazard.csv", "--median", "1", "--beta", "0.3", "--im", "PGV [m/s]"]);
    assert!(printed.starts_with("hazard        hazard.csv: PGV [m/s], 6 levels from 0.0500 to 2.0000"), "{printed}");
}

/// Rows without a known outcome are left out; beside that rate stand those of the tables in which none of them exceeds the limit, and all.
#[test]
fn rows_without_an_outcome_give_a_range() {
    let folder = folder();
    let rate = |outcome: &str, more: &[&str]| -> Value {
        let row = "6,c,0.4,0.6,completed";
        assert!(TABLE.contains(row));
        let table = TABLE.replace(row, &format!("6,c,0.4,0.6,{outcome}"));
        fs::write(folder.path().join("table.csv"), table).unwrap();
        let arguments = [&["rate", "hazard.csv", "--table", "table.csv", "--im", "PGV", "--json"], more].concat();
        serde_json::from_str(&stdout(folder.path(), &arguments)).unwrap()
    };
    for more in [&[][..], &["--empirical"]] {
        let [none, all] = ["completed", "overturned"].map(|outcome| rate(outcome, more));
        assert!(none["rate_of_unknown"].is_null());
        let found = rate("undecided", more);
        assert_eq!(found["rate_of_unknown"], Value::from(vec![none["rate"].clone(), all["rate"].clone()]), "{more:?}");
    }
    let text = stdout(folder.path(), &["rate", "hazard.csv", "--table", "table.csv", "--im", "PGV"]);
    assert!(
        text.contains("unknown       1 rows have no known outcome: ") && text.contains(" per year if all do"),
        "{text}"
    );
}

#[test]
fn options_of_a_table_have_no_effect_on_a_median() {
    let folder = folder();
    let median = ["rate", "hazard.csv", "--median", "0.5", "--beta", "0.4", "--im", "PGV [m/s]"];
    for option in [&["--limit", "0.5"][..], &["--partial"], &["--cluster", "record"]] {
        refused(folder.path(), &[&median, option].concat(), &[option[0], "without --table"]);
    }
}
