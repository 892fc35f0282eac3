//! A fragility curve and its data → a drawing.

use crate::study::chart::{Chart, Curve, Sample, drawing, keys, keys_height, range, text};
use crate::study::fragility::{Assessment, Limit, Link, Observation};
use crate::study::look::Look;
use crate::study::picture::PictureError;
use crate::study::plot::short;

/// Height of the title (pixels).
const HEAD: u32 = 110;
/// Height of the chart (pixels).
const CHART: u32 = 1000;
/// Points of the curve and of its band.
const POINTS: u32 = 120;
/// Groups into which the rows are put in the order of the measure, as many in each.
const MOST_BINS: usize = 12;
/// Fewer rows make no fraction.
const LEAST_OF_A_BIN: usize = 5;

/// Draws a curve with its band, the fractions of rows that exceed the limit in groups of as many, with their counts, and each
/// row as a tick, under the chart if it does not exceed the limit and over it if it does. `heading` is name and unit of the
/// measure.
pub fn curve(found: &Assessment, heading: &str, limit: Limit, confidence: f64) -> Result<String, PictureError> {
    let observations = found.data.observations();
    let measures = || observations.iter().map(|row| row.measures[0]);
    let x = range(measures());
    let step = x.end / f64::from(POINTS);
    let at: Vec<f64> = (1..=POINTS).map(|point| step * f64::from(point)).collect();
    let line = at.iter().map(|&measure| (measure, found.fit.probability(&[measure]))).collect();
    let band = at.iter().zip(found.band(&at));
    let band = band.map(|(&measure, interval)| (measure, interval.low.unwrap_or(0.0), interval.high.unwrap_or(1.0)));
    let bins = bins(observations);
    // A row of which a part exceeds the limit is a point of its own.
    let (parts, whole): (Vec<&Observation>, Vec<&Observation>) =
        observations.iter().partition(|row| 0.0 < row.fraction && row.fraction < 1.0);
    let tick = |row: &&Observation| (row.measures[0], if row.fraction == 1.0 { 1.06 } else { -0.06 });
    let legend = [
        (Sample::Curve(Look::BLACK), name(found).into()),
        (Sample::Band, format!("{} % confidence", short(100.0 * confidence))),
        (Sample::Circle, "fraction of a group of rows, with their number".into()),
        (Sample::Ticks, "rows that exceed the limit (above) and that do not (below)".into()),
        (Sample::Cross, "rows of which a part does".into()),
    ];
    let legend = &legend[..if parts.is_empty() { 4 } else { 5 }];
    let (measure, unit) = heading.strip_suffix(']').and_then(|text| text.split_once(" [")).unwrap_or((heading, "1"));
    let unit = if unit == "1" { String::new() } else { format!(" {}", unit.replace('2', "²")) };
    let axis = measure.replace("alpha", "α") + &unit.replacen(' ', " (", 1) + if unit.is_empty() { "" } else { ")" };
    let ordinate = match limit {
        Limit::Overturned => "probability of overturning".to_string(),
        Limit::Rotation(limit) => format!("probability of |θ|/α > {}", short(limit)),
    };
    let chart = Chart {
        x: (&axis, x),
        y: (&ordinate, -0.1..1.1),
        areas: vec![band.collect()],
        curves: vec![Curve { look: Look::BLACK, pieces: vec![line], ends: false }],
        crosses: parts.iter().map(|row| (row.measures[0], row.fraction)).collect(),
        ticks: whole.iter().map(tick).collect(),
        notes: bins.iter().map(|bin| ((bin.measure + 0.9 * step, bin.fraction + 0.03), bin.rows.to_string())).collect(),
        circles: bins.iter().map(|bin| (bin.measure, bin.fraction)).collect(),
        ..Chart::default()
    };
    drawing(HEAD + keys_height(legend) + CHART, |root| {
        let (head, rest) = root.split_vertically(HEAD);
        let title = format!(
            "median {:.3}{unit}, β = {:.3}; AUC {:.3}, Brier score {:.3}; {} rows",
            found.fit.median(),
            found.fit.dispersion(),
            found.auc,
            found.brier,
            observations.len()
        );
        head.draw_text(&title, &text(38.0), (180, 40))?;
        let (head, body) = rest.split_vertically(keys_height(legend));
        keys(&head, legend)?;
        chart.draw(root, &body)
    })
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
