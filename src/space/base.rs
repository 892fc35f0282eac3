//! Feet without gaps → the edges of the base, and the tilt over the critical one in the direction in which the body leans.
//!
//! The line through the centre of mass along gravity meets the plane of the feet at the distance h tan θ in the direction of the lean, in the
//! body's own axes. At the critical tilt that point is on an edge of the base, the hull of the feet without gaps.

use crate::numerics::dual::Dual;
use crate::numerics::scalar::Elementary;
use crate::space::motion::Lean;

/// An edge of the base, seen from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseEdge {
    /// Direction away from the base, of length 1, in body axes.
    pub outward: [f64; 2],
    /// Distance from the centre of mass (m), positive.
    pub distance: f64,
}

/// Returns the edges of the hull of some points around the centre of mass.
///
/// A pair is an edge if no point is outside its line, and none on the line is beyond its ends. All tests allow for round-off, and an edge
/// under the centre of mass has a distance of the round-off.
pub(super) fn edges(points: &[[f64; 2]]) -> Vec<BaseEdge> {
    let reach = points.iter().map(|[x, y]| libm::hypot(*x, *y)).fold(0.0, f64::max);
    let rounding = 8.0 * f64::EPSILON * reach;
    let mut edges = Vec::new();
    for (i, &[x, y]) in points.iter().enumerate() {
        for &[x_2, y_2] in &points[i + 1..] {
            let (along_x, along_y) = (x_2 - x, y_2 - y);
            let length = (along_x * along_x + along_y * along_y).sqrt();
            if length <= rounding {
                continue;
            }
            // Distances from the line and along it, times the length.
            let side = |a: f64, b: f64| along_x * (b - y) - along_y * (a - x);
            let along = |a: f64, b: f64| along_x * (a - x) + along_y * (b - y);
            let slack = rounding * length;
            let has_all_on = |sign: f64| points.iter().all(|&[a, b]| sign * side(a, b) >= -slack);
            let is_whole = points
                .iter()
                .all(|&[a, b]| side(a, b).abs() > slack || (-slack..=length * length + slack).contains(&along(a, b)));
            let outward = [along_y / length, -along_x / length];
            let distance = (side(0.0, 0.0).abs() / length).max(rounding);
            if is_whole && has_all_on(1.0) {
                edges.push(BaseEdge { outward, distance });
            } else if is_whole && has_all_on(-1.0) {
                edges.push(BaseEdge { outward: outward.map(|n| 0.0 - n), distance });
            }
        }
    }
    edges
}

impl BaseEdge {
    /// Returns the component of a lean towards the edge.
    #[inline]
    fn towards(&self, [x, y]: [f64; 2]) -> f64 {
        let [n_x, n_y] = self.outward;
        n_x * x + n_y * y
    }

    /// Returns a number that is positive where the tangent of the tilt exceeds a multiple of that of the critical tilt over this edge.
    #[inline]
    pub(super) fn excess(&self, multiple: f64, lean: &Lean<Dual>, center_height: f64) -> Dual {
        let ([x, y], [n_x, n_y]) = (lean.across, self.outward);
        (x * n_x + y * n_y) * center_height - lean.up * (multiple * self.distance)
    }

    /// Whether the critical tilt over this edge is less than that over another one.
    #[inline]
    pub(super) fn leads(&self, over: &BaseEdge, lean: &Lean<Dual>) -> bool {
        let across = lean.across.map(|number| number.re);
        self.towards(across) * over.distance > over.towards(across) * self.distance
    }

    /// Returns the tilt over that with the centre of mass over the line of this edge, in the direction of the lean (1).
    pub(super) fn tilt_over_critical(&self, lean: &Lean<Dual>, center_height: f64) -> Dual {
        let [x, y] = lean.across;
        let sine = x.hypot(y);
        if sine.re == 0.0 && sine.eps == 0.0 {
            return Dual::default();
        }
        let tilt = sine.atan2(lean.up);
        // An upright body leans along its rate.
        let is_upright = sine.re == 0.0;
        let [d_x, d_y] =
            if is_upright { [x.eps / sine.eps, y.eps / sine.eps] } else { [x.re / sine.re, y.re / sine.re] };
        let ahead = center_height * self.towards([d_x, d_y]);
        let critical = libm::atan2(self.distance, ahead);
        let ratio = tilt.re / critical;
        // The rate of the lean's direction, times the tilt.
        let turning = if is_upright {
            0.0
        } else {
            self.towards([x.eps - d_x * sine.eps, y.eps - d_y * sine.eps]) * (tilt.re / sine.re)
        };
        let square = self.distance * self.distance + ahead * ahead;
        let rate = tilt.eps + self.distance * center_height * turning / (critical * square);
        Dual::new(ratio, rate / critical)
    }
}
