//! Fragility curves and surfaces, and curves of incremental dynamic analysis → pictures.

use std::ops::Range;

use crate::canvas::Mark;
use crate::chart::{Chart, Curve, Tile, range, rotations};
use crate::formula::formula;
use crate::line_style::LineStyle;
use crate::numerals::{short, significant};
use crate::page::{Symbol, page};
use crate::picture::PictureError;
use rocking_studies::fragility::{
    Assessment, Data, Fit, Ida, Limit, Link, Observation, Response, SweepTable, split_heading,
};
use rocking_studies::statistics::{self, normal};

/// Height of the chart.
const HEIGHT: u32 = 10_000;
/// Points of the curve and of its band.
const POINTS: u32 = 1200;
/// Maximum number of bins.
const MAX_BINS: usize = 12;
/// Minimum number of rows per bin, for a meaningful fraction.
const MIN_ROWS_OF_A_BIN: usize = 5;

/// Draws a fragility curve with its band, the fractions of binned rows, and each row as a tick.
///
/// `blocks` describes the blocks; `heading` is name and unit of the measure.
pub fn curve(
    blocks: &str,
    found: &Assessment,
    heading: &str,
    limit: Limit,
    confidence: f64,
) -> Result<String, PictureError> {
    let observations = found.data.observations();
    let measures = || observations.iter().map(|row| row.measures[0]);
    let x = range(measures());
    let at: Vec<f64> = (1..=POINTS).map(|point| x.end * f64::from(point) / f64::from(POINTS)).collect();
    let side = x.end / 120.0;
    let curve = at.iter().map(|&measure| (measure, found.fit.probability(&[measure]))).collect();
    let band = at.iter().zip(found.band(&at));
    let band = band.map(|(&measure, interval)| (measure, interval.low.unwrap_or(0.0), interval.high.unwrap_or(1.0)));
    let bins = bins(observations);
    // Ticks of rows with the same measure stand side by side.
    let tick = |(number, row): (usize, &Observation)| {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let aside = (GOLDEN * number as f64).fract() - 0.5;
        let y = match row.fraction {
            0.0 => -0.06,
            1.0 => 1.06,
            fraction => fraction,
        };
        (row.measures[0] + 1.5 * side * aside, y)
    };
    let legend = [
        (Symbol::Curve(LineStyle::BLACK), name(found).into()),
        (Symbol::Band, format!("{} % confidence", short(100.0 * confidence))),
        (Symbol::Mark(Mark::Circle), "fraction of a group of rows, with their number".into()),
        (
            Symbol::Mark(Mark::Tick),
            "each row: above the chart if it exceeds the limit, below if not, between if a part does".into(),
        ),
    ];
    let ticks = observations.iter().enumerate().map(|row| (Mark::Tick, tick(row)));
    let circles = bins.iter().map(|bin| (Mark::Circle, (bin.measure, bin.fraction)));
    let (axis, unit) = axis(heading);
    let ordinate = probability_of(limit);
    let chart = Chart {
        x: (&axis, x),
        y: (&ordinate, -0.1..1.1),
        areas: vec![band.collect()],
        curves: vec![Curve::new(LineStyle::BLACK, vec![curve])],
        marks: ticks.chain(circles).collect(),
        notes: bins.iter().map(|bin| ((bin.measure + 0.9 * side, bin.fraction + 0.03), bin.rows.to_string())).collect(),
        ..Chart::default()
    };
    let title = format!(
        "median {}{unit}, β = {}; AUC {:.3}, Brier score {:.3}; {} rows",
        significant(found.fit.median(), 4),
        significant(found.fit.dispersion(), 4),
        found.auc,
        found.brier,
        observations.len()
    );
    page(&[title, blocks.into()], &legend, HEIGHT, |root, area| chart.draw(root, area))
}

/// Draws the curves of several limits, each with its name, over the measure with this heading.
pub fn states(title: &str, curves: &[(String, &Assessment)], heading: &str) -> Result<String, PictureError> {
    let measures = curves.iter().flat_map(|(_, found)| found.data.observations()).map(|row| row.measures[0]);
    let x = range(measures);
    let at = (1..=POINTS).map(|point| x.end * f64::from(point) / f64::from(POINTS));
    let line = |found: &Assessment| at.clone().map(|measure| (measure, found.fit.probability(&[measure]))).collect();
    let styles = (0..curves.len()).map(LineStyle::of);
    let drawn = curves.iter().zip(styles.clone()).map(|((_, found), style)| Curve::new(style, vec![line(found)]));
    let legend: Vec<_> =
        curves.iter().zip(styles).map(|((name, _), style)| (Symbol::Curve(style), name.clone())).collect();
    let (axis, _) = axis(heading);
    let chart = Chart {
        x: (&axis, x.clone()),
        y: ("probability of exceeding the limit", -0.05..1.05),
        curves: drawn.collect(),
        ..Chart::default()
    };
    page(&[title.into()], &legend, HEIGHT, |root, area| chart.draw(root, area))
}

/// Draws the peaks over the levels of a measure for each block and ground motion, with their fractiles.
///
/// A curve goes to the right edge if its block overturns at the next level, and returns when it stands again.
pub fn ida(blocks: &str, found: &Ida, heading: &str) -> Result<String, PictureError> {
    let stands = |response: &Response| match *response {
        Response::Stands(peak) => Some(peak),
        Response::Overturns | Response::Unknown => None,
    };
    let peaks = found.curves.iter().flatten().filter_map(stands);
    let (x, y) = (rotations(peaks), range(found.levels.iter().copied()));
    let segments = |responses: &[Response]| {
        // At rest without shaking.
        let mut segments = vec![vec![(0.0, 0.0)]];
        for (response, &level) in responses.iter().zip(&found.levels) {
            let open = segments.len() - 1;
            match *response {
                Response::Stands(peak) => segments[open].push((peak, level)),
                Response::Overturns => {
                    if let Some(&(_, before)) = segments[open].last() {
                        segments[open].push((x.end, before + 0.5 * (level - before)));
                        segments.push(Vec::new());
                    }
                }
                Response::Unknown => segments.push(Vec::new()),
            }
        }
        segments
    };
    let curve = |style: LineStyle, responses: &[Response]| Curve::new(style, segments(responses));
    let single = found.curves.iter().map(|responses| curve(LineStyle::FAINT, responses));
    let fractiles = [(LineStyle::DASHED, 0.16), (LineStyle::BLACK, 0.5), (LineStyle::DASHED, 0.84)];
    let fractiles = fractiles.map(|(style, part)| curve(style, &found.fractile(part)));
    let (axis, _) = axis(heading);
    let chart = Chart {
        x: ("peak |θ|/α", x.clone()),
        y: (&axis, y),
        curves: single.chain(fractiles).collect(),
        verticals: if x.contains(&1.0) { vec![(LineStyle::LEVEL, 1.0)] } else { Vec::new() },
        ..Chart::default()
    };
    let legend = [
        (
            Symbol::Curve(LineStyle::FAINT),
            "one block and ground motion; to the right edge where it overturns".to_string(),
        ),
        (Symbol::Curve(LineStyle::BLACK), "median".into()),
        (Symbol::Curve(LineStyle::DASHED), "16 % and 84 %".into()),
    ];
    let title = format!(
        "{} curves, {} levels; overturning counts as more than any peak",
        found.curves.len(),
        found.levels.len()
    );
    page(&[title, blocks.into()], &legend, HEIGHT, |root, area| chart.draw(root, area))
}

/// Draws a fragility surface of two measures in grey, with the lines of 10, 50 and 90 %, and the rows.
pub fn surface(
    blocks: &str,
    data: &Data,
    fit: &Fit,
    headings: [&str; 2],
    limit: Limit,
) -> Result<String, PictureError> {
    /// Tiles along each axis.
    const TILES: u32 = 80;
    let observations = data.observations();
    let [x, y] = [0, 1].map(|measure| range(observations.iter().map(|row| row.measures[measure])));
    let edge = |range: &Range<f64>, tile: u32| range.end * f64::from(tile) / f64::from(TILES);
    let tile = |number: u32| {
        let sides = [(&x, number % TILES), (&y, number / TILES)].map(|(range, i)| edge(range, i)..edge(range, i + 1));
        let middle = [0, 1].map(|side: usize| 0.5 * (sides[side].start + sides[side].end));
        let [x, y] = sides;
        // Light enough for visible lines and marks.
        Tile { x, y, grey: 255 - (130.0 * fit.probability(&middle)).round() as u8 }
    };
    let line = |deviate: f64| {
        let [a, b, c] = [0, 1, 2].map(|i| fit.coefficients[i]);
        // a + b ln x + c ln y = deviate, stepped along the axis of the smaller coefficient.
        let points = (1..=4 * TILES).map(|i| {
            let position = f64::from(i) / f64::from(4 * TILES);
            if b.abs() < c.abs() {
                let at = position * x.end;
                (at, libm::exp((deviate - a - b * libm::log(at)) / c))
            } else {
                let at = position * y.end;
                (libm::exp((deviate - a - c * libm::log(at)) / b), at)
            }
        });
        points.filter(|(at_x, at_y)| *at_x <= x.end && *at_y <= y.end).collect::<Vec<_>>()
    };
    let deviates = match fit.link {
        Link::Probit => [0.1, 0.5, 0.9].map(normal::quantile),
        Link::Logit => [0.1_f64, 0.5, 0.9].map(|p| libm::log(p / (1.0 - p))),
    };
    let styles = [LineStyle::DASHED, LineStyle::BLACK, LineStyle::DASHED];
    let curves = deviates.into_iter().zip(styles).map(|(deviate, style)| Curve::new(style, vec![line(deviate)]));
    let marks = |exceeds: bool, mark: Mark| {
        let rows = observations.iter().filter(move |row| (row.fraction >= 0.5) == exceeds);
        rows.map(move |row| (mark, (row.measures[0], row.measures[1])))
    };
    let [(axis_x, _), (axis_y, _)] = headings.map(axis);
    let chart = Chart {
        x: (&axis_x, x.clone()),
        y: (&axis_y, y.clone()),
        tiles: (0..TILES * TILES).map(tile).collect(),
        curves: curves.collect(),
        marks: marks(true, Mark::Cross).chain(marks(false, Mark::Circle)).collect(),
        ..Chart::default()
    };
    let legend = [
        (Symbol::Curve(LineStyle::BLACK), "50 %".to_string()),
        (Symbol::Curve(LineStyle::DASHED), "10 % and 90 %".into()),
        (Symbol::Mark(Mark::Cross), "rows that exceed the limit with a probability of 50 % or more".into()),
        (Symbol::Mark(Mark::Circle), "other rows".into()),
    ];
    let title = format!("{}, {} rows", probability_of(limit), observations.len());
    page(&[title, blocks.into()], &legend, HEIGHT, |root, area| chart.draw(root, area))
}

/// Describes file, slenderness and foundations of a table, as far as its columns show.
pub fn blocks(table: &SweepTable) -> String {
    let span = |symbol: &str, names: &[&str], unit: &str| {
        let numbers = names.iter().find_map(|name| table.numbers(name).ok())?;
        let [low, high] = statistics::range(numbers.into_iter().flatten())?;
        let to = if low == high { String::new() } else { format!(" to {}", significant(high, 4)) };
        Some(formula(&format!("{symbol} = {}{to}{unit}", significant(low, 4))))
    };
    let file = table.file().rsplit(['/', '\\']).next().map(String::from);
    let foundations = table.words("foundation").map(|words| format!("foundation {}", words.join(" or ")));
    let parts = [
        file,
        span("α", &["alpha", "dimensionless.alpha"], " rad"),
        foundations,
        span("η", &["eta", "dimensionless.eta"], ""),
        span("ξ_v", &["xi_v", "dimensionless.xi_v"], ""),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Splits a heading such as `PGV [m/s]` into an axis label and a suffix for numbers.
pub(crate) fn axis(heading: &str) -> (String, String) {
    let (measure, unit) = split_heading(heading);
    let (measure, unit) = (measure.replace("alpha", "α"), unit.unwrap_or("1").replace('2', "²"));
    match unit.as_str() {
        "1" => (measure, String::new()),
        _ => (format!("{measure} ({unit})"), format!(" {unit}")),
    }
}

/// Returns the name of the probability that a limit is exceeded.
pub fn probability_of(limit: Limit) -> String {
    match limit {
        Limit::Overturned => "probability of overturning".into(),
        Limit::Rotation(limit) => format!("probability of |θ|/α > {}", short(limit)),
        Limit::Slip(limit) => format!("probability of a slip above {} m", short(limit)),
    }
}

fn name(found: &Assessment) -> &'static str {
    match found.fit.link {
        Link::Probit => "lognormal fragility",
        Link::Logit => "logistic fragility",
    }
}

/// Rows with adjacent measures.
struct Bin {
    /// Mean of their measures.
    measure: f64,
    /// Mean of their fractions.
    fraction: f64,
    rows: usize,
}

/// Sorts the rows by measure into bins of similar size; rows with the same measure share a bin.
fn bins(observations: &[Observation]) -> Vec<Bin> {
    let mut rows: Vec<&Observation> = observations.iter().collect();
    rows.sort_by(|a, b| a.measures[0].total_cmp(&b.measures[0]));
    let count = (rows.len() / MIN_ROWS_OF_A_BIN).clamp(1, MAX_BINS);
    let size = rows.len().div_ceil(count);
    let mut bins: Vec<Vec<&Observation>> = vec![Vec::new()];
    for alike in rows.chunk_by(|a, b| a.measures[0] == b.measures[0]) {
        match bins.last_mut() {
            Some(last) if last.len() < size => last.extend(alike),
            _ => bins.push(alike.to_vec()),
        }
    }
    let mean = |rows: &[&Observation], value: fn(&Observation) -> f64| {
        rows.iter().map(|row| value(row)).sum::<f64>() / rows.len() as f64
    };
    bins.iter()
        .map(|rows| Bin {
            measure: mean(rows, |row| row.measures[0]),
            fraction: mean(rows, |row| row.fraction),
            rows: rows.len(),
        })
        .collect()
}
