//! Fragility curves → a report, as text or JSON.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Serialize;

use crate::output::summary::aligned;
use rocking_studies::fragility::{Assessment, Goodness, Interval, RowCounts, Surface};

/// Report of all curves, in SI units.
#[derive(Serialize)]
pub struct FragilityReport {
    pub table: String,
    pub limit: String,
    pub link: String,
    pub confidence: f64,
    /// Method of the intervals.
    pub intervals: String,
    pub rows: RowCounts,
    pub measures: Vec<MeasureReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface: Option<SurfaceReport>,
}

/// Warns of rows and samples that a curve leaves out although they may exceed the limit.
pub fn warning_of_left_out(counts: &RowCounts) -> Option<String> {
    let RowCounts { all, exceeded, exceeded_at_most, undecided, partly_known, .. } = *counts;
    let [least, most] = [exceeded, exceeded_at_most].map(|count| 100.0 * count / all as f64);
    let rows =
        (undecided > 0).then(|| format!("{undecided} undecided rows may exceed the limit and are left out of curves"));
    let samples = (partly_known > 0).then(|| {
        format!("in {partly_known} rows, samples without a known outcome may exceed the limit and are left out of its probability")
    });
    let doubts: Vec<String> = rows.into_iter().chain(samples).collect();
    (!doubts.is_empty())
        .then(|| format!("{}: it is exceeded in {least:.1} % to {most:.1} % of all rows", doubts.join("; ")))
}

/// Curve of a measure.
#[derive(Serialize)]
pub struct MeasureReport {
    im: String,
    rows: usize,
    median: f64,
    median_interval: [Option<f64>; 2],
    beta: f64,
    beta_interval: [Option<f64>; 2],
    /// Coefficients of the natural logarithm of the measure.
    intercept: f64,
    slope: f64,
    standard_errors: Vec<f64>,
    log_likelihood: f64,
    null_log_likelihood: f64,
    #[serde(rename = "AUC")]
    auc: f64,
    #[serde(rename = "Brier")]
    brier: f64,
    /// Whether the curve fits groups of rows; missing for fewer than three groups.
    goodness_of_fit: Option<Goodness>,
    efficiency: Option<f64>,
    /// Number of blocks behind the efficiency: those that lifted off and stand.
    rocking: usize,
    /// p-value of the hypothesis that the measure is sufficient, by the other column.
    sufficiency: BTreeMap<String, f64>,
    /// Number of bootstrap samples without a curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    without_curve: Option<usize>,
}

impl MeasureReport {
    /// Reports the curve of the measure with this heading.
    pub fn of(heading: &str, found: &Assessment, sufficiency: BTreeMap<String, f64>) -> MeasureReport {
        let Assessment { rows, fit, median, dispersion, auc, brier, efficiency, rocking, .. } = found;
        let ends = |Interval { low, high }: &Interval| [*low, *high];
        MeasureReport {
            im: heading.into(),
            rows: *rows,
            median: fit.median(),
            median_interval: ends(median),
            beta: fit.dispersion(),
            beta_interval: ends(dispersion),
            intercept: fit.coefficients[0],
            slope: fit.coefficients[1],
            standard_errors: found.standard_errors.clone(),
            log_likelihood: fit.log_likelihood,
            null_log_likelihood: fit.null_log_likelihood,
            auc: *auc,
            brier: *brier,
            goodness_of_fit: found.goodness,
            efficiency: *efficiency,
            rocking: *rocking,
            sufficiency,
            without_curve: found.without_curve(),
        }
    }

    /// Returns the fields of the measure in the printed table.
    fn fields(&self) -> Vec<String> {
        let end = |end: Option<f64>| end.map_or("?".into(), |end| format!("{end:.4}"));
        let with = |value: f64, [low, high]: [Option<f64>; 2]| format!("{value:.4} ({} to {})", end(low), end(high));
        let mut fields = vec![
            self.im.clone(),
            with(self.median, self.median_interval),
            with(self.beta, self.beta_interval),
            format!("{:.3}", self.auc),
            format!("{:.4}", self.brier),
            self.goodness_of_fit.map_or("none".into(), |fit| format!("{:.3}", fit.p)),
            self.efficiency.map_or("none".into(), |efficiency| format!("{efficiency:.3}")),
            self.rocking.to_string(),
            self.rows.to_string(),
        ];
        fields.extend(self.sufficiency.values().map(|p| format!("{p:.2e}")));
        fields
    }
}

/// Surface of two measures.
#[derive(Serialize)]
pub struct SurfaceReport {
    im: [String; 2],
    rows: usize,
    intercept: f64,
    /// Coefficients of the natural logarithms of the measures.
    slopes: [f64; 2],
    standard_errors: Vec<f64>,
    log_likelihood: f64,
    #[serde(rename = "AUC")]
    auc: f64,
    #[serde(rename = "Brier")]
    brier: f64,
}

impl SurfaceReport {
    /// Reports the surface of the measures with these headings.
    pub fn of(headings: [&str; 2], found: &Surface) -> SurfaceReport {
        let Surface { rows, fit, standard_errors, auc, brier, .. } = found;
        SurfaceReport {
            im: headings.map(String::from),
            rows: *rows,
            intercept: fit.coefficients[0],
            slopes: [fit.coefficients[1], fit.coefficients[2]],
            standard_errors: standard_errors.clone(),
            log_likelihood: fit.log_likelihood,
            auc: *auc,
            brier: *brier,
        }
    }

    fn text(&self) -> String {
        let SurfaceReport { im: [one, other], rows, intercept, slopes: [b, c], standard_errors, auc, brier, .. } = self;
        let [a, b, c] =
            [(intercept, 0), (b, 1), (c, 2)].map(|(value, i)| format!("{value:.4} ± {:.4}", standard_errors[i]));
        format!(
            "surface       of {rows} rows: ({a}) + ({b}) ln {one} + ({c}) ln {other}; AUC {auc:.3}, Brier {brier:.4}\n"
        )
    }
}

impl FragilityReport {
    /// Writes the report as text.
    pub fn text(&self) -> String {
        let RowCounts { all, decided, exceeded, exceeded_at_most, partly_known, failed, separated, undecided } =
            self.rows;
        let left_out = [
            (failed, "failed"),
            (separated, "ended at separation"),
            (undecided, "undecided"),
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
        let mut text = format!(
            "table         {}: {all} rows{left_out}\n\
             limit         {}: exceeded in {exceeded} of {decided} rows{range}\n\
             curve         {}, intervals of {} %: {}\n",
            self.table,
            self.limit,
            self.link,
            100.0 * self.confidence,
            self.intervals
        );
        let mut rows = vec![
            ["measure", "median", "beta", "AUC", "Brier", "p of fit", "efficiency", "rocking", "rows"]
                .map(String::from)
                .to_vec(),
        ];
        rows[0].extend(self.measures[0].sufficiency.keys().map(|other| format!("p beside {other}")));
        rows.extend(self.measures.iter().map(MeasureReport::fields));
        text += &aligned(&rows, 0..0);
        text.extend(self.surface.iter().map(SurfaceReport::text));
        let without: usize = self.measures.iter().filter_map(|measure| measure.without_curve).sum();
        if without > 0 {
            let _ = writeln!(
                text,
                "bootstrap     {without} samples have no curve: their data are separable or of one class"
            );
        }
        text
    }
}
