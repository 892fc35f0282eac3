//! Fragility curves → their summary.

use std::collections::BTreeMap;

use crate::commands::fragility::{MeasureCurve, TableCases};
use crate::options::fit::FitOptions;
use crate::output::summary::{Object, Summary, aligned};
use rocking_charts::numerals;
use rocking_studies::fragility::{Assessment, Interval, Limit, RowCounts, Surface};
use rocking_studies::spec::words::Words;

/// Warns of rows and samples left out although they may exceed the limit.
pub fn warning_of_left_out(counts: &RowCounts) -> Option<String> {
    let RowCounts { all, exceeded, exceeded_at_most, undecided, partly_known, without_response, .. } = *counts;
    let [least, most] = [exceeded, exceeded_at_most].map(|count| 100.0 * count / all as f64);
    let rows =
        (undecided > 0).then(|| format!("{undecided} undecided rows may exceed the limit and are left out of curves"));
    let samples = (partly_known > 0).then(|| {
        format!("in {partly_known} rows, samples without a known outcome may exceed the limit and are left out of its probability")
    });
    let missing = (without_response > 0)
        .then(|| format!("{without_response} rows without the response of the limit are left out of curves"));
    let doubts: Vec<String> = rows.into_iter().chain(samples).chain(missing).collect();
    (!doubts.is_empty())
        .then(|| format!("{}: it is exceeded in {least:.1} % to {most:.1} % of all rows", doubts.join("; ")))
}

/// Writes a number with its interval. An end without a bound is a question mark.
pub fn with_interval(value: f64, ends: Interval) -> String {
    let fixed = |value: f64, decimals: usize| format!("{value:.decimals$}");
    let ends = match ends {
        [Some(low), Some(high)] => numerals::ends([low, high], 4, fixed),
        ends => ends.map(|end| end.map_or("?".into(), |end| fixed(end, 4))),
    };
    format!("{} ({})", fixed(value, 4), ends.join(" to "))
}

/// The curve of a measure.
pub struct MeasureReport {
    json: Object,
    /// Fields of the printed table.
    fields: Vec<String>,
    /// Columns beside the measure whose sufficiency is tested.
    beside: Vec<String>,
    /// Number of bootstrap samples without a curve.
    without_curve: Option<usize>,
}

impl MeasureReport {
    /// Reports the curve of the measure with this heading.
    ///
    /// `sufficiency` has the p-value of the hypothesis that the measure is sufficient, by the other column.
    pub fn of(heading: &str, found: &Assessment, sufficiency: &BTreeMap<String, f64>) -> MeasureReport {
        let Assessment { rows, fit, auc, brier, efficiency, rocking, .. } = found;
        let (median, beta, goodness) = (fit.median(), fit.dispersion(), found.goodness());
        let [of_median, of_beta] = [found.median, found.dispersion];
        let json = Object::default()
            .with("im", heading)
            .with("rows", rows)
            .with("median", median)
            .with("median_interval", of_median)
            .with("beta", beta)
            .with("beta_interval", of_beta)
            // Coefficients of the natural logarithm of the measure.
            .with("intercept", fit.coefficients[0])
            .with("slope", fit.coefficients[1])
            .with("standard_errors", found.standard_errors())
            .with("log_likelihood", fit.log_likelihood)
            .with("null_log_likelihood", fit.null_log_likelihood)
            .with("AUC", auc)
            .with("Brier", brier)
            // Whether the curve fits groups of rows; null for fewer than three groups.
            .with("goodness_of_fit", goodness)
            .with("efficiency", efficiency)
            // Number of blocks behind the efficiency: those that lifted off and stand.
            .with("rocking", rocking)
            .with("sufficiency", sufficiency)
            .with_some("without_curve", found.without_curve());
        let mut fields = vec![
            heading.into(),
            with_interval(median, of_median),
            with_interval(beta, of_beta),
            format!("{auc:.3}"),
            format!("{brier:.4}"),
            goodness.map_or("none".into(), |fit| format!("{:.3}", fit.p)),
            efficiency.map_or("none".into(), |efficiency| format!("{efficiency:.3}")),
            rocking.to_string(),
            rows.to_string(),
        ];
        fields.extend(sufficiency.values().map(|p| format!("{p:.2e}")));
        let beside = sufficiency.keys().cloned().collect();
        MeasureReport { json, fields, beside, without_curve: found.without_curve() }
    }
}

/// The surface of two measures, in numbers and in words.
pub struct SurfaceReport {
    json: Object,
    text: String,
}

impl SurfaceReport {
    /// Reports the surface of the measures with these headings.
    pub fn of(headings: [&str; 2], found: &Surface) -> SurfaceReport {
        let Surface { rows, fit, standard_errors, auc, brier, .. } = found;
        let coefficients = &fit.coefficients;
        let json = Object::default()
            .with("im", headings)
            .with("rows", rows)
            .with("intercept", coefficients[0])
            // Of the natural logarithms of the measures.
            .with("slopes", [coefficients[1], coefficients[2]])
            .with("standard_errors", standard_errors)
            .with("log_likelihood", fit.log_likelihood)
            .with("AUC", auc)
            .with("Brier", brier);
        let [a, b, c] = [0, 1, 2].map(|i| format!("{:.4} ± {:.4}", coefficients[i], standard_errors[i]));
        let [one, other] = headings;
        let text = format!("of {rows} rows: ({a}) + ({b}) ln {one} + ({c}) ln {other}; AUC {auc:.3}, Brier {brier:.4}");
        SurfaceReport { json, text }
    }
}

/// Begins the summary of a table with its rows, and those that exceed a limit.
pub fn summary_of_rows(name: &str, is_in_space: bool, limit: Limit, counts: &RowCounts) -> Summary {
    let RowCounts {
        all,
        decided,
        exceeded,
        exceeded_at_most,
        partly_known,
        failed,
        separated,
        undecided,
        without_response,
    } = *counts;
    let left_out = [
        (failed, "failed"),
        (separated, "ended at separation"),
        (undecided, "undecided"),
        (without_response, "without the response of the limit"),
        (partly_known, "with samples of unknown outcome"),
    ];
    let left_out = left_out.iter().filter(|(count, _)| *count > 0);
    let left_out: String = left_out.map(|(count, why)| format!(", {count} {why}")).collect();
    // A sum of probabilities has too many digits.
    let [exceeded, at_most] = [exceeded, exceeded_at_most].map(|count| (count * 10.0).round() / 10.0);
    let range = if decided < all || partly_known > 0 {
        format!(", in {exceeded} to {at_most} of all {all}")
    } else {
        String::new()
    };
    let mut summary = Summary::default();
    summary.item("table", name, "table", format!("{name}: {all} rows{left_out}"));
    if is_in_space {
        summary.item("model", "block in space", "model", "block in space");
    }
    let limit = limit.to_string();
    summary.item("limit", &limit, "limit", format!("{limit}: exceeded in {exceeded} of {decided} rows{range}"));
    summary.entry("rows", counts);
    summary
}

/// Adds the curves of measures with the method of their intervals.
pub fn add_curves(summary: &mut Summary, fit: &FitOptions, intervals: &str, measures: &[&MeasureReport]) {
    let [first, ..] = measures else { return };
    let text = format!("{}, intervals of {} %: {intervals}", fit.link, 100.0 * fit.rows.ci);
    summary.item("link", fit.link.word(), "curve", text);
    summary.entry("confidence", fit.rows.ci);
    summary.entry("intervals", intervals);
    let head = ["measure", "median", "beta", "AUC", "Brier", "p of fit", "efficiency", "rocking", "rows"];
    let beside = first.beside.iter().map(|other| format!("p beside {other}"));
    let mut lines = vec![head.map(String::from).into_iter().chain(beside).collect()];
    lines.extend(measures.iter().map(|measure| measure.fields.clone()));
    summary.text += &aligned(&lines, 0..0);
    summary.entry("measures", measures.iter().map(|measure| &measure.json).collect::<Vec<_>>());
}

/// Adds a line on the samples of the bootstrap without a curve, if there are any.
pub fn add_without_curve(summary: &mut Summary, measures: &[&MeasureReport]) {
    let without: usize = measures.iter().filter_map(|measure| measure.without_curve).sum();
    if without > 0 {
        let text = format!("{without} samples have no curve: their data are separable or of one class");
        summary.line("bootstrap", text);
    }
}

/// Summarizes the curves of a table, in SI units.
pub(super) fn summary(table: &TableCases, fit: &FitOptions, curves: &[MeasureCurve]) -> Summary {
    let mut summary = summary_of_rows(&table.name, table.is_in_space, table.limit, &table.counts);
    // A polar chart needs no measure.
    let [first, ..] = curves else { return summary };
    let measures: Vec<&MeasureReport> = curves.iter().map(|curve| &curve.report).collect();
    add_curves(&mut summary, fit, &first.intervals, &measures);
    for SurfaceReport { json, text } in curves.iter().filter_map(|curve| curve.surface.as_ref()) {
        summary.item("surface", json, "surface", text);
    }
    add_without_curve(&mut summary, &measures);
    summary
}
