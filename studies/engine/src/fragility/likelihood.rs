//! A linear predictor and an outcome → the log-likelihood and its derivatives.

use crate::spec::words::Words;
use crate::statistics::normal;

/// The distribution function of the linear predictor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    /// Normal: lognormal fragility.
    Probit,
    /// Logistic.
    Logit,
}

impl Words for Link {
    const WORDS: &'static [(&'static str, Link)] = &[("probit", Link::Probit), ("logit", Link::Logit)];
}

/// A term of the log-likelihood, for one outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Term {
    /// `y ln P + (1 − y) ln(1 − P)`.
    pub log_likelihood: f64,
    /// Its derivative with respect to the predictor.
    pub score: f64,
    /// Minus its second derivative, above zero.
    pub curvature: f64,
    /// The expected curvature: Fisher's information.
    pub information: f64,
}

impl std::ops::Mul<f64> for Term {
    type Output = Term;

    fn mul(self, weight: f64) -> Term {
        Term {
            log_likelihood: weight * self.log_likelihood,
            score: weight * self.score,
            curvature: weight * self.curvature,
            information: weight * self.information,
        }
    }
}

impl Link {
    /// The probability at a predictor.
    pub fn probability(self, predictor: f64) -> f64 {
        match self {
            Link::Probit => normal::probability(predictor),
            Link::Logit => 1.0 / (1.0 + libm::exp(-predictor)),
        }
    }

    /// [`Link::term`] without the information, which a single outcome does not need.
    pub(super) fn term_of_step(self, predictor: f64, y: f64) -> Term {
        let side = match (self, y) {
            (Link::Probit, 1.0) => 1.0,
            (Link::Probit, 0.0) => -1.0,
            (Link::Probit | Link::Logit, _) => return self.term(predictor, y),
        };
        let (log_likelihood, slope) = normal::log_probability_and_slope(side * predictor);
        Term {
            log_likelihood,
            score: side * slope,
            curvature: slope * (slope + side * predictor),
            information: f64::NAN,
        }
    }

    /// The term of a predictor for the fraction `y` of exceedances.
    pub(super) fn term(self, predictor: f64, y: f64) -> Term {
        match self {
            Link::Probit => {
                let [(log_up, up), (log_down, down)] = [predictor, -predictor].map(normal::log_probability_and_slope);
                let log = |fraction: f64, log: f64| if fraction > 0.0 { fraction * log } else { 0.0 };
                Term {
                    log_likelihood: log(y, log_up) + log(1.0 - y, log_down),
                    score: y * up - (1.0 - y) * down,
                    curvature: y * up * (up + predictor) + (1.0 - y) * down * (down - predictor),
                    information: up * down,
                }
            }
            Link::Logit => {
                let probability = self.probability(predictor);
                // −ln(1 + exp(−|x|)), the logarithm of the greater probability, is accurate at both ends.
                let greater = -libm::log1p(libm::exp(-predictor.abs()));
                let other = if predictor > 0.0 { 1.0 - y } else { y };
                let information = probability * self.probability(-predictor);
                Term {
                    log_likelihood: greater - other * predictor.abs(),
                    score: y - probability,
                    curvature: information,
                    information,
                }
            }
        }
    }
}

/// The word in options and reports.
impl std::fmt::Display for Link {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.word())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares score and curvature with differences, and the information with the expected curvature.
    #[test]
    fn score_and_curvature_are_the_derivatives() {
        for link in [Link::Probit, Link::Logit] {
            for predictor in [-12.0, -2.5, -0.1, 0.4, 3.0, 7.0] {
                for y in [0.0, 0.3, 1.0] {
                    let h = 1e-4;
                    let [below, at, above] = [-h, 0.0, h].map(|off| link.term(predictor + off, y));
                    let slope = (above.log_likelihood - below.log_likelihood) / (2.0 * h);
                    let of_step = link.term_of_step(predictor, y);
                    assert_eq!(
                        [of_step.log_likelihood, of_step.score, of_step.curvature],
                        [at.log_likelihood, at.score, at.curvature]
                    );
                    assert!((slope - at.score).abs() < 1e-7 * at.score.abs() + 1e-10, "{link} {predictor} {y}");
                    let bend = (below.score - above.score) / (2.0 * h);
                    assert!((bend - at.curvature).abs() < 1e-7 * at.curvature.abs() + 1e-10, "{link} {predictor} {y}");
                }
                let [p, other] = [predictor, -predictor].map(|predictor| link.probability(predictor));
                let [no, yes] = [0.0, 1.0].map(|y| link.term(predictor, y));
                let mean = p * yes.curvature + other * no.curvature;
                assert!((mean / yes.information - 1.0).abs() < 1e-8, "{link} {predictor}: {mean}");
                assert!((yes.log_likelihood.exp() / p - 1.0).abs() < 1e-13);
            }
        }
    }
}
