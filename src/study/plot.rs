//! A history → a drawing: rotation, reactions, regimes and ground acceleration over one axis of time.

use plotters::prelude::*;

use crate::block::{Block, Foundation};
use crate::contact::Regime;
use crate::study::formula::{formula, typeset};
use crate::study::history::{History, Row};
use crate::study::letters::FONT_FAMILY;
use crate::study::picture::PictureError;

/// Coordinates of the drawing are whole numbers: so many that lines are smooth.
const WIDTH: u32 = 1920;
const HEIGHT: u32 = 1520;
pub(super) const INK: RGBColor = RGBColor(25, 25, 25);
const DARK: RGBColor = RGBColor(20, 60, 120);
const LIGHT: RGBColor = RGBColor(235, 140, 40);
pub(super) const GRID: RGBColor = RGBColor(225, 225, 225);

/// A line: its name, its colour, and the value that it shows.
type Line<'a> = (&'static str, RGBColor, &'a dyn Fn(&Row) -> f64);

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// Draws a history as SVG. `title` says what was run; `g` turns accelerations into parts of gravity.
pub fn history(block: &Block, history: &History, title: &str) -> Result<String, PictureError> {
    let mut svg = String::new();
    draw(block, history, title, &mut svg).map_err(|error| PictureError::Drawing(error.to_string()))?;
    Ok(typeset(&svg))
}

fn draw(block: &Block, history: &History, title: &str, svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, (WIDTH, HEIGHT)).into_drawing_area();
    root.fill(&WHITE)?;
    let (head, body) = root.split_vertically(116);
    let text = |size: u32| (FONT_FAMILY, size).into_font().color(&INK);
    head.draw_text(title, &text(34), (LEFT_I, 24))?;
    let ended = history.ending.map(|(ending, time)| format!("; {ending} at t = {time:.3} s"));
    head.draw_text(&formula(&format!("{}{}", block_line(block), ended.unwrap_or_default())), &text(26), (LEFT_I, 72))?;
    let panels = body.split_by_breakpoints([0; 0], [460, 840, 1060]);
    let [rotation, reactions, regimes, ground] = panels.as_slice() else {
        return Err("the drawing has four panels".into());
    };
    let start = history.rows.first().map_or(0.0, |row| row.time);
    let end = history.rows.last().map_or(1.0, |row| row.time).max(start + 1e-9);
    let time = start..end;

    let alpha = block.alpha;
    let theta: [Line; 1] = [("", INK, &|row| row.seen.theta / alpha)];
    lines(rotation, history, &time, "θ / α", &theta, false)?;
    let weight = block.mass * block.gravity;
    let loads: [Line; 2] = [
        ("left N_L", DARK, &|row| row.seen.reaction[0] / weight),
        ("right N_R", LIGHT, &|row| row.seen.reaction[1] / weight),
    ];
    lines(reactions, history, &time, "N / (M g)", &loads, false)?;
    band(regimes, history, &time)?;
    let g = block.gravity;
    let horizontal: Line = ("horizontal", INK, &|row| row.ground[0] / g);
    let vertical: Line = ("vertical", LIGHT, &|row| row.ground[1] / g);
    if history.rows.iter().any(|row| row.ground[1] != 0.0) {
        // The vertical motion, which is the lighter one, lies below.
        lines(ground, history, &time, "ground / g", &[vertical, horizontal], true)?;
    } else {
        lines(ground, history, &time, "ground / g", &[("", INK, horizontal.2)], true)?;
    }
    root.present()?;
    Ok(())
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
        "α = {} rad, p = {} rad/s, {foundation} ({:.2} m wide, {:.2} m high, R0 = {r0:.2} m)",
        short(alpha),
        short(p),
        2.0 * b,
        2.0 * h
    )
}

/// Room for labels at the left, which lines the panels up.
pub(super) const LEFT: u32 = 140;
const LEFT_I: i32 = LEFT as i32 + 16;

fn lines(
    area: &Area,
    history: &History,
    time: &std::ops::Range<f64>,
    name: &str,
    lines: &[Line],
    with_time: bool,
) -> Result<(), Box<dyn std::error::Error>> {
    let values = || history.rows.iter().flat_map(|row| lines.iter().map(|line| line.2(row)));
    let (low, high) = values().fold((0.0_f64, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    let margin = 0.08 * (high - low).max(1e-12);
    // Room for the names of the lines over them.
    let above = if lines.len() > 1 { 4.0 * margin } else { margin };
    let mut chart = ChartBuilder::on(area)
        .margin_right(48)
        .margin_left(16)
        .margin_top(16)
        .set_label_area_size(LabelAreaPosition::Left, LEFT)
        .set_label_area_size(LabelAreaPosition::Bottom, if with_time { 88 } else { 12 })
        .build_cartesian_2d(time.clone(), low - margin..high + above)?;
    let mut mesh = chart.configure_mesh();
    mesh.light_line_style(TRANSPARENT)
        .bold_line_style(ShapeStyle::from(GRID).stroke_width(2))
        .axis_style(ShapeStyle::from(INK).stroke_width(2))
        .label_style((FONT_FAMILY, 26).into_font().color(&INK))
        .axis_desc_style((FONT_FAMILY, 28).into_font().color(&INK))
        .y_desc(name)
        .x_labels(12)
        .y_labels(6)
        .y_label_formatter(&|y| short(*y));
    if with_time {
        mesh.x_desc("time (s)").x_label_formatter(&|x| short(*x));
    } else {
        mesh.x_label_formatter(&|_| String::new());
    }
    mesh.draw()?;
    chart.draw_series(std::iter::once(PathElement::new(vec![(time.start, 0.0), (time.end, 0.0)], INK.mix(0.45))))?;
    for (label, colour, value) in lines {
        let style = ShapeStyle { color: colour.to_rgba(), filled: false, stroke_width: 2 };
        let series = chart.draw_series(LineSeries::new(thinned(&history.rows, *value), style))?;
        if !label.is_empty() {
            let key = style.stroke_width(6);
            series.label(formula(label)).legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 36, y)], key));
        }
    }
    if lines.len() > 1 {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(TRANSPARENT)
            .legend_area_size(60)
            .label_font((FONT_FAMILY, 26).into_font().color(&INK))
            .draw()?;
    }
    Ok(())
}

/// A number for an axis, without the noise of its last digits.
pub(super) fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" || text.is_empty() { "0".into() } else { text.replace('-', "−") }
}

/// One lane a regime: which corners touch is read from the place, not from a colour.
fn band(area: &Area, history: &History, time: &std::ops::Range<f64>) -> Result<(), Box<dyn std::error::Error>> {
    let separated = history.events.iter().any(|event| event.after == Regime::Separated);
    let lanes: &[(Regime, &str)] = &[
        (Regime::TiltingLeft, "on left"),
        (Regime::FullContact, "on both"),
        (Regime::TiltingRight, "on right"),
        (Regime::Separated, "on none"),
    ];
    let lanes = if separated { lanes } else { &lanes[..3] };
    let lane = |regime: Regime| lanes.iter().position(|lane| lane.0 == regime).unwrap_or(0) as f64;
    let height = lanes.len() as f64;
    let mut chart = ChartBuilder::on(area)
        .margin_right(48)
        .margin_left(16)
        .margin_top(8)
        .set_label_area_size(LabelAreaPosition::Left, LEFT)
        .set_label_area_size(LabelAreaPosition::Bottom, 12)
        .build_cartesian_2d(time.clone(), 0.0..height)?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(ShapeStyle::from(GRID).stroke_width(2))
        .axis_style(ShapeStyle::from(INK).stroke_width(2))
        .x_labels(12)
        .x_label_formatter(&|_| String::new())
        .y_labels(0)
        .draw()?;
    let mut since = time.start;
    let mut regime = history.rows.first().map_or(Regime::FullContact, |row| row.regime);
    let mut bars = Vec::new();
    for event in &history.events {
        bars.push((regime, since, event.time));
        (regime, since) = (event.after, event.time);
    }
    bars.push((regime, since, time.end));
    chart.draw_series(bars.into_iter().map(|(regime, from, to)| {
        let low = lane(regime);
        let colour = if regime == Regime::FullContact { INK.mix(0.45) } else { DARK.mix(0.9) };
        Rectangle::new([(from, low + 0.14), (to, low + 0.86)], colour.filled())
    }))?;
    let style = (FONT_FAMILY, 26).into_font().color(&INK);
    for (i, (_, name)) in lanes.iter().enumerate() {
        let (x, y) = chart.backend_coord(&(time.start, i as f64 + 0.5));
        let (left, top) = area.get_base_pixel();
        area.draw_text(name, &style, (x - left - LEFT as i32 + 8, y - top - 16))?;
    }
    Ok(())
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
