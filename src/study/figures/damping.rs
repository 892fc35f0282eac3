//! Figure 9: least damping against complete separation in free vibration.

use crate::block::BlockError;
use crate::excitation::Pulse;
use crate::numerics::wide::Width;
use crate::records::ground::Ground;
use crate::simulation::{Initial, Settings};
use crate::study::chart::{Chart, Curve};
use crate::study::figures::page::page;
use crate::study::figures::parameters::{DAMPING_ALPHA, Detail, EPSILON, ETA, GREATEST_XI_V, P, RATE, block};
use crate::study::figures::table::Table;
use crate::study::figures::{Figure, FigureError, Work};
use crate::study::history::Run;
use crate::study::look::Look;
use crate::study::numerals::short;
use crate::study::outcome::End;
use crate::study::search::{self, Scan};
use crate::study::spectrum::Base;
use crate::study::together::outcomes;

/// Width to which ξ_v is closed in (1).
const RESOLUTION: f64 = 1e-4;

const CURVES: usize = EPSILON.len() * ETA.len();

/// Damping that a block needs in free vibration (1); nothing where the greatest that is looked at does not do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Least {
    /// The least ξ_v from which on it does not separate, other than on its way over.
    pub against_separation: Option<f64>,
    /// The least ξ_v from which on it does not overturn.
    pub against_overturning: Option<f64>,
}

/// Searches the damping that a block needs.
pub fn least_damping(alpha: f64, eta: f64, epsilon: f64, detail: &Detail) -> Result<Least, BlockError> {
    let scan = Scan { from: 0.0, to: GREATEST_XI_V, points: detail.dampings, resolution: RESOLUTION };
    let block = |xi_v| block(alpha, P, Base::Viscoelastic { eta, xi_v, epsilon });
    // What is good at both ends of a range is good between.
    block(scan.from).and(block(scan.to))?;
    let run = |&(_, xi_v): &(usize, f64)| Run {
        block: block(xi_v).unwrap_or_else(|error| unreachable!("{error}")),
        settings: Settings::default(),
        initial: Initial { theta_dot: RATE * alpha * P, ..Initial::default() },
        pulse: Pulse::NONE,
        ground: Ground::default(),
        duration: None,
        output_step: 0.01,
    };
    let outcomes = |values: &[(usize, f64)]| outcomes(Width::widest(), values.iter().map(run), || ());
    let found = search::changes(&scan, 1, |values| outcomes(values).iter().map(|outcome| outcome.end).collect());
    let [found] = found.as_slice() else { unreachable!("one search was asked for") };
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
    (EPSILON[curve / ETA.len()], ETA[curve % ETA.len()], alpha)
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
    let mut table = Table::new(
        9,
        caption,
        &lines,
        &["epsilon [1]", "eta [1]", "alpha [rad]", "least.xi_v [1]", "least.xi_v.overturning [1]"],
    )?;
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
    let highest = curves.iter().flatten().flatten().fold(0.0_f64, |high, point| high.max(point.1));
    let svg = page(9, caption, &[], 10_000, |root, body| {
        let areas = body.split_evenly((1, EPSILON.len()));
        for ((area, epsilon), curves) in areas.iter().zip(EPSILON).zip(curves.chunks(ETA.len())) {
            let looks = [Look::DOTTED, Look::DASH_DOTTED, Look::DASHED, Look::BLACK];
            let ends = curves.iter().zip(ETA).filter_map(|(pieces, eta)| {
                let &(alpha, xi_v) = pieces.last()?.last()?;
                Some(((alpha + 0.003, xi_v), format!("η = {}", short(eta))))
            });
            let notes = ends.collect();
            let curves = curves.iter().zip(looks);
            let chart = Chart {
                title: format!("ε = {}", short(epsilon)),
                // Room for the names of the curves at their ends.
                x: ("α (rad)", DAMPING_ALPHA[0]..DAMPING_ALPHA[1] + 0.05),
                y: ("least ξ_v", 0.0..1.06 * highest.max(1e-9)),
                curves: curves.map(|(pieces, look)| Curve { look, pieces: pieces.clone(), ends: false }).collect(),
                notes,
                ..Chart::default()
            };
            chart.draw(root, area)?;
        }
        Ok(())
    })?;
    Ok(Figure { number: 9, svg, table: table.finish()?, failed: 0 })
}
