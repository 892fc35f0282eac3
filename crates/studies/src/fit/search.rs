//! Starts within the bounds → the least sum of squares of all tests.

use nalgebra::DVector;
use rayon::prelude::*;

use crate::fit::evaluation::Evaluator;
use crate::fit::least_squares::{Linearization, Minimum, minimize};
use crate::fit::problem::FitError;
use crate::fit::unknowns::first_start;
use crate::statistics::sampling::LatinHypercube;

/// Parts of the tests' sums of squares that are fitted one after the other.
///
/// The phase of late cycles turns with small changes of a parameter, which makes many minima; few impacts make few.
const PARTS: [f64; 2] = [0.7, 1.0];

/// Number of starts that are followed from the first part on.
const FOLLOWED: usize = 3;

/// Sum of squares over the least of a minimum that is not followed further.
const HOPELESS: f64 = 2.0;

/// Steps end where the next would gain this part of the variance of a residual; in the last part and before it.
pub const TOLERANCE: [f64; 2] = [1e-6, 1.0];

/// The minima of several starts that the data tell apart, the best first.
pub fn search(evaluator: &Evaluator, progress: impl Fn(u64, u64) + Sync) -> Result<Vec<Minimum>, FitError> {
    let options = evaluator.problem.options;
    let windows = evaluator.windows(&PARTS);
    let count = evaluator.unknowns.len();
    let cube = LatinHypercube::new(options.starts.max(2) - 1, count, options.seed);
    let start = |number: u32| match number {
        0 => first_start(evaluator.unknowns),
        _ => DVector::from_iterator(count, (0..count).map(|direction| cube.coordinate(number - 1, direction))),
    };
    let found: Vec<_> = (0..options.starts)
        .into_par_iter()
        .map(|number| (start(number), evaluator.linearize(&start(number), &windows[0], false).map(|at| at.cost())))
        .collect();
    let failure = found.iter().find_map(|(_, cost)| cost.clone().err().flatten());
    let mut starts: Vec<(DVector<f64>, f64)> =
        found.into_iter().filter_map(|(at, cost)| Some((at, cost.ok()?))).collect();
    // A stable order: of equals the first start leads.
    starts.sort_by(|a, b| a.1.total_cmp(&b.1));
    starts.truncate(FOLLOWED);
    let all = 2 + PARTS.len() as u64;
    progress(1, all);
    let mut followed: Vec<Minimum> = Vec::new();
    for (number, (window, part)) in windows.iter().zip(PARTS).enumerate() {
        let tolerance = TOLERANCE[usize::from(part < 1.0)];
        let from: Vec<DVector<f64>> = match number {
            0 => starts.iter().map(|(at, _)| at.clone()).collect(),
            _ => followed.iter().map(|minimum| minimum.point.clone()).collect(),
        };
        let next = from.into_par_iter().filter_map(|point| {
            let linearize = |at: &DVector<f64>| evaluator.linearize(at, window, true).ok();
            let at = linearize(&point)?;
            Some(minimize(linearize, point, at, |cost| evaluator.variance(cost, window), tolerance))
        });
        followed = distinct(next.collect());
        progress(2 + number as u64, all);
    }
    if followed.is_empty() { Err(failure.unwrap_or(FitError::Starts)) } else { Ok(followed) }
}

/// The minima that the data tell apart and whose sums of squares are at most [`HOPELESS`] times the least, the best first.
fn distinct(mut minima: Vec<Minimum>) -> Vec<Minimum> {
    minima.sort_by(|a, b| a.at.cost().total_cmp(&b.at.cost()));
    let least = minima.first().map_or(0.0, |best| best.at.cost());
    minima.retain(|minimum| minimum.at.cost() <= HOPELESS * least);
    let mut kept: Vec<Minimum> = Vec::new();
    for minimum in minima {
        if kept.iter().all(|better| !are_alike(better, &minimum)) {
            kept.push(minimum);
        }
    }
    kept
}

/// Whether the linear model at one minimum changes little up to another.
fn are_alike(one: &Minimum, other: &Minimum) -> bool {
    let Linearization { jacobian, .. } = &one.at;
    (jacobian * (&other.point - &one.point)).norm_squared() <= 0.01 * one.at.cost()
}
