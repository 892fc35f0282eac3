//! A block in space → its sketch in axonometry, seen from the right in front and above.

use std::f64::consts::TAU;

use plotters::style::text_anchor::{HPos, VPos};

use super::symbols::{
    OUTLINE, Point, axis, centre_of_mass, dimension_line, extension, fill_polygon, pointer, stroke, unit, write,
};
use super::{beside_values, engineering};
use crate::canvas::{Area, Drawn, TEXT, anchored, grey};
use crate::history_in_space::friction;
use crate::numerals::significant;
use crate::picture::PictureError;
use rocking_block::space::{Base, SpaceBody, SpaceParameters};
use rocking_studies::hull::hull;
use rocking_studies::space::{facts, foot_names};

/// Width and height of the drawing beside its dimensions.
const ROOM: [f64; 2] = [9000.0, 10_000.0];
/// Margins: left, above, right, below.
const MARGINS: [f64; 4] = [3700.0, 900.0, 2900.0, 1700.0];
/// Directions of the page, to the right and up, in the axes of space: seen from an azimuth of −60° and 20° above the ground.
const RIGHT: [f64; 3] = [0.866, 0.5, 0.0];
const UP: [f64; 3] = [-0.171, 0.296, 0.94];
/// Points of a circle.
const POINTS: usize = 96;
/// Feet beyond which only the first one has a name.
const MAX_NAMES: usize = 6;
/// Grey levels of the top, the front and the right side.
const FACES: [u8; 3] = [246, 234, 218];

/// A place from the middle of the base or, of a list of feet, from below the centre of mass (m).
type Place = [f64; 3];

/// The block in space to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct SketchInSpace<'a> {
    /// Its parameters.
    pub parameters: &'a SpaceParameters,
    /// The block.
    pub body: &'a SpaceBody,
    /// Height of the body (m), if known. Of others the sides end at the height of the centre of mass.
    pub height: Option<f64>,
}

/// The scale of a drawing, and the place of its origin.
struct Projection {
    scale: f64,
    origin: Point,
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Projection {
    /// Fits these places into the room of the drawing.
    fn of(places: &[Place]) -> Projection {
        let spread = |along: [f64; 3]| {
            rocking_studies::statistics::range(places.iter().map(|place| dot(*place, along))).unwrap_or([0.0, 1.0])
        };
        let ([left, right], [low, high]) = (spread(RIGHT), spread(UP));
        let scale = (ROOM[0] / (right - left)).min(ROOM[1] / (high - low));
        Projection { scale, origin: (MARGINS[0] - scale * left, MARGINS[1] + scale * high) }
    }

    fn at(&self, place: Place) -> Point {
        (self.origin.0 + self.scale * dot(place, RIGHT), self.origin.1 - self.scale * dot(place, UP))
    }
}

impl SketchInSpace<'_> {
    /// Draws the sketch as SVG.
    ///
    /// # Errors
    /// [`PictureError::Drawing`].
    pub fn svg(&self) -> Result<String, PictureError> {
        let metres = |length: f64| format!("{} m", significant(length, 4));
        let [width, depth] = self.sizes();
        let base = match &self.parameters.base {
            Base::Rectangle { .. } => format!("{} wide, {} deep", metres(width), metres(depth)),
            Base::Circle { .. } => format!("on a circle of {}", metres(width)),
            Base::List { feet, .. } => format!("on {} feet", feet.len()),
        };
        let height = self.height.map(|height| format!(", {} high", metres(height))).unwrap_or_default();
        let projection = Projection::of(&self.places());
        let lowest = self.places().into_iter().map(|place| projection.at(place).1).fold(0.0, f64::max);
        let rightmost = self.places().into_iter().map(|place| projection.at(place).0).fold(0.0, f64::max);
        let ends = [rightmost + MARGINS[2], lowest + MARGINS[3]];
        beside_values(&format!("Block in space {base}{height}"), self.paragraphs(), ends, |area| {
            self.draw(area, &projection)
        })
    }

    /// Width and depth of the base, or of the feet of a list (m).
    fn sizes(&self) -> [f64; 2] {
        [0, 1].map(|along| {
            let feet = self.body.feet.iter().map(|foot| foot.place[along]);
            rocking_studies::statistics::range(feet).map_or(0.0, |[low, high]| high - low)
        })
    }

    /// The height up to which the body is drawn (m).
    fn top(&self) -> f64 {
        self.height.unwrap_or(self.body.center_height)
    }

    /// The feet from the middle of the base.
    fn feet(&self) -> Vec<[f64; 2]> {
        let [e_x, e_y] = self.parameters.eccentricity;
        self.body.feet.iter().map(|foot| [foot.place.x + e_x, foot.place.y + e_y]).collect()
    }

    /// The corners of the base, anticlockwise as seen from above.
    fn outline(&self) -> Vec<[f64; 2]> {
        if !matches!(self.parameters.base, Base::Circle { .. }) {
            return hull(self.feet());
        }
        let on_circle = |i: usize| {
            let (sin, cos) = libm::sincos(TAU * i as f64 / POINTS as f64);
            [self.body.half_width * cos, self.body.half_width * sin]
        };
        (0..POINTS).map(on_circle).collect()
    }

    /// The places that have to fit.
    fn places(&self) -> Vec<Place> {
        let corners = self.outline().into_iter();
        corners.flat_map(|[x, y]| [[x, y, 0.0], [x, y, self.top()]]).chain([self.centre()]).collect()
    }

    fn centre(&self) -> Place {
        let [x, y] = self.parameters.eccentricity;
        [x, y, self.body.center_height]
    }

    fn draw(&self, area: &Area, projection: &Projection) -> Drawn {
        let (mut outline, top) = (self.outline(), self.top());
        let at = |[x, y]: [f64; 2], z: f64| projection.at([x, y, z]);
        let is_round = matches!(self.parameters.base, Base::Circle { .. });
        // The viewer is towards −y and +x: a side is seen if its outer normal points there.
        let is_seen = |([ax, ay], [bx, by]): ([f64; 2], [f64; 2])| (by - ay) * 0.5 + (bx - ax) * 0.866 > 0.0;
        // The sides that are seen follow one another from the first corner on.
        let before = |i: usize| outline[(i + outline.len() - 1) % outline.len()];
        let after = |i: usize| outline[(i + 1) % outline.len()];
        let is_first = |i: &usize| is_seen((outline[*i], after(*i))) && !is_seen((before(*i), outline[*i]));
        let first = (0..outline.len()).find(is_first).unwrap_or(0);
        outline.rotate_left(first);
        let sides = || outline.iter().zip(outline.iter().cycle().skip(1)).map(|(a, b)| (*a, *b));
        let seen: Vec<_> = sides().filter(|side| is_seen(*side)).collect();
        if is_round {
            // One surface, without seams.
            let below = seen.iter().map(|(a, _)| at(*a, 0.0)).chain(seen.last().map(|(_, b)| at(*b, 0.0)));
            let above = seen.iter().rev().map(|(_, b)| at(*b, top)).chain(seen.first().map(|(a, _)| at(*a, top)));
            fill_polygon(area, &below.chain(above).collect::<Vec<_>>(), grey(FACES[1]))?;
        } else {
            for (a, b) in &seen {
                let level = if b[1] - a[1] > (b[0] - a[0]).abs() { FACES[2] } else { FACES[1] };
                fill_polygon(area, &[at(*a, 0.0), at(*b, 0.0), at(*b, top), at(*a, top)], grey(level))?;
            }
        }
        for (a, b) in sides().filter(|side| !is_seen(*side)) {
            axis(area, &[at(a, 0.0), at(b, 0.0)])?;
        }
        if self.height.is_some() {
            let rim: Vec<Point> = outline.iter().map(|corner| at(*corner, top)).collect();
            fill_polygon(area, &rim, grey(FACES[0]))?;
            stroke(area, &[&rim[..], &rim[..1]].concat(), OUTLINE)?;
        }
        for (a, b) in &seen {
            stroke(area, &[at(*a, 0.0), at(*b, 0.0)], OUTLINE)?;
            for corner in [a, b] {
                // Of a round body only the outermost lines are seen.
                let is_between = seen.iter().filter(|(a, b)| a == corner || b == corner).count() > 1;
                if !(is_round && is_between) {
                    stroke(area, &[at(*corner, 0.0), at(*corner, top)], OUTLINE)?;
                }
            }
        }
        let is_in_front = |foot: [f64; 2]| seen.iter().any(|(a, b)| *a == foot || *b == foot);
        self.draw_feet(area, projection, |foot| is_in_front(foot) || is_round && 0.5 * foot[0] > 0.866 * foot[1])?;
        self.draw_dimensions(area, projection)?;
        SketchInSpace::draw_axes(area)?;
        let [x, y, _] = self.centre();
        axis(area, &[at([x, y], 0.0), projection.at(self.centre())])?;
        centre_of_mass(area, projection.at(self.centre()))
    }

    /// Draws the feet with their names: triangles under the base, grey ones behind the body.
    fn draw_feet(&self, area: &Area, projection: &Projection, is_in_front: impl Fn([f64; 2]) -> bool) -> Drawn {
        const SIDE: f64 = 150.0;
        let names = foot_names(self.parameters);
        let middle = projection.at([0.0; 3]);
        for (number, (foot, name)) in self.feet().into_iter().zip(&names).enumerate() {
            let (right, down) = projection.at([foot[0], foot[1], 0.0]);
            let triangle = [(right, down), (right - SIDE, down + 1.6 * SIDE), (right + SIDE, down + 1.6 * SIDE)];
            let level = if is_in_front(foot) { 60 } else { 165 };
            fill_polygon(area, &triangle, grey(level))?;
            if names.len() <= MAX_NAMES || number == 0 {
                let side = if right < middle.0 { HPos::Right } else { HPos::Left };
                let beside = if right < middle.0 { right - 260.0 } else { right + 260.0 };
                let style = anchored(TEXT, side, VPos::Center);
                area.draw_text(name, &style.color(&grey(level / 2)), unit((beside, down + 200.0)))?;
            }
        }
        Ok(())
    }

    fn draw_dimensions(&self, area: &Area, projection: &Projection) -> Drawn {
        let metres = |name: &str, length: f64| format!("{name} = {} m", significant(length, 4));
        let h = self.body.center_height;
        let outline = self.outline();
        // The vertical dimensions stand beside the outermost lines of the body.
        let right = |place: &[f64; 2]| dot([place[0], place[1], 0.0], RIGHT);
        let (Some(&leftmost), Some(&rightmost)) = (
            outline.iter().min_by(|a, b| right(a).total_cmp(&right(b))),
            outline.iter().max_by(|a, b| right(a).total_cmp(&right(b))),
        ) else {
            return Ok(());
        };
        let vertical = |[x, y]: [f64; 2], height: f64, name: &str, aside: f64| -> Drawn {
            let [low, high] = [0.0, height].map(|z| projection.at([x, y, z]));
            for end in [low, high] {
                extension(area, end, (end.0 + 1.2 * aside, end.1))?;
            }
            dimension_line(area, (low.0 + aside, low.1), (high.0 + aside, high.1))?;
            let side = if aside < 0.0 { HPos::Right } else { HPos::Left };
            let middle = (low.0 + aside + 0.2 * aside, 0.5 * (low.1 + high.1));
            write(area, &metres(name, height), middle, side, VPos::Center)
        };
        if let Some(height) = self.height {
            vertical(leftmost, height, if height == 2.0 * h { "2h" } else { "height" }, -600.0)?;
        }
        vertical(rightmost, h, "h", 600.0)?;
        let Base::Rectangle { .. } = self.parameters.base else { return Ok(()) };
        // Width along the front, depth along the right side, shifted away from the base on the page.
        let [b, d] = self.sizes().map(|size| 0.5 * size);
        for (name, ends, shift, side) in [
            ("2b", [[-b, -d], [b, -d]], (-250.0, 900.0), HPos::Right),
            ("depth", [[b, -d], [b, d]], (450.0, 800.0), HPos::Left),
        ] {
            let places = ends.map(|[x, y]| projection.at([x, y, 0.0]));
            let shifted = places.map(|(x, y)| (x + shift.0, y + shift.1));
            for (from, to) in places.into_iter().zip(shifted) {
                extension(area, from, (to.0 + 0.15 * shift.0, to.1 + 0.15 * shift.1))?;
            }
            dimension_line(area, shifted[0], shifted[1])?;
            let [x, y] = [shifted[0].0 + shifted[1].0, shifted[0].1 + shifted[1].1].map(|sum| 0.5 * sum);
            let length = if name == "2b" { 2.0 * b } else { 2.0 * d };
            let aside = if matches!(side, HPos::Right) { -200.0 } else { 200.0 };
            write(area, &metres(name, length), (x + aside, y + 330.0), side, VPos::Center)?;
        }
        Ok(())
    }

    /// Draws the axes of space at the upper left.
    fn draw_axes(area: &Area) -> Drawn {
        const LENGTH: f64 = 800.0;
        let origin = (650.0, 1900.0);
        for (name, along) in [("x", [1.0, 0.0, 0.0]), ("y", [0.0, 1.0, 0.0]), ("z", [0.0, 0.0, 1.0])] {
            let to = |length: f64| (origin.0 + length * dot(along, RIGHT), origin.1 - length * dot(along, UP));
            pointer(area, origin, to(LENGTH))?;
            write(area, name, to(1.25 * LENGTH), HPos::Center, VPos::Center)?;
        }
        Ok(())
    }

    /// Returns the values in words: body, feet.
    fn paragraphs(&self) -> Vec<Vec<String>> {
        let SketchInSpace { parameters, body, .. } = self;
        let short = |value: f64| significant(value, 4);
        let mut of_body = vec![
            format!(
                "α_edge = {} rad = {}°, balance over the nearest edge",
                short(body.edge_angle),
                short(body.edge_angle.to_degrees())
            ),
            format!("R0 = {} m, p = {} rad/s", short(body.r0), short(body.p)),
            format!("M = {} kg", short(body.mass)),
        ];
        let [xx, yy, zz, xy, xz, yz] = facts::inertia(body);
        let listed = |numbers: [f64; 3]| numbers.map(short).join(", ");
        of_body.push(format!("I_xx, I_yy, I_zz = {} kg m²", listed([xx, yy, zz])));
        if [xy, xz, yz].iter().any(|product| *product != 0.0) {
            of_body.push(format!("I_xy, I_xz, I_yz = {} kg m²", listed([xy, xz, yz])));
        }
        if parameters.eccentricity != [0.0; 2] {
            let [e_x, e_y] = parameters.eccentricity.map(short);
            of_body.push(format!("centre of mass at e_x = {e_x} m, e_y = {e_y} m"));
        }
        let mut of_feet = vec![
            format!("each of {} feet:", body.count()),
            format!("K = {}, C = {}", engineering(body.stiffness, "N/m"), engineering(body.damping, "N s/m")),
            format!("κ = {}, ξ_h = {}", short(parameters.kappa), short(parameters.xi_h.unwrap_or(body.xi_v))),
            format!("ω_v = {} rad/s, ξ_v = {}", short(body.omega_v), short(body.xi_v)),
        ];
        of_feet.push(match friction(body) {
            Some(friction) => format!("friction μ = {}", short(friction)),
            None => "friction without a limit".into(),
        });
        let gaps = body.feet.iter().filter(|foot| foot.static_load == 0.0).count();
        if gaps > 0 {
            of_feet.push(format!("{gaps} of them with a gap at rest"));
        }
        vec![of_body, of_feet]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rocking_block::space::{BaseSize, FootPlace, SpaceSupports};

    fn sketch(base: Base, height: Option<f64>) -> String {
        let inertia = matches!(base, Base::List { .. }).then_some([900.0, 900.0, 200.0, 0.0, 0.0, 0.0]);
        let supports = SpaceSupports::OfHeave { omega_v: 120.0, xi_v: 0.2 };
        let parameters = SpaceParameters { base, inertia, supports, ..SpaceParameters::default() };
        let body = SpaceBody::new(&parameters).unwrap();
        SketchInSpace { parameters: &parameters, body: &body, height }.svg().unwrap()
    }

    /// Each body is drawn with the names of its feet and its lengths.
    #[test]
    fn each_base_has_its_lengths_and_feet() {
        let size = BaseSize::Lengths { width: 0.6, center_height: 1.5 };
        let has = |svg: &str, label: &str| svg.replace('\u{A0}', " ").contains(label);
        let prism = sketch(Base::Rectangle { size, depth_ratio: 1.5 }, Some(3.0));
        for label in ["2b = 0.6 m", "depth = 0.9 m", "h = 1.5 m", "2h = 3 m", "SW", "NE", "0.9 m deep"] {
            assert!(has(&prism, label), "{label}");
        }
        let cylinder = sketch(Base::Circle { size, feet: 16 }, None);
        assert!(has(&cylinder, "on a circle of 0.6 m") && !has(&cylinder, "2h"));
        let places = [[-0.3, -0.2], [0.4, -0.2], [0.0, 0.3]].map(|[x, y]| FootPlace { x, y, gap: 0.0 });
        let gap = FootPlace { x: 0.2, y: 0.2, gap: 1e-3 };
        let list = sketch(Base::List { feet: [&places[..], &[gap]].concat(), center_height: 1.5 }, None);
        assert!(has(&list, "on 4 feet") && has(&list, "1 of them with a gap at rest"));
    }

    /// Lengths along one axis keep their ratio on the page.
    #[test]
    fn the_projection_is_parallel() {
        let projection = Projection::of(&[[0.0; 3], [2.0, 1.0, 3.0]]);
        let shift = |a: Place, b: Place| {
            let (a, b) = (projection.at(a), projection.at(b));
            (b.0 - a.0).hypot(b.1 - a.1)
        };
        let (one, two) = (shift([0.0; 3], [0.0, 1.0, 0.0]), shift([1.0, 1.0, 2.0], [1.0, 3.0, 2.0]));
        assert!((two / one - 2.0).abs() < 1e-12, "{one}, {two}");
    }
}
