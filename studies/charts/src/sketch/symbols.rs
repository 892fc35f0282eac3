//! Symbols of an engineer's sketch: springs, dashpots, hatched ground, anchors, dimensions, angles.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use rocking_block::block::restraints::LinkKind;

use crate::canvas::{Area, Drawn, INK, Position, TEXT, anchored, fill, grey, text};
use crate::formula::{formula, width};
use crate::line_style::LineStyle;

/// A point in units of the drawing, y downwards.
pub type Point = (f64, f64);

/// Widths of lines: outlines, symbols, and dimensions with their leaders.
pub const OUTLINE: u32 = 60;
const SYMBOL: u32 = 35;
const FINE: u32 = 18;
/// Length of an arrow head, and half its width.
const ARROW: [f64; 2] = [210.0, 60.0];
/// Distance of hatch lines, and their length.
const HATCH: [f64; 2] = [240.0, 260.0];

/// Rounds a point to whole units.
pub fn unit((x, y): Point) -> Position {
    (x.round() as i32, y.round() as i32)
}

/// Draws a line.
pub fn stroke(area: &Area, points: &[Point], width: u32) -> Drawn {
    let points: Vec<Position> = points.iter().copied().map(unit).collect();
    Ok(area.draw(&PathElement::new(points, INK.stroke_width(width)))?)
}

/// Draws a thin line with dashes and dots.
pub fn axis(area: &Area, points: &[Point]) -> Drawn {
    LineStyle::LEVEL.draw(area, &points.iter().copied().map(unit).collect::<Vec<_>>())
}

/// Fills a polygon.
pub fn fill_polygon(area: &Area, points: &[Point], colour: RGBColor) -> Drawn {
    let points: Vec<Position> = points.iter().copied().map(unit).collect();
    Ok(area.draw(&Polygon::new(points, colour.filled()))?)
}

/// Draws the surface of a rigid body from `a` to `b`. It is hatched on the right of that direction as seen on the page.
pub fn hatched(area: &Area, a: Point, b: Point, width: u32) -> Drawn {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length = dx.hypot(dy);
    let (tx, ty) = (dx / length, dy / length);
    // At 45 degrees backwards from the normal on the right.
    let (hx, hy) = ((-ty - tx) * 0.5_f64.sqrt(), (tx - ty) * 0.5_f64.sqrt());
    let count = (length / HATCH[0]).round().max(2.0);
    for i in 1..=count as u32 {
        let along = length * f64::from(i) / count;
        let from = (a.0 + along * tx, a.1 + along * ty);
        stroke(area, &[from, (from.0 + HATCH[1] * hx, from.1 + HATCH[1] * hy)], FINE)?;
    }
    stroke(area, &[a, b], width)
}

/// Draws a spring and a dashpot side by side between two heights. The bar above them reaches to `corner`.
pub fn support(area: &Area, middle: f64, corner: f64, [top, bottom]: [f64; 2]) -> Drawn {
    const APART: f64 = 640.0;
    let (spring, dashpot) = (middle - 0.5 * APART, middle + 0.5 * APART);
    let bar = top + 130.0;
    stroke(area, &[(corner, top), (corner, bar)], SYMBOL)?;
    stroke(area, &[(spring.min(corner), bar), (dashpot.max(corner), bar)], SYMBOL)?;
    let length = bottom - bar;
    let mut points = vec![(spring, bar), (spring, bar + 0.15 * length)];
    const TURNS: u32 = 7;
    for i in 0..TURNS {
        let side = if i % 2 == 0 { 150.0 } else { -150.0 };
        points.push((spring + side, bar + length * (0.15 + 0.7 * (f64::from(i) + 0.5) / f64::from(TURNS))));
    }
    points.extend([(spring, bar + 0.85 * length), (spring, bottom)]);
    stroke(area, &points, SYMBOL)?;
    let [rim, piston, floor] = [0.3, 0.52, 0.72].map(|fraction| bar + fraction * length);
    let half = 170.0;
    stroke(area, &[(dashpot, bar), (dashpot, piston)], SYMBOL)?;
    stroke(area, &[(dashpot - 0.75 * half, piston), (dashpot + 0.75 * half, piston)], 2 * SYMBOL)?;
    let pot = [(dashpot - half, rim), (dashpot - half, floor), (dashpot + half, floor), (dashpot + half, rim)];
    stroke(area, &pot, SYMBOL)?;
    stroke(area, &[(dashpot, floor), (dashpot, bottom)], SYMBOL)
}

/// Draws the symbol of a centre of mass: a circle with two black quarters.
pub fn centre_of_mass(area: &Area, (x, y): Point) -> Drawn {
    const RADIUS: f64 = 170.0;
    const QUARTER: f64 = std::f64::consts::FRAC_PI_2;
    area.draw(&Circle::new(unit((x, y)), RADIUS as i32, WHITE.filled()))?;
    for start in [0.0, 2.0] {
        let mut sector = vec![(x, y)];
        sector.extend(arc((x, y), RADIUS, start * QUARTER, (start + 1.0) * QUARTER));
        fill_polygon(area, &sector, INK)?;
    }
    Ok(area.draw(&Circle::new(unit((x, y)), RADIUS as i32, INK.stroke_width(SYMBOL)))?)
}

/// Returns the points of an arc; angles in radians from the right, anticlockwise.
fn arc((x, y): Point, radius: f64, from: f64, to: f64) -> Vec<Point> {
    const POINTS: u32 = 24;
    let at = |i: u32| {
        let (sin, cos) = libm::sincos(from + (to - from) * f64::from(i) / f64::from(POINTS));
        (x + radius * cos, y - radius * sin)
    };
    (0..=POINTS).map(at).collect()
}

/// Draws an angle as an arc with an arrow at each end, if they find room.
pub fn angle(area: &Area, centre: Point, radius: f64, from: f64, to: f64) -> Drawn {
    let points = arc(centre, radius, from, to);
    stroke(area, &points, FINE)?;
    if radius * (to - from).abs() < 3.0 * ARROW[0] {
        return Ok(());
    }
    // The arrows follow chords of their own length.
    let turn = (to - from).signum() * ARROW[0] / radius;
    for (end, inside) in [(from, from + turn), (to, to - turn)] {
        let [tip, base] = [end, inside].map(|angle| {
            let (sin, cos) = libm::sincos(angle);
            (centre.0 + radius * cos, centre.1 - radius * sin)
        });
        arrow(area, tip, (tip.0 - base.0, tip.1 - base.1))?;
    }
    Ok(())
}

/// Draws a line with an arrow head at its end.
pub fn pointer(area: &Area, from: Point, to: Point) -> Drawn {
    stroke(area, &[from, to], SYMBOL)?;
    arrow(area, to, (to.0 - from.0, to.1 - from.1))
}

/// Draws an arrow head in a direction of any length.
fn arrow(area: &Area, (x, y): Point, (dx, dy): Point) -> Drawn {
    let length = dx.hypot(dy);
    let (tx, ty) = (dx / length, dy / length);
    let base = (x - ARROW[0] * tx, y - ARROW[0] * ty);
    let side = |sign: f64| (base.0 - sign * ARROW[1] * ty, base.1 + sign * ARROW[1] * tx);
    fill_polygon(area, &[(x, y), side(1.0), side(-1.0)], INK)
}

/// Draws the line of a dimension, with arrows inside, or outside where it is short.
pub fn dimension_line(area: &Area, a: Point, b: Point) -> Drawn {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length = dx.hypot(dy);
    if length >= 3.0 * ARROW[0] {
        stroke(area, &[a, b], FINE)?;
        arrow(area, a, (-dx, -dy))?;
        return arrow(area, b, (dx, dy));
    }
    let (tx, ty) = (dx / length, dy / length);
    let out = 2.2 * ARROW[0];
    stroke(area, &[(a.0 - out * tx, a.1 - out * ty), (b.0 + out * tx, b.1 + out * ty)], FINE)?;
    arrow(area, a, (dx, dy))?;
    arrow(area, b, (-dx, -dy))
}

/// Draws a horizontal dimension with its text. The text is in the middle above the line where it fits, else at the right of the arrows.
pub fn horizontal_dimension(area: &Area, [a, b]: [f64; 2], y: f64, label: &str) -> Drawn {
    dimension_line(area, (a, y), (b, y))?;
    let needed = width(label, TEXT) + 200.0;
    if needed <= b - a {
        return write(area, label, (0.5 * (a + b), y - 90.0), HPos::Center, VPos::Bottom);
    }
    let beyond = if b - a >= 3.0 * ARROW[0] { 140.0 } else { 2.2 * ARROW[0] + 140.0 };
    write(area, label, (b + beyond, y), HPos::Left, VPos::Center)
}

/// Draws a vertical dimension with its text. The text is at the left of the line where it fits, else above it, towards `side`.
pub fn vertical_dimension(area: &Area, x: f64, [top, bottom]: [f64; 2], label: &str, side: HPos) -> Drawn {
    dimension_line(area, (x, top), (x, bottom))?;
    if width(label, TEXT) > bottom - top {
        let above = if bottom - top >= 3.0 * ARROW[0] { 200.0 } else { 2.2 * ARROW[0] + 100.0 };
        let start = if matches!(side, HPos::Right) { x + 300.0 } else { x - 300.0 };
        return write(area, label, (start, top - above), side, VPos::Bottom);
    }
    let style = text(TEXT).transform(FontTransform::Rotate270).pos(Pos::new(HPos::Center, VPos::Bottom));
    Ok(area.draw_text(&formula(label), &style, unit((x - 110.0, 0.5 * (top + bottom))))?)
}

/// Draws an extension line from a drawn point to a dimension.
pub fn extension(area: &Area, from: Point, to: Point) -> Drawn {
    let points = [from, to].map(unit).to_vec();
    Ok(area.draw(&PathElement::new(points, grey(120).stroke_width(FINE)))?)
}

/// Draws a leader from a label to a point, which a dot marks.
pub fn leader(area: &Area, from: Point, to: Point) -> Drawn {
    extension(area, from, to)?;
    Ok(area.draw(&Circle::new(unit(to), 35, INK.filled()))?)
}

/// Writes a label on white, so that lines do not cross it.
pub fn write(area: &Area, label: &str, at: Point, horizontal: HPos, vertical: VPos) -> Drawn {
    const MARGIN: f64 = 50.0;
    let length = width(label, TEXT);
    let left = match horizontal {
        HPos::Left => at.0,
        HPos::Center => at.0 - 0.5 * length,
        HPos::Right => at.0 - length,
    };
    let middle = match vertical {
        VPos::Top => at.1 + 0.5 * TEXT,
        VPos::Center => at.1,
        VPos::Bottom => at.1 - 0.5 * TEXT,
    };
    let (half_length, half_height) = (0.5 * length + MARGIN, 0.5 * TEXT);
    let corners = [-1.0, 1.0].map(|sign| unit((left + 0.5 * length + sign * half_length, middle + sign * half_height)));
    fill(area, corners, WHITE)?;
    Ok(area.draw_text(&formula(label), &anchored(TEXT, horizontal, vertical), unit(at))?)
}

/// End of the line of a tie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// An anchor in a surface that is drawn anyway.
    OnGround,
    /// An anchor with its own piece of ground.
    Anchor,
    /// The anchor is farther away.
    Broken,
}

/// Draws a tie from the block to the end of its line. Its label is away from the centre of mass, in a circle, or in a cylinder for a
/// damper.
pub fn tie(area: &Area, [block, to]: [Point; 2], end: End, kind: LinkKind, label: &str, centre: Point) -> Drawn {
    let line = [block, to].map(unit).to_vec();
    area.draw(&PathElement::new(line, TIE.stroke_width(OUTLINE)))?;
    area.draw(&Circle::new(unit(block), 90, TIE.filled()))?;
    let (dx, dy) = (to.0 - block.0, to.1 - block.1);
    let length = dx.hypot(dy).max(1.0);
    let (tx, ty) = (dx / length, dy / length);
    match end {
        End::OnGround => area.draw(&Circle::new(unit(to), 130, TIE.filled()))?,
        End::Anchor => {
            // A plate across the tie, hatched on the far side.
            const HALF: f64 = 330.0;
            let side = |sign: f64| (to.0 + sign * HALF * ty, to.1 - sign * HALF * tx);
            hatched(area, side(-1.0), side(1.0), OUTLINE)?;
        }
        End::Broken => {
            for along in [0.0, 130.0] {
                let at = (to.0 - along * tx, to.1 - along * ty);
                let slash =
                    |sign: f64| (at.0 - sign * (150.0 * ty + 80.0 * tx), at.1 + sign * (150.0 * tx - 80.0 * ty));
                stroke(area, &[slash(1.0), slash(-1.0)], SYMBOL)?;
            }
        }
    }
    let at = |fraction: f64| (block.0 + fraction * dx, block.1 + fraction * dy);
    let is_free = |(x, y): Point| (x - centre.0).hypot(y - centre.1) > 600.0;
    let middle = if is_free(at(0.4)) { at(0.4) } else { at(0.2) };
    match kind {
        LinkKind::Tie => {
            area.draw(&Circle::new(unit(middle), 260, WHITE.filled()))?;
            area.draw(&Circle::new(unit(middle), 260, TIE.stroke_width(SYMBOL)))?;
        }
        LinkKind::Damper => {
            const HALF: [f64; 2] = [560.0, 340.0];
            let corner = |[along, across]: [f64; 2]| {
                let (along, across) = (along * HALF[0], across * HALF[1]);
                unit((middle.0 + along * tx - across * ty, middle.1 + along * ty + across * tx))
            };
            let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]].map(corner);
            area.draw(&Polygon::new(corners.to_vec(), WHITE.filled()))?;
            area.draw(&PathElement::new(corners.to_vec(), TIE.stroke_width(SYMBOL)))?;
        }
    }
    write(area, label, middle, HPos::Center, VPos::Center)
}

/// Colour of ties.
const TIE: RGBColor = RGBColor(20, 60, 120);
