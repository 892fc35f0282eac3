//! Fragility curves and surfaces, curves of incremental dynamic analysis → drawings.

use std::ops::Range;

use crate::study::chart::{Cell, Chart, Curve, Sample, headed, keys, keys_height, range, rotations};
use crate::study::formula::formula;
use crate::study::fragility::{Assessment, Data, Fit, Ida, Limit, Link, Observation, Response, Table};
use crate::study::look::Look;
use crate::study::normal;
use crate::study::numerals::{short, significant};
use crate::study::picture::PictureError;

/// Height of the chart.
const CHART: u32 = 10_000;
/// Points of the curve and of its band.
const POINTS: u32 = 1200;
/// Groups into which the rows are put in the order of the measure, as many in each.
const MOST_BINS: usize = 12;
/// Fewer rows make no fraction.
const LEAST_OF_A_BIN: usize = 5;

/// Draws a curve with its band, the fractions of rows that exceed the limit in groups of as many, with their counts, and each
/// row as a tick. `blocks` tells the blocks, `heading` is name and unit of the measure.
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
    let line = at.iter().map(|&measure| (measure, found.fit.probability(&[measure]))).collect();
    let band = at.iter().zip(found.band(&at));
    let band = band.map(|(&measure, interval)| (measure, interval.low.unwrap_or(0.0), interval.high.unwrap_or(1.0)));
    let bins = bins(observations);
    // Rows of the same level stand side by side.
    let tick = |(number, row): (usize, &Observation)| {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let aside = (GOLDEN * number as f64).fract() - 0.5;
        let y = match row.fraction {
            0.0 => -0.06,
            1.0 => 1.06,
            part => part,
        };
        (row.measures[0] + 1.5 * side * aside, y)
    };
    let legend = [
        (Sample::Curve(Look::BLACK), name(found).into()),
        (Sample::Band, format!("{} % confidence", short(100.0 * confidence))),
        (Sample::Circle, "fraction of a group of rows, with their number".into()),
        (
            Sample::Ticks,
            "each row: above the chart if it exceeds the limit, below if not, between if a part does".into(),
        ),
    ];
    let (axis, unit) = axis(heading);
    let ordinate = probability_of(limit);
    let chart = Chart {
        x: (&axis, x),
        y: (&ordinate, -0.1..1.1),
        areas: vec![band.collect()],
        curves: vec![Curve { look: Look::BLACK, pieces: vec![line], ends: false }],
        ticks: observations.iter().enumerate().map(tick).collect(),
        notes: bins.iter().map(|bin| ((bin.measure + 0.9 * side, bin.fraction + 0.03), bin.rows.to_string())).collect(),
        circles: bins.iter().map(|bin| (bin.measure, bin.fraction)).collect(),
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
    page(&title, blocks, &legend, &chart)
}

/// Draws the peaks over the levels of a measure for each block and ground motion, with their fractiles. A curve goes to the
/// right edge where its block overturns at the next level, and comes back where it stands again.
pub fn ida(blocks: &str, found: &Ida, heading: &str) -> Result<String, PictureError> {
    let stands = |response: &Response| match *response {
        Response::Stands(peak) => Some(peak),
        Response::Overturns | Response::Unknown => None,
    };
    let peaks = found.curves.iter().flatten().filter_map(stands);
    let (x, y) = (rotations(peaks), range(found.levels.iter().copied()));
    let pieces = |responses: &[Response]| {
        // At rest without shaking.
        let mut pieces = vec![vec![(0.0, 0.0)]];
        for (response, &level) in responses.iter().zip(&found.levels) {
            let open = pieces.len() - 1;
            match *response {
                Response::Stands(peak) => pieces[open].push((peak, level)),
                Response::Overturns => {
                    if let Some(&(_, before)) = pieces[open].last() {
                        pieces[open].push((x.end, before + 0.5 * (level - before)));
                        pieces.push(Vec::new());
                    }
                }
                Response::Unknown => pieces.push(Vec::new()),
            }
        }
        pieces
    };
    let curve = |look: Look, responses: &[Response]| Curve { look, pieces: pieces(responses), ends: false };
    let single = found.curves.iter().map(|responses| curve(Look::FAINT, responses));
    let fractiles = [(Look::DASHED, 0.16), (Look::BLACK, 0.5), (Look::DASHED, 0.84)];
    let fractiles = fractiles.map(|(look, part)| curve(look, &found.fractile(part)));
    let (axis, _) = axis(heading);
    let chart = Chart {
        x: ("peak |θ|/α", x.clone()),
        y: (&axis, y),
        curves: single.chain(fractiles).collect(),
        verticals: if x.contains(&1.0) { vec![(Look::LEVEL, 1.0)] } else { Vec::new() },
        ..Chart::default()
    };
    let legend = [
        (Sample::Curve(Look::FAINT), "one block and ground motion; to the right edge where it overturns".to_string()),
        (Sample::Curve(Look::BLACK), "median".into()),
        (Sample::Curve(Look::DASHED), "16 % and 84 %".into()),
    ];
    let title = format!(
        "{} curves, {} levels; overturning counts as more than any peak",
        found.curves.len(),
        found.levels.len()
    );
    page(&title, blocks, &legend, &chart)
}

/// Draws the probability of a surface of two measures in grey, with the lines on which it is 10, 50 and 90 %, and the rows.
pub fn surface(
    blocks: &str,
    data: &Data,
    fit: &Fit,
    headings: [&str; 2],
    limit: Limit,
) -> Result<String, PictureError> {
    const CELLS: u32 = 80;
    let observations = data.observations();
    let [x, y] = [0, 1].map(|measure| range(observations.iter().map(|row| row.measures[measure])));
    let part = |range: &Range<f64>, cell: u32| range.end * f64::from(cell) / f64::from(CELLS);
    let cell = |number: u32| {
        let sides = [(&x, number % CELLS), (&y, number / CELLS)].map(|(range, i)| part(range, i)..part(range, i + 1));
        let middle = [0, 1].map(|side: usize| 0.5 * (sides[side].start + sides[side].end));
        let [x, y] = sides;
        // Dark enough for what is drawn over it to be seen.
        Cell { x, y, grey: 255 - (130.0 * fit.probability(&middle)).round() as u8 }
    };
    let line = |deviate: f64| {
        let [a, b, c] = [0, 1, 2].map(|i| fit.coefficients[i]);
        // a + b ln x + c ln y = deviate, along the axis that crosses it.
        let points = (1..=4 * CELLS).map(|i| {
            let along = f64::from(i) / f64::from(4 * CELLS);
            if b.abs() < c.abs() {
                let at = along * x.end;
                (at, libm::exp((deviate - a - b * libm::log(at)) / c))
            } else {
                let at = along * y.end;
                (libm::exp((deviate - a - c * libm::log(at)) / b), at)
            }
        });
        points.filter(|(at_x, at_y)| *at_x <= x.end && *at_y <= y.end).collect::<Vec<_>>()
    };
    let deviates = match fit.link {
        Link::Probit => [0.1, 0.5, 0.9].map(normal::quantile),
        Link::Logit => [0.1_f64, 0.5, 0.9].map(|part| libm::log(part / (1.0 - part))),
    };
    let looks = [Look::DASHED, Look::BLACK, Look::DASHED];
    let curves =
        deviates.into_iter().zip(looks).map(|(deviate, look)| Curve { look, pieces: vec![line(deviate)], ends: false });
    let of = |exceeds: bool| {
        observations
            .iter()
            .filter(move |row| (row.fraction >= 0.5) == exceeds)
            .map(|row| (row.measures[0], row.measures[1]))
    };
    let [(axis_x, _), (axis_y, _)] = headings.map(axis);
    let chart = Chart {
        x: (&axis_x, x.clone()),
        y: (&axis_y, y.clone()),
        cells: (0..CELLS * CELLS).map(cell).collect(),
        curves: curves.collect(),
        crosses: of(true).collect(),
        circles: of(false).collect(),
        ..Chart::default()
    };
    let legend = [
        (Sample::Curve(Look::BLACK), "50 %".to_string()),
        (Sample::Curve(Look::DASHED), "10 % and 90 %".into()),
        (Sample::Cross, "rows of which half or more exceed the limit".into()),
        (Sample::Circle, "the others".into()),
    ];
    page(&format!("{}, {} rows", probability_of(limit), observations.len()), blocks, &legend, &chart)
}

/// File, slenderness and foundation of the blocks of a table, where it has them.
pub fn blocks(table: &Table) -> String {
    let span = |symbol: &str, names: &[&str], unit: &str| {
        let numbers = names.iter().find_map(|name| table.numbers(name).ok())?;
        let [low, high] = [f64::min, f64::max].map(|of| numbers.iter().flatten().copied().reduce(of));
        let (low, high) = (low?, high?);
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

/// Draws a chart under its title, its blocks and its keys.
fn page(title: &str, blocks: &str, legend: &[(Sample, String)], chart: &Chart) -> Result<String, PictureError> {
    headed(&[title.into(), blocks.into()], keys_height(legend) + CHART, |root, rest| {
        let (head, body) = rest.split_vertically(keys_height(legend));
        keys(&head, legend)?;
        chart.draw(root, &body)
    })
}

/// The name of an axis and a blank with the unit, if it has one, of a heading such as `PGV [m/s]`.
fn axis(heading: &str) -> (String, String) {
    let (measure, unit) = heading.strip_suffix(']').and_then(|text| text.split_once(" [")).unwrap_or((heading, "1"));
    let (measure, unit) = (measure.replace("alpha", "α"), unit.replace('2', "²"));
    match unit.as_str() {
        "1" => (measure, String::new()),
        _ => (format!("{measure} ({unit})"), format!(" {unit}")),
    }
}

fn probability_of(limit: Limit) -> String {
    match limit {
        Limit::Overturned => "probability of overturning".into(),
        Limit::Rotation(limit) => format!("probability of |θ|/α > {}", short(limit)),
    }
}

fn name(found: &Assessment) -> &'static str {
    match found.fit.link {
        Link::Probit => "lognormal fragility",
        Link::Logit => "logistic fragility",
    }
}

/// Rows whose measures are next to each other.
struct Bin {
    /// Mean of their measures.
    measure: f64,
    /// Mean of their fractions.
    fraction: f64,
    rows: usize,
}

/// The rows in the order of the measure, in groups of as many, of which those with the same measure are not parted.
fn bins(observations: &[Observation]) -> Vec<Bin> {
    let mut rows: Vec<&Observation> = observations.iter().collect();
    rows.sort_by(|a, b| a.measures[0].total_cmp(&b.measures[0]));
    let count = (rows.len() / LEAST_OF_A_BIN).clamp(1, MOST_BINS);
    let size = rows.len().div_ceil(count);
    let mut bins: Vec<Vec<&Observation>> = vec![Vec::new()];
    for alike in rows.chunk_by(|a, b| a.measures[0] == b.measures[0]) {
        match bins.last_mut() {
            Some(last) if last.len() < size => last.extend(alike),
            _ => bins.push(alike.to_vec()),
        }
    }
    let mean = |rows: &[&Observation], of: fn(&Observation) -> f64| {
        rows.iter().map(|row| of(row)).sum::<f64>() / rows.len() as f64
    };
    bins.iter()
        .map(|rows| Bin {
            measure: mean(rows, |row| row.measures[0]),
            fraction: mean(rows, |row| row.fraction),
            rows: rows.len(),
        })
        .collect()
}
