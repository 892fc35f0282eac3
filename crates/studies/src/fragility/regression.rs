//! Data → the curve or surface of maximum likelihood.

use nalgebra::{DMatrix, DVector};

use crate::fragility::data::Data;
use crate::fragility::likelihood::{Link, Term};
use crate::fragility::observation::{FitError, Observation};

/// A fitted curve or surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
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
    /// [`FitError::NotConverged`] for data that are nearly separable.
    pub fn fit(&self, link: Link) -> Result<Fit, FitError> {
        let observations = self.observations();
        let Maximum { coefficients, covariance, log_likelihood } =
            maximize(&Design::full(observations), link, DVector::zeros(1 + self.measures()))?;
        let total: f64 = observations.iter().map(|row| row.weight).sum();
        let mean = observations.iter().map(|row| row.weight * row.fraction).sum::<f64>() / total;
        let null_log_likelihood = total * (mean * libm::log(mean) + (1.0 - mean) * libm::log1p(-mean));
        Ok(Fit { link, coefficients, covariance, log_likelihood, null_log_likelihood })
    }
}

impl Fit {
    /// The probability at these measures, one for each slope and above zero.
    pub fn probability(&self, measures: &[f64]) -> f64 {
        let slopes = self.coefficients.iter().skip(1).zip(measures);
        self.link.probability(self.coefficients[0] + slopes.map(|(slope, x)| slope * libm::log(*x)).sum::<f64>())
    }

    /// The first measure at a probability of one half, `exp(−a/b)`; for a surface, where the second measure is 1.
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
pub(super) struct Design<'a> {
    pub observations: &'a [Observation],
    /// A row for each observation.
    pub x: DMatrix<f64>,
    pub offset: DVector<f64>,
}

impl Design<'_> {
    /// The full model: an intercept and the logarithm of each measure.
    pub fn full(observations: &[Observation]) -> Design<'_> {
        let columns = 1 + observations[0].measures.len();
        let x = DMatrix::from_fn(observations.len(), columns, |row, column| match column {
            0 => 1.0,
            _ => libm::log(observations[row].measures[column - 1]),
        });
        Design { observations, x, offset: DVector::zeros(observations.len()) }
    }

    /// The log-likelihood at these coefficients, and its weighted terms.
    pub fn terms(&self, link: Link, coefficients: &DVector<f64>) -> (f64, Vec<Term>) {
        let predictor = &self.x * coefficients + &self.offset;
        let rows = self.observations.iter().zip(predictor.iter());
        let terms: Vec<Term> = rows.map(|(row, &predictor)| link.term(predictor, row.fraction) * row.weight).collect();
        (terms.iter().map(|term| term.log_likelihood).sum(), terms)
    }

    /// `Xᵀ diag(w) X`.
    fn squared(&self, weights: impl Iterator<Item = f64>) -> DMatrix<f64> {
        let mut weighted = self.x.clone();
        for (mut row, weight) in weighted.row_iter_mut().zip(weights) {
            row *= weight;
        }
        self.x.tr_mul(&weighted)
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
pub(super) fn maximize(design: &Design, link: Link, start: DVector<f64>) -> Result<Maximum, FitError> {
    const MAX_ITERATIONS: u32 = 100;
    const MAX_HALVINGS: u32 = 60;
    let mut at = start;
    let (mut best, mut terms) = design.terms(link, &at);
    let mut length = f64::INFINITY;
    for _ in 0..MAX_ITERATIONS {
        let score = design.x.tr_mul(&DVector::from_iterator(terms.len(), terms.iter().map(|term| term.score)));
        let curvature = design.squared(terms.iter().map(|term| term.curvature));
        let Some(step) = curvature.cholesky().map(|curvature| curvature.solve(&score)) else { break };
        // The next step would change the likelihood by about the square of this, which is below round-off.
        if step.dot(&score) <= 1e-24 * (1.0 + best.abs()) {
            let information = design.squared(terms.iter().map(|term| term.information));
            let Some(inverse) = information.cholesky() else { break };
            return Ok(Maximum { coefficients: at, covariance: inverse.inverse(), log_likelihood: best });
        }
        let mut part = 1.0;
        for _ in 0..MAX_HALVINGS {
            let next = &at + part * &step;
            let (likelihood, of_next) = design.terms(link, &next);
            // Near the maximum, round-off may make the better step look worse.
            if likelihood >= best - 1e-13 * (1.0 + best.abs()) {
                (at, best, terms) = (next, likelihood, of_next);
                break;
            }
            part *= 0.5;
        }
        length = part * step.norm();
    }
    Err(FitError::NotConverged { iterations: MAX_ITERATIONS, step: length })
}
