//! Line styles that differ in lightness and width as well as in colour, and stay visible where curves coincide.

use kurbo::{PathEl, Point};
use plotters::prelude::*;

use crate::canvas::{Area, Drawn, Position, grey};

/// Style of a curve; lengths in tenths of a pixel.
///
/// Where two curves coincide, the one drawn last is narrower and darker, or has gaps, so that both are visible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineStyle {
    /// Width of the line.
    width: u32,
    /// Colour of the line.
    colour: RGBColor,
    /// Lengths of dashes and gaps in turn; empty for a solid line.
    dashes: &'static [f64],
    /// Symbol at even distances along the line.
    marker: Option<Marker>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Marker {
    Circle,
    Disc,
    Triangle,
    Cross,
}

/// Styles in drawing order. The first three are solid, because dashes are lost where a curve oscillates.
const LAYERS: [LineStyle; 5] = [
    LineStyle::solid(90, RGBColor(120, 195, 240)),
    LineStyle::solid(60, RGBColor(200, 80, 0)),
    LineStyle::solid(30, RGBColor(20, 20, 20)),
    LineStyle { dashes: &[340.0, 140.0], ..LineStyle::solid(50, RGBColor(0, 110, 80)) },
    LineStyle { dashes: &[60.0, 110.0], ..LineStyle::solid(50, RGBColor(130, 0, 120)) },
];

impl LineStyle {
    /// Wide grey line on which others stay visible.
    pub const WIDE_GREY: LineStyle = LineStyle::solid(110, grey(175));
    /// Black line.
    pub const BLACK: LineStyle = LineStyle::solid(60, BLACK);
    /// Thin black line.
    pub const THIN: LineStyle = LineStyle::solid(30, BLACK);
    /// Thin dark blue line.
    pub const BLUE: LineStyle = LineStyle::solid(30, RGBColor(20, 60, 120));
    /// Thin orange line, lighter than [`LineStyle::BLUE`].
    pub const ORANGE: LineStyle = LineStyle::solid(30, RGBColor(235, 140, 40));
    /// Thin blue line, lighter than [`LineStyle::BLUE`].
    pub const LIGHT_BLUE: LineStyle = LineStyle::solid(30, RGBColor(105, 180, 235));
    /// Thin brown line, darker than [`LineStyle::ORANGE`].
    pub const BROWN: LineStyle = LineStyle::solid(30, RGBColor(130, 55, 0));
    /// Thin grey line, one of many.
    pub const FAINT: LineStyle = LineStyle::solid(30, grey(150));
    /// Black dashed line.
    pub const DASHED: LineStyle = LineStyle { dashes: &[220.0, 120.0], ..LineStyle::solid(50, BLACK) };
    /// Black dotted line.
    pub const DOTTED: LineStyle = LineStyle { dashes: &[50.0, 110.0], ..LineStyle::solid(50, BLACK) };
    /// Black line of dashes and dots.
    pub const DASH_DOTTED: LineStyle = LineStyle { dashes: &[340.0, 90.0, 50.0, 90.0], ..LineStyle::solid(40, BLACK) };
    /// Thin light line of a grid.
    pub const GRID: LineStyle = LineStyle::solid(30, grey(225));
    /// Thin grey dashed line at a reference level.
    pub const LEVEL: LineStyle = LineStyle { dashes: &[140.0, 90.0], ..LineStyle::solid(30, grey(110)) };

    const fn solid(width: u32, colour: RGBColor) -> LineStyle {
        LineStyle { width, colour, dashes: &[], marker: None }
    }

    /// Returns the style of a curve by its number from 0. Lines distinguish the first five, markers the next twenty.
    pub fn of(curve: usize) -> LineStyle {
        let markers = [None, Some(Marker::Circle), Some(Marker::Disc), Some(Marker::Triangle), Some(Marker::Cross)];
        LineStyle { marker: markers[curve / LAYERS.len() % markers.len()], ..LAYERS[curve % LAYERS.len()] }
    }

    /// Draws a line through these points. A single point draws nothing.
    ///
    /// # Errors
    /// The drawing fails.
    pub fn draw(&self, area: &Area, points: &[Position]) -> Drawn {
        let style = self.colour.stroke_width(self.width);
        let strokes = match self.dashes {
            _ if points.len() < 2 => Vec::new(),
            [] => vec![points.to_vec()],
            pattern => dashes(points, 0.0, pattern),
        };
        for stroke in strokes {
            // The stub of a dash at the end of a line would look like a mark across it.
            let [(x0, y0), ..] = stroke[..] else { continue };
            if stroke.iter().any(|(x, y)| (x - x0).abs().max((y - y0).abs()) >= 30) {
                area.draw(&PathElement::new(stroke, style))?;
            }
        }
        let Some(marker) = self.marker else { return Ok(()) };
        // The first marker stands a little inside, the others at even distances.
        for start in dashes(points, 980.0, &[10.0, 1390.0]) {
            marker.draw(area, start[0])?;
        }
        Ok(())
    }
}

impl Marker {
    fn draw(self, area: &Area, at: Position) -> Drawn {
        let (open, full) = (BLACK.stroke_width(40), BLACK.filled());
        match self {
            Marker::Circle => {
                area.draw(&Circle::new(at, 110, WHITE.filled()))?;
                area.draw(&Circle::new(at, 110, open))?;
            }
            Marker::Disc => area.draw(&Circle::new(at, 100, full))?,
            Marker::Triangle => area.draw(&TriangleMarker::new(at, 140, full))?,
            Marker::Cross => area.draw(&Cross::new(at, 110, open))?,
        }
        Ok(())
    }
}

/// Returns the dashes of a line whose pattern starts at `offset`.
fn dashes(points: &[Position], offset: f64, pattern: &[f64]) -> Vec<Vec<Position>> {
    let mut points = points.to_vec();
    points.dedup();
    let points = points.into_iter().map(|(x, y)| (f64::from(x), f64::from(y)));
    let line = points.enumerate().map(|(i, point)| match i {
        0 => PathEl::MoveTo(point.into()),
        _ => PathEl::LineTo(point.into()),
    });
    let unit = |point: Point| (point.x.round() as i32, point.y.round() as i32);
    let mut dashes: Vec<Vec<Position>> = Vec::new();
    for element in kurbo::dash(line, offset, pattern) {
        match element {
            PathEl::MoveTo(point) => dashes.push(vec![unit(point)]),
            PathEl::LineTo(point) => dashes.last_mut().into_iter().for_each(|dash| dash.push(unit(point))),
            // A polyline is open and has no curves.
            PathEl::QuadTo(..) | PathEl::CurveTo(..) | PathEl::ClosePath => {}
        }
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::drawing;
    use crate::picture::PictureFormat;
    use resvg::tiny_skia::Pixmap;

    /// Dashes go round corners and keep the lengths and gaps of the pattern.
    #[test]
    fn dashes_follow_the_line() {
        let mut found = dashes(&[(0, 0), (100, 0), (100, 0), (100, 100)], 0.0, &[60.0, 20.0]);
        found.sort();
        assert_eq!(found, [vec![(0, 0), (60, 0)], vec![(80, 0), (100, 0), (100, 40)], vec![(100, 60), (100, 100)]]);
        assert_eq!(dashes(&[(0, 0), (300, 0)], 98.0, &[1.0, 139.0])[0][0], (42, 0));
    }

    /// Draws horizontal lines and returns the pixels.
    fn pixels(styles: &[LineStyle]) -> Vec<[u8; 3]> {
        let svg =
            drawing(600, |root| styles.iter().try_for_each(|style| style.draw(root, &[(1000, 300), (23_000, 300)])));
        let png = PictureFormat::Png.encode(&svg.unwrap()).unwrap();
        let pixmap = Pixmap::decode_png(&png).unwrap();
        pixmap.pixels().iter().map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect()
    }

    /// Two curves on the same line both show at least a fifth of their pixels, and all styles differ.
    #[test]
    fn coinciding_curves_are_seen() {
        let is_other = |a: &[u8; 3], b: &[u8; 3]| (0..3).any(|channel| a[channel].abs_diff(b[channel]) > 40);
        let differ = |a: &[[u8; 3]], b: &[[u8; 3]]| a.iter().zip(b).filter(|(a, b)| is_other(a, b)).count() as f64;
        let white = pixels(&[]);
        for (i, &below) in LAYERS.iter().enumerate() {
            for &above in &LAYERS[i + 1..] {
                let [both, a, b] = [&[below, above][..], &[below], &[above]].map(pixels);
                let [seen_below, seen_above] =
                    [differ(&both, &b) / differ(&a, &white), differ(&both, &a) / differ(&b, &white)];
                assert!(seen_below > 0.2 && seen_above > 0.3, "{below:?} {above:?}: {seen_below} {seen_above}");
            }
        }
        let styles: Vec<LineStyle> = (0..25).map(LineStyle::of).collect();
        assert!(styles.iter().enumerate().all(|(i, style)| !styles[..i].contains(style)));
    }

    /// Converts a linear RGB colour to CIE L*a*b*.
    fn lab([r, g, b]: [f64; 3]) -> [f64; 3] {
        let x = (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505;
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        let z = (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089;
        let [x, y, z] = [x, y, z].map(|t: f64| if t > 0.008856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 });
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// Colour vision deficiencies are simulated by the matrices of Machado, Oliveira and Fernandes (2009). Solid styles differ in lightness
    /// as well, for grey prints.
    #[test]
    fn curves_differ_for_colour_blind_readers_and_in_grey() {
        let [protan, deutan, tritan] = [
            [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
            [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
            [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
        ];
        let normal = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let linear = |RGBColor(r, g, b): RGBColor| {
            [r, g, b].map(|c| {
                let c = f64::from(c) / 255.0;
                if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
            })
        };
        for sight in [normal, protan, deutan, tritan] {
            let seen = |style: &LineStyle| {
                let from = linear(style.colour);
                let row = |row: [f64; 3]| (row[0] * from[0] + row[1] * from[1] + row[2] * from[2]).clamp(0.0, 1.0);
                lab(sight.map(row))
            };
            for (i, a) in LAYERS.iter().enumerate() {
                for b in &LAYERS[i + 1..] {
                    let [one, other] = [seen(a), seen(b)];
                    let apart = (0..3).map(|k| (one[k] - other[k]).powi(2)).sum::<f64>().sqrt();
                    // A difference of 2.3 is just noticeable side by side.
                    assert!(apart > 25.0, "{a:?} {b:?}: {apart}");
                    if a.dashes.is_empty() && b.dashes.is_empty() {
                        assert!((one[0] - other[0]).abs() > 20.0, "{a:?} {b:?}: lightness {} {}", one[0], other[0]);
                    }
                }
            }
        }
    }
}
