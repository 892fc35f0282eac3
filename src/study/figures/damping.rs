//! Figure 9: least damping against complete separation in free vibration.

use crate::block::{BlockError, Common, Dimensionless};
use crate::simulation::Settings;
use crate::study::figures::page::{Chart, Curve, keys, page};
use crate::study::figures::parameters::{DAMPING_ALPHA, DAMPING_EPSILON, Detail, ETA, GREATEST_XI_V, P, RATE};
use crate::study::figures::table::Table;
use crate::study::figures::{Figure, FigureError, Work};
use crate::study::history::End;
use crate::study::plot::short;
use crate::study::search::{Scan, damping_against_separation};

/// Width to which ξ_v is closed in (1).
const RESOLUTION: f64 = 1e-4;

const CURVES: usize = DAMPING_EPSILON.len() * ETA.len();

/// The least ξ_v from which on a block does not separate in free vibration, up to the greatest that is looked at; nothing if
/// it separates there.
pub fn least_damping(alpha: f64, eta: f64, epsilon: f64, detail: &Detail) -> Result<Option<f64>, BlockError> {
    let scan = Scan { from: 0.0, to: GREATEST_XI_V, points: detail.dampings, resolution: RESOLUTION };
    let block = Dimensionless { alpha, p: P, eta, xi_v: 0.0 };
    let common = Common { epsilon, ..Common::default() };
    let found = damping_against_separation(&block, &common, RATE, Settings::default(), &scan)?;
    Ok(found.least_without(End::Separated))
}

/// How many searches the figure has.
pub fn tasks(detail: &Detail) -> u64 {
    CURVES as u64 * detail.slendernesses
}

/// ε, η and α of a search.
fn place(task: u64, detail: &Detail) -> (f64, f64, f64) {
    let (curve, i) = ((task / detail.slendernesses) as usize, task % detail.slendernesses);
    let part = i as f64 / (detail.slendernesses - 1) as f64;
    let alpha = DAMPING_ALPHA[0] + part * (DAMPING_ALPHA[1] - DAMPING_ALPHA[0]);
    (DAMPING_EPSILON[curve / ETA.len()], ETA[curve % ETA.len()], alpha)
}

/// Makes the figure.
pub fn figure(caption: &str, detail: &Detail, work: &mut Work) -> Result<Figure, FigureError> {
    let found = work.make(tasks(detail), |task| {
        let (epsilon, eta, alpha) = place(task, detail);
        least_damping(alpha, eta, epsilon, detail)
    });
    let lines = [format!(
        "scanned at {} values of xi_v from 0 to {GREATEST_XI_V}, closed in to {RESOLUTION}; `separated`: at {GREATEST_XI_V} still",
        detail.dampings
    )];
    let mut table = Table::new(9, caption, &lines, &["epsilon", "eta", "alpha", "least.xi_v"])?;
    let mut curves: Vec<Vec<Vec<(f64, f64)>>> = vec![vec![Vec::new()]; CURVES];
    for (task, least) in found.into_iter().enumerate() {
        let (epsilon, eta, alpha) = place(task as u64, detail);
        let least = least?;
        let pieces = &mut curves[task / detail.slendernesses as usize];
        match (least, pieces.last_mut()) {
            (Some(xi_v), Some(piece)) => piece.push((alpha, xi_v)),
            _ => pieces.push(Vec::new()),
        }
        let least = least.map_or("separated".into(), |xi_v| xi_v.to_string());
        table.push([epsilon.to_string(), eta.to_string(), alpha.to_string(), least])?;
    }
    let names: Vec<_> = ETA.iter().enumerate().map(|(look, eta)| (look, format!("η = {}", short(*eta)))).collect();
    let highest = curves.iter().flatten().flatten().fold(0.0_f64, |high, point| high.max(point.1));
    let svg = page(9, caption, [1800, 56 + 700 * DAMPING_EPSILON.len() as u32], |root, body| {
        let (key, body) = body.split_vertically(56);
        keys(&key, &names)?;
        let areas = body.split_evenly((DAMPING_EPSILON.len(), 1));
        for ((area, epsilon), curves) in areas.iter().zip(DAMPING_EPSILON).zip(curves.chunks(ETA.len())) {
            let curves = curves.iter().enumerate().map(|(look, pieces)| {
                let pieces = pieces.iter().filter(|piece| !piece.is_empty()).cloned().collect();
                Curve { look, pieces, ends: false }
            });
            let chart = Chart {
                title: format!("ε = {}", short(epsilon)),
                x: ("α (rad)", DAMPING_ALPHA[0]..DAMPING_ALPHA[1]),
                y: ("least ξ_v", 0.0..1.06 * highest.max(1e-9)),
                curves: curves.collect(),
            };
            chart.draw(root, area)?;
        }
        Ok(())
    })?;
    Ok(Figure { number: 9, svg, table: table.finish()?, failed: 0 })
}
