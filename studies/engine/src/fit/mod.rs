//! A block, measured tests of it, free parameters → estimates with their intervals, by least squares.
//!
//! The derivatives of the runs are exact ([`rocking_gradients`]), through all impacts.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`problem`] | a block, tests of it, names of free parameters → a checked problem |
//! | [`mod@unknowns`] | names of free parameters → their ranges, and a box of coordinates from 0 to 1 |
//! | [`model`] | a run, times → a measured quantity at these times, with its derivatives |
//! | [`evaluation`] | a point of the box → residuals of all tests, with their Jacobian |
//! | [`least_squares`] | residuals and their Jacobian → the least sum of squares in the box |
//! | [`mod@search`] | starts within the bounds → the least of several minima |
//! | [`intervals`] | a minimum → intervals of the profile likelihood |
//! | [`mod@combinations`] | the Jacobian → combinations that the data determine, and those that they do not |
//! | [`mod@notes`] | a fit → its weaknesses in sentences |
//! | [`mod@file`] | a study file with `[fit]` → a problem |

pub mod combinations;
pub mod evaluation;
pub mod file;
pub mod intervals;
pub mod least_squares;
pub mod model;
pub mod notes;
pub mod problem;
pub mod search;
pub mod unknowns;

use std::sync::atomic::Ordering;

use nalgebra::DMatrix;
use rayon::ThreadPool;
use rayon::prelude::*;
use rocking_block::block::Block;
use serde::Serialize;

use crate::fit::combinations::{Combination, combinations};
use crate::fit::evaluation::Evaluator;
use crate::fit::intervals::{EVALUATIONS, IntervalEnd, Lower, Profile};
use crate::fit::least_squares::Minimum;
use crate::fit::unknowns::{set, unknowns};

pub use problem::{FitError, Free, Options, Problem, Test};

/// An estimated parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Its name; `test_2.zero` for a test's own parameter.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// The estimate.
    pub value: f64,
    /// Its standard error, to first order.
    pub standard_error: f64,
    /// Interval of the profile likelihood. `None` for a test's own parameter, for a search for intervals that kept finding better fits, and
    /// for an end at which the data admit the bound.
    pub interval: Option<[Option<f64>; 2]>,
    /// Interval of the quadratic approximation, symmetric in the logarithm where that is fitted.
    pub quadratic_interval: [f64; 2],
    /// Its bounds.
    pub bounds: [f64; 2],
    /// The bound at which the estimate lies, if it does.
    pub at_bound: Option<f64>,
}

/// A test and its fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TestFit {
    /// Name of the measured column.
    pub output: String,
    /// Its unit.
    pub unit: String,
    /// Times (s).
    #[serde(skip)]
    pub times: Vec<f64>,
    /// Measured values.
    #[serde(skip)]
    pub measured: Vec<f64>,
    /// Fitted values, with the zero and the delay of the test.
    #[serde(skip)]
    pub fitted: Vec<f64>,
    /// Measured less fitted values.
    #[serde(skip)]
    pub residuals: Vec<f64>,
    /// Their root mean square.
    pub rms: f64,
    /// Durbin's and Watson's statistic of the residuals (1). It is 2 for white noise, less for correlated residuals.
    pub durbin_watson: f64,
    /// Correlation of each residual with the next (1).
    pub autocorrelation: f64,
    /// Time of a grazing event of the fitted run (s). It has no derivatives after it.
    pub grazing: Option<f64>,
    /// Time at which the fitted block has overturned (s).
    pub overturned: Option<f64>,
}

/// A fit.
#[derive(Clone, Debug, Serialize)]
pub struct Fit {
    /// The estimates: of the block, then of each test.
    pub estimates: Vec<Estimate>,
    /// Covariance of the estimates, to first order.
    pub covariance: Vec<Vec<f64>>,
    /// Combinations of the parameters, the best determined first.
    pub combinations: Vec<Combination>,
    /// The tests with their fits.
    pub tests: Vec<TestFit>,
    /// Weighted sum of squares over its degrees of freedom (1), if the noise is given. It is about 1 if model and noise are right.
    pub reduced_chi_squared: Option<f64>,
    /// Standard deviation of the errors estimated from the residuals, if the noise is not given.
    pub noise: Option<f64>,
    /// Confidence level of the intervals.
    pub level: f64,
    /// Values of the parameters at other minima that the level admits.
    pub other_minima: Vec<Vec<f64>>,
    /// Whether the search has ended at a minimum.
    pub is_converged: bool,
    /// Weaknesses of the fit, in sentences.
    pub notes: Vec<String>,
    /// Numbers of runs without and with derivatives.
    pub runs: [u64; 2],
    /// The fitted block.
    #[serde(skip)]
    pub block: Block,
}

/// Fits a problem; `progress` receives the parts done and their number. The result does not depend on the number of threads.
///
/// # Errors
/// An invalid problem, or one without a start whose block is valid and whose runs succeed.
pub fn fit(problem: &Problem, pool: &ThreadPool, progress: &(impl Fn(u64, u64) + Sync)) -> Result<Fit, FitError> {
    problem.check()?;
    let unknowns = unknowns(problem)?;
    let evaluator = Evaluator { problem, unknowns: &unknowns, runs: Default::default() };
    pool.install(|| {
        let minima = search::search(&evaluator, progress)?;
        let (best, others, ends) = with_intervals(&evaluator, minima, RESTARTS, EVALUATIONS);
        finish(&evaluator, &best, &others, ends)
    })
}

/// Ends of the intervals of the shared parameters, as coordinates.
type Ends = Vec<[IntervalEnd; 2]>;

/// Maximum number of searches from lower minima. They are found on the way to the ends of intervals.
const RESTARTS: usize = 4;

/// Returns the best of several minima with its intervals, and other admissible ones. The intervals cover those of the others.
///
/// A lower minimum found on the way to an end replaces the best one. After the last of these restarts no interval is known.
fn with_intervals(
    evaluator: &Evaluator,
    mut minima: Vec<Minimum>,
    restarts: usize,
    evaluations: usize,
) -> (Minimum, Vec<Minimum>, Option<Ends>) {
    let counts = evaluator.problem.counts();
    let shared = evaluator.problem.free.len();
    let deviate = evaluator.deviate(&counts);
    let mut best = minima.remove(0);
    let mut lower = 0;
    loop {
        let (least, variance) = (best.at.cost(), evaluator.variance(best.at.cost(), &counts));
        let others = minima.iter().filter(|other| other.at.cost() - least <= deviate * deviate * variance);
        let others: Vec<Minimum> = others.cloned().collect();
        if lower > restarts {
            return (best, others, None);
        }
        let found: Result<Vec<Ends>, Lower> = std::iter::once(&best)
            .chain(&others)
            .map(|from| {
                let covariance = from.at.triangle().covariance();
                let covariance = &covariance;
                let profile = Profile { evaluator, from, least, covariance, variance, deviate, evaluations };
                let end = |k: usize| profile.end(k / 2, [-1.0, 1.0][k % 2]);
                let ends = (0..2 * shared).into_par_iter().map(end).collect::<Vec<_>>();
                let ends = ends.into_iter().collect::<Result<Vec<IntervalEnd>, Lower>>()?;
                Ok(ends.chunks(2).map(|pair| [pair[0], pair[1]]).collect())
            })
            .collect();
        let point = match found {
            Ok(found) => return (best, others, found.into_iter().reduce(hull)),
            Err(Lower(point)) => point,
        };
        lower += 1;
        let [.., tolerance] = search::TOLERANCE;
        if let Some(found) = evaluator.minimum(&point, &counts, tolerance, None) {
            minima.push(std::mem::replace(&mut best, found));
        }
    }
}

/// Returns the intervals that cover both sets.
fn hull(one: Ends, other: Ends) -> Ends {
    let end = |one: IntervalEnd, other: IntervalEnd, outer: fn(f64, f64) -> f64| match (one, other) {
        (IntervalEnd::At(one), IntervalEnd::At(other)) => IntervalEnd::At(outer(one, other)),
        (
            IntervalEnd::At(one) | IntervalEnd::Unsettled(one),
            IntervalEnd::At(other) | IntervalEnd::Unsettled(other),
        ) => IntervalEnd::Unsettled(outer(one, other)),
        (IntervalEnd::Open, _) | (_, IntervalEnd::Open) => IntervalEnd::Open,
    };
    let both = one.into_iter().zip(other);
    both.map(|([low, high], [lower, higher])| [end(low, lower, f64::min), end(high, higher, f64::max)]).collect()
}

fn finish(evaluator: &Evaluator, best: &Minimum, others: &[Minimum], ends: Option<Ends>) -> Result<Fit, FitError> {
    let Evaluator { problem, unknowns, .. } = evaluator;
    let counts = problem.counts();
    let values = evaluator.values(&best.point);
    let variance = evaluator.variance(best.at.cost(), &counts);
    let covariance = best.at.triangle().covariance() * variance;
    let (level, deviate) = (problem.options.level, evaluator.deviate(&counts));
    let estimate = |i: usize| {
        let unknown = &unknowns[i];
        let at = |end: &IntervalEnd| match end {
            IntervalEnd::At(coordinate) | IntervalEnd::Unsettled(coordinate) => Some(unknown.value(*coordinate)),
            IntervalEnd::Open => None,
        };
        let deviation = covariance[(i, i)].sqrt();
        let standard_error = deviation * unknown.slope(best.point[i]);
        let quadratic_interval = [-deviate, deviate].map(|side| match unknown.is_logarithmic {
            true => values[i] * libm::exp(side * standard_error / values[i]),
            false => values[i] + side * standard_error,
        });
        Estimate {
            name: unknown.full_name(),
            unit: unknown.unit.clone(),
            value: values[i],
            standard_error,
            interval: ends.as_ref().and_then(|ends| ends.get(i)).map(|[low, high]| [at(low), at(high)]),
            quadratic_interval,
            bounds: unknown.bounds,
            at_bound: unknown.bounds.into_iter().find(|&bound| bound == values[i]),
        }
    };
    let estimates: Vec<Estimate> = (0..unknowns.len()).map(estimate).collect();
    let slopes: Vec<f64> = unknowns.iter().zip(&best.point).map(|(unknown, &at)| unknown.slope(at)).collect();
    let of_values = DMatrix::from_fn(slopes.len(), slopes.len(), |i, j| covariance[(i, j)] * slopes[i] * slopes[j]);
    let tests = (0..problem.tests.len()).map(|number| test_fit(evaluator, number, &values, best));
    let tests = tests.collect::<Result<Vec<_>, _>>()?;
    let data = counts.iter().sum::<usize>();
    let freedom = data.saturating_sub(unknowns.len()).max(1) as f64;
    let data_cost = best.at.residuals.rows(0, data).norm_squared();
    let has_noise = problem.tests[0].noise.is_some();
    let mut parameters = problem.parameters(&problem.tests[0]);
    for (unknown, value) in unknowns.iter().zip(&values).filter(|(unknown, _)| unknown.test.is_none()) {
        set(&mut parameters, &unknown.name, *value);
    }
    let runs = evaluator.runs.each_ref().map(|count| count.load(Ordering::Relaxed));
    let mut fit = Fit {
        estimates,
        covariance: of_values.row_iter().map(|row| row.iter().copied().collect()).collect(),
        combinations: combinations(&best.at.triangle_of(data), unknowns, variance),
        tests,
        reduced_chi_squared: has_noise.then_some(data_cost / freedom),
        noise: (!has_noise).then_some((data_cost / freedom).sqrt()),
        level,
        other_minima: others.iter().map(|other| evaluator.values(&other.point)).collect(),
        is_converged: best.is_converged,
        notes: Vec::new(),
        runs,
        block: parameters.checked_block().map_err(FitError::Block)?,
    };
    fit.notes = notes::notes(&fit);
    match ends {
        None => fit.notes.push(notes::NO_INTERVALS.into()),
        Some(ends) => {
            let is_unsettled =
                |(_, ends): &(_, &[IntervalEnd; 2])| ends.iter().any(|end| matches!(end, IntervalEnd::Unsettled(_)));
            let unsettled = unknowns.iter().zip(&ends).filter(is_unsettled);
            fit.notes.extend(unsettled.map(|(unknown, _)| notes::unsettled(&unknown.full_name())));
        }
    }
    Ok(fit)
}

fn test_fit(evaluator: &Evaluator, number: usize, values: &[f64], best: &Minimum) -> Result<TestFit, FitError> {
    let test = &evaluator.problem.tests[number];
    let before: usize = evaluator.problem.tests[..number].iter().map(|test| test.values.len()).sum();
    let weighted = best.at.residuals.rows(before, test.values.len());
    let residuals: Vec<f64> = weighted.iter().map(|residual| -residual * test.noise.unwrap_or(1.0)).collect();
    let series = evaluator
        .time_series(number, values, test.times.iter().copied(), true)
        .map_err(|e| e.unwrap_or(FitError::Starts))?;
    let squares: f64 = residuals.iter().map(|residual| residual * residual).sum();
    let over = |of: fn(f64, f64) -> f64| residuals.windows(2).map(|pair| of(pair[0], pair[1])).sum::<f64>() / squares;
    Ok(TestFit {
        output: test.output.clone(),
        unit: evaluator.problem.unit(test)?,
        times: test.times.clone(),
        measured: test.values.clone(),
        fitted: test.values.iter().zip(&residuals).map(|(measured, residual)| measured - residual).collect(),
        rms: (squares / residuals.len() as f64).sqrt(),
        durbin_watson: over(|a, b| (b - a) * (b - a)),
        autocorrelation: over(|a, b| a * b),
        residuals,
        grazing: series.grazing,
        overturned: series.ended,
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;
    use rocking_block::block::{Common, Dimensionless, Supports};

    use super::*;

    const TRUTH: Dimensionless = Dimensionless { alpha: 0.25, p: 3.0, supports: Supports::HOUSNER };

    /// A release test of the true block without errors, for a fit of p within 2.5 and `high`.
    fn problem(times: &[f64], noise: f64, high: f64) -> Problem {
        let test = Test { noise: Some(noise), ..Test::release(0.1, times.to_vec(), vec![0.0; times.len()]) };
        let mut problem = Problem {
            block: TRUTH.with(&Common::default()),
            ties: Vec::new(),
            free: vec![Free { bounds: Some([2.5, high]), ..Free::named("p") }],
            tests: vec![test],
            options: Options::default(),
        };
        let all = unknowns(&problem).unwrap();
        let series = evaluator(&problem, &all).time_series(0, &[TRUTH.p], times.iter().copied(), true);
        problem.tests[0].values =
            series.unwrap_or_else(|_| unreachable!()).points.iter().map(|point| point.value).collect();
        problem
    }

    fn evaluator<'a>(problem: &'a Problem, unknowns: &'a [unknowns::Unknown]) -> Evaluator<'a> {
        Evaluator { problem, unknowns, runs: Default::default() }
    }

    /// A point that is taken for a minimum.
    fn taken(evaluator: &Evaluator, coordinate: f64) -> Minimum {
        let point = DVector::from_element(1, coordinate);
        let at = evaluator.linearize(&point, &evaluator.problem.counts()).unwrap_or_else(|_| unreachable!());
        Minimum { point, at, is_converged: true }
    }

    /// The search for intervals about a point that is no minimum finds the minimum. It is kept and said even after the last restart.
    #[test]
    fn a_lower_minimum_found_at_last_is_kept() {
        let problem = problem(&[0.1, 0.2], 1e-3, 3.5);
        let all = unknowns(&problem).unwrap();
        let evaluator = evaluator(&problem, &all);
        // It is 8 % off.
        let poor = taken(&evaluator, 0.3);
        for restarts in [0, 1] {
            let (best, others, ends) = with_intervals(&evaluator, vec![poor.clone()], restarts, EVALUATIONS);
            let found = evaluator.values(&best.point)[0];
            assert!((found / TRUTH.p - 1.0).abs() < 1e-3, "{found}, {restarts} restarts");
            assert_eq!(ends.is_some(), restarts > 0);
            let fit = finish(&evaluator, &best, &others, ends).unwrap();
            assert_eq!(fit.estimates[0].interval.is_some(), restarts > 0);
            assert_eq!(fit.notes.iter().any(|note| note == notes::NO_INTERVALS), restarts == 0);
        }
    }

    /// An end that the search has not reached within its evaluations is said.
    #[test]
    fn an_end_that_has_not_settled_is_said() {
        let times: Vec<f64> = (1..=20).map(|i| 0.1 * f64::from(i)).collect();
        let problem = problem(&times, 0.02, 3.6);
        let all = unknowns(&problem).unwrap();
        let evaluator = evaluator(&problem, &all);
        for evaluations in [0, EVALUATIONS] {
            let (best, others, ends) = with_intervals(&evaluator, vec![taken(&evaluator, 0.5)], 0, evaluations);
            let fit = finish(&evaluator, &best, &others, ends).unwrap();
            let said = fit.notes.iter().any(|note| note.starts_with("the interval of p is rough"));
            assert_eq!(said, evaluations == 0, "{fit:?}");
        }
    }
}
