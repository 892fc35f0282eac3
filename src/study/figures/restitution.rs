//! Figure 3: Housner's restitution e over the restitution ε of the landing corner.

use crate::study::chart::{Chart, Curve};
use crate::study::figures::page::page;
use crate::study::figures::parameters::{P, RESTITUTION_ALPHA, block};
use crate::study::figures::table::Table;
use crate::study::figures::{Figure, FigureError};
use crate::study::look::Look;
use crate::study::numerals::short;
use crate::study::spectrum::Base;

/// Stretches of ε between which e is a straight line anyway.
const STRETCHES: u32 = 20;

/// Makes the figure.
pub fn figure(caption: &str) -> Result<Figure, FigureError> {
    let mut table = Table::new(3, caption, &[], &["alpha [rad]", "epsilon [1]", "e [1]"])?;
    let (mut curves, mut notes) = (Vec::new(), Vec::new());
    for &alpha in &RESTITUTION_ALPHA {
        let mut points = Vec::new();
        for i in 0..=STRETCHES {
            let epsilon = f64::from(i) / f64::from(STRETCHES);
            let e = block(alpha, P, Base::Rigid { epsilon, restitution_factor: 1.0 })?.restitution();
            table.push([alpha, epsilon, e].map(|value| value.to_string()))?;
            points.push((epsilon, e));
        }
        // The name stands at the end of its line.
        notes.push(((-0.105, points[0].1), format!("α = {}", short(alpha))));
        curves.push(Curve { look: Look::BLACK, pieces: vec![points], ends: false });
    }
    let chart = Chart { x: ("ε", -0.11..1.0), y: ("e", 0.9..1.002), curves, notes, ..Chart::default() };
    let svg = page(3, caption, &[], 13_000, |root, body| chart.draw(root, body))?;
    Ok(Figure { number: 3, svg, table: table.finish()?, failed: 0 })
}
