//! Block and ties → a scale, and the positions of body, supports and dimensions in units of the drawing.

use super::Sketch;
use crate::sketch::symbols::{End, Point};
use rocking_block::block::Foundation;
use rocking_block::block::restraints::Tie;

/// Height of a support.
pub const SUPPORT: f64 = 1600.0;
/// Distance from the middle of a support to the wall of its recess in the ground.
pub const RECESS: f64 = 1050.0;
/// Height of the dimension above the body.
pub const ABOVE: f64 = 500.0;
/// Greatest width and height of the drawing.
const MAX_WIDTH: f64 = 16_400.0;
const HEIGHT: f64 = 12_600.0;
/// Margins of the drawing: left, right, at the top and at the bottom.
const MARGIN: f64 = 700.0;
const HEAD: f64 = 400.0;
const FOOT: f64 = 350.0;
/// Space beside the body for labels, and further out for a dimension.
const LABELS: f64 = 3050.0;
const SIDE: f64 = 650.0;
/// Space around the anchor of a tie.
const ANCHOR: f64 = 600.0;
/// Heights of the ground and of the dimension under it.
const GROUND: f64 = 550.0;
const ROW: f64 = 750.0;
/// Least distance of the middles of two supports.
const APART: f64 = 2300.0;

/// The drawn part of a tie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnTie {
    /// Its end on the block.
    pub block: Point,
    /// Its anchor, or the point at which its line is broken off.
    pub end: Point,
    /// Symbol drawn there.
    pub kind: End,
}

/// Places in units from the upper left corner of the drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Left and right side of the body.
    pub left: f64,
    pub right: f64,
    /// Upper and lower side of the body.
    pub top: f64,
    pub base: f64,
    /// Centre of mass.
    pub centre: Point,
    /// Middles of the supports.
    pub supports: [f64; 2],
    /// Ends of the ground.
    pub edges: [f64; 2],
    /// End of the labels at the left, and start of those at the right.
    pub label_edges: [f64; 2],
    /// Abscissas of the vertical dimensions.
    pub sides: [f64; 2],
    /// Lower end of the foundation.
    pub below: f64,
    /// Ordinate of the dimension under the foundation.
    pub row: f64,
    /// The ties.
    pub ties: Vec<DrawnTie>,
    /// Right and lower end of the drawing.
    pub ends: [f64; 2],
}

impl Layout {
    /// Lays out a sketch at the largest scale that fits.
    pub fn new(sketch: &Sketch) -> Layout {
        let b = sketch.block.b;
        let body = sketch.height.unwrap_or(2.0 * sketch.block.h);
        let reaches: Vec<Reach> = sketch.block.ties().iter().map(|tie| Reach::new(tie, b, body)).collect();
        let furthest = |coordinate: fn([f64; 2]) -> f64| {
            reaches.iter().flat_map(|reach| [coordinate(reach.block), coordinate(reach.end)]).fold(0.0, f64::max)
        };
        // How far ties reach beyond the body (m), by 0 if they do not.
        let aside = [furthest(|[x, _]| -x), furthest(|[x, _]| x)].map(|x| (x - b).max(0.0));
        let (up, down) = ((furthest(|[_, z]| z) - body).max(0.0), furthest(|[_, z]| -z));
        let on_supports = sketch.block.foundation == Foundation::Viscoelastic;
        let under = GROUND + if on_supports { SUPPORT } else { 0.0 };
        let above = HEAD + if sketch.block.eccentricity == 0.0 { 0.0 } else { ABOVE + 450.0 };

        let beside = |scale: f64| aside.map(|x| if x > 0.0 { (scale * x + ANCHOR).max(LABELS) } else { LABELS });
        let deep = |scale: f64| if down > 0.0 { under + scale * down } else { under };
        let fits = |scale: f64| {
            let [left, right] = beside(scale);
            let wide = 2.0 * MARGIN + left + 2.0 * scale * b + right + 2.0 * SIDE;
            let high = above + scale * (up + body) + deep(scale) + ROW + FOOT;
            wide <= MAX_WIDTH && high <= HEIGHT
        };
        // The largest scale that fits, in units per metre: every dimension grows with it.
        let (mut scale, mut too_large) = (0.0, HEIGHT / body);
        for _ in 0..60 {
            let middle = 0.5 * (scale + too_large);
            if fits(middle) { scale = middle } else { too_large = middle }
        }

        let [beside_left, beside_right] = beside(scale);
        let wide = 2.0 * SIDE + beside_left + 2.0 * scale * b + beside_right;
        let start = MARGIN;
        let left = start + SIDE + beside_left;
        let right = left + 2.0 * scale * b;
        let top = above + scale * up;
        let base = top + scale * body;
        // Under a block on supports the ground begins below these.
        let lower = |z: f64| if z < 0.0 && on_supports { SUPPORT } else { 0.0 };
        let at = |[x, z]: [f64; 2]| (0.5 * (left + right) + scale * x, base - scale * z + lower(z));
        let outward = if on_supports { (0.5 * (APART - (right - left))).max(0.0) } else { 0.0 };
        let supports = [left - outward, right + outward];
        let room = if on_supports { RECESS + 500.0 } else { 900.0 };
        let edges = match sketch.block.ties().is_empty() {
            true => [supports[0] - room, supports[1] + room],
            false => [left - beside_left, right + beside_right],
        };
        let below = base + under;
        Layout {
            left,
            right,
            top,
            base,
            centre: at([sketch.block.eccentricity, sketch.block.h]),
            supports,
            edges,
            label_edges: [left - 420.0, right + 420.0],
            sides: [start + 0.5 * SIDE, start + wide - 0.5 * SIDE],
            below: below + 60.0,
            row: base + deep(scale) + ROW - 150.0,
            ends: [start + wide + MARGIN, base + deep(scale) + ROW + FOOT],
            ties: reaches
                .iter()
                .map(|reach| DrawnTie {
                    block: at(reach.block),
                    end: at(reach.end),
                    kind: match reach.is_anchor {
                        true if reach.end[1] == 0.0 => End::OnGround,
                        true => End::Anchor,
                        false => End::Broken,
                    },
                })
                .collect(),
        }
    }
}

/// The part of a tie that is drawn (m).
struct Reach {
    block: [f64; 2],
    end: [f64; 2],
    is_anchor: bool,
}

impl Reach {
    /// Cuts a tie where it leaves the surroundings of the body. A block end outside them is moved to their edge.
    fn new(tie: &Tie, b: f64, body: f64) -> Reach {
        let around = (2.0 * b).max(body);
        let limits = [[-b - 0.9 * around, b + 0.9 * around], [-0.4 * around, body + 0.4 * around]];
        let block = [0, 1].map(|axis| tie.block[axis].clamp(limits[axis][0], limits[axis][1]));
        let mut fraction: f64 = 1.0;
        for axis in [0, 1] {
            let distance = tie.ground[axis] - block[axis];
            let limit = limits[axis][usize::from(distance > 0.0)];
            if distance != 0.0 {
                fraction = fraction.min(((limit - block[axis]) / distance).max(0.0));
            }
        }
        let end = [0, 1].map(|axis| block[axis] + fraction * (tie.ground[axis] - block[axis]));
        Reach { block, end, is_anchor: fraction == 1.0 }
    }
}
