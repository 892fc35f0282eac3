//! Results → CSV, in SI units and full precision.

use rocking_studies::assess::{Comparison, Counts, Plan, Results};
use rocking_studies::fragility::split_heading;
use rocking_studies::output::csv::lines;
use rocking_studies::output::runner::Study;

/// Makes the tables, with the names of their files.
pub fn tables(plan: &Plan, results: &Results) -> Result<Vec<(&'static str, String)>, csv::Error> {
    let sizes = &results.sizes;
    Ok(vec![
        ("runs.csv", plan.sweep.header().text()? + &lines(&results.table.table)?),
        ("spectrum.csv", sizes.spectrum.header().text()? + &lines(&sizes.table)?),
        ("states.csv", states(results)?),
        ("variants.csv", comparisons(results)?),
    ])
}

fn text(value: Option<f64>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}

/// Begins a table with the name of the study and these columns.
fn table(results: &Results, name: &str, columns: &[String]) -> Result<csv::Writer<Vec<u8>>, csv::Error> {
    let head =
        format!("# rocking-block {} assess, {name}\n# study {}\n", env!("CARGO_PKG_VERSION"), results.report.study);
    let mut writer = csv::Writer::from_writer(head.into_bytes());
    writer.write_record(columns)?;
    Ok(writer)
}

/// The runs with a known outcome, those of them beyond the limit, and the runs without.
fn counts(runs: Counts) -> [String; 3] {
    [runs.known, runs.exceeded, runs.left_out].map(|count| count.to_string())
}

fn finished(writer: csv::Writer<Vec<u8>>) -> Result<String, csv::Error> {
    let bytes = writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

fn states(results: &Results) -> Result<String, csv::Error> {
    let (name, unit) = split_heading(&results.report.im);
    let unit = unit.unwrap_or("1");
    let im = |column: &str| format!("{column}.{name} [{unit}]");
    let mut columns =
        ["state", "limit", "source", "runs [1]", "exceeded [1]", "unknown [1]"].map(String::from).to_vec();
    columns.extend([im("median"), im("median.low"), im("median.high")]);
    columns.extend(["beta [1]", "beta.low [1]", "beta.high [1]"].map(String::from));
    columns.extend(["rate [1/year]", "rate.low [1/year]", "rate.high [1/year]"].map(String::from));
    let mut writer = table(results, "states", &columns)?;
    for state in &results.report.states {
        let mut row = vec![state.name.clone(), state.limit.clone(), state.source.clone().unwrap_or_default()];
        row.extend(counts(state.runs));
        let curve = state.curve;
        row.push(text(curve.map(|curve| curve.median)));
        row.extend(curve.map_or([None; 2], |curve| curve.median_interval).map(text));
        row.push(text(curve.map(|curve| curve.beta)));
        row.extend(curve.map_or([None; 2], |curve| curve.beta_interval).map(text));
        row.push(text(state.rate.map(|rate| rate.rate)));
        row.extend(state.rate.map_or([None; 2], |rate| rate.rate_interval).map(text));
        writer.write_record(row)?;
    }
    finished(writer)
}

/// Variants, blocks with friction, and both ends of each range of the sensitivity.
fn comparisons(results: &Results) -> Result<String, csv::Error> {
    let report = &results.report;
    let (name, unit) = split_heading(&report.im);
    let unit = unit.unwrap_or("1");
    let mut columns = ["kind", "name", "value", "alpha [rad]", "static_threshold [m/s2]"].map(String::from).to_vec();
    columns.extend(["limit", "runs [1]", "exceeded [1]", "unknown [1]"].map(String::from));
    columns.push(format!("median.{name} [{unit}]"));
    columns.extend(["beta [1]", "rate [1/year]", "peak.slip [m]", "peak.tension/weight [1]"].map(String::from));
    let limit = &report.states[report.compared_state].limit;
    let mut writer = table(results, &format!("variants and sensitivity for {limit}"), &columns)?;
    let mut write = |kind: &str, value: Option<f64>, comparison: &Comparison| {
        let mut row = vec![kind.to_string(), comparison.name.clone(), text(value), comparison.alpha.to_string()];
        row.push(text(comparison.static_threshold));
        row.push(comparison.limit.clone());
        row.extend(counts(comparison.runs));
        row.extend(
            [comparison.curve.map(|curve| curve.median), comparison.curve.map(|curve| curve.beta), comparison.rate]
                .map(text),
        );
        row.extend([comparison.peak_slip, comparison.peak_tension].map(text));
        writer.write_record(row)
    };
    for variant in &report.variants {
        write("variant", None, variant)?;
    }
    for sensitivity in &report.sensitivity {
        for (value, end) in sensitivity.assumption.values.into_iter().zip(&sensitivity.ends) {
            write("sensitivity", Some(value), end)?;
        }
    }
    finished(writer)
}
