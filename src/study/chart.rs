//! Curves → charts that read without colours, with lanes for what curves cannot show, and the keys to both.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::study::formula::{self, formula, typeset};
use crate::study::letters::FONT_FAMILY;
use crate::study::look::Look;
use crate::study::picture::PictureError;
use crate::study::plot::{GRID, INK, short};

/// A part of a drawing.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// What drawing may end in.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Width of a drawing (pixels). Sizes of text are such that it can be read where 1000 are left of them.
pub const WIDTH: u32 = 2400;
/// Size of the text (pixels).
pub const TEXT: f64 = 34.0;
/// Height of a row of keys (pixels).
const KEY_ROW: u32 = 60;
/// Height of a lane and of the bar in it (pixels).
const LANE: [u32; 2] = [34, 20];
/// Radius of a circle that marks a point (pixels).
const CIRCLE: i32 = 12;
/// Room at the left of a chart for labels, and at its right (pixels).
const SIDES: [u32; 2] = [180, 40];
/// Of the room at the left, what stays empty (pixels).
const EDGE: u32 = 24;

/// Makes a drawing of this height (pixels).
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
    Ok(typeset(&svg))
}

/// The style of a text of this size (pixels).
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

/// Height of the rows that these keys take (pixels).
pub fn keys_height(keys: &[(Sample, String)]) -> u32 {
    KEY_ROW * places(keys).last().map_or(0, |last| last.1 + 1)
}

/// Place (pixels from the left) and row of each key.
fn places(keys: &[(Sample, String)]) -> Vec<(i32, u32)> {
    let (mut x, mut row) = (SIDES[0] as i32, 0);
    let mut places = Vec::new();
    for (_, name) in keys {
        let width = 200 + formula::width(name, TEXT) as i32;
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
        let bar = [(x, y - 14), (x + 120, y + 14)];
        match sample {
            Sample::Curve(look) => look.draw(area, &[(x, y), (x + 120, y)])?,
            Sample::Band => area.draw(&Rectangle::new(bar, BAND.filled()))?,
            Sample::Cross => area.draw(&Cross::new((x + 60, y), 16, INK.stroke_width(7)))?,
            Sample::Circle => {
                area.draw(&Circle::new((x + 60, y), CIRCLE, WHITE.filled()))?;
                area.draw(&Circle::new((x + 60, y), CIRCLE, INK.stroke_width(4)))?;
            }
            Sample::Ticks => {
                for tick in [x + 40, x + 52, x + 70, x + 76] {
                    area.draw(&PathElement::new(vec![(tick, y - 12), (tick, y + 12)], INK.stroke_width(2)))?;
                }
            }
            Sample::Fill(fill) => fill.draw(area, bar[0], bar[1])?,
            Sample::Bar(grey) => {
                area.draw(&Rectangle::new(bar, RGBColor(*grey, *grey, *grey).filled()))?;
                area.draw(&Rectangle::new(bar, INK.stroke_width(4)))?;
            }
        }
        area.draw_text(&formula(name), &text(TEXT).pos(Pos::new(HPos::Left, VPos::Center)), (x + 138, y))?;
    }
    Ok(())
}

const BAND: RGBColor = RGBColor(228, 228, 228);

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
        let style = match self {
            Fill::Separated => RGBColor(165, 165, 165).filled(),
            Fill::Overturned => INK.filled(),
            Fill::Undecided => RGBColor(220, 220, 220).filled(),
            Fill::Failed => INK.stroke_width(3),
        };
        area.draw(&Rectangle::new([from, to], style))?;
        if self == Fill::Failed {
            area.draw(&PathElement::new(vec![from, to], style))?;
            area.draw(&PathElement::new(vec![(from.0, to.1), (to.0, from.1)], style))?;
        }
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
        let (head, body) = area.split_vertically(if self.title.is_empty() { 12 } else { 70 });
        let style = text(TEXT).pos(Pos::new(HPos::Left, VPos::Center));
        if !self.title.is_empty() {
            head.draw_text(&formula(&self.title), &style, (SIDES[0] as i32, 40))?;
        }
        let (body, under) = body.split_vertically(body.dim_in_pixel().1 - lanes_height(self.lanes.len()));
        let mut chart = ChartBuilder::on(&body)
            .margin_right(SIDES[1])
            .margin_left(EDGE)
            .margin_top(6)
            .set_label_area_size(LabelAreaPosition::Left, SIDES[0] - EDGE)
            .set_label_area_size(LabelAreaPosition::Bottom, 96)
            .build_cartesian_2d(self.x.1.clone(), self.y.1.clone())?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(ShapeStyle::from(GRID).stroke_width(3))
            .axis_style(ShapeStyle::from(INK).stroke_width(3))
            .label_style(text(0.9 * TEXT))
            .axis_desc_style(text(TEXT))
            .x_desc(formula(self.x.0))
            .y_desc(formula(self.y.0))
            .x_labels(9)
            .y_labels(6)
            .x_label_formatter(&|x| short(*x))
            .y_label_formatter(&|y| short(*y))
            .draw()?;
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
        chart.draw_series(self.cells.iter().map(|Cell { x, y, grey }| {
            Rectangle::new([(x.start, y.start), (x.end, y.end)], RGBColor(*grey, *grey, *grey).filled())
        }))?;
        if self.y.1.start < 0.0 {
            chart.draw_series(std::iter::once(PathElement::new(across(0.0), INK.stroke_width(2))))?;
        }
        for (look, x) in &self.verticals {
            let ends = [self.y.1.start, self.y.1.end].map(|y| chart.backend_coord(&(*x, y)));
            look.draw(root, &ends)?;
        }
        for curve in &self.curves {
            for piece in &curve.pieces {
                let at: Vec<(i32, i32)> = piece.iter().map(|point| chart.backend_coord(point)).collect();
                curve.look.draw(root, &at)?;
                if let (true, Some(&end)) = (curve.ends, at.last()) {
                    root.draw(&Cross::new(end, 16, INK.stroke_width(7)))?;
                }
            }
        }
        for at in &self.crosses {
            root.draw(&Cross::new(chart.backend_coord(at), 16, INK.stroke_width(7)))?;
        }
        for at in &self.ticks {
            let (x, y) = chart.backend_coord(at);
            root.draw(&PathElement::new(vec![(x, y - 12), (x, y + 12)], INK.stroke_width(2)))?;
        }
        for at in &self.circles {
            root.draw(&Circle::new(chart.backend_coord(at), CIRCLE, WHITE.filled()))?;
            root.draw(&Circle::new(chart.backend_coord(at), CIRCLE, INK.stroke_width(4)))?;
        }
        for (at, note) in &self.notes {
            let (x, y) = chart.backend_coord(at);
            root.draw_text(&formula(note), &style, (x, y))?;
        }
        if !self.message.is_empty() {
            let middle = [&self.x.1, &self.y.1].map(|range| 0.5 * (range.start + range.end));
            let centred = text(TEXT).pos(Pos::new(HPos::Center, VPos::Center));
            root.draw_text(&self.message, &centred, chart.backend_coord(&(middle[0], middle[1])))?;
        }
        let left = area.get_base_pixel().0;
        for (i, lane) in self.lanes.iter().enumerate() {
            let top = under.get_base_pixel().1 + 18 + (LANE[0] * i as u32) as i32;
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
        self.look.draw(root, &[(left, middle), (left + SIDES[0] as i32 - 48, middle)])?;
        for (part, fill) in &self.parts {
            let from = pixel(part.start);
            fill.draw(root, (from, top), (pixel(part.end).max(from + 2), bottom))?;
        }
        let frame = [(pixel(self.range.start), top), (pixel(self.range.end), bottom)];
        root.draw(&Rectangle::new(frame, INK.stroke_width(2)))?;
        Ok(())
    }
}

/// Height of so many lanes (pixels).
pub fn lanes_height(count: usize) -> u32 {
    LANE[0] * count as u32 + if count == 0 { 0 } else { 30 }
}

/// A range around these values and zero, with a margin.
pub fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    let margin = 0.06 * (high - low).max(1e-12);
    if low < 0.0 { low - margin..high + margin } else { 0.0..high + margin }
}
