//! Curves, areas, marks and outcome bars → a chart with axes.

use std::borrow::Cow;
use std::ops::Range;

use plotters::chart::MeshStyle;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::canvas::{
    Area, Drawn, INK, Mark, Position, SHADE, TEXT, anchored, fill, grey, line, outline, pixel_corner, text,
};
use crate::formula::formula;
use crate::line_style::LineStyle;
use crate::numerals::{significant, tick};

/// Space for labels at the left of a chart, and at its right.
pub const SIDES: [u32; 2] = [1800, 400];
/// Empty part of the space at the left.
pub const EDGE: u32 = 240;
/// Vertical distance of outcome bars, and their height.
const BAR: [u32; 2] = [340, 200];
/// Greatest |θ|/α of a picture. Blocks are about to overturn long before.
pub const MAX_ROTATION: f64 = 1.5;

/// [`Chart::balance`] of a block whose centre of mass is above the middle of its base.
pub const EVEN_BALANCE: [f64; 2] = [-1.0, 1.0];

/// Axes on which a chart is drawn.
type Axes<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// A curve, as segments without gaps.
pub struct Curve {
    /// Style of the line.
    pub style: LineStyle,
    /// Points of each segment.
    pub segments: Vec<Vec<(f64, f64)>>,
    /// Whether the run ended at the last point, which a cross then marks.
    pub ends: bool,
}

impl Curve {
    /// Returns a curve without a cross at its end.
    pub fn new(style: LineStyle, segments: Vec<Vec<(f64, f64)>>) -> Curve {
        Curve { style, segments, ends: false }
    }
}

/// A bar under a chart that shows where the blocks of a curve separate or overturn.
pub struct OutcomeBar {
    /// Style of the curve.
    pub style: LineStyle,
    /// Range of the abscissa.
    pub range: Range<f64>,
    /// Parts of the range with their outcomes.
    pub parts: Vec<(Range<f64>, Fill)>,
}

/// Filling of a part of an outcome bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// Complete separation: grey.
    Separated,
    /// Overturning: black.
    Overturned,
    /// A run that ended before its outcome was known: light grey.
    Undecided,
    /// A failed run: a cross.
    Failed,
}

impl Fill {
    /// All fillings, those that others may cover first.
    pub const ALL: [Fill; 4] = [Fill::Separated, Fill::Overturned, Fill::Undecided, Fill::Failed];

    /// Returns the name of the outcome.
    pub fn name(self) -> &'static str {
        match self {
            Fill::Separated => "complete separation",
            Fill::Overturned => "overturning",
            Fill::Undecided => "undecided",
            Fill::Failed => "run failed",
        }
    }

    /// Fills the rectangle between two corners.
    ///
    /// # Errors
    /// The drawing fails.
    pub fn draw(self, area: &Area, corners: [Position; 2]) -> Drawn {
        let colour = match self {
            Fill::Separated => grey(165),
            Fill::Overturned => INK,
            Fill::Undecided => grey(220),
            Fill::Failed => {
                let [(x0, y0), (x1, y1)] = corners;
                outline(area, corners, 30)?;
                line(area, corners, 30)?;
                return line(area, [(x0, y1), (x1, y0)], 30);
            }
        };
        fill(area, corners.map(pixel_corner), colour)
    }
}

/// A grey rectangle of a chart.
pub struct Tile {
    /// Range of the abscissa.
    pub x: Range<f64>,
    /// Range of the ordinate.
    pub y: Range<f64>,
    /// Grey level, 0 (black) to 255.
    pub grey: u8,
}

/// A chart.
#[derive(Default)]
pub struct Chart<'a> {
    /// Title.
    pub title: String,
    /// Name and range of the abscissa.
    pub x: (&'a str, Range<f64>),
    /// Name and range of the ordinate.
    pub y: (&'a str, Range<f64>),
    /// Shaded range of the ordinate.
    pub band: Option<Range<f64>>,
    /// Shaded areas: abscissa, lower and upper ordinate of their points.
    pub areas: Vec<Vec<(f64, f64, f64)>>,
    /// Grey rectangles.
    pub tiles: Vec<Tile>,
    /// Marks, drawn over the curves.
    pub marks: Vec<(Mark, (f64, f64))>,
    /// Curves, drawn in this order.
    pub curves: Vec<Curve>,
    /// Ordinates θ/α of the unstable equilibria of a block on a rigid base. Lines mark the left one and the right one.
    pub balance: Option<[f64; 2]>,
    /// Names of ordinates, in place of numbers.
    pub names: Vec<(f64, Cow<'static, str>)>,
    /// Names of abscissas, in place of numbers.
    pub abscissas: Vec<(f64, Cow<'static, str>)>,
    /// Vertical lines.
    pub verticals: Vec<(LineStyle, f64)>,
    /// Texts, left-aligned at a point of the chart.
    pub notes: Vec<((f64, f64), String)>,
    /// Text in the middle of an empty chart.
    pub message: String,
    /// Outcome bars under the chart.
    pub bars: Vec<OutcomeBar>,
}

impl Chart<'_> {
    /// Whether a shaded area is wide enough to be seen: a legend names no band that the chart does not show.
    pub fn shows_band(&self) -> bool {
        /// Width of an area that a line would cover, over the range of the ordinate.
        const THIN: f64 = 1e-3;
        let least = THIN * (self.y.1.end - self.y.1.start);
        self.areas.iter().any(|area| area.len() > 1 && area.iter().any(|(_, low, high)| high - low > least))
    }

    /// Whether the chart has a line in this style.
    pub fn shows_line(&self, style: LineStyle) -> bool {
        self.curves.iter().any(|curve| curve.style == style && curve.segments.iter().any(|points| points.len() > 1))
    }

    /// Draws the chart into a part of the drawing.
    ///
    /// # Errors
    /// The drawing fails.
    pub fn draw(&self, root: &Area, area: &Area) -> Drawn {
        let (head, body) = area.split_vertically(if self.title.is_empty() { 120 } else { 700 });
        let left_aligned = anchored(TEXT, HPos::Left, VPos::Center);
        if !self.title.is_empty() {
            head.draw_text(&formula(&self.title), &left_aligned, (SIDES[0] as i32, 400))?;
        }
        let (body, under) = body.split_vertically(body.dim_in_pixel().1 - bars_height(self.bars.len()));
        let [(x_name, x), (y_name, y)] = [&self.x, &self.y];
        let mut chart = ChartBuilder::on(&body)
            .margin_right(SIDES[1])
            .margin_left(EDGE)
            .margin_top(60)
            .set_label_area_size(LabelAreaPosition::Left, SIDES[0] - EDGE)
            .set_label_area_size(LabelAreaPosition::Bottom, if x_name.is_empty() { 180 } else { 960 })
            .build_cartesian_2d(x.clone(), y.clone())?;
        let abscissa = |value: &f64| if x_name.is_empty() { String::new() } else { tick(*value, x) };
        let ordinate = |value: &f64| tick(*value, y);
        let mut mesh = chart.configure_mesh();
        set_mesh_style(&mut mesh);
        mesh.x_desc(formula(x_name))
            .y_desc(formula(y_name))
            .x_labels(9)
            .y_labels(6)
            .x_label_formatter(&abscissa)
            .y_label_formatter(&ordinate);
        if !self.names.is_empty() {
            mesh.disable_y_mesh().y_labels(0);
        }
        if !self.abscissas.is_empty() {
            mesh.disable_x_mesh().x_labels(0);
        }
        mesh.draw()?;
        self.draw_shades(&mut chart)?;
        let at = |x: f64, y: f64| chart.backend_coord(&(x, y));
        for Tile { x, y, grey: level } in &self.tiles {
            fill(root, [at(x.start, y.start), at(x.end, y.end)].map(pixel_corner), grey(*level))?;
        }
        if y.start < 0.0 {
            line(root, [at(x.start, 0.0), at(x.end, 0.0)], 20)?;
        }
        self.draw_balance(root, at)?;
        for (style, x) in &self.verticals {
            style.draw(root, &[at(*x, y.start), at(*x, y.end)])?;
        }
        self.draw_curves(root, at)?;
        for (mark, point) in &self.marks {
            mark.draw(root, chart.backend_coord(point))?;
        }
        for (point, note) in &self.notes {
            root.draw_text(&formula(note), &left_aligned, chart.backend_coord(point))?;
        }
        for (ordinate, name) in &self.names {
            let (left, middle) = at(x.start, *ordinate);
            root.draw_text(name.as_ref(), &anchored(0.9 * TEXT, HPos::Right, VPos::Center), (left - 150, middle))?;
        }
        for (abscissa, name) in &self.abscissas {
            let (middle, bottom) = at(*abscissa, y.start);
            root.draw_text(name.as_ref(), &anchored(0.9 * TEXT, HPos::Center, VPos::Top), (middle, bottom + 130))?;
        }
        if !self.message.is_empty() {
            let [x, y] = [x, y].map(|range| 0.5 * (range.start + range.end));
            root.draw_text(&self.message, &anchored(TEXT, HPos::Center, VPos::Center), at(x, y))?;
        }
        let left = area.get_base_pixel().0;
        for (i, bar) in self.bars.iter().enumerate() {
            let top = under.get_base_pixel().1 + 180 + (BAR[0] * i as u32) as i32;
            bar.draw(root, (left + EDGE as i32, top), |x| at(x, y.start).0)?;
        }
        Ok(())
    }

    /// Shades the band and the areas.
    fn draw_shades(&self, chart: &mut Axes<'_, '_>) -> Drawn {
        if let Some(band) = &self.band {
            let corners = [(self.x.1.start, band.start), (self.x.1.end, band.end)];
            chart.draw_series(std::iter::once(Rectangle::new(corners, SHADE.filled())))?;
        }
        for area in &self.areas {
            let lower = area.iter().map(|(x, low, _)| (*x, *low));
            let upper = area.iter().rev().map(|(x, _, high)| (*x, *high));
            let corners: Vec<(f64, f64)> = lower.chain(upper).collect();
            chart.draw_series(std::iter::once(Polygon::new(corners, SHADE.filled())))?;
        }
        Ok(())
    }

    /// Draws the rotations of balance with their names; `at` converts a point of the chart.
    fn draw_balance(&self, root: &Area, at: impl Fn(f64, f64) -> Position) -> Drawn {
        let (x, y) = (&self.x.1, &self.y.1);
        for level in self.balance.into_iter().flatten().filter(|level| y.contains(level)) {
            let right = at(x.end, level);
            LineStyle::LEVEL.draw(root, &[at(x.start, level), right])?;
            let is_even = self.balance == Some(EVEN_BALANCE);
            let (name, anchor, aside) = match (level < 0.0, is_even) {
                (true, true) => ("θ = −α", VPos::Top, 60),
                (false, true) => ("|θ| = α", VPos::Bottom, -60),
                (true, false) => ("θ = −α_L", VPos::Top, 60),
                (false, false) => ("θ = α_R", VPos::Bottom, -60),
            };
            root.draw_text(
                &formula(name),
                &anchored(0.8 * TEXT, HPos::Right, anchor),
                (right.0 - 100, right.1 + aside),
            )?;
        }
        Ok(())
    }

    /// Draws the curves within the ordinates; `at` converts a point of the chart.
    fn draw_curves(&self, root: &Area, at: impl Fn(f64, f64) -> Position) -> Drawn {
        let y = &self.y.1;
        for curve in &self.curves {
            for segment in &curve.segments {
                for part in clipped(segment, y) {
                    let points: Vec<Position> = part.iter().map(|&(x, y)| at(x, y)).collect();
                    curve.style.draw(root, &points)?;
                }
                if let (true, Some(&(x, end))) = (curve.ends, segment.last().filter(|end| y.contains(&end.1))) {
                    Mark::Cross.draw(root, at(x, end))?;
                }
            }
        }
        Ok(())
    }
}

/// Sets the style of axes, grid and labels.
pub fn set_mesh_style(mesh: &mut MeshStyle<RangedCoordf64, RangedCoordf64, SVGBackend>) {
    mesh.light_line_style(TRANSPARENT)
        .bold_line_style(grey(225).stroke_width(30))
        .axis_style(INK.stroke_width(30))
        .label_style(text(0.9 * TEXT))
        .axis_desc_style(text(TEXT))
        .set_all_tick_mark_size(50);
}

impl OutcomeBar {
    /// Draws the bar from its upper left corner; `pixel` converts an abscissa.
    fn draw(&self, root: &Area, (left, top): Position, pixel: impl Fn(f64) -> i32) -> Drawn {
        let bottom = top + BAR[1] as i32;
        let middle = (top + bottom) / 2;
        self.style.draw(root, &[(left, middle), (left + SIDES[0] as i32 - 480, middle)])?;
        for (part, fill) in &self.parts {
            let from = pixel(part.start);
            fill.draw(root, [(from, top), (pixel(part.end).max(from + 20), bottom)])?;
        }
        outline(root, [(pixel(self.range.start), top), (pixel(self.range.end), bottom)], 20)
    }
}

/// Returns the ticks of a logarithmic axis between two numbers above zero: the decimal logarithm of each and its name. They are powers of ten,
/// and the doubles and halves of them over few.
pub fn logarithmic(range: &Range<f64>) -> Vec<(f64, Cow<'static, str>)> {
    /// Ticks at most, so that their names do not overlap.
    const MAX: i32 = 12;
    let [first, last] = [range.start, range.end].map(|end| libm::floor(libm::log10(end)) as i32);
    let decades = last - first + 1;
    let multiples: &[f64] = if 3 * decades <= MAX { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let step = (decades / MAX + 1) as usize;
    let of_power = |power: i32| {
        // A division has the bits of the number as it is read.
        let number = move |multiple: f64| match power {
            0.. => multiple * 10_f64.powi(power),
            _ => multiple / 10_f64.powi(-power),
        };
        multiples.iter().map(move |multiple| number(*multiple))
    };
    let all = (first..=last).step_by(step).flat_map(of_power);
    let name = |number: f64| match number {
        1e-3..1e4 => significant(number, 1),
        _ => format!("{number:e}"),
    };
    all.filter(|number| range.contains(number)).map(|number| (libm::log10(number), name(number).into())).collect()
}

/// Returns the height of the outcome bars of a chart.
pub fn bars_height(count: usize) -> u32 {
    BAR[0] * count as u32 + if count == 0 { 0 } else { 300 }
}

/// Clips a line to a range of the ordinate.
fn clipped(line: &[(f64, f64)], range: &Range<f64>) -> Vec<Vec<(f64, f64)>> {
    let mut pieces: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut is_open = false;
    for pair in line.windows(2) {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
        if y0.max(y1) < range.start || y0.min(y1) > range.end {
            is_open = false;
            continue;
        }
        let inside = |(x, y): (f64, f64)| {
            let bound = y.clamp(range.start, range.end);
            if bound == y { (x, y) } else { (x0 + (x1 - x0) * (bound - y0) / (y1 - y0), bound) }
        };
        let [from, to] = [inside(pair[0]), inside(pair[1])];
        match pieces.last_mut() {
            Some(piece) if is_open => piece.push(to),
            _ => pieces.push(vec![from, to]),
        }
        is_open = to == pair[1];
    }
    pieces
}

/// Returns the ordinate for rotations θ/α: zero, all values and a margin, within ±1.5.
pub fn rotations(values: impl Iterator<Item = f64>) -> Range<f64> {
    let Range { start, end } = range(values);
    start.max(-MAX_ROTATION)..end.min(MAX_ROTATION)
}

/// Returns the ranges of abscissa and ordinate for curves, as [`range`] does.
pub fn extents(curves: &[Curve]) -> [Range<f64>; 2] {
    let points = || curves.iter().flat_map(|curve| curve.segments.iter().flatten());
    [range(points().map(|point| point.0)), range(points().map(|point| point.1))]
}

/// Returns a range that contains zero, these values and a margin.
pub fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    let margin = 0.06 * (high - low).max(1e-12);
    if low < 0.0 { low - margin..high + margin } else { 0.0..high + margin }
}
