//! A history → a drawing: rotation, reactions, regimes and ground acceleration over one axis of time.

use std::ops::Range;

use crate::block::{Block, Foundation};
use crate::contact::Regime;
use crate::study::chart::{
    Area, Cell, Chart, Curve, Drawn, MOST_ROTATION, Sample, headed, keys, keys_height, range, rotations,
};
use crate::study::formula::formula;
use crate::study::history::{History, Row};
use crate::study::look::Look;
use crate::study::numerals::{short, significant};
use crate::study::picture::PictureError;

/// Heights of the panels: rotation, reactions, regimes, ground.
const HEIGHTS: [u32; 4] = [6200, 5000, 2900, 3400];

/// A line: its name, its look, and the value that it shows.
type Line<'a> = (&'static str, Look, &'a dyn Fn(&Row) -> f64);

/// A part of a drawing: its height, and what is drawn into it, on the whole drawing and the part.
type Panel<'a> = (u32, Box<dyn Fn(&Area, &Area) -> Drawn + 'a>);

/// Draws a history as SVG. `title` says what was run.
pub fn history(block: &Block, history: &History, title: &str) -> Result<String, PictureError> {
    let ended = history.ending.map(|(ending, time)| format!("; {ending} at t = {time:.3} s")).unwrap_or_default();
    let heading = [title.into(), formula(&format!("{}{ended}", block_line(block)))];
    let (alpha, weight, g) = (block.alpha, block.mass * block.gravity, block.gravity);
    let start = history.rows.first().map_or(0.0, |row| row.time);
    let end = history.rows.last().map_or(1.0, |row| row.time).max(start + 1e-9);
    let axis = |shown: bool| (if shown { "time (s)" } else { "" }, start..end);
    let moves = |of: usize| history.rows.iter().any(|row| row.ground[of] != 0.0);
    let has_ground = moves(0) || moves(1);

    let theta: Line = ("", Look::THIN, &|row| row.seen.theta / alpha);
    let left: Line = ("left corner N_L", Look::DARK, &|row| row.seen.reaction[0] / weight);
    let right: Line = ("right corner N_R", Look::LIGHT, &|row| row.seen.reaction[1] / weight);
    let horizontal: Line = ("horizontal", Look::THIN, &|row| row.ground[0] / g);
    let vertical: Line = ("vertical", Look::LIGHT, &|row| row.ground[1] / g);
    let values = |line: Line| history.rows.iter().map(line.2).collect::<Vec<f64>>();
    let rotation = Chart {
        title: beyond(history, alpha).unwrap_or_default(),
        x: axis(false),
        y: ("θ/α", rotations(values(theta).into_iter())),
        marks_alpha: true,
        ..Chart::default()
    };
    let of_ground: &[Line] = match (moves(0), moves(1)) {
        (true, true) => &[vertical, horizontal],
        (false, true) => &[vertical],
        (true, false) => &[("", horizontal.1, horizontal.2)],
        (false, false) => &[],
    };
    let [of_rotation, of_reactions, of_regimes, of_motion] = HEIGHTS;
    let mut panels: Vec<Panel> = vec![
        lines(history, of_rotation, rotation, &[theta]),
        lines(
            history,
            of_reactions,
            Chart { x: axis(false), y: ("N/(M g)", 0.0..0.0), ..Chart::default() },
            &[left, right],
        ),
        (of_regimes, Box::new(|root, area| regimes(history, axis(!has_ground)).draw(root, area))),
    ];
    if has_ground {
        let chart = Chart { x: axis(true), y: ("ground/g", 0.0..0.0), ..Chart::default() };
        panels.push(lines(history, of_motion, chart, of_ground));
    }
    headed(&heading, panels.iter().map(|panel| panel.0).sum(), |root, body| {
        let mut rest = body.clone();
        for (height, draw) in &panels {
            let (area, below) = rest.split_vertically(*height);
            draw(root, &area)?;
            rest = below;
        }
        Ok(())
    })
}

/// Where the rotation leaves the picture, in words.
fn beyond(history: &History, alpha: f64) -> Option<String> {
    let first = history.rows.iter().find(|row| row.seen.theta.abs() > MOST_ROTATION * alpha)?;
    let peak = significant(history.peaks.theta / alpha, 4);
    Some(format!("|θ|/α > {} from t = {} s on; its peak is {peak}", short(MOST_ROTATION), significant(first.time, 4)))
}

/// A chart of lines with their keys over it; an empty range becomes that of the lines.
fn lines<'a>(history: &'a History, height: u32, mut chart: Chart<'a>, lines: &[Line<'a>]) -> Panel<'a> {
    let samples: Vec<_> = lines
        .iter()
        .filter(|line| !line.0.is_empty())
        .map(|(name, look, _)| (Sample::Curve(*look), (*name).into()))
        .collect();
    chart.curves = lines
        .iter()
        .map(|&(_, look, value)| Curve { look, pieces: vec![thinned(&history.rows, value)], ends: false })
        .collect();
    if chart.y.1.is_empty() {
        chart.y.1 = range(chart.curves.iter().flat_map(|curve| &curve.pieces[0]).map(|point| point.1));
    }
    (
        height,
        Box::new(move |root, area| {
            let (head, body) = area.split_vertically(keys_height(&samples));
            keys(&head, &samples)?;
            chart.draw(root, &body)
        }),
    )
}

/// The block's parameters in a line.
pub fn block_line(block: &Block) -> String {
    let Block { alpha, p, xi_v, epsilon, r0, b, h, .. } = *block;
    let foundation = match block.foundation {
        Foundation::Viscoelastic => {
            format!("η = {}, ξ_v = {}, ε = {}", short(block.eta()), short(xi_v), short(epsilon))
        }
        Foundation::Rigid if block.restitution_factor == 1.0 => format!("rigid base, e = {:.4}", block.restitution()),
        Foundation::Rigid => {
            let factor = short(block.restitution_factor);
            format!("rigid base, e = {:.4}, {factor} × Housner's", block.restitution())
        }
    };
    format!(
        "α = {} rad, p = {} rad/s, {foundation} ({} m wide, {} m high, R0 = {} m)",
        short(alpha),
        short(p),
        significant(2.0 * b, 5),
        significant(2.0 * h, 5),
        significant(r0, 5)
    )
}

/// A lane for each regime: its place tells which corners touch.
fn regimes<'a>(history: &History, x: (&'a str, Range<f64>)) -> Chart<'a> {
    let separated = history.events.iter().any(|event| event.after == Regime::Separated);
    let lanes: &[(Regime, &str)] = &[
        (Regime::TiltingLeft, "on left"),
        (Regime::FullContact, "on both"),
        (Regime::TiltingRight, "on right"),
        (Regime::Separated, "on none"),
    ];
    let lanes = if separated { lanes } else { &lanes[..3] };
    let lane = |regime: Regime| lanes.iter().position(|lane| lane.0 == regime).unwrap_or(0) as f64;
    let mut since = x.1.start;
    let mut regime = history.rows.first().map_or(Regime::FullContact, |row| row.regime);
    let mut cells = Vec::new();
    let mut add = |regime, x: Range<f64>| {
        let grey = if regime == Regime::FullContact { 155 } else { 60 };
        cells.push(Cell { x, y: lane(regime) + 0.14..lane(regime) + 0.86, grey });
    };
    for event in &history.events {
        add(regime, since..event.time);
        (regime, since) = (event.after, event.time);
    }
    add(regime, since..x.1.end);
    let names = (0..).zip(lanes).map(|(i, (_, name))| (f64::from(i) + 0.5, *name)).collect();
    Chart { x, y: ("", 0.0..lanes.len() as f64), names, cells, ..Chart::default() }
}

/// The points of a line, at most four for each of some thousand stretches of time: the first, the least, the greatest and
/// the last, so that no peak is lost.
fn thinned(rows: &[Row], value: impl Fn(&Row) -> f64) -> Vec<(f64, f64)> {
    const STRETCHES: usize = 1500;
    let size = rows.len().div_ceil(STRETCHES).max(1);
    if size <= 4 {
        return rows.iter().map(|row| (row.time, value(row))).collect();
    }
    let mut points = Vec::with_capacity(4 * STRETCHES);
    for stretch in rows.chunks(size) {
        let by_value = |a: &&Row, b: &&Row| value(a).total_cmp(&value(b));
        let mut chosen =
            [stretch.first(), stretch.iter().min_by(by_value), stretch.iter().max_by(by_value), stretch.last()];
        chosen.sort_by(|a, b| {
            a.map(|row| row.time).partial_cmp(&b.map(|row| row.time)).unwrap_or(std::cmp::Ordering::Equal)
        });
        points.extend(chosen.into_iter().flatten().map(|row| (row.time, value(row))));
    }
    points
}
