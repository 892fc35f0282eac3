//! A history in space → tilt and its direction, twist, forces and contacts of the feet, slip and ground accelerations over time.

use std::ops::Range;

use crate::chart::{Chart, Curve, MAX_ROTATION, Tile, rotations};
use crate::formula::formula;
use crate::history::{Series, panel};
use crate::line_style::LineStyle;
use crate::numerals::{short, significant};
use crate::page::{StackedChart, Symbol, stacked};
use crate::picture::PictureError;
use rocking_block::space::outputs::FootObservation;
use rocking_block::space::{Base, SpaceBody, SpaceEventKind, SpaceParameters};
use rocking_studies::space::{HistoryInSpace, RowInSpace, RunInSpace, foot_names};

/// Heights of the panels: tilt, direction, twist, forces, slip, ground.
const HEIGHTS: [u32; 6] = [5600, 3500, 2900, 4400, 3200, 4600];
/// Heights of the contacts: of a row of few feet, and of all rows of many.
const OF_CONTACTS: [u32; 2] = [520, 4400];
/// Feet that have a curve each.
const MAX_CURVES: usize = 4;
/// Tilt over the greatest one below which its direction is not drawn.
const NO_DIRECTION: f64 = 0.01;

/// Grey levels of feet that stick and slide.
const STICKS: u8 = 165;
const SLIDES: u8 = 40;

/// Draws a history as SVG, with a title for the run.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn history(run: &RunInSpace, history: &HistoryInSpace, title: &str) -> Result<String, PictureError> {
    let (body, rows) = (&run.setup.body, &history.rows);
    let ended = history.ending.map(|(ending, time)| format!("; {ending} at t = {time:.3} s")).unwrap_or_default();
    let heading = [title.into(), formula(&format!("block in space: {}{ended}", block_line(&run.parameters, body)))];
    let (weight, g) = (body.mass * body.gravity, body.gravity);
    let time = |row: &RowInSpace| row.observation.time;
    let start = rows.first().map_or(0.0, time);
    let end = rows.last().map_or(1.0, time).max(start + 1e-9);
    let moves = |direction: usize| rows.iter().any(|row| row.ground[direction] != 0.0);
    let has_ground = (0..3).any(moves);
    let axis = |shown: bool| (if shown { "time (s)" } else { "" }, start..end);
    let panel = |height, chart, series: &[Series<RowInSpace>]| panel(rows, time, height, chart, series);

    let tilt: [Series<RowInSpace>; 3] = [
        ("θ", LineStyle::WIDE_GREY, &|row| row.tilt_over_critical),
        ("θ_x", LineStyle::BLUE, &|row| of_critical(row, row.observation.attitude.tilt_x)),
        ("θ_y", LineStyle::ORANGE, &|row| of_critical(row, row.observation.attitude.tilt_y)),
    ];
    let values = rows.iter().flat_map(|row| tilt.iter().map(move |(.., value)| value(row)));
    let of_tilt = Chart {
        title: beyond(history).unwrap_or_default(),
        x: axis(false),
        y: ("θ/α", rotations(values)),
        ..Chart::default()
    };
    let twist: Series<RowInSpace> = ("", LineStyle::THIN, &|row| row.observation.attitude.twist.to_degrees());
    let names = foot_names(&run.parameters);
    let [forces, slips] =
        [of_feet(&names, "N", |foot| foot.normal, 1.0 / weight), of_feet(&names, "foot", |foot| foot.slip, 1e3)];
    let chart = |y: &'static str| Chart { x: axis(false), y: (y, 0.0..0.0), ..Chart::default() };
    let mut panels = vec![
        panel(HEIGHTS[0], of_tilt, &tilt),
        (HEIGHTS[1], Vec::new(), direction(history, axis(false))),
        panel(HEIGHTS[2], chart("twist (°)"), &[twist]),
        panel(HEIGHTS[3], chart("N/(M g)"), &series(&forces)),
        contacts(history, &names, axis(false)),
        panel(HEIGHTS[4], Chart { x: axis(!has_ground), ..chart("slip (mm)") }, &series(&slips)),
    ];
    let ground: [Series<RowInSpace>; 3] = [
        ("a_gz", LineStyle::WIDE_GREY, &|row| row.ground[2] / g),
        ("a_gx", LineStyle::BLUE, &|row| row.ground[0] / g),
        ("a_gy", LineStyle::ORANGE, &|row| row.ground[1] / g),
    ];
    let of_ground: Vec<_> =
        ground.into_iter().zip([2, 0, 1]).filter(|(_, axis)| moves(*axis)).map(|(s, _)| s).collect();
    if has_ground {
        panels.push(panel(HEIGHTS[5], Chart { x: axis(true), ..chart("ground acceleration (g)") }, &of_ground));
    }
    stacked(&heading, &[], &panels)
}

/// A curve of the feet: its name, its style, its value.
type OfFeet = (String, LineStyle, Box<dyn Fn(&RowInSpace) -> f64>);

/// Returns a curve of each foot, or that of the greatest value of many feet.
fn of_feet(names: &[String], quantity: &str, of: fn(&FootObservation) -> f64, factor: f64) -> Vec<OfFeet> {
    if names.len() > MAX_CURVES {
        let greatest = move |row: &RowInSpace| factor * row.observation.feet.iter().map(of).fold(0.0, f64::max);
        return vec![(format!("greatest of {} feet", names.len()), LineStyle::THIN, Box::new(greatest))];
    }
    let curve = |(foot, name): (usize, &String)| -> OfFeet {
        let value = move |row: &RowInSpace| factor * of(&row.observation.feet[foot]);
        let separator = if quantity == "N" { "_" } else { " " };
        (format!("{quantity}{separator}{name}"), FEET[foot], Box::new(value))
    };
    names.iter().enumerate().map(curve).collect()
}

/// Line styles of the feet: −x blue, +x orange; −y dark, +y light.
const FEET: [LineStyle; MAX_CURVES] = [LineStyle::BLUE, LineStyle::LIGHT_BLUE, LineStyle::BROWN, LineStyle::ORANGE];

fn series(curves: &[OfFeet]) -> Vec<Series<'_, RowInSpace>> {
    curves.iter().map(|(name, style, value)| -> Series<RowInSpace> { (name, *style, value) }).collect()
}

/// Returns a component of the tilt over the critical tilt in the direction of the lean.
fn of_critical(row: &RowInSpace, component: f64) -> f64 {
    let tilt = row.observation.attitude.tilt;
    if tilt > 0.0 { row.tilt_over_critical * (component / tilt) } else { 0.0 }
}

/// Describes a tilt beyond the ordinate.
fn beyond(history: &HistoryInSpace) -> Option<String> {
    let first = history.rows.iter().find(|row| row.tilt_over_critical > MAX_ROTATION)?;
    let peak = significant(history.peaks.tilt_over_critical, 4);
    Some(format!("θ/α > {} after t = {} s; peak {peak}", short(MAX_ROTATION), significant(first.observation.time, 4)))
}

/// Draws the direction of the tilt from +x towards +y, where there is a tilt.
fn direction<'a>(history: &HistoryInSpace, x: (&'a str, Range<f64>)) -> Chart<'a> {
    let least = NO_DIRECTION * history.rows.iter().map(|row| row.observation.attitude.tilt).fold(0.0, f64::max);
    let mut segments: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
    for row in &history.rows {
        let attitude = row.observation.attitude;
        let degrees = attitude.azimuth.to_degrees();
        let previous = segments.last().and_then(|segment| segment.last());
        let turns_over = previous.is_some_and(|(_, previous)| (previous - degrees).abs() > 180.0);
        if attitude.tilt <= least || turns_over {
            segments.push(Vec::new());
        }
        if let Some(segment) = segments.last_mut().filter(|_| attitude.tilt > least) {
            segment.push((row.observation.time, degrees));
        }
    }
    segments.retain(|segment| segment.len() > 1);
    let names = [(-180.0, "−180°"), (-90.0, "−90°"), (0.0, "0"), (90.0, "90°"), (180.0, "180°")];
    let names = names.map(|(degrees, name)| (degrees, name.into())).into();
    let curves = vec![Curve::new(LineStyle::THIN, segments)];
    let title = "direction of the tilt, from +x towards +y".into();
    Chart { title, x, y: ("", -190.0..190.0), curves, names, ..Chart::default() }
}

/// Draws the contacts in a row for each foot: grey where it sticks, black where it slides.
fn contacts<'a>(history: &HistoryInSpace, names: &[String], x: (&'a str, Range<f64>)) -> StackedChart<'a> {
    let count = names.len();
    let is_few = count <= 2 * MAX_CURVES;
    let margin = if is_few { 0.14 } else { 0.0 };
    let first = history.rows.first().map(|row| &row.observation.feet[..]).unwrap_or_default();
    let grey = |sticks: bool| if sticks { STICKS } else { SLIDES };
    // The present contact of each foot, since some time.
    let mut since: Vec<(f64, Option<u8>)> =
        first.iter().map(|foot| (x.1.start, foot.touches.then(|| grey(!foot.slides)))).collect();
    let mut tiles = Vec::new();
    let mut add = |foot: usize, from: f64, to: f64, level: Option<u8>| {
        // The first foot is the uppermost.
        let y = (count - 1 - foot) as f64;
        if let (Some(grey), true) = (level, to > from) {
            tiles.push(Tile { x: from..to, y: y + margin..y + 1.0 - margin, grey });
        }
    };
    for event in &history.events {
        let (foot, level) = match event.kind {
            SpaceEventKind::LiftOff(foot) => (foot, None),
            SpaceEventKind::Landing(foot) | SpaceEventKind::Sticks(foot) => (foot, Some(STICKS)),
            SpaceEventKind::Slides(foot) => (foot, Some(SLIDES)),
            SpaceEventKind::Overturning => continue,
        };
        let (from, previous) = std::mem::replace(&mut since[foot], (event.time, level));
        add(foot, from, event.time, previous);
    }
    for (foot, (from, level)) in since.into_iter().enumerate() {
        add(foot, from, x.1.end, level);
    }
    let of_row = |foot: usize| (count - 1 - foot) as f64 + 0.5;
    // Of many feet the first and each eighth one after it have names.
    let shown = (0..count).filter(|foot| is_few || foot % 8 == 0);
    let names = shown.map(|foot| (of_row(foot), format!("foot {}", names[foot]).into()));
    let legend = vec![(Symbol::Grey(STICKS), "foot sticks".into()), (Symbol::Grey(SLIDES), "slides".into())];
    let height = 600 + OF_CONTACTS[0] * count as u32;
    let chart = Chart { x, y: ("", 0.0..count as f64), names: names.collect(), tiles, ..Chart::default() };
    (height.min(OF_CONTACTS[1]) + 500, legend, chart)
}

/// Describes the parameters of a block in space in a line.
pub fn block_line(parameters: &SpaceParameters, body: &SpaceBody) -> String {
    let base = match &parameters.base {
        Base::Rectangle { depth_ratio, .. } => format!(
            "{} m × {} m",
            significant(2.0 * body.half_width, 5),
            significant(2.0 * body.half_width * depth_ratio, 5)
        ),
        Base::Circle { feet, .. } => format!("{feet} feet on a circle of {} m", significant(2.0 * body.half_width, 5)),
        Base::List { feet, .. } => format!("{} feet", feet.len()),
    };
    let eccentricity = match parameters.eccentricity {
        [0.0, 0.0] => String::new(),
        [x, y] => format!(", e_x = {} m, e_y = {} m", significant(x, 5), significant(y, 5)),
    };
    format!(
        "{base}, h = {} m, α = {} rad, p = {} rad/s, ω_v = {} rad/s, ξ_v = {}, κ = {}, {}{eccentricity}",
        significant(body.center_height, 5),
        short(body.alpha),
        short(body.p),
        short(body.omega_v),
        short(body.xi_v),
        short(parameters.kappa),
        friction(body).map_or("feet that do not slide".into(), |friction| format!("μ = {}", short(friction)))
    )
}

/// Returns the coefficient of friction μ of feet that may slide. From the default on it is no limit.
pub(crate) fn friction(body: &SpaceBody) -> Option<f64> {
    Some(body.friction).filter(|friction| *friction < SpaceParameters::default().friction)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The default friction stands for no limit, and no line writes its number.
    #[test]
    fn friction_is_written_where_it_limits() {
        let line = |friction: f64| {
            let parameters = SpaceParameters { friction, ..SpaceParameters::default() };
            block_line(&parameters, &SpaceBody::new(&parameters).unwrap())
        };
        assert!(line(0.35).ends_with("κ = 1, μ = 0.35"), "{}", line(0.35));
        let plain = line(SpaceParameters::default().friction);
        assert!(plain.ends_with("feet that do not slide") && !plain.contains("μ = "), "{plain}");
    }
}
