//! Figure 9: least damping against complete separation in free vibration.

use crate::block::BlockError;
use crate::excitation::Pulse;
use crate::simulation::{Initial, Settings};
use crate::study::figures::page::{Chart, Curve, keys, page};
use crate::study::figures::parameters::{DAMPING_ALPHA, DAMPING_EPSILON, Detail, ETA, GREATEST_XI_V, P, RATE, block};
use crate::study::figures::table::Table;
use crate::study::figures::{Figure, FigureError, Work};
use crate::study::ground::Ground;
use crate::study::history::Run;
use crate::study::outcome::End;
use crate::study::plot::short;
use crate::study::search::{self, Scan};
use crate::study::spectrum::Base;

/// Width to which ξ_v is closed in (1).
const RESOLUTION: f64 = 1e-4;

const CURVES: usize = DAMPING_EPSILON.len() * ETA.len();

/// Damping that a block needs in free vibration (1); nothing where the greatest that is looked at does not do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Least {
    /// The least ξ_v from which on it does not separate while |θ| < α.
    pub against_separation: Option<f64>,
    /// The least ξ_v from which on it does not overturn. A block that separates beyond |θ| = α is on its way down, and
    /// counts as overturned.
    pub against_overturning: Option<f64>,
}

/// Searches the damping that a block needs.
pub fn least_damping(alpha: f64, eta: f64, epsilon: f64, detail: &Detail) -> Result<Least, BlockError> {
    let scan = Scan { from: 0.0, to: GREATEST_XI_V, points: detail.dampings, resolution: RESOLUTION };
    let block = |xi_v| block(alpha, P, Base::Viscoelastic { eta, xi_v, epsilon });
    // What is good at both ends of a range is good between.
    block(scan.from).and(block(scan.to))?;
    let outcome = |xi_v| {
        let Ok(block) = block(xi_v) else { return End::Failed };
        let run = Run {
            block,
            settings: Settings::default(),
            initial: Initial { theta_dot: RATE * alpha * P, ..Initial::default() },
            pulse: Pulse::NONE,
            ground: Ground::default(),
            duration: None,
            output_step: 0.01,
        };
        run.outcome().end
    };
    let found = search::changes(&scan, outcome, |_, _| ());
    Ok(Least {
        against_separation: found.least_without(End::Separated),
        against_overturning: found.least_without(End::Overturned),
    })
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
        "scanned at {} values of xi_v from 0 to {GREATEST_XI_V}, closed in to {RESOLUTION}, until the block has come down; a word: at {GREATEST_XI_V} still",
        detail.dampings
    )];
    let mut table =
        Table::new(9, caption, &lines, &["epsilon", "eta", "alpha", "least.xi_v", "least.xi_v.overturning"])?;
    let mut curves: Vec<Vec<Vec<(f64, f64)>>> = vec![vec![Vec::new()]; CURVES];
    for (task, least) in found.into_iter().enumerate() {
        let (epsilon, eta, alpha) = place(task as u64, detail);
        let least = least?;
        let pieces = &mut curves[task / detail.slendernesses as usize];
        match (least.against_separation, pieces.last_mut()) {
            (Some(xi_v), Some(piece)) => piece.push((alpha, xi_v)),
            _ => pieces.push(Vec::new()),
        }
        let [separation, overturning] =
            [(least.against_separation, "separated"), (least.against_overturning, "overturned")]
                .map(|(least, word)| least.map_or(word.to_string(), |xi_v| xi_v.to_string()));
        table.push([epsilon.to_string(), eta.to_string(), alpha.to_string(), separation, overturning])?;
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
