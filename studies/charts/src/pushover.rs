//! The curve of a slow rotation, and its cycle → a page.

use crate::canvas::Mark;
use crate::chart::{Chart, Curve, extents};
use crate::formula::formula;
use crate::history::block_line;
use crate::line_style::LineStyle;
use crate::numerals::significant;
use crate::page::{Key, Symbol, page};
use crate::picture::PictureError;
use rocking_block::block::Block;
use rocking_studies::pushover::statics::Equilibrium;
use rocking_studies::pushover::{Landmark, LandmarkKind, Pushover};

/// Height of the chart.
const HEIGHT: u32 = 9000;

/// Rotation (rad) below which a difference is round-off.
const ROUND_OFF: f64 = 1e-12;
/// Distance of marks whose numbers would overlap, relative to the axes.
const NEAR: [f64; 2] = [0.02, 0.035];

/// Returns the landmarks of a curve by rotation, without its beginning. Those at one rotation stand together.
pub fn groups(landmarks: &[Landmark]) -> Vec<&[Landmark]> {
    let named = landmarks.iter().position(|landmark| landmark.kind != LandmarkKind::AtRest).unwrap_or(landmarks.len());
    landmarks[named..].chunk_by(|one, next| (one.at.theta - next.at.theta).abs() <= ROUND_OFF).collect()
}

/// Returns the names of landmarks at one rotation.
pub fn names(group: &[Landmark]) -> String {
    group.iter().map(|landmark| landmark.kind.to_string()).collect::<Vec<_>>().join(", ")
}

/// Adds the number of a mark. Numbers of marks nearer than `near` stand behind each other.
fn add_number(notes: &mut Vec<((f64, f64), String)>, number: usize, place: (f64, f64), near: [f64; 2]) {
    match notes.iter_mut().find(|(at, _)| (at.0 - place.0).abs() <= near[0] && (at.1 - place.1).abs() <= near[1]) {
        Some((_, numbers)) => *numbers = format!("{numbers}, {number}"),
        None => notes.push((place, number.to_string())),
    }
}

/// Draws the lateral force over the rotation as SVG.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn pushover(block: &Block, pushover: &Pushover) -> Result<String, PictureError> {
    let weight = block.mass * block.gravity;
    let point = |at: &Equilibrium| (at.theta, at.force / weight);
    let line = |rows: &[Equilibrium]| vec![rows.iter().map(point).collect::<Vec<_>>()];
    let mut curves = vec![Curve::new(LineStyle::of(0), line(&pushover.rows))];
    let mut legend: Vec<Key> = vec![(Symbol::Curve(LineStyle::of(0)), "slow rotation".into())];
    if let Some(cycle) = &pushover.cycle {
        curves.push(Curve::new(LineStyle::of(2), line(&cycle.rows)));
        legend.push((Symbol::Curve(LineStyle::of(2)), format!("cycle of ±{} rad", significant(cycle.amplitude, 4))));
    }
    let [x, y] = extents(&curves);
    // A block that slides before it lifts has a curve upwards.
    let is_upright = pushover.rows.iter().all(|row| row.theta.abs() <= ROUND_OFF) && pushover.cycle.is_none();
    let x = if is_upright { 0.0..block.alpha } else { x };
    let aside = [0.008 * (x.end - x.start), 0.035 * (y.end - y.start)];
    let near = [NEAR[0] * (x.end - x.start), NEAR[1] * (y.end - y.start)];
    let (mut marks, mut explained) = (Vec::<(Mark, (f64, f64))>::new(), Vec::new());
    let mut notes: Vec<((f64, f64), String)> = Vec::new();
    for (number, group) in groups(&pushover.landmarks).into_iter().enumerate() {
        let at = point(&group[0].at);
        marks.push((Mark::Circle, at));
        add_number(&mut notes, number + 1, (at.0 + aside[0], at.1 + aside[1]), near);
        explained.push(format!("{} {}", number + 1, names(group)));
    }
    let chart = Chart { x: ("θ (rad)", x), y: ("F/(M g)", y), curves, marks, notes, ..Chart::default() };
    let heading = ["Lateral force at the centre of mass".into(), formula(&block_line(block)), explained.join("; ")];
    page(&heading, &legend, HEIGHT, |root, body| chart.draw(root, body))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_marks_that_lie_together_do_not_overlap() {
        let mut notes = Vec::new();
        for (number, place) in [(1, (0.0, 0.1)), (2, (0.001, 0.101)), (3, (0.2, 0.1)), (4, (0.0, 0.3))] {
            add_number(&mut notes, number, place, [0.01, 0.02]);
        }
        let texts: Vec<&str> = notes.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(texts, ["1, 2", "3", "4"]);
    }
}
