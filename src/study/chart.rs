//! Curves → charts that read without colours, with lanes for what curves cannot show, and the keys to both.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::study::formula::{self, formula, typeset};
use crate::study::letters::FONT_FAMILY;
use crate::study::look::Look;
use crate::study::numerals::tick;
use crate::study::picture::PictureError;

/// A part of a drawing.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// What drawing may end in.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Units of a drawing in a pixel. Coordinates are whole numbers of units, so that curves have no steps.
pub const PIXEL: u32 = 10;
/// Width of a drawing. All lengths are in units; text is readable where 1000 pixels are left of the width.
pub const WIDTH: u32 = 2400 * PIXEL;
/// Size of the text.
pub const TEXT: f64 = 340.0;
/// Left edge of the heading.
pub const MARGIN: u32 = 480;
/// Height of a line of the heading.
const LINE: u32 = 500;
/// Height of a row of keys.
const KEY_ROW: u32 = 600;
/// Height of a lane and of the bar in it.
const LANE: [u32; 2] = [340, 200];
/// Radius of a circle that marks a point.
const CIRCLE: i32 = 120;
/// Room for labels at the left of a chart, and at its right.
pub const SIDES: [u32; 2] = [1800, 400];
/// Empty part of the room at the left.
const EDGE: u32 = 240;

/// Makes a drawing of this height.
pub fn drawing(height: u32, draw: impl FnOnce(&Area) -> Drawn) -> Result<String, PictureError> {
    let mut svg = String::new();
    let made = || -> Drawn {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        root.fill(&WHITE)?;
        draw(&root)?;
        root.present()?;
        Ok(())
    };
    made().map_err(|error| PictureError::Drawing(error.to_string()))?;
    // The view box keeps the units; a viewer and PNG take the size in pixels.
    let size = |pixel: u32| format!("width=\"{}\" height=\"{}\" viewBox", WIDTH / pixel, height / pixel);
    Ok(typeset(&svg.replacen(&size(1), &size(PIXEL), 1)))
}

/// Makes a drawing under a heading: a large line and smaller ones, each wrapped. Formulas in them are marked by [`formula`]. `draw` gets the whole drawing, and the part of this height under the heading.
pub fn headed(
    heading: &[String],
    height: u32,
    draw: impl FnOnce(&Area, &Area) -> Drawn,
) -> Result<String, PictureError> {
    let sizes = std::iter::once(1.15 * TEXT).chain(std::iter::repeat(TEXT));
    let lines = heading.iter().zip(sizes).filter(|(line, _)| !line.is_empty()).flat_map(|(line, size)| {
        let wrapped = wrapped(line, size, f64::from(WIDTH - 2 * MARGIN));
        wrapped.into_iter().map(move |line| (line, size))
    });
    let lines: Vec<(String, f64)> = lines.collect();
    let head = 450 + LINE * lines.len() as u32;
    drawing(head + height, |root| {
        let (top, body) = root.split_vertically(head);
        for (i, (line, size)) in lines.iter().enumerate() {
            top.draw_text(&line.replace('\u{A0}', " "), &text(*size), (MARGIN as i32, 280 + (LINE * i as u32) as i32))?;
        }
        draw(root, &body)
    })
}

/// Breaks a text with marked formulas into lines of at most this width. No line ends at a no-break space.
pub fn wrapped(text: &str, size: f64, most: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if formula::marked_width(&format!("{line} {word}"), size) <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}

/// The style of a text of this size.
pub fn text(size: f64) -> TextStyle<'static> {
    // plotters takes the height of a line, 1.24 times the size of the font.
    (FONT_FAMILY, 1.24 * size).into_font().color(&INK)
}

/// What a key explains.
pub enum Sample {
    /// A curve.
    Curve(Look),
    /// A shaded band.
    Band,
    /// A cross at the end of a curve.
    Cross,
    /// A circle.
    Circle,
    /// Short upright lines.
    Ticks,
    /// A part of a lane.
    Fill(Fill),
    /// A bar with a filling of this grey level.
    Bar(u8),
}

/// Height of the rows that these keys take.
pub fn keys_height(keys: &[(Sample, String)]) -> u32 {
    KEY_ROW * places(keys).last().map_or(0, |last| last.1 + 1)
}

/// Distance from the left and row of each key.
fn places(keys: &[(Sample, String)]) -> Vec<(i32, u32)> {
    let (mut x, mut row) = (SIDES[0] as i32, 0);
    let mut places = Vec::new();
    for (_, name) in keys {
        let width = 2000 + formula::width(name, TEXT) as i32;
        if x + width > (WIDTH - SIDES[1]) as i32 && x > SIDES[0] as i32 {
            (x, row) = (SIDES[0] as i32, row + 1);
        }
        places.push((x, row));
        x += width;
    }
    places
}

/// Draws keys in rows.
pub fn keys(area: &Area, keys: &[(Sample, String)]) -> Drawn {
    for ((sample, name), (x, row)) in keys.iter().zip(places(keys)) {
        let y = (KEY_ROW * row + KEY_ROW / 2) as i32;
        let bar = [(x, y - 140), (x + 1200, y + 140)];
        match sample {
            Sample::Curve(look) => look.draw(area, &[(x, y), (x + 1200, y)])?,
            Sample::Band => area.draw(&Rectangle::new(bar, BAND.filled()))?,
            Sample::Cross => area.draw(&Cross::new((x + 600, y), 160, INK.stroke_width(70)))?,
            Sample::Circle => {
                area.draw(&Circle::new((x + 600, y), CIRCLE, WHITE.filled()))?;
                area.draw(&Circle::new((x + 600, y), CIRCLE, INK.stroke_width(40)))?;
            }
            Sample::Ticks => {
                for tick in [x + 400, x + 520, x + 700, x + 760] {
                    area.draw(&PathElement::new(vec![(tick, y - 120), (tick, y + 120)], INK.stroke_width(20)))?;
                }
            }
            Sample::Fill(fill) => fill.draw(area, bar[0], bar[1])?,
            Sample::Bar(grey) => {
                area.draw(&Rectangle::new(bar, RGBColor(*grey, *grey, *grey).filled()))?;
                outline(area, bar, 40)?;
            }
        }
        area.draw_text(&formula(name), &text(TEXT).pos(Pos::new(HPos::Left, VPos::Center)), (x + 1380, y))?;
    }
    Ok(())
}

/// Colour of axes and text.
pub const INK: RGBColor = RGBColor(25, 25, 25);
/// Colour of a grid.
pub const GRID: RGBColor = RGBColor(225, 225, 225);
/// Name of the line at which a block on a rigid base is in unstable equilibrium.
const LEVEL: &str = "|θ| = α";
/// Greatest |θ|/α that a picture shows: a block is on its way over long before.
pub const MOST_ROTATION: f64 = 1.5;
/// Colour of shaded areas.
pub const BAND: RGBColor = RGBColor(228, 228, 228);

/// A curve: its look, and its pieces, each drawn without a gap.
pub struct Curve {
    /// Its look.
    pub look: Look,
    /// Its pieces.
    pub pieces: Vec<Vec<(f64, f64)>>,
    /// Whether a cross stands at its end: the run ended there.
    pub ends: bool,
}

/// A bar under a chart that says where along the abscissa a curve's blocks separate or overturn.
pub struct Lane {
    /// The look of the curve.
    pub look: Look,
    /// The range that the bar has, and its parts.
    pub range: Range<f64>,
    /// What is so where.
    pub parts: Vec<(Range<f64>, Fill)>,
}

/// Filling of a part of a lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// Complete separation: grey.
    Separated,
    /// Overturning: black.
    Overturned,
    /// A run that ended before its outcome was known: light grey.
    Undecided,
    /// A run that failed: a cross.
    Failed,
}

impl Fill {
    /// What it stands for.
    pub fn name(self) -> &'static str {
        match self {
            Fill::Separated => "complete separation",
            Fill::Overturned => "overturning",
            Fill::Undecided => "undecided",
            Fill::Failed => "run failed",
        }
    }

    fn draw(self, area: &Area, from: (i32, i32), to: (i32, i32)) -> Drawn {
        let colour = match self {
            Fill::Separated => RGBColor(165, 165, 165),
            Fill::Overturned => INK,
            Fill::Undecided => RGBColor(220, 220, 220),
            Fill::Failed => {
                outline(area, [from, to], 30)?;
                for diagonal in [[from, to], [(from.0, to.1), (to.0, from.1)]] {
                    area.draw(&PathElement::new(diagonal, INK.stroke_width(30)))?;
                }
                return Ok(());
            }
        };
        area.draw(&Rectangle::new([from, to].map(whole), colour.filled()))?;
        Ok(())
    }
}

/// A part of the plane of a chart.
pub struct Cell {
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
    /// What stands over it.
    pub title: String,
    /// Name and range of the abscissa.
    pub x: (&'a str, Range<f64>),
    /// Name and range of the ordinate.
    pub y: (&'a str, Range<f64>),
    /// Range of the ordinate that is shaded.
    pub band: Option<Range<f64>>,
    /// Shaded areas: abscissa, lower and upper ordinate of each point of one.
    pub areas: Vec<Vec<(f64, f64, f64)>>,
    /// Filled cells.
    pub cells: Vec<Cell>,
    /// Points that are marked with a cross.
    pub crosses: Vec<(f64, f64)>,
    /// Points that are marked with a circle.
    pub circles: Vec<(f64, f64)>,
    /// Points that are marked with a short upright line.
    pub ticks: Vec<(f64, f64)>,
    /// Curves, those that lie below first.
    pub curves: Vec<Curve>,
    /// Whether lines mark the ordinates ±1 as |θ| = α.
    pub marks_alpha: bool,
    /// Names of ordinates, in place of numbers.
    pub names: Vec<(f64, &'static str)>,
    /// Vertical lines.
    pub verticals: Vec<(Look, f64)>,
    /// Texts that begin at a point of the chart.
    pub notes: Vec<((f64, f64), String)>,
    /// What stands in its middle in place of curves.
    pub message: String,
    /// Lanes under it.
    pub lanes: Vec<Lane>,
}

impl Chart<'_> {
    /// Draws it into a part of the drawing.
    pub fn draw(&self, root: &Area, area: &Area) -> Drawn {
        let (head, body) = area.split_vertically(if self.title.is_empty() { 120 } else { 700 });
        let style = text(TEXT).pos(Pos::new(HPos::Left, VPos::Center));
        if !self.title.is_empty() {
            head.draw_text(&formula(&self.title), &style, (SIDES[0] as i32, 400))?;
        }
        let (body, under) = body.split_vertically(body.dim_in_pixel().1 - lanes_height(self.lanes.len()));
        let mut chart = ChartBuilder::on(&body)
            .margin_right(SIDES[1])
            .margin_left(EDGE)
            .margin_top(60)
            .set_label_area_size(LabelAreaPosition::Left, SIDES[0] - EDGE)
            .set_label_area_size(LabelAreaPosition::Bottom, if self.x.0.is_empty() { 180 } else { 960 })
            .build_cartesian_2d(self.x.1.clone(), self.y.1.clone())?;
        let abscissa = |x: &f64| if self.x.0.is_empty() { String::new() } else { tick(*x, &self.x.1) };
        let ordinate = |y: &f64| tick(*y, &self.y.1);
        let mut mesh = chart.configure_mesh();
        mesh.light_line_style(TRANSPARENT)
            .bold_line_style(ShapeStyle::from(GRID).stroke_width(30))
            .axis_style(ShapeStyle::from(INK).stroke_width(30))
            .label_style(text(0.9 * TEXT))
            .axis_desc_style(text(TEXT))
            .x_desc(formula(self.x.0))
            .y_desc(formula(self.y.0))
            .x_labels(9)
            .y_labels(6)
            .set_all_tick_mark_size(50)
            .x_label_formatter(&abscissa)
            .y_label_formatter(&ordinate);
        if !self.names.is_empty() {
            mesh.disable_y_mesh().y_labels(0);
        }
        mesh.draw()?;
        let across = |y: f64| vec![(self.x.1.start, y), (self.x.1.end, y)];
        if let Some(band) = &self.band {
            let corners = [(self.x.1.start, band.start), (self.x.1.end, band.end)];
            chart.draw_series(std::iter::once(Rectangle::new(corners, BAND.filled())))?;
        }
        for area in &self.areas {
            let below = area.iter().map(|(x, low, _)| (*x, *low));
            let corners: Vec<(f64, f64)> = below.chain(area.iter().rev().map(|(x, _, high)| (*x, *high))).collect();
            chart.draw_series(std::iter::once(Polygon::new(corners, BAND.filled())))?;
        }
        for Cell { x, y, grey } in &self.cells {
            let corners = [(x.start, y.start), (x.end, y.end)].map(|corner| whole(chart.backend_coord(&corner)));
            root.draw(&Rectangle::new(corners, RGBColor(*grey, *grey, *grey).filled()))?;
        }
        if self.y.1.start < 0.0 {
            chart.draw_series(std::iter::once(PathElement::new(across(0.0), INK.stroke_width(20))))?;
        }
        for level in [-1.0, 1.0].into_iter().filter(|level| self.marks_alpha && self.y.1.contains(level)) {
            let [left, right] = [self.x.1.start, self.x.1.end].map(|x| chart.backend_coord(&(x, level)));
            Look::LEVEL.draw(root, &[left, right])?;
            let (name, below) = if self.y.1.start < 0.0 && level < 0.0 { ("θ = −α", true) } else { (LEVEL, false) };
            let anchor = Pos::new(HPos::Right, if below { VPos::Top } else { VPos::Bottom });
            let y = right.1 + if below { 60 } else { -60 };
            root.draw_text(name, &text(0.8 * TEXT).pos(anchor), (right.0 - 100, y))?;
        }
        for (look, x) in &self.verticals {
            let ends = [self.y.1.start, self.y.1.end].map(|y| chart.backend_coord(&(*x, y)));
            look.draw(root, &ends)?;
        }
        for curve in &self.curves {
            for piece in &curve.pieces {
                for part in clipped(piece, &self.y.1) {
                    let at: Vec<(i32, i32)> = part.iter().map(|point| chart.backend_coord(point)).collect();
                    curve.look.draw(root, &at)?;
                }
                if let (true, Some(end)) = (curve.ends, piece.last().filter(|end| self.y.1.contains(&end.1))) {
                    root.draw(&Cross::new(chart.backend_coord(end), 160, INK.stroke_width(70)))?;
                }
            }
        }
        for at in &self.crosses {
            root.draw(&Cross::new(chart.backend_coord(at), 160, INK.stroke_width(70)))?;
        }
        for at in &self.ticks {
            let (x, y) = chart.backend_coord(at);
            root.draw(&PathElement::new(vec![(x, y - 120), (x, y + 120)], INK.stroke_width(20)))?;
        }
        for at in &self.circles {
            root.draw(&Circle::new(chart.backend_coord(at), CIRCLE, WHITE.filled()))?;
            root.draw(&Circle::new(chart.backend_coord(at), CIRCLE, INK.stroke_width(40)))?;
        }
        for (at, note) in &self.notes {
            let (x, y) = chart.backend_coord(at);
            root.draw_text(&formula(note), &style, (x, y))?;
        }
        for (y, name) in &self.names {
            let (x, y) = chart.backend_coord(&(self.x.1.start, *y));
            root.draw_text(name, &text(0.9 * TEXT).pos(Pos::new(HPos::Right, VPos::Center)), (x - 150, y))?;
        }
        if !self.message.is_empty() {
            let middle = [&self.x.1, &self.y.1].map(|range| 0.5 * (range.start + range.end));
            let centred = text(TEXT).pos(Pos::new(HPos::Center, VPos::Center));
            root.draw_text(&self.message, &centred, chart.backend_coord(&(middle[0], middle[1])))?;
        }
        let left = area.get_base_pixel().0;
        for (i, lane) in self.lanes.iter().enumerate() {
            let top = under.get_base_pixel().1 + 180 + (LANE[0] * i as u32) as i32;
            lane.draw(root, (left + EDGE as i32, top), |x| chart.backend_coord(&(x, self.y.1.start)).0)?;
        }
        Ok(())
    }
}

impl Lane {
    /// Draws it from a corner at its left; `pixel` gives the place of an abscissa.
    fn draw(&self, root: &Area, (left, top): (i32, i32), pixel: impl Fn(f64) -> i32) -> Drawn {
        let bottom = top + LANE[1] as i32;
        let middle = (top + bottom) / 2;
        self.look.draw(root, &[(left, middle), (left + SIDES[0] as i32 - 480, middle)])?;
        for (part, fill) in &self.parts {
            let from = pixel(part.start);
            fill.draw(root, (from, top), (pixel(part.end).max(from + 20), bottom))?;
        }
        let frame = [(pixel(self.range.start), top), (pixel(self.range.end), bottom)];
        outline(root, frame, 20)
    }
}

/// Draws the outline of a rectangle between two corners.
pub fn outline(area: &Area, [(x0, y0), (x1, y1)]: [(i32, i32); 2], width: u32) -> Drawn {
    area.draw(&PathElement::new([(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)], INK.stroke_width(width)))?;
    Ok(())
}

/// The nearest corner of a pixel: filled areas that share such corners have no seam.
fn whole((x, y): (i32, i32)) -> (i32, i32) {
    let pixel = PIXEL as i32;
    let near = |at: i32| (at + pixel / 2).div_euclid(pixel) * pixel;
    (near(x), near(y))
}

/// Height of the lanes of a chart.
pub fn lanes_height(count: usize) -> u32 {
    LANE[0] * count as u32 + if count == 0 { 0 } else { 300 }
}

/// The parts of a line within a range of its ordinate.
fn clipped(line: &[(f64, f64)], range: &Range<f64>) -> Vec<Vec<(f64, f64)>> {
    let mut parts: Vec<Vec<(f64, f64)>> = Vec::new();
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
        match parts.last_mut() {
            Some(part) if is_open => part.push(to),
            _ => parts.push(vec![from, to]),
        }
        is_open = to == pair[1];
    }
    parts
}

/// A range of rotations θ/α for the ordinate: around all values and zero, but not beyond ±1.5.
pub fn rotations(values: impl Iterator<Item = f64>) -> Range<f64> {
    let Range { start, end } = range(values);
    start.max(-MOST_ROTATION)..end.min(MOST_ROTATION)
}

/// A range around these values and zero, with a margin.
pub fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    let margin = 0.06 * (high - low).max(1e-12);
    if low < 0.0 { low - margin..high + margin } else { 0.0..high + margin }
}
