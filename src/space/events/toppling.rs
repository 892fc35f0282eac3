//! Toppling: the centre of mass is outside the polygon of the feet, seen from above, and the tilt grows.
//!
//! Where a run ends, such a block counts as overturned.

use crate::space::body::SpaceBody;
use crate::space::motion::BodyMotion;

/// Whether the block topples in this state.
pub fn topples(body: &SpaceBody, state: &[f64]) -> bool {
    let motion = BodyMotion::of(state);
    let axis = motion.turn.axis();
    let rate = motion.omega.cross(&axis);
    let feet = || body.feet.iter().map(|foot| motion.turn.rotate(&foot.place)).map(|arm| [arm.x, arm.y]);
    axis.x * rate.x + axis.y * rate.y > 0.0 && is_outside(feet)
}

/// Whether the origin is outside the convex hull of some points: a line through it has all of them on one side.
///
/// If there is such a line, one along a point is.
fn is_outside<I: Iterator<Item = [f64; 2]>>(points: impl Fn() -> I) -> bool {
    points().any(|[x, y]| {
        let side = |[a, b]: [f64; 2]| x * b - y * a;
        // Points on the line itself have to be on the same half of it.
        let ahead = |[a, b]: [f64; 2]| x * a + y * b > 0.0;
        let is_on = |sign: f64| points().all(|point| sign * side(point) > 0.0 || side(point) == 0.0 && ahead(point));
        is_on(1.0) || is_on(-1.0)
    })
}
