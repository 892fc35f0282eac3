//! Figure 3: Housner's restitution e over the restitution ε of the landing corner.

use crate::figure::{self, Figure, FigureError, page};
use crate::parameters::{P, RESTITUTION_ALPHA, block};
use rocking_charts::chart::{Chart, Curve};
use rocking_charts::line_style::LineStyle;
use rocking_charts::numerals::short;
use rocking_studies::output::table::TableColumn;
use rocking_studies::spectrum::FoundationCurve;

/// Intervals of ε. Between the points e is linear anyway.
const INTERVALS: u32 = 20;

/// Makes the figure.
pub fn figure() -> Result<Figure, FigureError> {
    let columns = [
        TableColumn::real("alpha", "rad", |row: &[f64; 3]| row[0]),
        TableColumn::real("epsilon", "1", |row: &[f64; 3]| row[1]),
        TableColumn::real("e", "1", |row: &[f64; 3]| row[2]),
    ];
    let (mut rows, mut curves, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    for &alpha in &RESTITUTION_ALPHA {
        let mut points = Vec::new();
        for i in 0..=INTERVALS {
            let epsilon = f64::from(i) / f64::from(INTERVALS);
            let e = block(alpha, P, FoundationCurve::rigid(epsilon, 1.0))?.restitution();
            rows.push([alpha, epsilon, e]);
            points.push((epsilon, e));
        }
        // Each name stands at the end of its line.
        notes.push(((-0.105, points[0].1), format!("α = {}", short(alpha))));
        curves.push(Curve::new(LineStyle::BLACK, vec![points]));
    }
    let chart = Chart { x: ("ε", -0.11..1.0), y: ("e", 0.9..1.002), curves, notes, ..Chart::default() };
    let svg = page(3, &[], 13_000, |root, body| chart.draw(root, body))?;
    figure::figure(3, &[], &columns, &rows, svg)
}
