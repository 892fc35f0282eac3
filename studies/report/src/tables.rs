//! Results → CSV, in SI units and full precision.

use std::io;

use rocking_studies::assess::{Comparison, CurveResult, Plan, RateResult, Results, StateResult};
use rocking_studies::fragility::{Direction, split_heading};
use rocking_studies::output::csv::{lines, with_headings};
use rocking_studies::output::runner::Study;
use rocking_studies::output::table::{Table, TableColumn};

/// Makes the tables, with the names of their files.
pub fn tables(plan: &Plan, results: &Results) -> io::Result<Vec<(&'static str, String)>> {
    let mut tables = vec![("runs.csv", plan.sweep.header().text()? + &lines(&results.table.table)?)];
    if let Some(sizes) = &results.sizes {
        tables.push(("spectrum.csv", sizes.spectrum.header().text()? + &lines(&sizes.table)?));
    }
    if !results.report.directions.is_empty() {
        tables.push(("directions.csv", directions(results)?));
    }
    tables.extend([("states.csv", states(results)?), ("variants.csv", comparisons(results)?)]);
    Ok(tables)
}

/// Returns a table of these columns below the name of the study.
fn table<R>(results: &Results, name: &str, columns: &[TableColumn<R>], rows: &[R]) -> io::Result<String> {
    let head =
        format!("# rocking-block {} assess, {name}\n# study {}\n", env!("CARGO_PKG_VERSION"), results.report.study);
    Ok(head + &with_headings(&Table::of(columns, rows))?)
}

fn directions(results: &Results) -> io::Result<String> {
    type Row<'a> = &'a Direction;
    let columns = [
        TableColumn::real("azimuth", "deg", |direction: &Row| direction.azimuth),
        TableColumn::real("width", "deg", |direction: &Row| direction.width),
        TableColumn::count("runs", |direction: &Row| direction.known),
        TableColumn::real("exceeded", "1", |direction: &Row| direction.exceeded),
        TableColumn::count("unknown", |direction: &Row| direction.rows - direction.known),
        TableColumn::optional("median.tilt/alpha", "1", |direction: &Row| direction.median),
    ];
    let limit = &results.report.states[results.report.compared_state].limit;
    let rows: Vec<Row> = results.report.directions.iter().collect();
    table(results, &format!("directions for {limit}"), &columns, &rows)
}

fn states(results: &Results) -> io::Result<String> {
    type Row<'a> = &'a StateResult;
    let (name, unit) = split_heading(&results.report.im);
    let unit = unit.unwrap_or("1");
    let curve = |column: &str, unit: &str, value: fn(CurveResult) -> Option<f64>| {
        TableColumn::optional(column, unit, move |state: &Row| state.curve.and_then(value))
    };
    let median = |column: &str, value| curve(&format!("{column}.{name}"), unit, value);
    let rate = |column: &str, value: fn(RateResult) -> Option<f64>| {
        TableColumn::optional(column, "1/year", move |state: &Row| state.rate.and_then(value))
    };
    let columns = [
        TableColumn::text("state", |state: &Row| state.name.clone()),
        TableColumn::text("limit", |state: &Row| state.limit.to_string()),
        TableColumn::text("source", |state: &Row| state.source.clone().unwrap_or_default()),
        TableColumn::count("runs", |state: &Row| state.runs.known),
        TableColumn::count("exceeded", |state: &Row| state.runs.exceeded),
        TableColumn::count("unknown", |state: &Row| state.runs.left_out),
        median("median", |curve| Some(curve.median)),
        median("median.low", |curve| curve.median_interval[0]),
        median("median.high", |curve| curve.median_interval[1]),
        curve("beta", "1", |curve| Some(curve.beta)),
        curve("beta.low", "1", |curve| curve.beta_interval[0]),
        curve("beta.high", "1", |curve| curve.beta_interval[1]),
        rate("rate", |found| Some(found.rate)),
        rate("rate.low", |found| found.rate_interval[0]),
        rate("rate.high", |found| found.rate_interval[1]),
        rate("rate.if_no_unknown_exceeds", |found| found.rate_of_unknown.and_then(|[none, _]| none)),
        rate("rate.if_all_unknown_exceed", |found| found.rate_of_unknown.and_then(|[_, all]| all)),
    ];
    table(results, "states", &columns, &results.report.states.iter().collect::<Vec<_>>())
}

/// Variants, and both ends of each range of the sensitivity.
fn comparisons(results: &Results) -> io::Result<String> {
    /// A kind of comparison, the value of its quantity, and its results.
    type Row<'a> = (&'static str, Option<f64>, &'a Comparison);
    let report = &results.report;
    let (name, unit) = split_heading(&report.im);
    let columns = [
        TableColumn::text("kind", |(kind, ..): &Row| kind.to_string()),
        TableColumn::text("name", |(.., found): &Row| found.name.clone()),
        TableColumn::optional("value", "", |(_, value, _): &Row| *value).with_unit(None),
        TableColumn::real("alpha", "rad", |(.., found): &Row| found.alpha),
        TableColumn::optional("static_threshold", "m/s2", |(.., found): &Row| found.static_threshold),
        TableColumn::text("limit", |(.., found): &Row| found.limit.to_string()),
        TableColumn::count("runs", |(.., found): &Row| found.runs.known),
        TableColumn::count("exceeded", |(.., found): &Row| found.runs.exceeded),
        TableColumn::count("unknown", |(.., found): &Row| found.runs.left_out),
        TableColumn::optional(format!("median.{name}"), unit.unwrap_or("1"), |(.., found): &Row| {
            found.curve.map(|curve| curve.median)
        }),
        TableColumn::optional("beta", "1", |(.., found): &Row| found.curve.map(|curve| curve.beta)),
        TableColumn::optional("rate", "1/year", |(.., found): &Row| found.rate),
        TableColumn::optional("rate.if_no_unknown_exceeds", "1/year", |(.., found): &Row| {
            found.rate_of_unknown.and_then(|[none, _]| none)
        }),
        TableColumn::optional("rate.if_all_unknown_exceed", "1/year", |(.., found): &Row| {
            found.rate_of_unknown.and_then(|[_, all]| all)
        }),
        TableColumn::optional("peak.slip", "m", |(.., found): &Row| found.peak_slip),
        TableColumn::optional("peak.tension/weight", "1", |(.., found): &Row| found.peak_tension),
    ];
    let variants = report.variants.iter().map(|variant| ("variant", None, variant));
    let ends = report.sensitivity.iter().flat_map(|sensitivity| {
        let values = sensitivity.assumption.values.map(Some);
        values.into_iter().zip(&sensitivity.ends).map(|(value, end)| ("sensitivity", value, end))
    });
    let limit = &report.states[report.compared_state].limit;
    let rows: Vec<Row> = variants.chain(ends).collect();
    table(results, &format!("variants and sensitivity for {limit}"), &columns, &rows)
}
