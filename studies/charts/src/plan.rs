//! A history in space → the paths of the base's middle and of the centre of mass over the base, seen from above.

use std::ops::Range;

use crate::canvas::{Mark, WIDTH};
use crate::chart::{Chart, Curve, MAX_ROTATION, SIDES, extents};
use crate::formula::formula;
use crate::history_in_space::block_line;
use crate::line_style::LineStyle;
use crate::page::{Key, Symbol, page};
use crate::picture::PictureError;
use rocking_block::space::SpaceBody;
use rocking_block::space::motion::{BodyMotion, DISPLACEMENT, FEET_FROM, QUATERNION};
use rocking_studies::hull::hull;
use rocking_studies::space::{HistoryInSpace, RowInSpace, RunInSpace};

/// Greatest height of the axes.
const MOST: f64 = 16_000.0;
/// Height of a page beside that of the axes: ticks and names.
const AROUND: u32 = 120 + 60 + 960;

/// Draws the plan as SVG, with a title for the run. Lengths have one scale in both directions.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn plan(run: &RunInSpace, history: &HistoryInSpace, title: &str) -> Result<String, PictureError> {
    let body = &run.setup.body;
    // A block that falls leaves the page.
    let stands = |row: &&RowInSpace| row.tilt_over_critical <= MAX_ROTATION;
    let rows: Vec<&RowInSpace> = history.rows.iter().take_while(stands).collect();
    let path = |of: fn(&RowInSpace) -> [f64; 2]| rows.iter().map(|row| point(of(row))).collect::<Vec<_>>();
    let (base, centre) = (path(|row| row.observation.drift), path(centre_of_mass));
    let at_rest = closed(body.feet.iter().map(|foot| [foot.place.x, foot.place.y]).collect());
    let at_end = rows.last().map(|row| outline(body, row)).unwrap_or_default();
    let curves = [
        (LineStyle::DASHED, at_rest, "base at rest"),
        (LineStyle::WIDE_GREY, at_end, "base at the end"),
        (LineStyle::ORANGE, centre, "centre of mass"),
        (LineStyle::BLUE, base, "middle of the base"),
    ];
    let legend: Vec<Key> = curves.iter().map(|(style, _, name)| (Symbol::Curve(*style), (*name).into())).collect();
    let marks = curves[2..].iter().filter_map(|(_, points, _)| Some((Mark::Cross, *points.last()?))).collect();
    let curves: Vec<Curve> = curves.into_iter().map(|(style, points, _)| Curve::new(style, vec![points])).collect();
    let (x, y, height) = to_scale(extents(&curves));
    let falls = match rows.len() < history.rows.len() {
        true => format!("; drawn until θ/α = {MAX_ROTATION}"),
        false => String::new(),
    };
    let heading = [title.into(), formula(&format!("block in space: {}{falls}", block_line(&run.parameters, body)))];
    let chart = Chart { x: ("x (m)", x), y: ("y (m)", y), curves, marks, ..Chart::default() };
    page(&heading, &legend, height + AROUND, |root, area| chart.draw(root, area))
}

fn point([x, y]: [f64; 2]) -> (f64, f64) {
    (x, y)
}

fn centre_of_mass(row: &RowInSpace) -> [f64; 2] {
    [row.observation.displacement.x, row.observation.displacement.y]
}

/// Returns the corners of points as a closed line.
fn closed(points: Vec<[f64; 2]>) -> Vec<(f64, f64)> {
    let corners: Vec<(f64, f64)> = hull(points).into_iter().map(point).collect();
    corners.iter().chain(corners.first()).copied().collect()
}

/// Returns the outline of the feet.
fn outline(body: &SpaceBody, row: &RowInSpace) -> Vec<(f64, f64)> {
    let mut state = [0.0; FEET_FROM];
    state[DISPLACEMENT..QUATERNION].copy_from_slice(row.observation.displacement.as_slice());
    state[QUATERNION..QUATERNION + 4].copy_from_slice(&row.observation.quaternion);
    let motion = BodyMotion::of(&state);
    let place = |place| motion.displacement + motion.turn.rotate(place);
    closed(body.feet.iter().map(|foot| place(&foot.place)).map(|place| [place.x, place.y]).collect())
}

/// Widens one of two ranges so that both have the same scale. Returns the height of the axes, too.
fn to_scale([x, y]: [Range<f64>; 2]) -> (Range<f64>, Range<f64>, u32) {
    let width = f64::from(WIDTH - SIDES[0] - SIDES[1]);
    let [across, up] = [&x, &y].map(|range| range.end - range.start);
    // The greatest scale at which both fit.
    let scale = (width / across).min(MOST / up);
    let widened = 0.5 * (width / scale - across);
    (x.start - widened..x.end + widened, y, (scale * up) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_directions_have_one_scale() {
        let width = f64::from(WIDTH - SIDES[0] - SIDES[1]);
        for ranges in [[-1.0..1.0, -0.1..0.2], [-0.1..0.2, -3.0..1.0], [0.0..2.0, 0.0..1.0]] {
            let (x, y, height) = to_scale(ranges.clone());
            let scales = [width / (x.end - x.start), f64::from(height) / (y.end - y.start)];
            assert!((scales[0] / scales[1] - 1.0).abs() < 1e-3 && f64::from(height) <= MOST, "{ranges:?}: {scales:?}");
            assert!(x.start <= ranges[0].start && x.end >= ranges[0].end && y == ranges[1]);
        }
    }
}
