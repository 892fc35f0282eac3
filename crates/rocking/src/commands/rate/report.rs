//! An annual rate → its text, JSON, table and warnings.

use std::fmt::Write;

use serde::Serialize;

use rocking_charts::rate::per_year;
use rocking_studies::fragility::{CurveFit, Interval, split_heading};
use rocking_studies::risk::{AnnualRate, HazardCurve, RatePart, probability_in};

/// Share of the rate from extrapolated curves that draws a warning.
const NOTABLE: f64 = 0.01;

/// Report of an annual rate, in SI units and years.
#[derive(Serialize)]
pub struct RateReport {
    hazard: HazardReport,
    fragility: CurveReport,
    /// Annual rate.
    rate: f64,
    rate_interval: [Option<f64>; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    confidence: Option<f64>,
    /// Years.
    return_period: f64,
    return_period_interval: [Option<f64>; 2],
    probabilities: Vec<Probability>,
    /// Measures below which 5, 50 and 95 % of the rate arise.
    quantiles: [Option<f64>; 3],
    extrapolated: Extrapolated,
    deaggregation: Vec<PartReport>,
}

/// Probability in some years.
#[derive(Serialize)]
struct Probability {
    years: f64,
    probability: f64,
    interval: [Option<f64>; 2],
}

/// Shares of the rate from beyond the data.
#[derive(Serialize)]
struct Extrapolated {
    below_hazard: f64,
    above_hazard: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    below_rows: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    above_rows: Option<f64>,
    #[serde(skip)]
    rows: Option<[f64; 2]>,
}

/// A part of the rate; the ends of the outermost parts are zero and, as null, infinity.
#[derive(Serialize)]
struct PartReport {
    from: f64,
    to: Option<f64>,
    /// Annual rate at which the lower end is exceeded.
    hazard: Option<f64>,
    /// Probability of exceeding the limit at the lower end.
    probability: f64,
    rate: f64,
    share: f64,
}

/// The hazard curve of a report.
#[derive(Serialize)]
pub struct HazardReport {
    file: String,
    im: String,
    levels: usize,
    range: [f64; 2],
    remarks: Vec<String>,
}

impl HazardReport {
    /// Describes a hazard curve in the unit of its heading.
    pub fn new(file: String, im: String, hazard: &HazardCurve) -> HazardReport {
        let levels = hazard.levels();
        let range = [levels[0], levels[levels.len() - 1]];
        HazardReport { file, im, levels: levels.len(), range, remarks: hazard.remarks.clone() }
    }
}

/// The fragility curve of a report.
#[derive(Serialize)]
pub struct CurveReport {
    curve: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    table: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    median: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    beta: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    levels: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    intervals: Option<String>,
}

impl CurveReport {
    const NONE: CurveReport = CurveReport {
        curve: String::new(),
        table: None,
        limit: None,
        median: None,
        beta: None,
        levels: None,
        intervals: None,
    };

    /// Describes a curve of options.
    pub fn lognormal(median: f64, beta: f64) -> CurveReport {
        CurveReport { curve: "lognormal".into(), median: Some(median), beta: Some(beta), ..CurveReport::NONE }
    }

    /// Describes a curve fitted to a table.
    pub fn fitted(table: String, limit: String, fit: &CurveFit, intervals: String) -> CurveReport {
        CurveReport {
            curve: fit.link.to_string(),
            table: Some(table),
            limit: Some(limit),
            median: Some(fit.median()),
            beta: Some(fit.dispersion()),
            intervals: Some(intervals),
            ..CurveReport::NONE
        }
    }

    /// Describes the fractions of a table.
    pub fn empirical(table: String, limit: String, levels: usize) -> CurveReport {
        CurveReport {
            curve: "empirical".into(),
            table: Some(table),
            limit: Some(limit),
            levels: Some(levels),
            ..CurveReport::NONE
        }
    }

    fn text(&self) -> String {
        let CurveReport { curve, table, limit, median, beta, levels, .. } = self;
        let mut text = curve.clone();
        if let (Some(median), Some(beta)) = (median, beta) {
            let _ = write!(text, ", median {median:.4}, beta {beta:.4}");
        }
        if let Some(levels) = levels {
            let _ = write!(text, ", fractions at {levels} levels");
        }
        if let (Some(limit), Some(table)) = (limit, table) {
            let _ = write!(text, "; {limit} in {table}");
        }
        text
    }
}

impl RateReport {
    /// Reports a rate with the ends of its interval at a confidence level; `rows` is the range of the rows of a table.
    pub fn new(
        hazard: HazardReport,
        fragility: CurveReport,
        found: &AnnualRate,
        ends: Option<(f64, Interval)>,
        years: &[f64],
        rows: Option<[f64; 2]>,
    ) -> RateReport {
        let rate = found.rate;
        let rate_interval = ends.map_or([None, None], |(_, ends)| [ends.low, ends.high]);
        let probability = |&years: &f64| Probability {
            years,
            probability: probability_in(years, rate),
            interval: rate_interval.map(|end| end.map(|rate| probability_in(years, rate))),
        };
        let part = |RatePart { from, to, rate, fraction }: RatePart| PartReport {
            from,
            to: Some(to).filter(|to| to.is_finite()),
            hazard: Some(from).filter(|from| *from > 0.0).map(|from| found.hazard().rate(from)),
            probability: if from > 0.0 { found.curve().probability(from) } else { 0.0 },
            rate,
            share: fraction,
        };
        let fraction = |contribution: f64| if rate > 0.0 { contribution / rate } else { 0.0 };
        RateReport {
            rate,
            rate_interval,
            confidence: ends.map(|(confidence, _)| confidence),
            return_period: 1.0 / rate,
            return_period_interval: [rate_interval[1], rate_interval[0]].map(|end| end.map(|rate| 1.0 / rate)),
            probabilities: years.iter().map(probability).collect(),
            quantiles: [0.05, 0.5, 0.95].map(|fraction| found.quantile(fraction)),
            extrapolated: Extrapolated {
                below_hazard: fraction(found.below_hazard),
                above_hazard: fraction(found.above_hazard),
                below_rows: rows.map(|[least, _]| fraction(found.between(0.0, least))),
                above_rows: rows.map(|[_, greatest]| fraction(found.between(greatest, f64::INFINITY))),
                rows,
            },
            deaggregation: found.deaggregation().into_iter().map(part).collect(),
            hazard,
            fragility,
        }
    }

    /// Returns the heading of the picture.
    pub fn lines(&self) -> Vec<String> {
        let between =
            self.confidence.map_or(String::new(), |_| format!(" ({})", self.between(self.rate_interval, per_year)));
        let file = self.hazard.file.rsplit(['/', '\\']).next().unwrap_or_default();
        vec![
            format!("{} per year{between}, once in {} years", per_year(self.rate), period(self.return_period)),
            format!("hazard {file}; fragility {}", self.fragility.text()),
        ]
    }

    fn between(&self, ends: [Option<f64>; 2], format: impl Fn(f64) -> String) -> String {
        let [low, high] = ends.map(|end| end.map_or("?".into(), &format));
        format!("{low} to {high}")
    }

    /// Returns a warning for each curve that is extrapolated in a notable part of the rate.
    pub fn warnings(&self) -> Vec<String> {
        let Extrapolated { below_hazard, above_hazard, below_rows, above_rows, rows } = self.extrapolated;
        let HazardReport { im, range: [least, greatest], remarks, file, .. } = &self.hazard;
        let [first, last] = rows.unwrap_or_default();
        let parts = [
            (Some(below_hazard), format!("below {least:.4}, the least level of the hazard curve")),
            (Some(above_hazard), format!("above {greatest:.4}, the greatest level of the hazard curve")),
            (below_rows, format!("below {first:.4}, the least value in the rows of the fragility curve")),
            (above_rows, format!("above {last:.4}, the greatest value in the rows of the fragility curve")),
        ];
        let notable = parts
            .into_iter()
            .filter_map(|(fraction, place)| Some((fraction.filter(|fraction| *fraction >= NOTABLE)?, place)));
        let notable =
            notable.map(|(fraction, place)| format!("{} % of the rate comes from {im} {place}", percent(fraction)));
        remarks.iter().map(|remark| format!("{file}: {remark}")).chain(notable).collect()
    }

    /// Writes the report as text.
    pub fn text(&self) -> String {
        let HazardReport { file, im, levels, range: [least, greatest], .. } = &self.hazard;
        let ends = |ends: [Option<f64>; 2], format: fn(f64) -> String| match self.confidence {
            Some(confidence) => format!(" ({} % interval {})", 100.0 * confidence, self.between(ends, format)),
            None => String::new(),
        };
        let mut text = format!(
            "hazard        {file}: {im}, {levels} levels from {least:.4} to {greatest:.4}\n\
             fragility     {}\n\
             rate          {} per year{}\n\
             return period {} years{}\n",
            self.fragility.text(),
            per_year(self.rate),
            ends(self.rate_interval, per_year),
            period(self.return_period),
            ends(self.return_period_interval, period),
        );
        for Probability { years, probability, interval } in &self.probabilities {
            let interval = ends(*interval, |probability| format!("{} %", percent(probability)));
            // Writing to a String never fails.
            let _ = writeln!(
                text,
                "probability   {} % in {years} {}{interval}",
                percent(*probability),
                if *years == 1.0 { "year" } else { "years" }
            );
        }
        if let [Some(low), Some(middle), Some(high)] = self.quantiles {
            let _ = writeln!(text, "comes from    {im}: half below {middle:.4}, 90 % between {low:.4} and {high:.4}");
        }
        let Extrapolated { below_hazard, above_hazard, below_rows, above_rows, .. } = self.extrapolated;
        let _ = write!(
            text,
            "extrapolated  hazard: {} % below its levels, {} % above",
            percent(below_hazard),
            percent(above_hazard)
        );
        if let (Some(below), Some(above)) = (below_rows, above_rows) {
            let _ = write!(text, "; fragility: {} % below its rows, {} % above", percent(below), percent(above));
        }
        text + "\n"
    }

    /// Writes the deaggregation as CSV, in full precision.
    pub fn table(&self) -> String {
        let unit = split_heading(&self.hazard.im).1.unwrap_or("1");
        let mut table = format!(
            "# rocking-block {} rate\n# {}\n",
            env!("CARGO_PKG_VERSION"),
            self.text().trim_end().replace('\n', "\n# ")
        );
        let _ = writeln!(table, "from [{unit}],to [{unit}],hazard [1/year],probability [1],rate [1/year],share [1]");
        for PartReport { from, to, hazard, probability, rate, share } in &self.deaggregation {
            let [to, hazard] = [to, hazard].map(|value| value.map_or(String::new(), |value| format!("{value:?}")));
            let _ = writeln!(table, "{from:?},{to},{hazard},{probability:?},{rate:?},{share:?}");
        }
        table
    }
}

/// Formats a probability or another fraction in per cent with three digits.
fn percent(fraction: f64) -> String {
    match 100.0 * fraction {
        ..1e-10 => "0".into(),
        small if small < 1e-3 => format!("{small:.1e}"),
        other => rocking_charts::numerals::significant(other, 3),
    }
}

/// Formats a return period.
fn period(years: f64) -> String {
    match years {
        ..1e7 => rocking_charts::numerals::significant(years, 3),
        ..1e12 => format!("{years:.2e}"),
        _ => "more than 1e12".into(),
    }
}
