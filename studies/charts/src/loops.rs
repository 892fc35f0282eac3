//! A history → the forces of dampers and of ties that yield over their elongations.

use crate::chart::{Chart, Curve, extents};
use crate::formula::formula;
use crate::history::{LINKS, block_line, link_names};
use crate::page::{Key, Symbol, page, with_legend};
use crate::picture::PictureError;
use rocking_block::block::Block;
use rocking_block::block::restraints::{LinkKind, ObservedRestraint};
use rocking_studies::run::{History, Row};

/// Height of the chart.
const HEIGHT: u32 = 9000;

/// Returns the numbers of the dampers, and of the ties that yield.
pub fn numbers(block: &Block) -> Vec<usize> {
    let links = block.ties().iter().enumerate();
    links.filter(|(_, link)| link.kind == LinkKind::Damper || link.yields()).map(|(number, _)| number).collect()
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
        let point = |row: &Row| {
            let ObservedRestraint { elongation, pull, .. } = row.observation.restraints[number];
            (1e3 * elongation, pull / weight)
        };
        let segments = history.rows.chunk_by(|row, next| pulls(row) && pulls(next)).filter(|rows| pulls(&rows[0]));
        Curve::new(LINKS[number], segments.map(|rows| rows.iter().map(point).collect()).collect())
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
