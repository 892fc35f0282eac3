//! A history → the forces of dampers and of ties that yield over their elongations.

use crate::chart::{Chart, Curve, extents};
use crate::formula::formula;
use crate::history::{LINKS, block_line, link_names};
use crate::page::{Key, Symbol, page, with_legend};
use crate::picture::PictureError;
use rocking_block::block::Block;
use rocking_block::block::restraints::{LinkKind, ObservedRestraint, Tie};
use rocking_studies::run::{History, Row};

/// Height of the chart.
const HEIGHT: u32 = 9000;

/// Returns the numbers of the dampers, and of the ties that yield.
pub fn numbers(block: &Block) -> Vec<usize> {
    let links = block.ties().iter().enumerate();
    links.filter(|(_, link)| link.kind == LinkKind::Damper || link.yields()).map(|(number, _)| number).collect()
}

/// Returns elongation (m) and pull (N) where a link begins and ends to yield between two samples. Without yielding there are none.
///
/// A sample lies on its elastic line k (s − s_p). The plastic elongation s_p changes only on the line r k s ± (1 − r) F_y of its sign, so that
/// the path turns where the elastic lines of both samples meet it. A dashpot adds a force of its own, whose path only samples show.
fn corners(tie: &Tie, before: &ObservedRestraint, after: &ObservedRestraint) -> [Option<[f64; 2]>; 2] {
    let Tie { stiffness, damping, yield_force, hardening, .. } = *tie;
    let change = after.plastic - before.plastic;
    [before.plastic, after.plastic].map(|plastic| {
        let elongation = plastic / (1.0 - hardening) + change.signum() * yield_force / stiffness;
        (change != 0.0 && damping == 0.0).then_some([elongation, stiffness * (elongation - plastic)])
    })
}

/// Draws the loops as SVG, with a title for the run.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn loops(block: &Block, history: &History, title: &str) -> Result<String, PictureError> {
    let (names, weight) = (link_names(block), block.mass * block.gravity);
    let numbers = numbers(block);
    let curve = |&number: &usize| {
        // A slack tie may be far from where it pulls.
        let pulls = |row: &Row| row.observation.restraints[number].pull != 0.0;
        let segments = history.rows.chunk_by(|row, next| pulls(row) && pulls(next)).filter(|rows| pulls(&rows[0]));
        // The samples and, before each, the corners since the last one.
        let through_corners = |rows: &[Row]| {
            let observed: Vec<ObservedRestraint> = rows.iter().map(|row| row.observation.restraints[number]).collect();
            let between = observed.windows(2).flat_map(|pair| {
                let corners = corners(&block.ties()[number], &pair[0], &pair[1]);
                corners.into_iter().flatten().chain([[pair[1].elongation, pair[1].pull]])
            });
            let first = observed.first().map(|first| [first.elongation, first.pull]);
            first.into_iter().chain(between).map(|[elongation, pull]| (1e3 * elongation, pull / weight)).collect()
        };
        Curve::new(LINKS[number], segments.map(through_corners).collect())
    };
    let curves: Vec<Curve> = numbers.iter().map(curve).collect();
    let [x, y] = extents(&curves);
    let legend: Vec<Key> =
        numbers.iter().map(|&number| (Symbol::Curve(LINKS[number]), names[number].clone())).collect();
    let chart = Chart { x: ("elongation (mm)", x), y: ("T/(M g)", y), curves, ..Chart::default() };
    page(&[title.into(), formula(&block_line(block))], &[], HEIGHT, |root, body| {
        chart.draw(root, &with_legend(body, &legend)?)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between samples far apart, the path has the stiffness k or r k.
    #[test]
    fn a_path_between_samples_turns_where_the_link_yields() {
        let (k, r, yield_force) = (1e6, 0.05, 1e3);
        let tie = Tie { stiffness: k, hardening: r, yield_force, kind: LinkKind::Damper, ..Tie::default() };
        // Yielding in tension to 3 mm, then in compression to −1 mm, by the lines r k s ± (1 − r) F_y and k (s − s_p).
        let on_line = |s: f64, sign: f64| {
            let pull = r * k * s + sign * (1.0 - r) * yield_force;
            ObservedRestraint { elongation: s, pull, plastic: s - pull / k }
        };
        let elastic = |s: f64, plastic: f64| ObservedRestraint { elongation: s, pull: k * (s - plastic), plastic };
        let (longest, shortest) = (on_line(3e-3, 1.0), on_line(-1e-3, -1.0));
        let samples = [elastic(5e-4, 0.0), elastic(2.7e-3, longest.plastic), elastic(-8e-4, shortest.plastic)];
        let mut path = vec![[samples[0].elongation, samples[0].pull]];
        for pair in samples.windows(2) {
            path.extend(corners(&tie, &pair[0], &pair[1]).into_iter().flatten());
            path.push([pair[1].elongation, pair[1].pull]);
        }
        assert_eq!(path.len(), 7);
        for pair in path.windows(2) {
            let slope = (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]);
            assert!([k, r * k].iter().any(|known| (slope / known - 1.0).abs() < 1e-9), "{slope} N/m in {path:?}");
        }
        for corner in [longest, shortest] {
            let is_corner =
                |at: &[f64; 2]| (at[0] - corner.elongation).abs() < 1e-15 && (at[1] - corner.pull).abs() < 1e-9;
            assert!(path.iter().any(is_corner), "{corner:?} is not in {path:?}");
        }
        assert_eq!(corners(&tie, &samples[0], &samples[0]), [None, None]);
        assert_eq!(corners(&Tie { damping: 1.0, ..tie }, &samples[0], &samples[1]), [None, None]);
    }
}
