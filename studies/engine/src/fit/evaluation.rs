//! A point of the box → residuals of all tests, with their Jacobian.

use std::sync::atomic::{AtomicU64, Ordering};

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::fit::least_squares::{Linearization, Minimum, minimize};
use crate::fit::model::{TimeSeries, time_series};
use crate::fit::problem::{FitError, Problem, Test};
use crate::fit::unknowns::{MEASUREMENT_PARAMETERS, Unknown, set};
use crate::statistics::{normal, student};

/// A problem with its unknowns.
pub struct Evaluator<'a> {
    /// The problem.
    pub problem: &'a Problem,
    /// Its unknowns, the coordinates of a point.
    pub unknowns: &'a [Unknown],
    /// Numbers of runs so far, without and with derivatives.
    pub runs: [AtomicU64; 2],
}

impl Evaluator<'_> {
    /// Returns the values of the unknowns at a point.
    pub fn values(&self, point: &DVector<f64>) -> Vec<f64> {
        self.unknowns.iter().zip(point).map(|(unknown, &coordinate)| unknown.value(coordinate)).collect()
    }

    /// Returns the unknowns of a test with their indices.
    fn of_test(&self, number: usize) -> impl Iterator<Item = (usize, &Unknown)> {
        self.unknowns.iter().enumerate().filter(move |(_, unknown)| unknown.test.is_none_or(|test| test == number))
    }

    /// Returns zero and delay of a test.
    fn zero_and_delay(&self, number: usize, values: &[f64]) -> [f64; 2] {
        let test = &self.problem.tests[number];
        let value = |name: &str, default: f64| {
            let found = self.of_test(number).find(|(_, unknown)| unknown.name == name);
            found.map_or(default, |(i, _)| values[i])
        };
        [value("zero", test.zero), value("delay", test.delay)]
    }

    /// Returns a test's column at times of its clock. Its derivatives are with respect to the unknowns of the test.
    ///
    /// # Errors
    /// The failure of a run; `None` for an invalid block, or one without the parameters or the column.
    pub fn time_series(
        &self,
        number: usize,
        values: &[f64],
        times: impl Iterator<Item = f64>,
        with_gradients: bool,
    ) -> Result<TimeSeries, Option<FitError>> {
        let test = &self.problem.tests[number];
        let mut parameters = self.problem.parameters(test);
        for (i, unknown) in self.of_test(number) {
            set(&mut parameters, &unknown.name, values[i]);
        }
        let is_of_run = |(_, unknown): &(usize, &Unknown)| !MEASUREMENT_PARAMETERS.contains(&unknown.name.as_str());
        let names: Option<Vec<String>> = with_gradients
            .then(|| self.of_test(number).filter(is_of_run).map(|(_, unknown)| unknown.name.clone()).collect());
        let with_rate = with_gradients && self.of_test(number).any(|(_, unknown)| unknown.name == "delay");
        let [_, delay] = self.zero_and_delay(number, values);
        let times: Vec<f64> = times.map(|time| time - delay).collect();
        let run = self.problem.run(test, &parameters).map_err(|_| None)?;
        self.runs[usize::from(with_gradients)].fetch_add(1, Ordering::Relaxed);
        let found = time_series(&run, &parameters, names.as_deref(), &test.output, &times, with_rate);
        found.ok_or(None)?.map_err(|error| Some(FitError::Runs(error)))
    }

    /// Estimates the sum of squares of the first `counts` values and of the priors. The estimate comes from a sample of the values.
    ///
    /// # Errors
    /// The failure of a run; `None` for an invalid block or a sum of squares that is not finite.
    pub fn rough_cost(&self, point: &DVector<f64>, counts: &[usize]) -> Result<f64, Option<FitError>> {
        /// Number of values of a test that suffice to rank starts.
        const SAMPLE: usize = 100;
        let values = self.values(point);
        let cost_of_test = |number: usize| -> Result<f64, Option<FitError>> {
            let test = &self.problem.tests[number];
            let stride = counts[number].div_ceil(SAMPLE);
            let times = test.times[..counts[number]].iter().step_by(stride).copied();
            let series = self.time_series(number, &values, times, false)?;
            let [zero, _] = self.zero_and_delay(number, &values);
            let pairs = test.values.iter().step_by(stride).zip(&series.points);
            let residuals = pairs.map(|(measured, found)| (found.value + zero - measured) / test.noise.unwrap_or(1.0));
            Ok(residuals.map(|residual| residual * residual).sum::<f64>() * stride as f64)
        };
        let tests: Vec<f64> = (0..counts.len()).into_par_iter().map(cost_of_test).collect::<Result<_, _>>()?;
        let priors = self.priors().map(|(i, [mean, deviation])| (values[i] - mean) / deviation);
        let cost = tests.into_iter().sum::<f64>() + priors.map(|residual| residual * residual).sum::<f64>();
        if cost.is_finite() { Ok(cost) } else { Err(None) }
    }

    /// Returns the unknowns with priors, by their indices.
    fn priors(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        self.unknowns.iter().enumerate().filter_map(|(i, unknown)| Some((i, unknown.prior?)))
    }

    /// Returns the residuals of the first `counts` values and of the priors, with their Jacobian.
    ///
    /// # Errors
    /// The failure of a run; `None` for an invalid block or a sum of squares that is not finite.
    pub fn linearize(&self, point: &DVector<f64>, counts: &[usize]) -> Result<Linearization, Option<FitError>> {
        let values = self.values(point);
        let slopes: Vec<f64> = self.unknowns.iter().zip(point).map(|(unknown, &at)| unknown.slope(at)).collect();
        let tests: Vec<TimeSeries> = (0..self.problem.tests.len())
            .into_par_iter()
            .map(|number| {
                let times = self.problem.tests[number].times[..counts[number]].iter().copied();
                self.time_series(number, &values, times, true)
            })
            .collect::<Result<_, _>>()?;
        let rows = counts.iter().sum::<usize>() + self.priors().count();
        let mut residuals = DVector::zeros(rows);
        let mut jacobian = DMatrix::zeros(rows, self.unknowns.len());
        let mut row = 0;
        for (number, (test, series)) in self.problem.tests.iter().zip(&tests).enumerate() {
            let weight = 1.0 / test.noise.unwrap_or(1.0);
            let [zero, _] = self.zero_and_delay(number, &values);
            for (measured, found) in test.values.iter().zip(&series.points) {
                residuals[row] = weight * (found.value + zero - measured);
                let mut derivatives = found.derivatives.iter();
                for (i, unknown) in self.of_test(number) {
                    let derivative = match unknown.name.as_str() {
                        "zero" => 1.0,
                        "delay" => -found.rate,
                        _ => derivatives.next().copied().unwrap_or_default(),
                    };
                    jacobian[(row, i)] = weight * derivative * slopes[i];
                }
                row += 1;
            }
        }
        for (i, [mean, deviation]) in self.priors() {
            residuals[row] = (values[i] - mean) / deviation;
            jacobian[(row, i)] = slopes[i] / deviation;
            row += 1;
        }
        let found = Linearization { residuals, jacobian };
        if found.cost().is_finite() { Ok(found) } else { Err(None) }
    }

    /// Minimizes the sum of squares of the first `counts` values from a point. `tolerance` and `known` are those of [`minimize`]; `None` if
    /// the model fails at the point.
    pub fn minimum(
        &self,
        point: &DVector<f64>,
        counts: &[usize],
        tolerance: f64,
        known: Option<&Minimum>,
    ) -> Option<Minimum> {
        let linearize = |at: &DVector<f64>| self.linearize(at, counts).ok();
        let at = linearize(point)?;
        Some(minimize(linearize, point.clone(), at, |cost| self.variance(cost, counts), tolerance, known))
    }

    /// Returns the variance of a residual. It is 1 if the noise is given, else the mean square over the degrees of freedom.
    pub fn variance(&self, cost: f64, counts: &[usize]) -> f64 {
        match self.problem.tests[0].noise {
            Some(_) => 1.0,
            None => cost / self.freedom(counts),
        }
    }

    /// Degrees of freedom of the residuals, at least 1.
    fn freedom(&self, counts: &[usize]) -> f64 {
        (counts.iter().sum::<usize>().saturating_sub(self.unknowns.len())).max(1) as f64
    }

    /// Returns the deviate of the level of intervals. It is a normal one if the noise is given, else Student's of the degrees of freedom.
    pub fn deviate(&self, counts: &[usize]) -> f64 {
        let level = self.problem.options.level;
        match self.problem.tests[0].noise {
            Some(_) => normal::quantile(0.5 + 0.5 * level),
            None => student::quantile(1.0 - level, self.freedom(counts)),
        }
    }

    /// Returns for each fraction the numbers of values of the tests that reach it. Fractions are of a test's sum of squares about the mean.
    pub fn windows(&self, fractions: &[f64]) -> Vec<Vec<usize>> {
        let count = |test: &Test, fraction: f64| {
            let mean = test.values.iter().sum::<f64>() / test.values.len() as f64;
            let total: f64 = test.values.iter().map(|value| (value - mean) * (value - mean)).sum();
            let mut sum = 0.0;
            let reached = test.values.iter().position(|value| {
                sum += (value - mean) * (value - mean);
                sum >= fraction * total
            });
            if fraction < 1.0 { reached.map_or(test.values.len(), |last| last + 1) } else { test.values.len() }
        };
        fractions
            .iter()
            .map(|&fraction| self.problem.tests.iter().map(|test| count(test, fraction)).collect())
            .collect()
    }
}
