//! Drawing functions → SVG, in units of a tenth of a pixel.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::formula::typeset;
use crate::glyphs::FONT_FAMILY;
use crate::picture::PictureError;

/// A part of a drawing.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Result of a drawing function.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// A point of a drawing, in units from its upper left corner.
pub type Position = (i32, i32);

/// Units per pixel. Coordinates are whole numbers of units, fine enough for curves without steps.
pub const PIXEL: u32 = 10;
/// Width of a page. All lengths are in units; text stays readable down to a width of 1000 pixels.
pub const WIDTH: u32 = 2400 * PIXEL;
/// Font size.
pub const TEXT: f64 = 340.0;

/// Colour of axes and text.
pub const INK: RGBColor = RGBColor(25, 25, 25);
/// Colour of shaded areas.
pub const SHADE: RGBColor = grey(228);

/// Draws an SVG picture of this height.
///
/// # Errors
/// The drawing fails.
pub fn drawing(height: u32, draw: impl FnOnce(&Area) -> Drawn) -> Result<String, PictureError> {
    drawing_of([WIDTH, height], draw)
}

/// Draws an SVG picture of this width and height.
///
/// # Errors
/// The drawing fails.
pub fn drawing_of([width, height]: [u32; 2], draw: impl FnOnce(&Area) -> Drawn) -> Result<String, PictureError> {
    let mut svg = String::new();
    let result = || -> Drawn {
        let root = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
        root.fill(&WHITE)?;
        draw(&root)?;
        root.present()?;
        Ok(())
    };
    result().map_err(|error| PictureError::Drawing(error.to_string()))?;
    // The view box keeps the units; viewers and PNG take the size in pixels.
    let size = |pixel: u32| format!("width=\"{}\" height=\"{}\" viewBox", width / pixel, height / pixel);
    // Without this, viewers blend the edges of adjacent rectangles with the background, which shows as hairlines.
    let svg = svg.replace("<rect ", "<rect shape-rendering=\"crispEdges\" ");
    Ok(typeset(&svg.replacen(&size(1), &size(PIXEL), 1)))
}

/// Returns the text style for a font size.
pub fn text(size: f64) -> TextStyle<'static> {
    // plotters expects the line height, 1.24 times the font size.
    (FONT_FAMILY, 1.24 * size).into_font().color(&INK)
}

/// Returns the style of a text whose anchor is not its upper left corner.
pub fn anchored(size: f64, horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
    text(size).pos(Pos::new(horizontal, vertical))
}

/// Returns a grey of this level, 0 (black) to 255 (white).
pub const fn grey(level: u8) -> RGBColor {
    RGBColor(level, level, level)
}

/// Fills the rectangle between two corners.
///
/// # Errors
/// The drawing fails.
pub fn fill(area: &Area, corners: [Position; 2], colour: RGBColor) -> Drawn {
    Ok(area.draw(&Rectangle::new(corners, colour.filled()))?)
}

/// Draws a line through these points.
///
/// # Errors
/// The drawing fails.
pub fn line(area: &Area, points: impl Into<Vec<Position>>, width: u32) -> Drawn {
    Ok(area.draw(&PathElement::new(points, INK.stroke_width(width)))?)
}

/// Draws the outline of the rectangle between two corners.
///
/// # Errors
/// The drawing fails.
pub fn outline(area: &Area, [(x0, y0), (x1, y1)]: [Position; 2], width: u32) -> Drawn {
    line(area, [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)], width)
}

/// Returns the nearest corner of a pixel. Filled areas that share such corners have no seam.
pub fn pixel_corner((x, y): Position) -> Position {
    let pixel = PIXEL as i32;
    let nearest = |unit: i32| (unit + pixel / 2).div_euclid(pixel) * pixel;
    (nearest(x), nearest(y))
}

/// Mark at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Diagonal cross.
    Cross,
    /// White circle with an outline.
    Circle,
    /// Short upright line.
    Tick,
}

impl Mark {
    /// Draws the mark.
    ///
    /// # Errors
    /// The drawing fails.
    pub fn draw(self, area: &Area, (x, y): Position) -> Drawn {
        match self {
            Mark::Cross => area.draw(&Cross::new((x, y), 160, INK.stroke_width(70)))?,
            Mark::Circle => {
                area.draw(&Circle::new((x, y), 120, WHITE.filled()))?;
                area.draw(&Circle::new((x, y), 120, INK.stroke_width(40)))?;
            }
            Mark::Tick => line(area, [(x, y - 120), (x, y + 120)], 20)?,
        }
        Ok(())
    }
}
