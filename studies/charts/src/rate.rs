//! An annual rate → a page: hazard, fragility, deaggregation.

use std::ops::Range;

use crate::chart::{Chart, Curve, Tile};
use crate::fragility::{axis, band, spread};
use crate::line_style::LineStyle;
use crate::numerals::significant;
use crate::page::{Symbol, stacked};
use crate::picture::PictureError;
use rocking_studies::fragility::Interval;
use rocking_studies::risk::AnnualRate;

/// Heights of the charts.
const HEIGHTS: [u32; 3] = [5200, 5200, 5600];
/// Points of a curve.
const POINTS: u32 = 600;
/// Bars of the deaggregation.
const BARS: u32 = 60;
/// Names of powers of ten, the least first.
const POWERS: [&str; 15] = [
    "1e-14", "1e-13", "1e-12", "1e-11", "1e-10", "1e-9", "1e-8", "1e-7", "1e-6", "1e-5", "1e-4", "1e-3", "0.01", "0.1",
    "1",
];

/// Draws the hazard curve and the fragility curve with its band. The measures from which the rate comes are marked.
///
/// `heading` is name and unit of the measure, `limit` the name of the probability; `intervals` gives the ends of the confidence interval
/// at measures.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn rate(
    lines: &[String],
    found: &AnnualRate,
    heading: &str,
    limit: &str,
    intervals: impl Fn(&[f64]) -> Option<Vec<Interval>>,
) -> Result<String, PictureError> {
    let [least, greatest] = found.hazard_range();
    let reach = found.quantile(0.995).unwrap_or(greatest).min(1.6 * greatest);
    let x = 0.0..reach.max(0.5 * greatest).min(2.0 * reach.max(least));
    let at = spread(x.end, POINTS);
    let (axis, _) = axis(heading);
    let upper = hazard(found, &at, &x);
    let middle = Chart {
        x: ("", x.clone()),
        y: (limit, -0.05..1.05),
        areas: intervals(&at).map(|found| band(&at, &found)).into_iter().collect(),
        curves: vec![Curve::new(LineStyle::BLACK, vec![at.iter().map(|&m| (m, found.curve.probability(m))).collect()])],
        ..Chart::default()
    };
    let lower = deaggregation(found, &axis, &x);
    let mut legend = vec![
        (Symbol::Curve(LineStyle::BLACK), "curves".to_string()),
        (Symbol::Curve(LineStyle::DASHED), "hazard continued beyond its levels".into()),
        (Symbol::Grey(GREY), "share of the rate".into()),
        (Symbol::Grey(OUTSIDE), "share from beyond the hazard's levels".into()),
    ];
    if middle.shows_band() {
        legend.insert(1, (Symbol::Band, "confidence interval".into()));
    }
    let [top, centre, bottom] = HEIGHTS;
    // Pictures have units in parentheses, tables in brackets.
    let lines: Vec<String> = lines.iter().map(|line| line.replace(heading, &axis)).collect();
    stacked(&lines, &legend, &[(top, vec![], upper), (centre, vec![], middle), (bottom, vec![], lower)])
}

/// Grey levels of the bars inside and outside of the hazard's levels.
const GREY: u8 = 120;
const OUTSIDE: u8 = 205;

fn hazard(found: &AnnualRate, at: &[f64], x: &Range<f64>) -> Chart<'static> {
    let [least, greatest] = found.hazard_range();
    let hazard = &found.hazard;
    let log = |m: f64| (m, libm::log10(hazard.rate(m)));
    let ends = [least.min(x.end), x.end].map(|m| log(m).1);
    let y = ends[1].max(-14.0).floor()..ends[0].min(1.0).ceil().max(ends[1].floor() + 1.0);
    let stretch = |range: Range<f64>| -> Vec<(f64, f64)> {
        let inside = at.iter().copied().filter(|m| *m > range.start && *m < range.end);
        let ends = [range.start, range.end].into_iter().filter(|m| *m >= at[0] && *m <= x.end);
        let mut all: Vec<f64> = inside.chain(ends).collect();
        all.sort_by(f64::total_cmp);
        all.into_iter().map(log).collect()
    };
    let names = POWERS.iter().enumerate().map(|(i, name)| (i as f64 - 14.0, *name));
    let names: Vec<_> = names.filter(|(power, _)| *power >= y.start && *power <= y.end).collect();
    let levels = names.iter().map(|(power, _)| Curve::new(LineStyle::GRID, vec![vec![(0.0, *power), (x.end, *power)]]));
    let curves = [
        Curve::new(LineStyle::DASHED, vec![stretch(0.0..least), stretch(greatest..f64::INFINITY)]),
        Curve::new(LineStyle::BLACK, vec![stretch(least..greatest)]),
    ];
    let step = names.len().div_ceil(7);
    Chart {
        x: ("", x.clone()),
        y: ("annual rate (1/year)", y),
        curves: levels.chain(curves).collect(),
        names: names.iter().rev().step_by(step.max(1)).map(|(power, name)| (*power, (*name).into())).collect(),
        ..Chart::default()
    }
}

fn deaggregation<'a>(found: &AnnualRate, axis: &'a str, x: &Range<f64>) -> Chart<'a> {
    let [least, greatest] = found.hazard_range();
    let bars: Vec<(Range<f64>, f64)> = (0..BARS)
        .map(|bar| {
            let [from, to] = [bar, bar + 1].map(|end| x.end * f64::from(end) / f64::from(BARS));
            (from..to, found.between(from, to) / found.rate)
        })
        .collect();
    let highest = bars.iter().map(|bar| bar.1).fold(0.0, f64::max);
    let tile = |(range, share): &(Range<f64>, f64)| {
        let middle = 0.5 * (range.start + range.end);
        let grey = if (least..=greatest).contains(&middle) { GREY } else { OUTSIDE };
        Tile { x: range.start..range.end, y: 0.0..*share, grey }
    };
    let quantiles = [0.05, 0.5, 0.95].map(|share| found.quantile(share));
    let verticals = quantiles.into_iter().flatten().filter(|m| *m < x.end).map(|m| (LineStyle::LEVEL, m));
    let notes =
        [("5 %", quantiles[0]), ("50 %", quantiles[1]), ("95 %", quantiles[2])].into_iter().filter_map(|(name, m)| {
            let m = m.filter(|m| *m < 0.95 * x.end)?;
            Some(((m + 0.005 * x.end, 1.14 * highest), name.to_string()))
        });
    Chart {
        x: (axis, x.clone()),
        y: ("share of the rate", 0.0..1.25 * highest.max(1e-12)),
        tiles: bars.iter().map(tile).collect(),
        verticals: verticals.collect(),
        notes: notes.collect(),
        ..Chart::default()
    }
}

/// The least annual rate that is written as a number.
pub const NEGLIGIBLE: f64 = 1e-12;

/// Formats an annual rate with three significant digits.
pub fn per_year(rate: f64) -> String {
    per_year_to(rate, 3)
}

/// Formats an annual rate with this number of significant digits.
pub fn per_year_to(rate: f64, digits: usize) -> String {
    match rate {
        0.0..NEGLIGIBLE => "below 1e-12".into(),
        ..1e-3 => format!("{rate:.*e}", digits - 1),
        _ => significant(rate, digits),
    }
}
