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

/// Returns the landmarks of a curve by rotation, without its beginning. Those at one rotation stand together.
pub fn groups(landmarks: &[Landmark]) -> Vec<&[Landmark]> {
    let named = landmarks.iter().position(|landmark| landmark.kind != LandmarkKind::AtRest).unwrap_or(landmarks.len());
    landmarks[named..].chunk_by(|one, next| one.at.theta == next.at.theta).collect()
}

/// Returns the names of landmarks at one rotation.
pub fn names(group: &[Landmark]) -> String {
    group.iter().map(|landmark| landmark.kind.to_string()).collect::<Vec<_>>().join(", ")
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
    let x = if pushover.rows.iter().all(|row| row.theta == 0.0) { 0.0..block.alpha } else { x };
    let aside = [0.008 * (x.end - x.start), 0.035 * (y.end - y.start)];
    let (mut marks, mut notes, mut explained) = (Vec::new(), Vec::new(), Vec::new());
    for (number, group) in groups(&pushover.landmarks).into_iter().enumerate() {
        let at = point(&group[0].at);
        marks.push((Mark::Circle, at));
        notes.push(((at.0 + aside[0], at.1 + aside[1]), (number + 1).to_string()));
        explained.push(format!("{} {}", number + 1, names(group)));
    }
    let chart = Chart { x: ("θ (rad)", x), y: ("F/(M g)", y), curves, marks, notes, ..Chart::default() };
    let heading = ["Lateral force at the centre of mass".into(), formula(&block_line(block)), explained.join("; ")];
    page(&heading, &legend, HEIGHT, |root, body| chart.draw(root, body))
}
