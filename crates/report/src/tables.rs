//! Results → CSV, in SI units and full precision.

use rocking_studies::assess::{Comparison, Found};

/// Makes the tables, with the names of their files.
pub fn tables(found: &Found) -> Result<Vec<(&'static str, String)>, csv::Error> {
    Ok(vec![
        ("runs.csv", found.runs.clone()),
        ("spectrum.csv", found.sizes.table.clone()),
        ("states.csv", states(found)?),
        ("variants.csv", comparisons(found)?),
    ])
}

fn text(value: Option<f64>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}

/// Begins a table with the name of the study and these columns.
fn table(found: &Found, name: &str, columns: &[String]) -> Result<csv::Writer<Vec<u8>>, csv::Error> {
    let head =
        format!("# rocking-block {} assess, {name}\n# study {}\n", env!("CARGO_PKG_VERSION"), found.report.study);
    let mut writer = csv::Writer::from_writer(head.into_bytes());
    writer.write_record(columns)?;
    Ok(writer)
}

fn finished(writer: csv::Writer<Vec<u8>>) -> Result<String, csv::Error> {
    let bytes = writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

fn states(found: &Found) -> Result<String, csv::Error> {
    let (name, unit) = found.report.im.split_once(" [").unwrap_or((&found.report.im, "1]"));
    let im = |column: &str| format!("{column}.{name} [{unit}");
    let mut columns = ["state", "limit", "source", "runs [1]", "exceeded [1]"].map(String::from).to_vec();
    columns.extend([im("median"), im("median.low"), im("median.high")]);
    columns.extend(["beta [1]", "beta.low [1]", "beta.high [1]"].map(String::from));
    columns.extend(["rate [1/year]", "rate.low [1/year]", "rate.high [1/year]"].map(String::from));
    let mut writer = table(found, "states", &columns)?;
    for state in &found.report.states {
        let mut row = vec![state.name.clone(), state.limit.clone(), state.source.clone().unwrap_or_default()];
        row.extend([state.runs.known, state.runs.exceeded].map(|count| count.to_string()));
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
fn comparisons(found: &Found) -> Result<String, csv::Error> {
    let report = &found.report;
    let (name, unit) = report.im.split_once(" [").unwrap_or((&report.im, "1]"));
    let columns = ["kind", "name", "value", "alpha [rad]", "static_threshold [m/s2]", "runs [1]", "exceeded [1]"];
    let mut columns: Vec<String> = columns.map(String::from).to_vec();
    columns.push(format!("median.{name} [{unit}"));
    columns.extend(["beta [1]", "rate [1/year]", "peak.slip [m]", "peak.tension/weight [1]"].map(String::from));
    let limit = &report.states[report.compared_state].limit;
    let mut writer = table(found, &format!("variants and sensitivity for {limit}"), &columns)?;
    let mut write = |kind: &str, value: Option<f64>, of: &Comparison| {
        let mut row = vec![kind.to_string(), of.name.clone(), text(value), of.alpha.to_string()];
        row.push(text(of.static_threshold));
        row.extend([of.runs.known, of.runs.exceeded].map(|count| count.to_string()));
        row.extend([of.curve.map(|curve| curve.median), of.curve.map(|curve| curve.beta), of.rate].map(text));
        row.extend([of.peak_slip, of.peak_tension].map(text));
        writer.write_record(row)
    };
    for variant in &report.variants {
        write("variant", None, variant)?;
    }
    for sensitivity in &report.sensitivity {
        for (value, end) in sensitivity.values.into_iter().zip(&sensitivity.ends) {
            write("sensitivity", Some(value), end)?;
        }
    }
    finished(writer)
}
