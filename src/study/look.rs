//! The number of a curve → how it is drawn, without colours.

use plotters::prelude::*;

use crate::study::plot::INK;

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// How a curve looks: told from the others by dashes and markers, without colours.
pub(super) struct Look {
    /// Length of dashes and gaps in pixels; none for a line without gaps.
    dashes: Option<(i32, i32)>,
    marker: Option<Marker>,
    colour: RGBColor,
}

#[derive(Clone, Copy)]
enum Marker {
    Circle,
    Triangle,
    Cross,
    Disc,
}

impl Look {
    /// That of a curve by its number from 0.
    pub(super) fn of(curve: usize) -> Look {
        let dashes = [None, Some((20, 10)), Some((6, 8)), Some((40, 12))][curve % 4];
        let markers = [None, Some(Marker::Circle), Some(Marker::Triangle), Some(Marker::Cross), Some(Marker::Disc)];
        Look {
            dashes,
            marker: markers[curve % 5],
            colour: [INK, RGBColor(85, 85, 85), RGBColor(120, 120, 120)][curve % 3],
        }
    }

    /// Draws a line through these pixels, with some markers on it; a single point is a marker, or a dot.
    pub(super) fn draw(&self, area: &Area, at: &[(i32, i32)]) -> Result<(), Box<dyn std::error::Error>> {
        let style = self.colour.stroke_width(4);
        if let &[point] = at {
            return match self.marker {
                Some(marker) => self.mark(marker, area, point),
                None => Ok(area.draw(&Circle::new(point, 4, self.colour.filled()))?),
            };
        }
        match self.dashes {
            None => area.draw(&PathElement::new(at.to_vec(), style))?,
            Some((dash, gap)) => {
                area.draw(&plotters::element::DashedPathElement::new(at.to_vec(), dash, gap, style))?;
            }
        }
        let Some(marker) = self.marker else { return Ok(()) };
        // The first marker stands a little inside, the others at even distances.
        const APART: f64 = 110.0;
        let (mut way, mut next) = (0.0, 0.3 * APART);
        for pair in at.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|(x, y)| (f64::from(x), f64::from(y)));
            let length = (b.0 - a.0).hypot(b.1 - a.1);
            while length > 0.0 && next <= way + length {
                let part = (next - way) / length;
                let place = ((a.0 + part * (b.0 - a.0)).round() as i32, (a.1 + part * (b.1 - a.1)).round() as i32);
                self.mark(marker, area, place)?;
                next += APART;
            }
            way += length;
        }
        Ok(())
    }

    fn mark(&self, marker: Marker, area: &Area, at: (i32, i32)) -> Result<(), Box<dyn std::error::Error>> {
        let (open, full) = (self.colour.stroke_width(3), self.colour.filled());
        match marker {
            Marker::Circle => {
                area.draw(&Circle::new(at, 8, WHITE.filled()))?;
                area.draw(&Circle::new(at, 8, open))?;
            }
            Marker::Disc => area.draw(&Circle::new(at, 8, full))?,
            Marker::Triangle => area.draw(&TriangleMarker::new(at, 11, full))?,
            Marker::Cross => area.draw(&Cross::new(at, 9, open))?,
        }
        Ok(())
    }
}
