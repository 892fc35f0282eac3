//! Observations → the coefficients of the greatest likelihood.

use nalgebra::{DMatrix, DVector};

use crate::study::fragility::likelihood::{Link, Term};
use crate::study::fragility::{Data, FitError, Observation};

/// A fitted curve or surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Distribution of which the predictor is the deviate.
    pub link: Link,
    /// Intercept a, then a slope b for the natural logarithm of each measure.
    pub coefficients: Vec<f64>,
    /// Their covariance from the expected information, row by row.
    pub covariance: Vec<Vec<f64>>,
    /// Greatest log-likelihood, without the binomial coefficients of counts.
    pub log_likelihood: f64,
    /// That of a probability which does not depend on the measures.
    pub null_log_likelihood: f64,
}

impl Fit {
    pub(super) fn new(link: Link, data: &Data, maximum: &Maximum) -> Fit {
        let observations = data.observations();
        let total: f64 = observations.iter().map(|row| row.weight).sum();
        let mean = observations.iter().map(|row| row.weight * row.fraction).sum::<f64>() / total;
        Fit {
            link,
            coefficients: maximum.coefficients.iter().copied().collect(),
            covariance: maximum.covariance.row_iter().map(|row| row.iter().copied().collect()).collect(),
            log_likelihood: maximum.log_likelihood,
            null_log_likelihood: total * (mean * libm::log(mean) + (1.0 - mean) * libm::log1p(-mean)),
        }
    }

    /// The probability at these measures, as many as the data have, each above zero.
    pub fn probability(&self, measures: &[f64]) -> f64 {
        let slopes = self.coefficients[1..].iter().zip(measures);
        self.link.probability(self.coefficients[0] + slopes.map(|(slope, x)| slope * libm::log(*x)).sum::<f64>())
    }

    /// The first measure at which the probability is one half, where the second one, if there is one, is 1:
    /// `exp(−a/b)`.
    pub fn median(&self) -> f64 {
        libm::exp(-self.coefficients[0] / self.coefficients[1])
    }

    /// The dispersion `β = 1/b` of the first measure's logarithm (1): its standard deviation for probit, its scale for logit.
    /// Negative where the probability falls as the measure grows.
    pub fn dispersion(&self) -> f64 {
        1.0 / self.coefficients[1]
    }

    /// Standard errors of the coefficients, by the expected information.
    pub fn standard_errors(&self) -> Vec<f64> {
        (0..self.coefficients.len()).map(|i| self.covariance[i][i].sqrt()).collect()
    }

    /// The fitted probability of each observation.
    pub fn probabilities(&self, observations: &[Observation]) -> Vec<f64> {
        observations.iter().map(|row| self.probability(&row.measures)).collect()
    }
}

/// What a regression is made of: a predictor `offset + Σ x c` for each observation.
pub(super) struct Design<'a> {
    pub observations: &'a [Observation],
    /// A row for each observation.
    pub x: DMatrix<f64>,
    pub offset: DVector<f64>,
}

impl Design<'_> {
    /// An intercept, and the logarithm of each measure.
    pub fn full(observations: &[Observation]) -> Design<'_> {
        let columns = 1 + observations[0].measures.len();
        let x = DMatrix::from_fn(observations.len(), columns, |row, column| match column {
            0 => 1.0,
            _ => libm::log(observations[row].measures[column - 1]),
        });
        Design { observations, x, offset: DVector::zeros(observations.len()) }
    }

    /// The log-likelihood at these coefficients and the terms that it is the sum of, times their weights.
    pub fn terms(&self, link: Link, coefficients: &DVector<f64>) -> (f64, Vec<Term>) {
        let predictor = &self.x * coefficients + &self.offset;
        let terms = self.observations.iter().zip(predictor.iter()).map(|(row, &predictor)| {
            let Term { log_likelihood, score, curvature, information } = link.term(predictor, row.fraction);
            let w = row.weight;
            Term {
                log_likelihood: w * log_likelihood,
                score: w * score,
                curvature: w * curvature,
                information: w * information,
            }
        });
        let terms: Vec<Term> = terms.collect();
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

/// Where the likelihood is greatest.
pub(super) struct Maximum {
    pub coefficients: DVector<f64>,
    pub covariance: DMatrix<f64>,
    pub log_likelihood: f64,
}

/// Finds the greatest likelihood from coefficients of zero by Newton's method; a step after which it is less is halved. The
/// log-likelihood of both links is concave, so that there is one maximum, and data that are not separable have it.
pub(super) fn maximize(design: &Design, link: Link) -> Result<Maximum, FitError> {
    const MOST_ITERATIONS: u32 = 100;
    const MOST_HALVINGS: u32 = 60;
    let mut at = DVector::zeros(design.x.ncols());
    let (mut best, mut terms) = design.terms(link, &at);
    let mut length = f64::INFINITY;
    for _ in 0..MOST_ITERATIONS {
        let score = design.x.tr_mul(&DVector::from_iterator(terms.len(), terms.iter().map(|term| term.score)));
        let curvature = design.squared(terms.iter().map(|term| term.curvature));
        let Some(step) = curvature.cholesky().map(|curvature| curvature.solve(&score)) else { break };
        // What the next step adds to the likelihood is the square of this, and no digit of it is left.
        if step.dot(&score) <= 1e-24 * (1.0 + best.abs()) {
            let information = design.squared(terms.iter().map(|term| term.information));
            let Some(inverse) = information.cholesky() else { break };
            return Ok(Maximum { coefficients: at, covariance: inverse.inverse(), log_likelihood: best });
        }
        let mut part = 1.0;
        for _ in 0..MOST_HALVINGS {
            let next = &at + part * &step;
            let (likelihood, of_next) = design.terms(link, &next);
            // Near the maximum rounding decides which is greater.
            if likelihood >= best - 1e-13 * (1.0 + best.abs()) {
                (at, best, terms) = (next, likelihood, of_next);
                break;
            }
            part *= 0.5;
        }
        length = part * step.norm();
    }
    Err(FitError::NotConverged { iterations: MOST_ITERATIONS, step: length })
}
