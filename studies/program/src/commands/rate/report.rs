//! An annual rate → its summary, table and warnings.

use crate::commands::rate::Fragility;
use crate::output::summary::{Object, Summary};
use rocking_charts::numerals::{self, significant};
use rocking_charts::rate::{per_year, per_year_to};
use rocking_studies::fragility::{Assessment, Independence, Interval, split_heading};
use rocking_studies::output::format::DescribedTable;
use rocking_studies::output::table::{Table, TableColumn};
use rocking_studies::risk::{AnnualRate, RatePart, probability_in};

/// Share of the rate from extrapolated curves that draws a warning.
const NOTABLE: f64 = 0.01;

/// The numbers of a part of the rate with their units; two have that of the measure.
///
/// Hazard and probability are the annual rate and the probability of exceeding the limit at the lower end.
const PART: [(&str, Option<&str>); 6] = [
    ("from", None),
    ("to", None),
    ("hazard", Some("1/year")),
    ("probability", Some("1")),
    ("rate", Some("1/year")),
    ("share", Some("1")),
];

/// A report of an annual rate, in SI units and years.
pub struct RateReport<'a> {
    /// The file of the hazard curve.
    pub file: String,
    /// Heading of the measure.
    pub im: &'a str,
    /// The fragility curve.
    pub fragility: &'a Fragility,
    /// The rate.
    pub found: &'a AnnualRate,
    /// The ends of its interval at a confidence level.
    pub ends: Option<(f64, Interval)>,
    /// Rows of the table without a known outcome, with the rates if none of them exceeds the limit, and if all do.
    pub unknown: Option<(usize, Interval)>,
    /// Numbers of years for the probability of an exceedance.
    pub years: &'a [f64],
}

impl RateReport<'_> {
    /// Returns the heading of the picture.
    pub fn lines(&self) -> Vec<String> {
        let rate = self.found.rate;
        let between = self.ends.map_or(String::new(), |_| format!(" ({})", between(self.interval(), per_year_to)));
        let file = self.file.rsplit(['/', '\\']).next().unwrap_or_default();
        vec![
            format!("{} per year{between}, once in {} years", per_year(rate), period(1.0 / rate)),
            format!("hazard {file}; fragility {}", self.fragility.text),
        ]
    }

    /// The interval of the rate.
    fn interval(&self) -> Interval {
        self.ends.map_or([None; 2], |(_, ends)| ends)
    }

    /// Fractions of the rate from beyond the hazard curve and the rows. The first of each pair is from below, the second from above.
    fn extrapolated(&self) -> ([f64; 2], Option<[f64; 2]>) {
        let AnnualRate { rate, below_hazard, above_hazard, .. } = *self.found;
        let fraction = |contribution: f64| if rate > 0.0 { contribution / rate } else { 0.0 };
        let of_rows = self.fragility.rows.map(|[least, greatest]| {
            [self.found.between(0.0, least), self.found.between(greatest, f64::INFINITY)].map(fraction)
        });
        ([below_hazard, above_hazard].map(fraction), of_rows)
    }

    /// Returns a warning for each curve with a notable extrapolated part of the rate.
    pub fn warnings(&self) -> Vec<String> {
        let ([below, above], of_rows) = self.extrapolated();
        let ([least, greatest], [first, last]) = (self.found.hazard_range(), self.fragility.rows.unwrap_or_default());
        let [below_rows, above_rows] = of_rows.unwrap_or_default();
        let parts = [
            (below, format!("below {least:.4}, the least level of the hazard curve")),
            (above, format!("above {greatest:.4}, the greatest level of the hazard curve")),
            (below_rows, format!("below {first:.4}, the least value in the rows of the fragility curve")),
            (above_rows, format!("above {last:.4}, the greatest value in the rows of the fragility curve")),
        ];
        let notable = parts.into_iter().filter(|(fraction, _)| *fraction >= NOTABLE);
        let notable = notable
            .map(|(fraction, place)| format!("{} % of the rate comes from {} {place}", percent(fraction), self.im));
        let remarks = self.found.hazard.remarks.iter().map(|remark| format!("{}: {remark}", self.file));
        let is_of_one = |assessment: &&Assessment| assessment.independence == Independence::OneMotion;
        let of_one = self.fragility.assessment.as_ref().filter(is_of_one).map(|_| {
            "all rows are of one ground motion: the curve has no scatter from motion to motion, so that this is not the rate of a site, and no \
             interval is known"
                .into()
        });
        remarks.chain(of_one).chain(notable).collect()
    }

    /// Summarizes the rate.
    pub fn summary(&self) -> Summary {
        let RateReport { file, im, fragility, found, .. } = self;
        let (rate, [least, greatest], levels) = (found.rate, self.found.hazard_range(), found.hazard.levels().len());
        let ends = |ends: [Option<f64>; 2], format: fn(f64, usize) -> String| match self.ends {
            Some((confidence, _)) => format!(" ({} % interval {})", 100.0 * confidence, between(ends, format)),
            None => String::new(),
        };
        let mut summary = Summary::default();
        summary.item(
            "hazard",
            Object::from([("file", file.as_str()), ("im", im)])
                .with("levels", levels)
                .with("range", [least, greatest])
                .with("remarks", &found.hazard.remarks),
            "hazard",
            format!("{file}: {im}, {levels} levels from {least:.4} to {greatest:.4}"),
        );
        summary.item("fragility", &fragility.json, "fragility", &fragility.text);
        let interval = self.interval();
        summary.item("rate", rate, "rate", format!("{} per year{}", per_year(rate), ends(interval, per_year_to)));
        summary.entry("rate_interval", interval);
        if let Some((confidence, _)) = self.ends {
            summary.entry("confidence", confidence);
        }
        if let Some((rows, rates)) = self.unknown {
            let text =
                |rate: Option<f64>| rate.map_or("no curve".into(), |rate| format!("{} per year", per_year(rate)));
            let [none, all] = rates.map(text);
            summary.item(
                "rate_of_unknown",
                rates,
                "unknown",
                format!("{rows} rows have no known outcome: {none} if none of them exceeds the limit, {all} if all do"),
            );
        }
        let (years, periods) = (1.0 / rate, [interval[1], interval[0]].map(|end| end.map(|rate| 1.0 / rate)));
        let text = format!("{} years{}", period(years), ends(periods, period_to));
        summary.item("return_period", years, "return period", text);
        summary.entry("return_period_interval", periods);
        let mut probabilities = Vec::new();
        for &years in self.years {
            let probability = probability_in(years, rate);
            let interval = interval.map(|end| end.map(|rate| probability_in(years, rate)));
            let words = ends(interval, |probability, digits| format!("{} %", percent_to(probability, digits)));
            let unit = if years == 1.0 { "year" } else { "years" };
            summary.line("probability", format!("{} % in {years} {unit}{words}", percent(probability)));
            let numbers = Object::from([("years", years), ("probability", probability)]);
            probabilities.push(numbers.with("interval", interval));
        }
        summary.entry("probabilities", probabilities);
        self.add_parts(&mut summary);
        summary
    }

    /// Adds the measures from which the rate comes.
    fn add_parts(&self, summary: &mut Summary) {
        let RateReport { im, found, .. } = self;
        let quantiles = [0.05, 0.5, 0.95].map(|fraction| found.quantile(fraction));
        summary.entry("quantiles", quantiles);
        if let [Some(low), Some(middle), Some(high)] = quantiles {
            let text = format!("{im}: half below {middle:.4}, 90 % between {low:.4} and {high:.4}");
            summary.line("comes from", text);
        }
        let ([below, above], of_rows) = self.extrapolated();
        let of_rows_text = of_rows.map(|[below, above]| {
            format!("; fragility: {} % below its rows, {} % above", percent(below), percent(above))
        });
        summary.item(
            "extrapolated",
            Object::from([("below_hazard", below), ("above_hazard", above)])
                .with_some("below_rows", of_rows.map(|[below, _]| below))
                .with_some("above_rows", of_rows.map(|[_, above]| above)),
            "extrapolated",
            format!(
                "hazard: {} % below its levels, {} % above{}",
                percent(below),
                percent(above),
                of_rows_text.unwrap_or_default()
            ),
        );
        let part = |numbers| PART.into_iter().map(|(name, _)| name).zip(numbers).collect::<Object>();
        summary.entry("deaggregation", self.parts().map(part).collect::<Vec<_>>());
    }

    /// The numbers of [`PART`] for each part of the rate. An infinite upper end and the hazard at zero are missing.
    fn parts(&self) -> impl Iterator<Item = [Option<f64>; 6]> {
        let AnnualRate { hazard, curve, .. } = self.found;
        self.found.deaggregation().into_iter().map(|RatePart { from, to, rate, fraction }| {
            let above_zero = Some(from).filter(|from| *from > 0.0);
            let probability = above_zero.map_or(0.0, |from| curve.probability(from));
            let to = Some(to).filter(|to| to.is_finite());
            [Some(from), to, above_zero.map(|from| hazard.rate(from)), Some(probability), Some(rate), Some(fraction)]
        })
    }

    /// Returns the table of the deaggregation, with the lines of the summary.
    pub fn table(&self) -> DescribedTable {
        let unit = split_heading(self.im).1.unwrap_or("1");
        let column = |(number, (name, known)): (usize, (&str, Option<&str>))| {
            TableColumn::optional(name, known.unwrap_or(unit), move |part: &[Option<f64>; 6]| part[number])
        };
        let columns: Vec<_> = PART.into_iter().enumerate().map(column).collect();
        let head = format!("rocking-block {} rate", env!("CARGO_PKG_VERSION"));
        let summary = self.summary().text;
        let study = std::iter::once(head).chain(summary.trim_end().lines().map(String::from)).collect();
        DescribedTable { study, table: Table::of(&columns, &self.parts().collect::<Vec<_>>()) }
    }
}

/// Formats an interval. `format` takes a number and its digits.
fn between(ends: [Option<f64>; 2], format: fn(f64, usize) -> String) -> String {
    match ends {
        [Some(low), Some(high)] => numerals::ends([low, high], 3, format).join(" to "),
        ends => ends.map(|end| end.map_or("?".into(), |end| format(end, 3))).join(" to "),
    }
}

/// Formats a probability or another fraction in per cent with three digits.
fn percent(fraction: f64) -> String {
    percent_to(fraction, 3)
}

fn percent_to(fraction: f64, digits: usize) -> String {
    match 100.0 * fraction {
        ..1e-10 => "0".into(),
        small if small < 1e-3 => format!("{small:.*e}", digits - 2),
        other => significant(other, digits),
    }
}

/// Formats a return period.
fn period(years: f64) -> String {
    period_to(years, 3)
}

fn period_to(years: f64, digits: usize) -> String {
    match years {
        ..1e7 => significant(years, digits),
        ..1e12 => format!("{years:.*e}", digits - 1),
        _ => "more than 1e12".into(),
    }
}
