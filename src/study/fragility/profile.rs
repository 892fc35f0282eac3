//! A fitted curve → what else the data allow: intervals and bands of the profile likelihood.

use nalgebra::{DMatrix, DVector};

use crate::numerics::roots::sign_change;
use crate::study::fragility::clusters::{self, Independence};
use crate::study::fragility::regression::{Design, Fit, maximize};
use crate::study::fragility::{Data, FitError, Observation};

/// An interval; an end that the data do not bound is missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl Interval {
    /// Whether a value lies in it.
    pub fn contains(&self, value: f64) -> bool {
        self.low.is_none_or(|low| low <= value) && self.high.is_none_or(|high| value <= high)
    }
}

/// The likelihood of a curve of one measure with one of its features fixed and the other chosen for the best.
///
/// The interval of a feature holds the values at which twice the logarithm of the ratio to the greatest likelihood is at most
/// the quantile of χ² with one degree of freedom. It does not change with the unit or the logarithm of a feature, and needs
/// no symmetry.
///
/// Rows of the same record are not independent. Where records repeat, the fall that is allowed grows by the ratio of the
/// feature's variance with rows clustered by record to that with independent rows (R. E. Chandler, S. Bate, Inference for
/// clustered data using the independence loglikelihood, Biometrika 94 (2007) 167–183), and the quantile is that of t².
pub struct Profile<'a> {
    observations: &'a [Observation],
    /// Logarithms of the measure.
    x: Vec<f64>,
    fit: &'a Fit,
    /// Covariance of the coefficients; nothing if one record alone determines them.
    covariance: Option<DMatrix<f64>>,
    /// Permitted fall of twice the log-likelihood, for independent rows.
    allowed: f64,
}

impl<'a> Profile<'a> {
    /// The profile of a curve that was fitted to these data, of one measure; `confidence` is above 0 and below 1, `records`
    /// has the record of each observation.
    ///
    /// # Errors
    /// [`FitError::Measures`] for a surface.
    pub fn new(data: &'a Data, fit: &'a Fit, confidence: f64, records: &[usize]) -> Result<Profile<'a>, FitError> {
        if data.measures() != 1 {
            return Err(FitError::Measures { row: 0, found: data.measures(), expected: "1 for a curve" });
        }
        let deviate = Independence::of(records).deviate(confidence);
        let covariance = clusters::covariance(data, fit, records);
        let x = data.observations().iter().map(|row| libm::log(row.measures[0])).collect();
        Ok(Profile { observations: data.observations(), x, fit, covariance, allowed: deviate * deviate })
    }

    /// Interval of the median, in the unit of the measure. Where the probability need not depend on the measure at all, it has
    /// no bounds.
    pub fn median(&self) -> Interval {
        let [a, b] = self.coefficients();
        let log_median = -a / b;
        let gradient = [-1.0 / b, a / (b * b)];
        self.interval(log_median, gradient, |log_median, x| (x - log_median, 0.0)).map(libm::exp)
    }

    /// Interval of the dispersion β. Where the slope may be zero, β has no upper bound; if the data allow both signs of it,
    /// only the bounds of its own sign are reported.
    pub fn dispersion(&self) -> Interval {
        let [_, b] = self.coefficients();
        let slopes = self.interval(b, [0.0, 1.0], |b, x| (1.0, b * x));
        let same_sign = |slope: Option<f64>| slope.filter(|slope| slope * b > 0.0).map(|slope| 1.0 / slope);
        Interval { low: same_sign(slopes.high), high: same_sign(slopes.low) }
    }

    /// Interval of the probability at a measure above zero: a band, point by point.
    pub fn probability(&self, measure: f64) -> Interval {
        let ([a, b], x0) = (self.coefficients(), libm::log(measure));
        let found = self.interval(a + b * x0, [1.0, x0], |predictor, x| (x - x0, predictor));
        let found = found.map(|predictor| self.fit.link.probability(predictor));
        Interval { low: found.low.or(Some(0.0)), high: found.high.or(Some(1.0)) }
    }

    fn coefficients(&self) -> [f64; 2] {
        [self.fit.coefficients[0], self.fit.coefficients[1]]
    }

    /// By how much twice the log-likelihood falls, with the predictor `offset + x c` for the best c; `of` has x and offset for
    /// a logarithm of the measure.
    fn fall(&self, of: impl Fn(f64) -> (f64, f64)) -> f64 {
        let (x, offset): (Vec<f64>, Vec<f64>) = self.x.iter().map(|&x| of(x)).unzip();
        let rows = self.x.len();
        let (x, offset) = (DMatrix::from_vec(rows, 1, x), DVector::from_vec(offset));
        match maximize(&Design { observations: self.observations, x, offset }, self.fit.link) {
            Ok(maximum) => 2.0 * (self.fit.log_likelihood - maximum.log_likelihood),
            // So far out that no digit of the likelihood is left.
            Err(_) => f64::INFINITY,
        }
    }

    /// The interval of a feature with this estimate and this gradient with respect to the coefficients; `of` has x and offset
    /// of [`Profile::fall`] for a value of the feature and a logarithm of the measure.
    fn interval(&self, estimate: f64, gradient: [f64; 2], of: impl Fn(f64, f64) -> (f64, f64)) -> Interval {
        /// Farther than 2⁴⁰ standard deviations there is no bound.
        const DOUBLINGS: i32 = 40;
        let naive = variance(gradient, |i, j| self.fit.covariance[i][j]);
        let clustered = self.covariance.as_ref().map_or(f64::INFINITY, |of| variance(gradient, |i, j| of[(i, j)]));
        let (deviation, allowed) = (clustered.sqrt(), self.allowed * clustered / naive);
        if !(deviation > 0.0 && deviation.is_finite() && allowed.is_finite()) {
            return Interval { low: None, high: None };
        }
        let excess = |value: f64| self.fall(|x| of(value, x)) - allowed;
        let end = |sign: f64| {
            let mut near = (estimate, -allowed);
            for doubling in 0..DOUBLINGS {
                let value = estimate + sign * deviation * f64::from(2).powi(doubling);
                let far = (value, excess(value));
                if far.1 > 0.0 {
                    // The root is looked for from the estimate outwards.
                    let place = |t: f64| near.0 + t * (far.0 - near.0);
                    return Some(place(sign_change(0.0, 1.0, -near.1, -far.1.min(1e9), |t| {
                        -excess(place(t)).min(1e9)
                    })));
                }
                near = far;
            }
            None
        };
        Interval { low: end(-1.0), high: end(1.0) }
    }
}

/// The variance of a feature with this gradient, from a covariance.
fn variance(gradient: [f64; 2], covariance: impl Fn(usize, usize) -> f64) -> f64 {
    let [a, b] = gradient;
    a * a * covariance(0, 0) + 2.0 * a * b * covariance(0, 1) + b * b * covariance(1, 1)
}

impl Interval {
    fn map(self, of: impl Fn(f64) -> f64) -> Interval {
        Interval { low: self.low.map(&of), high: self.high.map(&of) }
    }
}
