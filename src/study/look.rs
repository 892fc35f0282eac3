//! Curves that differ in lightness and width as well as in colour, and stay visible where they coincide.

use kurbo::{PathEl, Point};
use plotters::prelude::*;

use crate::study::chart::{Area, Drawn};

/// Style of a curve; lengths in tenths of a pixel. Where two curves coincide, the one drawn last is narrower and darker, or has
/// gaps, so that both are visible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Width of the line.
    pub width: u32,
    /// Colour of the line.
    pub colour: RGBColor,
    /// Lengths of dashes and gaps in turn; none for a solid line.
    pub dashes: &'static [f64],
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

/// Looks of curves in drawing order. The first three are solid, since dashes are lost where a curve jumps up and down.
const LAYERS: [Look; 5] = [
    Look { width: 90, colour: RGBColor(120, 195, 240), dashes: &[], marker: None },
    Look { width: 60, colour: RGBColor(200, 80, 0), dashes: &[], marker: None },
    Look { width: 30, colour: RGBColor(20, 20, 20), dashes: &[], marker: None },
    Look { width: 50, colour: RGBColor(0, 110, 80), dashes: &[340.0, 140.0], marker: None },
    Look { width: 50, colour: RGBColor(130, 0, 120), dashes: &[60.0, 110.0], marker: None },
];

impl Look {
    /// A wide, light, solid line on which others are visible.
    pub const SOLID: Look = Look { width: 110, colour: RGBColor(175, 175, 175), dashes: &[], marker: None };
    /// A black, solid line.
    pub const BLACK: Look = Look { width: 60, colour: BLACK, dashes: &[], marker: None };
    /// A black, narrow, solid line.
    pub const THIN: Look = Look { width: 30, ..Look::BLACK };
    /// A dark blue, narrow line.
    pub const DARK: Look = Look { width: 30, colour: RGBColor(20, 60, 120), dashes: &[], marker: None };
    /// An orange, narrow line, lighter than [`Look::DARK`].
    pub const LIGHT: Look = Look { width: 30, colour: RGBColor(235, 140, 40), dashes: &[], marker: None };
    /// A light, narrow, solid line, one of many.
    pub const FAINT: Look = Look { width: 30, colour: RGBColor(150, 150, 150), dashes: &[], marker: None };
    /// A black, dashed line.
    pub const DASHED: Look = Look { width: 50, colour: BLACK, dashes: &[220.0, 120.0], marker: None };
    /// A black, dotted line.
    pub const DOTTED: Look = Look { width: 50, colour: BLACK, dashes: &[50.0, 110.0], marker: None };
    /// A black line of dashes and dots.
    pub const DASH_DOTTED: Look = Look { width: 40, colour: BLACK, dashes: &[340.0, 90.0, 50.0, 90.0], marker: None };
    /// A line that marks a level.
    pub const LEVEL: Look = Look { width: 30, colour: RGBColor(110, 110, 110), dashes: &[140.0, 90.0], marker: None };

    /// That of a curve by its number from 0; the first five differ in their lines, those that follow in their markers too.
    pub fn of(curve: usize) -> Look {
        let markers = [None, Some(Marker::Circle), Some(Marker::Disc), Some(Marker::Triangle), Some(Marker::Cross)];
        Look { marker: markers[curve / LAYERS.len() % markers.len()], ..LAYERS[curve % LAYERS.len()] }
    }

    /// Draws a line through these points. A single one is no line: nothing is drawn.
    pub fn draw(&self, area: &Area, at: &[(i32, i32)]) -> Drawn {
        let style = self.colour.stroke_width(self.width);
        for dash in self.split(at) {
            // What is left of a dash at the end of a line would lie across it.
            if dash.iter().all(|point| (point.0 - dash[0].0).abs().max((point.1 - dash[0].1).abs()) < 30) {
                continue;
            }
            area.draw(&PathElement::new(dash, style))?;
        }
        let Some(marker) = self.marker else { return Ok(()) };
        // The first marker stands a little inside, the others at even distances.
        for start in dashes(at, 980.0, &[10.0, 1390.0]) {
            self.mark(marker, area, start[0])?;
        }
        Ok(())
    }

    fn split(&self, at: &[(i32, i32)]) -> Vec<Vec<(i32, i32)>> {
        match (at.len(), self.dashes) {
            (0 | 1, _) => Vec::new(),
            (_, []) => vec![at.to_vec()],
            (_, pattern) => dashes(at, 0.0, pattern),
        }
    }

    fn mark(&self, marker: Marker, area: &Area, at: (i32, i32)) -> Drawn {
        let (open, full) = (BLACK.stroke_width(40), BLACK.filled());
        match marker {
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

/// The dashes of a line through these points; `offset` is how far the pattern has gone at its beginning.
fn dashes(at: &[(i32, i32)], offset: f64, pattern: &[f64]) -> Vec<Vec<(i32, i32)>> {
    let mut points = at.to_vec();
    points.dedup();
    let points = points.into_iter().map(|(x, y)| (f64::from(x), f64::from(y)));
    let line = points.enumerate().map(|(i, point)| match i {
        0 => PathEl::MoveTo(point.into()),
        _ => PathEl::LineTo(point.into()),
    });
    let pixel = |point: Point| (point.x.round() as i32, point.y.round() as i32);
    let mut dashes: Vec<Vec<(i32, i32)>> = Vec::new();
    for element in kurbo::dash(line, offset, pattern) {
        match element {
            PathEl::MoveTo(point) => dashes.push(vec![pixel(point)]),
            PathEl::LineTo(point) => dashes.last_mut().into_iter().for_each(|dash| dash.push(pixel(point))),
            // A line has no curves, and is not closed.
            PathEl::QuadTo(..) | PathEl::CurveTo(..) | PathEl::ClosePath => {}
        }
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::chart::drawing;
    use crate::study::picture::PictureFormat;
    use resvg::tiny_skia::Pixmap;

    /// Dashes go round corners, and their lengths and gaps are those of the pattern.
    #[test]
    fn dashes_follow_the_line() {
        let mut found = dashes(&[(0, 0), (100, 0), (100, 0), (100, 100)], 0.0, &[60.0, 20.0]);
        found.sort();
        assert_eq!(found, [vec![(0, 0), (60, 0)], vec![(80, 0), (100, 0), (100, 40)], vec![(100, 60), (100, 100)]]);
        assert_eq!(dashes(&[(0, 0), (300, 0)], 98.0, &[1.0, 139.0])[0][0], (42, 0));
    }

    /// The pixels of a picture of these lines.
    fn pixels(looks: &[Look]) -> Vec<[u8; 3]> {
        let svg = drawing(600, |root| looks.iter().try_for_each(|look| look.draw(root, &[(1000, 300), (23_000, 300)])));
        let png = PictureFormat::Png.encode(&svg.unwrap()).unwrap();
        let pixmap = Pixmap::decode_png(&png).unwrap();
        pixmap.pixels().iter().map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect()
    }

    /// Of two curves on the same line a good part of both is seen, and they differ where both are alone.
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
        let looks: Vec<Look> = (0..25).map(Look::of).collect();
        assert!(looks.iter().enumerate().all(|(i, look)| !looks[..i].contains(look)));
    }

    /// Lightness and two opponent colours (CIE L*a*b*) of a linear colour.
    fn lab([r, g, b]: [f64; 3]) -> [f64; 3] {
        let x = (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505;
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        let z = (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089;
        let [x, y, z] = [x, y, z].map(|t: f64| if t > 0.008856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 });
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// As people without one of the three kinds of cones see the curves (Machado, Oliveira and Fernandes 2009), and as a grey
    /// print shows the solid ones.
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
            let seen = |look: &Look| {
                let from = linear(look.colour);
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
