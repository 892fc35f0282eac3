//! Panels → a page with its caption; curves → a chart that reads without colours.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::study::look::Look;
use crate::study::picture::{FONT_FAMILY, PictureError};
use crate::study::plot::{GRID, INK, LEFT, short};

/// A part of the page.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// What drawing may end in.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Height of a line of the caption (pixels).
const LINE: u32 = 38;

/// Draws a page of this width and height (pixels, without its head): number and caption, and under them what `body` draws,
/// which is given the whole page and the part under the head.
pub fn page(
    number: u8,
    caption: &str,
    [width, height]: [u32; 2],
    body: impl FnOnce(&Area, &Area) -> Drawn,
) -> Result<String, PictureError> {
    let lines = wrapped(caption, width as usize / 13 - 6);
    let head = 96 + LINE * lines.len() as u32;
    let mut svg = String::new();
    let draw = || -> Drawn {
        let root = SVGBackend::with_string(&mut svg, (width, head + height)).into_drawing_area();
        root.fill(&WHITE)?;
        let (top, rest) = root.split_vertically(head);
        top.draw_text(&format!("Figure {number}"), &text(36), (40, 24))?;
        for (i, line) in lines.iter().enumerate() {
            top.draw_text(line, &text(26), (40, 78 + (LINE * i as u32) as i32))?;
        }
        body(&root, &rest)?;
        root.present()?;
        Ok(())
    };
    draw().map_err(|error| PictureError::Drawing(error.to_string()))?;
    Ok(svg)
}

/// The style of a text of this size.
pub fn text(size: u32) -> TextStyle<'static> {
    (FONT_FAMILY, size).into_font().color(&INK)
}

/// A text in lines of at most so many characters.
fn wrapped(text: &str, most: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        if !lines[last].is_empty() && lines[last].chars().count() + 1 + word.chars().count() > most {
            lines.push(word.into());
        } else {
            if !lines[last].is_empty() {
                lines[last].push(' ');
            }
            lines[last].push_str(word);
        }
    }
    lines
}

/// Draws keys of curves in a row, from the numbers of their looks and their names.
pub fn keys(area: &Area, curves: &[(usize, String)]) -> Drawn {
    let mut x = LEFT as i32 + 32;
    for (look, name) in curves {
        Look::of(*look).draw(area, &[(x, 24), (x + 50, 24), (x + 100, 24)])?;
        area.draw_text(name, &text(26), (x + 116, 8))?;
        x += 170 + 16 * name.chars().count() as i32;
    }
    Ok(())
}

/// A curve: its look, and its pieces, each drawn without a gap.
pub struct Curve {
    /// Number of its look.
    pub look: usize,
    /// Its pieces.
    pub pieces: Vec<Vec<(f64, f64)>>,
    /// Whether a cross stands at its end: the run ended there.
    pub ends: bool,
}

/// A chart.
pub struct Chart<'a> {
    /// What stands over it.
    pub title: String,
    /// Name and range of the abscissa.
    pub x: (&'a str, Range<f64>),
    /// Name and range of the ordinate.
    pub y: (&'a str, Range<f64>),
    /// Curves.
    pub curves: Vec<Curve>,
}

impl Chart<'_> {
    /// Draws it into a part of the page.
    pub fn draw(&self, root: &Area, area: &Area) -> Drawn {
        let (head, body) = area.split_vertically(if self.title.is_empty() { 8 } else { 52 });
        if !self.title.is_empty() {
            head.draw_text(&self.title, &text(26), (LEFT as i32 + 20, 16))?;
        }
        let mut chart = ChartBuilder::on(&body)
            .margin_right(40)
            .margin_left(16)
            .margin_top(4)
            .set_label_area_size(LabelAreaPosition::Left, LEFT)
            .set_label_area_size(LabelAreaPosition::Bottom, if self.x.0.is_empty() { 44 } else { 84 })
            .build_cartesian_2d(self.x.1.clone(), self.y.1.clone())?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(ShapeStyle::from(GRID).stroke_width(2))
            .axis_style(ShapeStyle::from(INK).stroke_width(2))
            .label_style(text(24))
            .axis_desc_style(text(26))
            .x_desc(self.x.0)
            .y_desc(self.y.0)
            .x_labels(9)
            .y_labels(6)
            .x_label_formatter(&|x| short(*x))
            .y_label_formatter(&|y| short(*y))
            .draw()?;
        if self.y.1.start < 0.0 {
            let zero = [self.x.1.start, self.x.1.end].map(|x| (x, 0.0)).to_vec();
            chart.draw_series(std::iter::once(PathElement::new(zero, INK.mix(0.45))))?;
        }
        for curve in &self.curves {
            for piece in &curve.pieces {
                let at: Vec<(i32, i32)> = piece.iter().map(|point| chart.backend_coord(point)).collect();
                Look::of(curve.look).draw(root, &at)?;
                if let (true, Some(&end)) = (curve.ends, at.last()) {
                    root.draw(&Cross::new(end, 13, INK.stroke_width(5)))?;
                }
            }
        }
        Ok(())
    }
}

/// A range around these values and zero, with a margin.
pub fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    let margin = 0.06 * (high - low).max(1e-12);
    if low < 0.0 { low - margin..high + margin } else { 0.0..high + margin }
}
