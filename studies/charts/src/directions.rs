//! Outcomes by the direction of the ground motion → a polar chart, seen from above.

use std::f64::consts::TAU;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::canvas::{Area, Drawn, INK, Mark, Position, SHADE, TEXT, WIDTH, anchored, grey};
use crate::formula::formula;
use crate::page::{Symbol, page};
use crate::picture::PictureError;
use rocking_studies::fragility::{Direction, Limit};

/// Radius of the circle of 1, and the height of the chart.
const RADIUS: f64 = 5200.0;
const HEIGHT: u32 = 13_600;
/// Place of a value beyond the circle of 1.
const BEYOND: f64 = 1.06;
/// Greatest half width of the sector of a single azimuth (degrees).
const HALF_WIDTH: f64 = 7.0;

/// Draws the fraction of rows beyond a limit as a sector of each direction, and the median of the peak tilts as a mark.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn directions(title: &str, found: &[Direction], limit: Limit) -> Result<String, PictureError> {
    let rows: usize = found.iter().map(|direction| direction.rows).sum();
    let known: usize = found.iter().map(|direction| direction.known).sum();
    let unknown = match rows - known {
        0 => String::new(),
        unknown => format!(", {unknown} of them without a known outcome"),
    };
    let heading = [
        title.to_string(),
        format!("azimuth of the first component from x towards y, seen from above; {rows} rows{unknown}"),
    ];
    let legend = [
        (Symbol::Band, formula(&format!("fraction of the rows beyond the limit: {limit}").replace("alpha", "α"))),
        (Symbol::Mark(Mark::Circle), formula("median of the peak tilt/α; outside the circle: overturned, or above 1")),
    ];
    page(&heading, &legend, HEIGHT, |_, area| draw(area, found))
}

/// Returns the place of a radius over that of 1 at an azimuth (degrees).
fn at(azimuth: f64, radius: f64) -> Position {
    let (sin, cos) = libm::sincos(azimuth.to_radians());
    let middle = [0.5 * f64::from(WIDTH), 0.5 * f64::from(HEIGHT)];
    ((middle[0] + RADIUS * radius * cos).round() as i32, (middle[1] - RADIUS * radius * sin).round() as i32)
}

/// Returns the points of an arc between two azimuths (degrees).
fn arc([from, to]: [f64; 2], radius: f64) -> impl Iterator<Item = Position> {
    let count = ((to - from) / 2.0).ceil().max(1.0) as u32;
    (0..=count).map(move |i| at(from + (to - from) * f64::from(i) / f64::from(count), radius))
}

/// Half the width of the sector of each direction (degrees): its own, or what its neighbours leave to a single azimuth.
fn half_width(found: &[Direction]) -> f64 {
    let azimuths = found.iter().map(|direction| direction.azimuth);
    let next = azimuths.clone().skip(1).chain(found.first().map(|first| first.azimuth + 360.0));
    let nearest = azimuths.zip(next).map(|(azimuth, next)| next - azimuth).fold(360.0, f64::min);
    match found.first().map_or(0.0, |direction| direction.width) {
        0.0 => (0.45 * nearest).min(HALF_WIDTH),
        width => 0.5 * width,
    }
}

fn draw(area: &Area, found: &[Direction]) -> Drawn {
    let half = half_width(found);
    for direction in found {
        let (azimuth, fraction) = (direction.azimuth, direction.fraction().unwrap_or(0.0));
        let points: Vec<Position> =
            std::iter::once(at(0.0, 0.0)).chain(arc([azimuth - half, azimuth + half], fraction)).collect();
        area.draw(&Polygon::new(points.clone(), SHADE.filled()))?;
        let closed = [&points[..], &points[..1]].concat();
        area.draw(&PathElement::new(closed, INK.stroke_width(30)))?;
    }
    for quarter in 1..=4 {
        let radius = 0.25 * f64::from(quarter);
        let colour = if quarter == 4 { INK } else { grey(170) };
        area.draw(&PathElement::new(arc([0.0, 360.0], radius).collect::<Vec<_>>(), colour.stroke_width(20)))?;
        let label = radius.to_string();
        area.draw_text(&label, &anchored(0.85 * TEXT, HPos::Left, VPos::Bottom), at(52.0, radius))?;
    }
    for twelfth in 0..12 {
        let azimuth = 360.0 / 12.0 * f64::from(twelfth);
        area.draw(&PathElement::new([at(azimuth, 0.0), at(azimuth, 1.0)], grey(200).stroke_width(15)))?;
        let name = match twelfth {
            0 => "0° (x)".into(),
            3 => "90° (y)".into(),
            _ => format!("{azimuth}°"),
        };
        let cos = libm::cos(TAU * f64::from(twelfth) / 12.0);
        let side = if cos > 0.1 {
            HPos::Left
        } else if cos < -0.1 {
            HPos::Right
        } else {
            HPos::Center
        };
        area.draw_text(&name, &anchored(TEXT, side, VPos::Center), at(azimuth, 1.16))?;
    }
    for direction in found {
        if let Some(median) = direction.median {
            Mark::Circle.draw(area, at(direction.azimuth, if median > 1.0 { BEYOND } else { median }))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn direction(azimuth: f64, width: f64, exceeded: f64, median: f64) -> Direction {
        Direction { azimuth, width, rows: 4, known: 4, exceeded, median: Some(median) }
    }

    /// x points to the right and y up; a sector reaches to its fraction.
    #[test]
    fn the_chart_is_a_view_from_above() {
        let ((x, _), (middle, high), (_, low)) = (at(0.0, 1.0), at(90.0, 1.0), at(0.0, 0.0));
        assert!(x > middle && high < low);
        let found = [direction(0.0, 0.0, 4.0, f64::INFINITY), direction(90.0, 0.0, 1.0, 0.4)];
        let svg = directions("t", &found, Limit::Overturned).unwrap();
        assert!(svg.contains("90° (y)") && svg.contains("8 rows"), "{svg}");
        let sector = [90.0 - HALF_WIDTH, 90.0 + HALF_WIDTH].map(|azimuth| at(azimuth, 0.25).0);
        assert!(sector.iter().all(|x| svg.contains(&format!(" {x},"))), "the sector of a quarter: {sector:?}");
        assert_eq!(half_width(&found), HALF_WIDTH);
        assert_eq!(half_width(&[direction(0.0, 0.0, 0.0, 0.0), direction(10.0, 0.0, 0.0, 0.0)]), 4.5);
        assert_eq!(half_width(&[direction(15.0, 30.0, 0.0, 0.0)]), 15.0);
    }
}
