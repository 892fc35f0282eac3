//! How a curve is drawn: told from the others without colours, and visible where it lies on another one.

use kurbo::{PathEl, Point};
use plotters::prelude::*;

use crate::study::chart::{Area, Drawn};

/// How a curve looks. Of two curves that coincide the one that is drawn last is narrower, darker and has gaps, so that both
/// are seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Width of the line (pixels).
    pub width: u32,
    /// Grey level, 0 (black) to 255.
    pub grey: u8,
    /// Lengths of dashes and gaps in turn (pixels); none for a line without gaps.
    pub dashes: &'static [f64],
    /// What stands on the line at even distances.
    marker: Option<Marker>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Marker {
    Circle,
    Disc,
    Triangle,
    Cross,
}

/// Looks of curves that are drawn over each other, in this order.
const LAYERS: [Look; 5] = [
    Look::SOLID,
    Look { width: 8, grey: 125, dashes: &[44.0, 14.0], marker: None },
    Look { width: 7, grey: 80, dashes: &[20.0, 12.0], marker: None },
    Look { width: 3, grey: 0, dashes: &[34.0, 9.0, 5.0, 9.0], marker: None },
    Look { width: 5, grey: 0, dashes: &[5.0, 11.0], marker: None },
];

impl Look {
    /// A wide, light line without gaps, over which others are seen.
    pub const SOLID: Look = Look { width: 11, grey: 175, dashes: &[], marker: None };
    /// A dark line without gaps.
    pub const BLACK: Look = Look { width: 6, grey: 0, dashes: &[], marker: None };
    /// A dark, narrow line without gaps.
    pub const THIN: Look = Look { width: 3, grey: 0, dashes: &[], marker: None };
    /// A narrow, light line without gaps, one of many.
    pub const FAINT: Look = Look { width: 3, grey: 150, dashes: &[], marker: None };
    /// A dark, dashed line.
    pub const DASHED: Look = Look { width: 5, grey: 0, dashes: &[22.0, 12.0], marker: None };
    /// A dark, dotted line.
    pub const DOTTED: Look = LAYERS[4];
    /// A dark line of dashes and dots.
    pub const DASH_DOTTED: Look = Look { width: 4, ..LAYERS[3] };

    /// That of a curve by its number from 0; the first five differ in their lines, those that follow in their markers too.
    pub fn of(curve: usize) -> Look {
        let markers = [None, Some(Marker::Circle), Some(Marker::Disc), Some(Marker::Triangle), Some(Marker::Cross)];
        Look { marker: markers[curve / LAYERS.len() % markers.len()], ..LAYERS[curve % LAYERS.len()] }
    }

    /// Draws a line through these pixels. A single one is no line: nothing is drawn.
    pub fn draw(&self, area: &Area, at: &[(i32, i32)]) -> Drawn {
        let at = &smoothed(at);
        let style = RGBColor(self.grey, self.grey, self.grey).stroke_width(self.width);
        for dash in self.split(at) {
            // What is left of a dash at the end of a line would lie across it.
            if dash.iter().all(|point| (point.0 - dash[0].0).abs().max((point.1 - dash[0].1).abs()) < 3) {
                continue;
            }
            area.draw(&PathElement::new(dash, style))?;
        }
        let Some(marker) = self.marker else { return Ok(()) };
        // The first marker stands a little inside, the others at even distances.
        for start in dashes(at, 98.0, &[1.0, 139.0]) {
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
        let (open, full) = (BLACK.stroke_width(4), BLACK.filled());
        match marker {
            Marker::Circle => {
                area.draw(&Circle::new(at, 11, WHITE.filled()))?;
                area.draw(&Circle::new(at, 11, open))?;
            }
            Marker::Disc => area.draw(&Circle::new(at, 10, full))?,
            Marker::Triangle => area.draw(&TriangleMarker::new(at, 14, full))?,
            Marker::Cross => area.draw(&Cross::new(at, 11, open))?,
        }
        Ok(())
    }
}

/// A line without the points that are so close to the one before that rounding to pixels would make it rough. The points
/// on both sides of a jump stay.
fn smoothed(at: &[(i32, i32)]) -> Vec<(i32, i32)> {
    const APART: i32 = 4;
    let are_apart = |a: (i32, i32), b: (i32, i32)| (a.0 - b.0).abs().max((a.1 - b.1).abs()) >= APART;
    let mut kept: Vec<(i32, i32)> = at.first().copied().into_iter().collect();
    for pair in at.windows(2) {
        let last = kept[kept.len() - 1];
        if are_apart(pair[0], pair[1]) && pair[0] != last {
            kept.push(pair[0]);
        }
        if are_apart(kept[kept.len() - 1], pair[1]) {
            kept.push(pair[1]);
        }
    }
    // The end stays where it is.
    kept.extend(at.last().filter(|end| kept.last() != Some(end)));
    kept
}

/// The dashes of a line through these pixels; `offset` is how far the pattern has gone at its beginning.
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

    /// What is left are points that are apart, the ends among them, and every step that can be seen.
    #[test]
    fn points_that_are_close_are_left_out() {
        let wave: Vec<(i32, i32)> = (0..200).map(|x| (x, if x % 40 < 20 { 0 } else { 100 })).collect();
        let kept = smoothed(&wave);
        assert!(kept.len() < 70 && kept[0] == (0, 0) && kept.last() == Some(&(199, 100)), "{kept:?}");
        let steps = kept.windows(2).filter(|pair| pair[0].1 != pair[1].1);
        assert_eq!(steps.map(|pair| pair[1].0 - pair[0].0).collect::<Vec<_>>(), [1; 9]);
        assert_eq!(smoothed(&[(0, 0), (1, 1)]), [(0, 0), (1, 1)]);
        assert_eq!(smoothed(&[(3, 3)]), [(3, 3)]);
    }

    /// What a line is drawn in, a pixel each.
    fn pixels(looks: &[Look]) -> Vec<u8> {
        let svg = drawing(60, |root| looks.iter().try_for_each(|look| look.draw(root, &[(100, 30), (2300, 30)])));
        let png = PictureFormat::Png.encode(&svg.unwrap()).unwrap();
        Pixmap::decode_png(&png).unwrap().pixels().iter().map(|pixel| pixel.red()).collect()
    }

    /// Of two curves on the same line a good part of both is seen, and they differ where both are alone.
    #[test]
    fn coinciding_curves_are_seen() {
        let differ = |a: &[u8], b: &[u8]| a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > 40).count() as f64;
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
}
