//! A history → rotation, reactions, regimes and ground acceleration over time.

use std::ops::Range;

use crate::chart::{Chart, Curve, MAX_ROTATION, Tile, extents, rotations};
use crate::formula::formula;
use crate::labels;
use crate::line_style::LineStyle;
use crate::numerals::{short, significant};
use crate::page::{StackedChart, Symbol, stacked};
use crate::picture::PictureError;
use rocking_block::block::restraints::{MAX_TIES, tie};
use rocking_block::block::{Block, Body, Corner, Regime, Supports};
use rocking_studies::run::outcome::Holds;
use rocking_studies::run::{History, Row};

/// Heights of the panels: rotation, reactions, regimes, slip and links, ground.
const HEIGHTS: [u32; 5] = [6200, 5000, 2900, 3400, 4600];

/// Line styles of the forces of ties and dampers.
pub(crate) const LINKS: [LineStyle; MAX_TIES] = [
    LineStyle::BLUE,
    LineStyle::ORANGE,
    LineStyle::BLACK,
    LineStyle::DASHED,
    LineStyle::DOTTED,
    LineStyle::DASH_DOTTED,
    LineStyle::FAINT,
    LineStyle::THIN,
];

/// A quantity over time: its name in the legend, the style of its line, its value.
pub(crate) type Series<'a, R = Row> = (&'a str, LineStyle, &'a dyn Fn(&R) -> f64);

/// Draws a history as SVG, with a title for the run.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn history(block: &Block, history: &History, title: &str) -> Result<String, PictureError> {
    let ended = history.ending.map(|(ending, time)| format!("; {ending} at t = {time:.3} s")).unwrap_or_default();
    let heading = [title.into(), formula(&format!("{}{ended}", block_line(block)))];
    let (alpha, weight, g) = (block.alpha, block.mass * block.gravity, block.gravity);
    let start = history.rows.first().map_or(0.0, |row| row.time);
    let end = history.rows.last().map_or(1.0, |row| row.time).max(start + 1e-9);
    let axis = |shown: bool| (if shown { "time (s)" } else { "" }, start..end);
    let moves = |direction: usize| history.rows.iter().any(|row| row.ground[direction] != 0.0);
    let has_ground = moves(0) || moves(1);
    let rows = &history.rows;
    let panel = |height, chart, series: &[Series]| panel(rows, |row| row.time, height, chart, series);

    let theta: Series = ("", LineStyle::THIN, &|row| row.observation.theta / alpha);
    let left: Series = ("left corner N_L", LineStyle::BLUE, &|row| row.observation.reaction[0] / weight);
    let right: Series = ("right corner N_R", LineStyle::ORANGE, &|row| row.observation.reaction[1] / weight);
    let horizontal: Series = ("horizontal", LineStyle::THIN, &|row| row.ground[0] / g);
    let vertical: Series = ("vertical", LineStyle::ORANGE, &|row| row.ground[1] / g);
    let rotation = Chart {
        title: beyond(history, alpha).unwrap_or_default(),
        x: axis(false),
        y: ("θ/α", rotations(history.rows.iter().map(theta.2))),
        balance: Some([-block.alpha_of(Corner::Left) / alpha, block.alpha_of(Corner::Right) / alpha]),
        ..Chart::default()
    };
    let of_ground: &[Series] = match (moves(0), moves(1)) {
        (true, true) => &[vertical, horizontal],
        (false, true) => &[vertical],
        (true, false) => &[("", horizontal.1, horizontal.2)],
        (false, false) => &[],
    };
    let reactions = Chart { x: axis(false), y: ("N/(M g)", 0.0..0.0), ..Chart::default() };
    let mut panels = vec![
        panel(HEIGHTS[0], rotation, &[theta]),
        panel(HEIGHTS[1], reactions, &[left, right]),
        (HEIGHTS[2], Vec::new(), regimes(history, axis(!has_ground))),
    ];
    let holds = Holds::of(block);
    if holds.friction {
        // Round-off would fill the panel of a block that does not slide.
        let is_still = history.rows.iter().all(|row| row.slip.abs() < 1e-9);
        let ordinate = if is_still { -1.0..1.0 } else { 0.0..0.0 };
        let slip = Chart { x: axis(false), y: ("slip (mm)", ordinate), ..Chart::default() };
        let slip_of: Series = ("", LineStyle::THIN, &|row| 1e3 * row.slip);
        // Before the regimes, which carry the time axis if there is no ground motion.
        panels.insert(1, panel(HEIGHTS[3], slip, &[slip_of]));
    }
    let names = link_names(block);
    if holds.has_links() {
        let tensions = Chart { x: axis(false), y: ("T/(M g)", 0.0..0.0), ..Chart::default() };
        let value = |link: usize| move |row: &Row| row.observation.restraints[link].pull / weight;
        let values: Vec<_> = (0..names.len()).map(value).collect();
        let series: Vec<Series> = values
            .iter()
            .zip(&names)
            .zip(LINKS)
            .map(|((value, name), style)| -> Series { (name, style, value) })
            .collect();
        panels.insert(panels.len() - 1, panel(HEIGHTS[3], tensions, &series));
    }
    if has_ground {
        let ground = Chart { x: axis(true), y: ("ground acceleration (g)", 0.0..0.0), ..Chart::default() };
        panels.push(panel(HEIGHTS[4], ground, of_ground));
    }
    stacked(&heading, &[], &panels)
}

/// Describes a rotation beyond the ordinate.
fn beyond(history: &History, alpha: f64) -> Option<String> {
    let first = history.rows.iter().find(|row| row.observation.theta.abs() > MAX_ROTATION * alpha)?;
    let peak = significant(history.peaks.theta / alpha, 4);
    Some(format!("|θ|/α > {} after t = {} s; peak {peak}", short(MAX_ROTATION), significant(first.time, 4)))
}

/// Adds series and their legend to a chart. An empty ordinate takes the range of the series.
pub(crate) fn panel<'a, R>(
    rows: &[R],
    time: fn(&R) -> f64,
    height: u32,
    mut chart: Chart<'a>,
    series: &[Series<R>],
) -> StackedChart<'a> {
    let legend = series
        .iter()
        .filter(|(name, ..)| !name.is_empty())
        .map(|&(name, style, _)| (Symbol::Curve(style), name.into()))
        .collect();
    let curve = |&(_, style, value): &Series<R>| Curve::new(style, vec![thinned(rows, time, value)]);
    chart.curves = series.iter().map(curve).collect();
    if chart.y.1.is_empty() {
        [_, chart.y.1] = extents(&chart.curves);
    }
    (height, legend, chart)
}

/// Describes the parameters of a block in a line.
pub fn block_line(block: &Block) -> String {
    let Block { alpha, epsilon, body: Body { p, r0, b, h, .. }, .. } = *block;
    let e = block.restitution();
    let foundation = match block.ratios() {
        Supports::Viscoelastic(ratios) => labels::supports(ratios, epsilon, short),
        Supports::HOUSNER => format!("rigid base, e = {e:.4}"),
        rigid => {
            let factor = rigid.restitution_factor().map(short).unwrap_or_default();
            format!("rigid base, e = {e:.4}, {factor} × Housner's")
        }
    };
    let mut holds = String::new();
    if block.eccentricity != 0.0 {
        holds += &format!(", e_x = {} m", significant(block.eccentricity, 5));
    }
    if block.friction > 0.0 {
        holds += &format!(", μ = {}", short(block.friction));
    }
    let Holds { ties, dampers, .. } = Holds::of(block);
    for (count, one, several) in [(ties, "tie", "ties"), (dampers, "damper", "dampers")] {
        match count {
            0 => {}
            1 => holds += &format!(", 1 {one}"),
            count => holds += &format!(", {count} {several}"),
        }
    }
    format!(
        "α = {} rad, p = {} rad/s, {foundation}{holds} ({} m wide, {} m high, R0 = {} m)",
        short(alpha),
        short(p),
        significant(2.0 * b, 5),
        significant(2.0 * h, 5),
        significant(r0, 5)
    )
}

/// Returns the names of the ties and dampers, such as `tie 1`.
pub fn link_names(block: &Block) -> Vec<String> {
    tie::names(block.ties()).into_iter().map(|name| name.replace('_', " ")).collect()
}

/// Draws the regimes in rows, one for each set of touching corners.
fn regimes<'a>(history: &History, x: (&'a str, Range<f64>)) -> Chart<'a> {
    let separated = history.events.iter().any(|event| event.after == Regime::Separated);
    let rows: &[(Regime, &str)] = &[
        (Regime::TiltingLeft, "on left"),
        (Regime::FullContact, "on both"),
        (Regime::TiltingRight, "on right"),
        (Regime::Separated, "on none"),
    ];
    let rows = if separated { rows } else { &rows[..3] };
    let row = |regime: Regime| rows.iter().position(|row| row.0 == regime).unwrap_or(0) as f64;
    let mut since = x.1.start;
    let mut regime = history.rows.first().map_or(Regime::FullContact, |row| row.regime);
    let mut tiles = Vec::new();
    let mut add = |regime, x: Range<f64>| {
        let grey = if regime == Regime::FullContact { 155 } else { 60 };
        tiles.push(Tile { x, y: row(regime) + 0.14..row(regime) + 0.86, grey });
    };
    for event in &history.events {
        add(regime, since..event.time);
        (regime, since) = (event.after, event.time);
    }
    add(regime, since..x.1.end);
    let names = (0..).zip(rows).map(|(i, (_, name))| (f64::from(i) + 0.5, (*name).into())).collect();
    Chart { x, y: ("", 0.0..rows.len() as f64), names, tiles, ..Chart::default() }
}

/// Thins a series without losing a peak.
///
/// Each of at most 1500 stretches of time keeps its first, least, greatest and last point.
pub fn thinned<T>(rows: &[T], time: impl Fn(&T) -> f64, value: impl Fn(&T) -> f64) -> Vec<(f64, f64)> {
    const STRETCHES: usize = 1500;
    let size = rows.len().div_ceil(STRETCHES).max(1);
    if size <= 4 {
        return rows.iter().map(|row| (time(row), value(row))).collect();
    }
    let mut points = Vec::with_capacity(4 * STRETCHES);
    for stretch in rows.chunks(size) {
        let by_value = |a: &&T, b: &&T| value(a).total_cmp(&value(b));
        let mut chosen =
            [stretch.first(), stretch.iter().min_by(by_value), stretch.iter().max_by(by_value), stretch.last()];
        chosen.sort_by(|a, b| a.map(&time).partial_cmp(&b.map(&time)).unwrap_or(std::cmp::Ordering::Equal));
        points.extend(chosen.into_iter().flatten().map(|row| (time(row), value(row))));
    }
    points
}
