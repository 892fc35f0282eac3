//! Data → the curve or surface of maximum likelihood.

use nalgebra::{DMatrix, DVector};

use crate::fragility::data::Data;
use crate::fragility::likelihood::{Link, Term};
use crate::fragility::observation::{CurveFitError, Observation};
use crate::fragility::rows::{EqualRows, SortedRows, total};
use crate::output::runner::in_parallel;

/// A fitted curve or surface.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveFit {
    /// The distribution function of the linear predictor.
    pub link: Link,
    /// Intercept a, then a slope b for the natural logarithm of each measure.
    pub coefficients: DVector<f64>,
    /// Covariance of the coefficients from the expected information.
    pub covariance: DMatrix<f64>,
    /// Greatest log-likelihood, without the binomial coefficients of counts.
    pub log_likelihood: f64,
    /// Log-likelihood of a constant probability.
    pub null_log_likelihood: f64,
}

impl Data {
    /// Fits the curve or surface of maximum likelihood by Newton's method; the maximum is unique.
    ///
    /// # Errors
    /// Data that are nearly separable.
    pub fn fit(&self, link: Link) -> Result<CurveFit, CurveFitError> {
        let observations = self.observations();
        let total: f64 = observations.iter().map(|row| row.weight).sum();
        let mean = observations.iter().map(|row| row.weight * row.fraction).sum::<f64>() / total;
        fit_of(&Predictor::full(observations), link, total, mean)
    }
}

/// Fits the curve or surface of rows with this total weight and mean fraction.
pub(super) fn fit_of(design: &impl Regression, link: Link, total: f64, mean: f64) -> Result<CurveFit, CurveFitError> {
    let Maximum { coefficients, covariance, log_likelihood } =
        maximize(design, link, DVector::zeros(design.columns()))?;
    let null_log_likelihood = total * (mean * libm::log(mean) + (1.0 - mean) * libm::log1p(-mean));
    Ok(CurveFit { link, coefficients, covariance, log_likelihood, null_log_likelihood })
}

impl CurveFit {
    /// The probability at these measures, one for each slope and above zero.
    pub fn probability(&self, measures: &[f64]) -> f64 {
        let slopes = self.coefficients.iter().skip(1).zip(measures);
        self.link.probability(self.coefficients[0] + slopes.map(|(slope, x)| slope * libm::log(*x)).sum::<f64>())
    }

    /// The first measure at a probability of one half, `exp(−a/b)`. On a surface, the second measure is 1 there.
    pub fn median(&self) -> f64 {
        libm::exp(-self.coefficients[0] / self.coefficients[1])
    }

    /// The dispersion `β = 1/b` of the logarithm of the first measure (1).
    ///
    /// Its standard deviation for probit, its scale for logit; negative where the probability falls with the measure.
    pub fn dispersion(&self) -> f64 {
        1.0 / self.coefficients[1]
    }

    /// The fitted probability of each observation.
    pub fn probabilities(&self, observations: &[Observation]) -> Vec<f64> {
        observations.iter().map(|row| self.probability(&row.measures)).collect()
    }
}

/// The design of a regression: a predictor `offset + Σ x c` for each observation.
pub(super) struct Predictor<'a> {
    pub observations: &'a [Observation],
    /// A row for each observation.
    pub x: DMatrix<f64>,
    pub offset: DVector<f64>,
}

impl Predictor<'_> {
    /// The full model: an intercept and the logarithm of each measure.
    pub fn full(observations: &[Observation]) -> Predictor<'_> {
        let columns = 1 + observations[0].measures.len();
        let x = DMatrix::from_fn(observations.len(), columns, |row, column| match column {
            0 => 1.0,
            _ => libm::log(observations[row].measures[column - 1]),
        });
        Predictor { observations, x, offset: DVector::zeros(observations.len()) }
    }

    /// The weighted terms of the log-likelihood at these coefficients.
    pub fn terms(&self, link: Link, coefficients: &DVector<f64>) -> Vec<Term> {
        let predictor = &self.x * coefficients + &self.offset;
        let rows = self.observations.iter().zip(predictor.iter());
        rows.map(|(row, &predictor)| link.term(predictor, row.fraction) * row.weight).collect()
    }
}

/// The rows of a regression.
pub(super) trait Regression {
    /// Number of coefficients.
    fn columns(&self) -> usize;

    /// Sums the terms of all rows, on all threads for many rows. The result does not depend on the number of threads.
    fn sums_of(
        &self,
        coefficients: &DVector<f64>,
        term: impl Fn(f64, f64) -> Term + Sync,
        weight: impl Fn(&Term) -> f64 + Sync,
    ) -> Sums;

    /// The sums of a step at these coefficients.
    fn sums(&self, link: Link, coefficients: &DVector<f64>) -> Sums {
        self.sums_of(coefficients, |predictor, y| link.term_of_step(predictor, y), |term| term.curvature)
    }

    /// The expected information at these coefficients.
    fn information(&self, link: Link, coefficients: &DVector<f64>) -> DMatrix<f64> {
        let sums = self.sums_of(coefficients, |predictor, y| link.term(predictor, y), |term| term.information);
        sums.squares(self.columns())
    }
}

impl Regression for Predictor<'_> {
    fn columns(&self) -> usize {
        self.x.ncols()
    }

    fn sums_of(
        &self,
        coefficients: &DVector<f64>,
        term: impl Fn(f64, f64) -> Term + Sync,
        weight: impl Fn(&Term) -> f64 + Sync,
    ) -> Sums {
        /// Number of rows of a chunk. The round-off of one long sum over 20,000 sorted rows hides the last steps to the maximum.
        const CHUNK: usize = 256;
        let columns = self.x.ncols();
        let chunk = |number: usize| {
            let mut sums = Sums::default();
            let begin = number * CHUNK;
            for (row, observation) in self.observations.iter().enumerate().skip(begin).take(CHUNK) {
                let mut x = [0.0; MAX_COLUMNS];
                (0..columns).for_each(|column| x[column] = self.x[(row, column)]);
                let predictor =
                    (0..columns).map(|column| x[column] * coefficients[column]).sum::<f64>() + self.offset[row];
                let term = term(predictor, observation.fraction) * observation.weight;
                sums.add(&x[..columns], &term, weight(&term));
            }
            sums
        };
        let chunks = self.observations.len().div_ceil(CHUNK);
        let parts: Vec<Sums> = match chunks {
            0..=8 => (0..chunks).map(chunk).collect(),
            _ => in_parallel(chunks, chunk),
        };
        total(&parts)
    }
}

/// The full model of a large table over two measures.
impl Regression for SortedRows {
    fn columns(&self) -> usize {
        3
    }

    fn sums_of(
        &self,
        coefficients: &DVector<f64>,
        term: impl Fn(f64, f64) -> Term + Sync,
        weight: impl Fn(&Term) -> f64 + Sync,
    ) -> Sums {
        self.sum(|row| Sums::of_row(row, coefficients.as_slice(), &term, &weight))
    }
}

/// Greatest number of coefficients: an intercept and two slopes.
const MAX_COLUMNS: usize = 3;

/// Sums over rows.
#[derive(Clone, Copy, Default)]
pub(super) struct Sums {
    likelihood: f64,
    /// Derivatives of the log-likelihood with respect to the coefficients.
    score: [f64; MAX_COLUMNS],
    /// Lower triangle of `Xᵀ diag(w) X`.
    squares: [[f64; MAX_COLUMNS]; MAX_COLUMNS],
}

impl Sums {
    /// The sums of a row of a large table at these coefficients. They are an intercept and one or two slopes.
    pub fn of_row(
        row: &EqualRows,
        coefficients: &[f64],
        term: impl Fn(f64, f64) -> Term,
        weight: impl Fn(&Term) -> f64,
    ) -> Sums {
        let [first, second] = row.measures.map(libm::log);
        let x = &[1.0, first, second][..coefficients.len()];
        let predictor = x.iter().zip(coefficients).map(|(x, coefficient)| x * coefficient).sum();
        let term = term(predictor, row.fraction) * f64::from(row.count);
        let mut sums = Sums::default();
        sums.add(x, &term, weight(&term));
        sums
    }

    /// Adds the term of a row with its weight in the squares.
    fn add(&mut self, x: &[f64], term: &Term, weight: f64) {
        self.likelihood += term.log_likelihood;
        for i in 0..x.len() {
            self.score[i] += x[i] * term.score;
            for j in 0..=i {
                self.squares[i][j] += weight * x[i] * x[j];
            }
        }
    }

    /// Adds `x xᵀ` with a weight.
    pub fn add_square(&mut self, x: &[f64], weight: f64) {
        self.add(x, &Term::default(), weight);
    }

    /// The derivatives of the log-likelihood.
    pub fn score(&self, columns: usize) -> DVector<f64> {
        DVector::from_fn(columns, |column, _| self.score[column])
    }

    /// `Xᵀ diag(w) X`.
    pub fn squares(&self, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(columns, columns, |i, j| self.squares[i.max(j)][i.min(j)])
    }
}

impl std::ops::Add for Sums {
    type Output = Sums;

    fn add(mut self, other: Sums) -> Sums {
        self.likelihood += other.likelihood;
        for i in 0..MAX_COLUMNS {
            self.score[i] += other.score[i];
            (0..=i).for_each(|j| self.squares[i][j] += other.squares[i][j]);
        }
        self
    }
}

/// The maximum of the likelihood.
pub(super) struct Maximum {
    pub coefficients: DVector<f64>,
    pub covariance: DMatrix<f64>,
    pub log_likelihood: f64,
}

/// Maximizes the likelihood by Newton's method from these coefficients, halving steps that decrease it.
///
/// The log-likelihood of both links is concave; data that are not separable have exactly one maximum.
pub(super) fn maximize(design: &impl Regression, link: Link, start: DVector<f64>) -> Result<Maximum, CurveFitError> {
    const MAX_ITERATIONS: u32 = 100;
    const MAX_HALVINGS: u32 = 60;
    let columns = design.columns();
    let mut at = start;
    let mut here = design.sums(link, &at);
    let mut length = f64::INFINITY;
    for _ in 0..MAX_ITERATIONS {
        let (score, best) = (here.score(columns), here.likelihood);
        let Some(step) = here.squares(columns).cholesky().map(|curvature| curvature.solve(&score)) else { break };
        // The next step would change the likelihood by about the square of this, which is below round-off.
        if step.dot(&score) <= 1e-24 * (1.0 + best.abs()) {
            let Some(inverse) = design.information(link, &at).cholesky() else { break };
            return Ok(Maximum { coefficients: at, covariance: inverse.inverse(), log_likelihood: best });
        }
        let mut fraction = 1.0;
        for _ in 0..MAX_HALVINGS {
            let next = &at + fraction * &step;
            let there = design.sums(link, &next);
            // Near the maximum, round-off may make the better step look worse.
            if there.likelihood >= best - 1e-13 * (1.0 + best.abs()) {
                (at, here) = (next, there);
                break;
            }
            fraction *= 0.5;
        }
        length = fraction * step.norm();
    }
    Err(CurveFitError(format!(
        "found no maximum of the likelihood in {MAX_ITERATIONS} iterations; the last step was {length:e}"
    )))
}
