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
    Assessment, DESCRIBED, Goodness, Ida, Interval, Limit, Link, Observation, Response, Surface, SweepTable,
    split_heading,
};
use rocking_studies::statistics::{self, normal};

/// Height of the chart.
const HEIGHT: u32 = 10_000;
/// Points of the curve and of its band.
const POINTS: u32 = 1200;
/// Curves of incremental dynamic analysis beyond which a picture shows their density.
const MAX_CURVES: usize = 60;
/// Cells of the density along both axes.
const CELLS: [usize; 2] = [150, 100];
/// Darkest grey of the density, on which the fractiles stay visible.
const DARKEST: f64 = 90.0;

/// Draws a fragility curve with its band and the fractions of binned rows. Each row is a tick.
///
/// `blocks` describes the blocks; `heading` is name and unit of the measure.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn curve(
    blocks: &str,
    found: &Assessment,
    heading: &str,
    limit: Limit,
    confidence: f64,
) -> Result<String, PictureError> {
    let observations = found.marks();
    let measures = || observations.iter().map(|row| row.measures[0]);
    let x = range(measures());
    let at = spread(x.end, POINTS);
    let side = x.end / 120.0;
    let curve = at.iter().map(|&measure| (measure, found.fit.probability(&[measure]))).collect();
    let band = band(&at, &found.band(&at));
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
    let rows = match observations.len() < found.rows {
        true => "some of the rows: above the chart if they exceed the limit, below if not, between if a part does",
        false => "each row: above the chart if it exceeds the limit, below if not, between if a part does",
    };
    let ticks = observations.iter().enumerate().map(|row| (Mark::Tick, tick(row)));
    let groups = &found.groups;
    let circles = groups.iter().map(|group| (Mark::Circle, (group.measure, group.fraction)));
    let (axis, unit) = axis(heading);
    let ordinate = probability_of(limit);
    let chart = Chart {
        x: (&axis, x),
        y: (&ordinate, -0.1..1.1),
        areas: vec![band],
        curves: vec![Curve::new(LineStyle::BLACK, vec![curve])],
        marks: ticks.chain(circles).collect(),
        notes: groups
            .iter()
            .map(|group| ((group.measure + 0.9 * side, group.fraction + 0.03), group.rows.to_string()))
            .collect(),
        ..Chart::default()
    };
    let mut legend = vec![
        (Symbol::Curve(LineStyle::BLACK), name(found).into()),
        (Symbol::Mark(Mark::Circle), "fraction of a group of rows, with their number".into()),
        (Symbol::Mark(Mark::Tick), rows.into()),
    ];
    if chart.shows_band() {
        legend.insert(1, (Symbol::Band, format!("{} % confidence", short(100.0 * confidence))));
    }
    let title = format!(
        "median {}{unit}, β = {}; AUC {:.3}, Brier score {:.3}; {} rows",
        significant(found.fit.median(), 4),
        significant(found.fit.dispersion(), 4),
        found.auc,
        found.brier,
        found.rows
    );
    page(&[title, misfit(found, &unit), blocks.into()], &legend, HEIGHT, |root, area| chart.draw(root, area))
}

/// Returns measures from above zero to `end` at even distances.
pub(crate) fn spread(end: f64, points: u32) -> Vec<f64> {
    (1..=points).map(|point| end * f64::from(point) / f64::from(points)).collect()
}

/// Returns the area of intervals of a probability at these measures.
pub(crate) fn band(at: &[f64], intervals: &[Interval]) -> Vec<(f64, f64, f64)> {
    let ends = |(&measure, [low, high]): (&f64, &Interval)| (measure, low.unwrap_or(0.0), high.unwrap_or(1.0));
    at.iter().zip(intervals).map(ends).collect()
}

/// Names the groups of rows outside the band by more than half a row. The test of the fit follows.
fn misfit(found: &Assessment, unit: &str) -> String {
    let measures: Vec<f64> = found.groups.iter().map(|group| group.measure).collect();
    let bands = band(&measures, &found.band(&measures));
    let outside = found.groups.iter().zip(bands).filter(|(group, (_, low, high))| {
        let half = 0.5 / group.rows as f64;
        group.fraction + half < *low || group.fraction - half > *high
    });
    let outside: Vec<String> = outside.map(|(group, _)| significant(group.measure, 3)).collect();
    let places = if outside.is_empty() { String::new() } else { format!(", at {}{unit}", outside.join(", ")) };
    let groups = format!("groups outside the band: {} of {}{places}", outside.len(), found.groups.len());
    match found.goodness() {
        Some(Goodness { deviance, degrees_of_freedom, p }) => format!(
            "{groups}; deviance {} (df = {degrees_of_freedom}), p = {}",
            significant(deviance, 3),
            significant(p, 2)
        ),
        None => groups,
    }
}

/// Draws the curves of several limits, each with its name, over the measure with this heading.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn states(title: &str, curves: &[(String, &Assessment)], heading: &str) -> Result<String, PictureError> {
    let measures = curves.iter().flat_map(|(_, found)| found.marks()).map(|row| row.measures[0]);
    let x = range(measures);
    let at = spread(x.end, POINTS);
    let line = |found: &Assessment| at.iter().map(|&measure| (measure, found.fit.probability(&[measure]))).collect();
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

/// Draws the peaks over the levels of a measure, with their fractiles. Each block under each ground motion is a curve. Many curves are a
/// density.
///
/// A curve leaves to the right edge at the level at which its block overturns, and returns at that at which it stands again.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn ida(blocks: &str, found: &Ida, heading: &str) -> Result<String, PictureError> {
    let stands = |response: &Response| match *response {
        Response::Stands(peak) => Some(peak),
        Response::Overturns | Response::Unknown => None,
    };
    let peaks = found.curves.iter().flat_map(|curve| &curve.responses).filter_map(stands);
    let levels = found.curves.iter().flat_map(|curve| &curve.levels).copied();
    let (x, y) = (rotations(peaks), range(levels));
    let is_dense = found.curves.len() > MAX_CURVES;
    let single = found
        .curves
        .iter()
        .filter(|_| !is_dense)
        .map(|curve| Curve::new(LineStyle::FAINT, segments(&curve.responses, &curve.levels, x.end)));
    let fractiles = [(LineStyle::DOTTED, 0.16), (LineStyle::BLACK, 0.5), (LineStyle::DASHED, 0.84)];
    let fractiles =
        fractiles.map(|(style, fraction)| (style, fraction, segments(&found.fractile(fraction), &found.levels, x.end)));
    let names = fractiles.iter().filter_map(|(_, fraction, segments)| {
        let (peak, level) = segments.iter().flatten().copied().reduce(|a, b| if b.0 > a.0 { b } else { a })?;
        let below = (peak - 0.06 * x.end, level + 0.02 * y.end);
        Some((below, format!("{} %", short(100.0 * fraction))))
    });
    let (axis, _) = axis(heading);
    let chart = Chart {
        x: (&format!("peak {}", found.rotation), x.clone()),
        y: (&axis, y.clone()),
        tiles: if is_dense { density(found, &x, &y) } else { Vec::new() },
        notes: names.collect(),
        verticals: if x.contains(&1.0) { vec![(LineStyle::LEVEL, 1.0)] } else { Vec::new() },
        curves: single.chain(fractiles.into_iter().map(|(style, _, segments)| Curve::new(style, segments))).collect(),
        ..Chart::default()
    };
    const LEAVES: &str = "to the right edge at the level at which it overturns";
    let one = match is_dense {
        true => (Symbol::Grey(DARKEST as u8), format!("more curves of one block and ground motion, {LEAVES}")),
        false => (Symbol::Curve(LineStyle::FAINT), format!("one block and ground motion, {LEAVES}")),
    };
    let legend = [
        one,
        (Symbol::Curve(LineStyle::DOTTED), "peak that 16 % of the curves do not exceed".into()),
        (Symbol::Curve(LineStyle::BLACK), "50 %".into()),
        (Symbol::Curve(LineStyle::DASHED), "84 %".into()),
    ];
    let levels = match found.curves.iter().all(|curve| curve.levels.len() == found.levels.len()) {
        true => format!("{} levels", found.levels.len()),
        false => format!("{} runs", found.curves.iter().map(|curve| curve.levels.len()).sum::<usize>()),
    };
    let title = format!("{} curves, {levels}; overturning counts as more than any peak", found.curves.len());
    page(&[title, blocks.into()], &legend, HEIGHT, |root, area| chart.draw(root, area))
}

/// Returns the segments of a curve over its levels, from rest without shaking. Peaks beyond the right edge are on it.
fn segments(responses: &[Response], levels: &[f64], edge: f64) -> Vec<Vec<(f64, f64)>> {
    let mut segments = vec![vec![(0.0, 0.0)]];
    let mut is_outside = false;
    for (response, &level) in responses.iter().zip(levels) {
        let open = segments.len() - 1;
        let last = segments[open].last().copied();
        match *response {
            Response::Stands(peak) if peak < edge => {
                // From the edge it returns at its level.
                segments[open].extend(is_outside.then_some((edge, level)));
                segments[open].push((peak, level));
                is_outside = false;
            }
            Response::Stands(_) | Response::Overturns => {
                if let (false, Some((peak, _))) = (is_outside, last) {
                    segments[open].extend([(peak, level), (edge, level)]);
                    segments.push(Vec::new());
                }
                is_outside = true;
            }
            Response::Unknown => {
                segments.push(Vec::new());
                is_outside = false;
            }
        }
    }
    segments
}

/// Returns grey cells, darker where more curves pass; each curve counts once per cell.
fn density(found: &Ida, x: &Range<f64>, y: &Range<f64>) -> Vec<Tile> {
    let [columns, rows] = CELLS;
    let mut counts = vec![0_u32; columns * rows];
    let cell = |position: f64, range: &Range<f64>, count: usize| {
        ((position / range.end * count as f64) as usize).min(count - 1)
    };
    for curve in &found.curves {
        let mut passed: Vec<usize> = Vec::new();
        for segment in segments(&curve.responses, &curve.levels, x.end) {
            for pair in segment.windows(2) {
                // Steps of half a cell.
                let spans =
                    [(pair[1].0 - pair[0].0) / x.end * columns as f64, (pair[1].1 - pair[0].1) / y.end * rows as f64];
                let steps = (2.0 * spans[0].abs().max(spans[1].abs())).ceil().max(1.0);
                passed.extend((0..=steps as usize).map(|step| {
                    let fraction = step as f64 / steps;
                    let at = |a: f64, b: f64| a + fraction * (b - a);
                    let row = cell(at(pair[0].1, pair[1].1), y, rows);
                    row * columns + cell(at(pair[0].0, pair[1].0), x, columns)
                }));
            }
        }
        passed.sort_unstable();
        passed.dedup();
        passed.into_iter().for_each(|cell| counts[cell] += 1);
    }
    // All curves begin at rest: the few darkest cells are alike.
    let mut sorted: Vec<u32> = counts.iter().copied().filter(|&count| count > 0).collect();
    sorted.sort_unstable();
    let most = sorted.get(sorted.len() * 49 / 50).map_or(1.0, |&count| f64::from(count));
    let edges = |cell: usize, range: &Range<f64>, count: usize| {
        let edge = |cell: usize| range.end * cell as f64 / count as f64;
        edge(cell)..edge(cell + 1)
    };
    let tile = |(number, &count): (usize, &u32)| Tile {
        x: edges(number % columns, x, columns),
        y: edges(number / columns, y, rows),
        // The square root shows single curves beside many.
        grey: (250.0 - (250.0 - DARKEST) * (f64::from(count) / most).min(1.0).sqrt()).round() as u8,
    };
    counts.iter().enumerate().filter(|(_, count)| **count > 0).map(tile).collect()
}

/// Draws a fragility surface of two measures in grey. It has the lines of 10, 50 and 90 %, and the rows.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn surface(blocks: &str, found: &Surface, headings: [&str; 2], limit: Limit) -> Result<String, PictureError> {
    /// Tiles along each axis.
    const TILES: u32 = 80;
    let (observations, fit) = (&found.marks, &found.fit);
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
    let title = format!("{}, {} rows", probability_of(limit), found.rows);
    page(&[title, blocks.into()], &legend, HEIGHT, |root, area| chart.draw(root, area))
}

/// File, slenderness and foundations of a table, as far as its columns show.
#[derive(Default)]
pub struct Blocks {
    file: Option<String>,
    /// Ranges of [`DESCRIBED`].
    spans: [Option<[f64; 2]>; 3],
    foundations: Option<Vec<String>>,
    is_in_space: bool,
}

impl Blocks {
    /// Takes rows of a table.
    pub fn take(&mut self, table: &SweepTable) {
        self.is_in_space = table.is_in_space();
        self.file = table.file.rsplit(['/', '\\']).next().map(String::from);
        for (span, name) in self.spans.iter_mut().zip(DESCRIBED) {
            let names = [name.to_string(), format!("dimensionless.{name}")];
            let numbers = names.iter().find_map(|name| table.numbers(name).ok()).unwrap_or_default();
            *span = statistics::range(numbers.into_iter().flatten().chain(span.iter().flatten().copied()));
        }
        if let Some(words) = table.words("foundation") {
            let known = self.foundations.get_or_insert_default();
            words.into_iter().for_each(|word| {
                if !known.contains(&word) {
                    known.push(word)
                }
            });
        }
    }

    /// Describes a table.
    pub fn of(table: &SweepTable) -> String {
        let mut blocks = Blocks::default();
        blocks.take(table);
        blocks.to_string()
    }
}

impl std::fmt::Display for Blocks {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let span = |span: Option<[f64; 2]>, symbol: &str, unit: &str| {
            let [low, high] = span?;
            let to = if low == high { String::new() } else { format!(" to {}", significant(high, 4)) };
            Some(formula(&format!("{symbol} = {}{to}{unit}", significant(low, 4))))
        };
        let [alpha, eta, xi_v] = self.spans;
        let foundations = self.foundations.as_ref().map(|words| format!("foundation {}", words.join(" or ")));
        let in_space = self.is_in_space.then(|| "blocks in space".to_string());
        let parts = [
            self.file.clone(),
            in_space,
            span(alpha, "α", " rad"),
            foundations,
            span(eta, "η", ""),
            span(xi_v, "ξ_v", ""),
        ];
        f.write_str(&parts.into_iter().flatten().collect::<Vec<_>>().join(", "))
    }
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
        Limit::Balance => "probability of passing the balance".into(),
        Limit::Rotation(limit) => format!("probability of |θ|/α > {}", short(limit)),
        Limit::Slip(limit) => format!("probability of a slip above {} m", short(limit)),
        Limit::Plastic(limit) => format!("probability of a plastic elongation above {} m", short(limit)),
        Limit::HalfCycles(limit) => format!("probability of more than {} half cycles", short(limit)),
        Limit::Breaks => "probability of a broken tie or damper".into(),
        Limit::Tilt(limit) => format!("probability of a tilt above {} of that of the balance", short(limit)),
        Limit::Twist(limit) => format!("probability of a twist above {} rad", short(limit)),
        Limit::Drift(limit) => format!("probability of a drift above {} m", short(limit)),
    }
}

fn name(found: &Assessment) -> &'static str {
    match found.fit.link {
        Link::Probit => "lognormal fragility",
        Link::Logit => "logistic fragility",
    }
}

#[cfg(test)]
mod tests {
    use rocking_studies::fragility::IdaCurve;

    use super::*;

    /// A block that overturns at 0.2 and 0.3 and stands at 0.4. Its peak is beyond the edge at 0.5.
    #[test]
    fn curves_leave_and_return_at_their_levels() {
        let responses = [
            Response::Stands(0.5),
            Response::Overturns,
            Response::Overturns,
            Response::Stands(0.8),
            Response::Stands(1.7),
        ];
        let found = segments(&responses, &[0.1, 0.2, 0.3, 0.4, 0.5], 1.5);
        let drawn: Vec<_> = found.iter().filter(|segment| segment.len() > 1).cloned().collect();
        assert_eq!(
            drawn,
            [
                vec![(0.0, 0.0), (0.5, 0.1), (0.5, 0.2), (1.5, 0.2)],
                vec![(1.5, 0.4), (0.8, 0.4), (0.8, 0.5), (1.5, 0.5)]
            ]
        );
    }

    /// Of many curves the picture shows cells, the darkest where all begin, and both fractiles by name.
    #[test]
    fn many_curves_are_a_density_with_named_fractiles() {
        let curve = |number: usize| IdaCurve {
            name: String::new(),
            levels: vec![0.1, 0.2],
            responses: vec![Response::Stands(0.01 * number as f64), Response::Overturns],
        };
        let picture = |count: usize| {
            let found = Ida {
                levels: vec![0.1, 0.2],
                curves: (1..=count).map(curve).collect(),
                rotation: "|θ|/α",
                breaks: None,
            };
            ida("", &found, "PGV [m/s]").unwrap()
        };
        let [few, many] = [MAX_CURVES, MAX_CURVES + 1].map(picture);
        assert!(few.matches("<rect").count() < 10 && many.matches("<rect").count() > 200);
        assert!(few.matches("<polyline").count() > many.matches("<polyline").count() + MAX_CURVES / 2);
        assert!(["16 %", "50 %", "84 %"].iter().all(|name| many.contains(name)));
        assert!(many.matches("<rect").count() == many.matches("<rect shape-rendering=\"crispEdges\"").count());
    }
}
