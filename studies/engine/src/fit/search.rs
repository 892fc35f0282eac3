//! Starts within the bounds → the least sum of squares of all tests.

use nalgebra::DVector;
use rayon::prelude::*;

use crate::fit::evaluation::Evaluator;
use crate::fit::least_squares::Minimum;
use crate::fit::problem::FitError;
use crate::fit::unknowns::first_start;
use crate::statistics::sampling::LatinHypercube;

/// Parts of the tests' sums of squares, fitted one after the other.
///
/// The phase of late cycles depends strongly on the parameters, which makes many minima; a beginning with few impacts has few.
const FRACTIONS: [f64; 2] = [0.7, 1.0];

/// Number of starts from which searches begin.
const SEARCHES: usize = 3;

/// Sum of squares over the least, above which a minimum is dropped.
const WORST: f64 = 2.0;

/// Gain of a step, over the variance of a residual, that ends each stage.
pub const TOLERANCE: [f64; 2] = [1.0, 1e-6];

/// Returns the minima of several starts that the data distinguish, the best first.
///
/// # Errors
/// No start has a valid block and runs that succeed.
pub fn search(evaluator: &Evaluator, progress: impl Fn(u64, u64) + Sync) -> Result<Vec<Minimum>, FitError> {
    let options = evaluator.problem.options;
    let windows = evaluator.windows(&FRACTIONS);
    let count = evaluator.unknowns.len();
    let cube = LatinHypercube::new(options.starts.max(2) - 1, count, options.seed);
    let start = |number: u32| match number {
        0 => first_start(evaluator.unknowns),
        _ => DVector::from_iterator(count, (0..count).map(|direction| cube.coordinate(number - 1, direction))),
    };
    let found: Vec<_> = (0..options.starts)
        .into_par_iter()
        .map(|number| (start(number), evaluator.rough_cost(&start(number), &windows[0])))
        .collect();
    let failure = found.iter().find_map(|(_, cost)| cost.clone().err().flatten());
    let mut starts: Vec<(DVector<f64>, f64)> =
        found.into_iter().filter_map(|(at, cost)| Some((at, cost.ok()?))).collect();
    // The sort is stable: of equal starts the first leads.
    starts.sort_by(|a, b| a.1.total_cmp(&b.1));
    starts.truncate(SEARCHES);
    let all = 2 + FRACTIONS.len() as u64;
    progress(1, all);
    let mut from: Vec<DVector<f64>> = starts.into_iter().map(|(at, _)| at).collect();
    let mut found = Vec::new();
    for (number, (window, tolerance)) in windows.iter().zip(TOLERANCE).enumerate() {
        let follow = |point: &DVector<f64>, known: Option<&Minimum>| evaluator.minimum(point, window, tolerance, known);
        // The best start comes first, and ends others that lead to the same minimum.
        let best = from.first().and_then(|point| follow(point, None));
        let known = best.as_ref().filter(|best| best.is_converged);
        let others: Vec<Option<Minimum>> = from.par_iter().skip(1).map(|point| follow(point, known)).collect();
        found = distinct(best.into_iter().chain(others.into_iter().flatten()).collect());
        from = found.iter().map(|minimum| minimum.point.clone()).collect();
        progress(2 + number as u64, all);
    }
    if found.is_empty() { Err(failure.unwrap_or(FitError::Starts)) } else { Ok(found) }
}

/// Returns the minima that the data distinguish, the best first. Their sums of squares are up to [`WORST`] times the least.
///
/// A search that has not converged counts if no minimum is better.
fn distinct(mut minima: Vec<Minimum>) -> Vec<Minimum> {
    minima.sort_by(|a, b| a.at.cost().total_cmp(&b.at.cost()));
    let least = minima.first().map_or(0.0, |best| best.at.cost());
    let better = minima.iter().find(|minimum| minimum.is_converged).map(|minimum| minimum.at.cost());
    minima.retain(|minimum| {
        let cost = minimum.at.cost();
        cost <= WORST * least && (minimum.is_converged || better.is_none_or(|better| cost < better))
    });
    let mut kept: Vec<Minimum> = Vec::new();
    for minimum in minima {
        if kept.iter().all(|better| !better.is_alike(&minimum.point)) {
            kept.push(minimum);
        }
    }
    kept
}
