//! Figure 3: Housner's restitution e over the restitution ε of the landing corner.

use crate::study::figures::page::{Chart, Curve, keys, page};
use crate::study::figures::parameters::{P, RESTITUTION_ALPHA, block};
use crate::study::figures::table::Table;
use crate::study::figures::{Figure, FigureError};
use crate::study::plot::short;
use crate::study::spectrum::Base;

/// Stretches of ε between which e is a straight line anyway.
const STRETCHES: u32 = 20;

/// Makes the figure.
pub fn figure(caption: &str) -> Result<Figure, FigureError> {
    let mut table = Table::new(3, caption, &[], &["alpha", "epsilon", "e"])?;
    let (mut curves, mut names) = (Vec::new(), Vec::new());
    for (look, &alpha) in RESTITUTION_ALPHA.iter().enumerate() {
        let mut points = Vec::new();
        for i in 0..=STRETCHES {
            let epsilon = f64::from(i) / f64::from(STRETCHES);
            let e = block(alpha, P, Base::Rigid { epsilon, restitution_factor: 1.0 })?.restitution();
            table.push([alpha, epsilon, e].map(|value| value.to_string()))?;
            points.push((epsilon, e));
        }
        curves.push(Curve { look, pieces: vec![points], ends: false });
        names.push((look, format!("α = {}", short(alpha))));
    }
    let chart = Chart { title: String::new(), x: ("ε", 0.0..1.0), y: ("e", 0.9..1.002), curves };
    let svg = page(3, caption, [1600, 1000], |root, body| {
        let (key, area) = body.split_vertically(56);
        keys(&key, &names)?;
        chart.draw(root, &area)
    })?;
    Ok(Figure { number: 3, svg, table: table.finish()?, failed: 0 })
}
