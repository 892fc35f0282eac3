//! What `rocking fragility` found → text for a person, or JSON.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Serialize;

use crate::study::fragility::{Assessment, Cases, Interval, Surface, Table};

/// What was found; SI units.
#[derive(Serialize)]
pub struct Curves {
    pub table: String,
    pub limit: String,
    pub link: String,
    pub confidence: f64,
    /// Method of the intervals.
    pub intervals: String,
    pub rows: Rows,
    pub measures: Vec<Measure>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface: Option<SurfaceResult>,
}

/// Rows of the table that count.
#[derive(Serialize)]
pub struct Rows {
    all: usize,
    /// Those that tell whether the limit is exceeded.
    told: usize,
    /// In how many of these it is: for ensembles, the sum of their probabilities.
    exceeded: f64,
    /// Those whose runs failed.
    failed: usize,
    /// Those whose runs ended at complete separation before the limit was exceeded.
    separated: usize,
    /// Those whose duration was too short.
    undecided: usize,
}

impl Rows {
    /// Those of a table.
    pub fn of(table: &Table, Cases { cases, failed, separated, undecided }: &Cases) -> Rows {
        let exceeded = cases.iter().map(|case| case.fraction).sum();
        Rows {
            all: table.rows(),
            told: cases.len(),
            exceeded,
            failed: *failed,
            separated: *separated,
            undecided: *undecided,
        }
    }
}

/// The curve of a measure.
#[derive(Serialize)]
pub struct Measure {
    im: String,
    rows: usize,
    median: f64,
    median_interval: [Option<f64>; 2],
    beta: f64,
    beta_interval: [Option<f64>; 2],
    /// Of the natural logarithm of the measure.
    intercept: f64,
    slope: f64,
    standard_errors: Vec<f64>,
    log_likelihood: f64,
    null_log_likelihood: f64,
    #[serde(rename = "AUC")]
    auc: f64,
    #[serde(rename = "Brier")]
    brier: f64,
    efficiency: Option<f64>,
    /// Blocks that lifted off and stand, from which the efficiency is.
    rocking: usize,
    /// Probability of the data, or of stranger ones, if the measure is sufficient beside each of these.
    sufficiency: BTreeMap<String, f64>,
    /// Samples of the bootstrap without a curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    without_curve: Option<usize>,
}

impl Measure {
    /// The curve of a measure of this heading.
    pub fn of(heading: &str, found: &Assessment, sufficiency: BTreeMap<String, f64>) -> Measure {
        let Assessment { data, fit, median, dispersion, auc, brier, efficiency, rocking, .. } = found;
        let ends = |Interval { low, high }: &Interval| [*low, *high];
        Measure {
            im: heading.into(),
            rows: data.observations().len(),
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
            efficiency: *efficiency,
            rocking: *rocking,
            sufficiency,
            without_curve: found.without_curve(),
        }
    }

    /// What stands in the table for a person.
    fn fields(&self) -> Vec<String> {
        let end = |end: Option<f64>| end.map_or("?".into(), |end| format!("{end:.4}"));
        let with = |value: f64, [low, high]: [Option<f64>; 2]| format!("{value:.4} ({} to {})", end(low), end(high));
        let mut fields = vec![
            self.im.clone(),
            with(self.median, self.median_interval),
            with(self.beta, self.beta_interval),
            format!("{:.3}", self.auc),
            format!("{:.4}", self.brier),
            self.efficiency.map_or("none".into(), |efficiency| format!("{efficiency:.3}")),
            self.rocking.to_string(),
            self.rows.to_string(),
        ];
        fields.extend(self.sufficiency.values().map(|p| format!("{p:.2e}")));
        fields
    }
}

/// The surface of two measures.
#[derive(Serialize)]
pub struct SurfaceResult {
    im: [String; 2],
    rows: usize,
    intercept: f64,
    /// Of the natural logarithm of each measure.
    slopes: [f64; 2],
    standard_errors: Vec<f64>,
    log_likelihood: f64,
    #[serde(rename = "AUC")]
    auc: f64,
    #[serde(rename = "Brier")]
    brier: f64,
}

impl SurfaceResult {
    /// What a surface of measures of these headings amounts to.
    pub fn of(headings: [&str; 2], found: &Surface) -> SurfaceResult {
        let Surface { data, fit, standard_errors, auc, brier } = found;
        SurfaceResult {
            im: headings.map(String::from),
            rows: data.observations().len(),
            intercept: fit.coefficients[0],
            slopes: [fit.coefficients[1], fit.coefficients[2]],
            standard_errors: standard_errors.clone(),
            log_likelihood: fit.log_likelihood,
            auc: *auc,
            brier: *brier,
        }
    }

    fn words(&self) -> String {
        let SurfaceResult { im: [one, other], rows, intercept, slopes: [b, c], standard_errors, auc, brier, .. } = self;
        let [a, b, c] =
            [(intercept, 0), (b, 1), (c, 2)].map(|(value, i)| format!("{value:.4} ± {:.4}", standard_errors[i]));
        format!(
            "surface       of {rows} rows: ({a}) + ({b}) ln {one} + ({c}) ln {other}; AUC {auc:.3}, Brier {brier:.4}\n"
        )
    }
}

impl Curves {
    /// For a person.
    pub fn words(&self) -> String {
        let Rows { all, told, exceeded, failed, separated, undecided } = self.rows;
        let left_out = [(failed, "failed"), (separated, "ended at separation"), (undecided, "undecided")];
        let left_out = left_out.iter().filter(|(count, _)| *count > 0);
        let left_out: String = left_out.map(|(count, why)| format!(", {count} {why}")).collect();
        let mut words = format!(
            "table         {}: {all} rows{left_out}\n\
             limit         {}: exceeded in {} of {told} rows\n\
             curve         {}, intervals of {} %: {}\n",
            self.table,
            self.limit,
            // A sum of probabilities has more digits than anybody needs.
            (exceeded * 10.0).round() / 10.0,
            self.link,
            100.0 * self.confidence,
            self.intervals
        );
        let mut rows = vec![
            ["measure", "median", "beta", "AUC", "Brier", "efficiency", "rocking", "rows"].map(String::from).to_vec(),
        ];
        rows[0].extend(self.measures[0].sufficiency.keys().map(|other| format!("p beside {other}")));
        rows.extend(self.measures.iter().map(Measure::fields));
        let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..rows[0].len()).map(width).collect();
        for row in &rows {
            let line: String = row.iter().zip(&widths).map(|(field, width)| format!("{field:<width$}  ")).collect();
            // Writing to a String never fails.
            let _ = writeln!(words, "{}", line.trim_end());
        }
        words.extend(self.surface.iter().map(SurfaceResult::words));
        let without: usize = self.measures.iter().filter_map(|measure| measure.without_curve).sum();
        if without > 0 {
            let _ = writeln!(
                words,
                "bootstrap     {without} samples have no curve: their data are separable or of one class"
            );
        }
        words
    }
}
