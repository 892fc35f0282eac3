//! A fitted curve → intervals and bands of the profile likelihood.

use nalgebra::{DMatrix, DVector};

use crate::fragility::clusters::{self, Independence};
use crate::fragility::data::Data;
use crate::fragility::observation::{CurveFitError, Observation};
use crate::fragility::regression::{CurveFit, Predictor, maximize};

/// Lower and upper end of an interval; an end without a bound is `None`.
pub type Interval = [Option<f64>; 2];

/// The profile likelihood of a curve of one measure. One feature is fixed, and the other coefficient maximized.
///
/// The interval of a feature holds the values whose likelihood ratio statistic is at most the quantile of χ² with one degree of
/// freedom. It does not depend on the unit of a feature or on taking its logarithm, and need not be symmetric.
///
/// Rows of the same record are not independent. Where records repeat, the permitted statistic grows by the ratio of the feature's
/// variance with rows clustered by motion to that with independent rows (R. E. Chandler, S. Bate, Inference for clustered data
/// using the independence loglikelihood, Biometrika 94 (2007) 167–183), and the quantile is that of t². It never shrinks: see
/// [`is_too_alike`](LikelihoodProfile::is_too_alike).
pub struct LikelihoodProfile<'a> {
    /// The rows, those of one measure together.
    observations: Vec<Observation>,
    /// Logarithms of the measure.
    x: Vec<f64>,
    fit: &'a CurveFit,
    /// Covariance of the coefficients; `None` if one record alone determines them.
    covariance: Option<DMatrix<f64>>,
    /// Permitted likelihood ratio statistic for independent rows.
    allowed: f64,
}

impl<'a> LikelihoodProfile<'a> {
    /// Prepares the profile of a curve fitted to these data of one measure.
    ///
    /// `confidence` is above 0 and below 1; `records` has the record of each observation.
    ///
    /// # Errors
    /// Data of a surface.
    pub fn new(
        data: &'a Data,
        fit: &'a CurveFit,
        confidence: f64,
        records: &[usize],
    ) -> Result<LikelihoodProfile<'a>, CurveFitError> {
        let found = data.measures();
        if found != 1 {
            return Err(CurveFitError(format!("found {found} measures in row 0; expected 1 for a curve")));
        }
        let deviate = Independence::of(records).deviate(confidence);
        Ok(LikelihoodProfile::clustered(data, fit, deviate, clusters::covariance(data, fit, records)))
    }

    /// [`LikelihoodProfile::new`] with a known deviate of the confidence and covariance. The deviate is two-sided; the covariance is
    /// clustered by motion.
    pub(super) fn clustered(
        data: &'a Data,
        fit: &'a CurveFit,
        deviate: f64,
        covariance: Option<DMatrix<f64>>,
    ) -> LikelihoodProfile<'a> {
        let observations = together(data.observations());
        let x = observations.iter().map(|row| libm::log(row.measures[0])).collect();
        LikelihoodProfile { observations, x, fit, covariance, allowed: deviate * deviate }
    }

    /// Interval of the median, in the unit of the measure. Unbounded where the data admit a slope of zero.
    pub fn median(&self) -> Interval {
        let [a, b] = self.coefficients();
        let log_median = -a / b;
        let gradient = [-1.0 / b, a / (b * b)];
        self.interval(log_median, gradient, b, |log_median, x| (x - log_median, 0.0)).map(|end| end.map(libm::exp))
    }

    /// Interval of the dispersion β. It has no upper bound where the data admit a slope of zero.
    ///
    /// If both signs of β are admissible, only bounds of the fitted sign are reported.
    pub fn dispersion(&self) -> Interval {
        let [a, b] = self.coefficients();
        let [least, greatest] = self.interval(b, [0.0, 1.0], a, |b, x| (1.0, b * x));
        [greatest, least].map(|slope| slope.filter(|slope| slope * b > 0.0).map(|slope| 1.0 / slope))
    }

    /// Pointwise interval of the probability at a measure above zero.
    pub fn probability(&self, measure: f64) -> Interval {
        let ([a, b], x0) = (self.coefficients(), libm::log(measure));
        let found = self.interval(a + b * x0, [1.0, x0], b, |predictor, x| (x - x0, predictor));
        let [low, high] = found.map(|end| end.map(|predictor| self.fit.link.probability(predictor)));
        [low.or(Some(0.0)), high.or(Some(1.0))]
    }

    /// Whether the motions agree too well for a variance of the median clustered by motion.
    pub fn is_too_alike(&self) -> bool {
        let [a, b] = self.coefficients();
        let gradient = [-1.0 / b, a / (b * b)];
        let naive = variance(gradient, &self.fit.covariance);
        self.covariance.as_ref().is_some_and(|of| clusters::is_too_alike(variance(gradient, of), naive))
    }

    fn coefficients(&self) -> [f64; 2] {
        [self.fit.coefficients[0], self.fit.coefficients[1]]
    }

    /// The likelihood ratio statistic of the predictor `offset + x c` with the best c. The search begins at `near` and leaves the best c
    /// there.
    ///
    /// `of` maps the logarithm of the measure to x and offset.
    fn statistic(&self, near: &mut f64, of: impl Fn(f64) -> (f64, f64)) -> f64 {
        let (x, offset): (Vec<f64>, Vec<f64>) = self.x.iter().map(|&x| of(x)).unzip();
        let rows = self.x.len();
        let (x, offset) = (DMatrix::from_vec(rows, 1, x), DVector::from_vec(offset));
        let design = Predictor { observations: &self.observations, x, offset };
        match maximize(&design, self.fit.link, DVector::from_element(1, *near)) {
            Ok(maximum) => {
                *near = maximum.coefficients[0];
                2.0 * (self.fit.log_likelihood - maximum.log_likelihood)
            }
            // So far out that the likelihood underflows.
            Err(_) => f64::INFINITY,
        }
    }

    /// The interval of a feature from its estimate and its gradient. The gradient is with respect to the coefficients. `other` is the
    /// coefficient that is fitted again for each value of the feature.
    ///
    /// `of` gives x and offset of [`LikelihoodProfile::statistic`] for a value of the feature and a logarithm of the measure.
    fn interval(&self, estimate: f64, gradient: [f64; 2], other: f64, of: impl Fn(f64, f64) -> (f64, f64)) -> Interval {
        /// An end farther than 2⁴⁰ standard deviations counts as unbounded.
        const DOUBLINGS: i32 = 40;
        /// Part of the permitted deviation to which an end is found. The likelihood has little more digits.
        const ACCURACY: f64 = 1e-12;
        let naive = variance(gradient, &self.fit.covariance);
        let clustered = self.covariance.as_ref().map_or(f64::INFINITY, |of| variance(gradient, of));
        let wider = clustered.max(naive);
        let (deviation, allowed) = (wider.sqrt(), self.allowed * wider / naive);
        if !(deviation > 0.0 && deviation.is_finite() && allowed.is_finite()) {
            return [None; 2];
        }
        // The statistic is a difference of log-likelihoods, and this its root.
        let round_off = 4.0 * f64::EPSILON * self.fit.log_likelihood.abs() / allowed.sqrt();
        let accuracy = round_off.max(ACCURACY * allowed.sqrt());
        let end = |sign: f64| {
            let mut other = other;
            // The root of the statistic is almost linear.
            let mut rest = |value: f64| {
                let statistic = self.statistic(&mut other, |x| of(value, x));
                allowed.sqrt() - statistic.max(0.0).sqrt().min(1e5)
            };
            let mut near = (estimate, allowed.sqrt());
            for doubling in 0..DOUBLINGS {
                let value = estimate + sign * deviation * libm::ldexp(1.0, doubling);
                let far = (value, rest(value));
                if far.1 < 0.0 {
                    return Some(secant(near, far, accuracy, rest));
                }
                near = far;
            }
            None
        };
        [-1.0, 1.0].map(end)
    }
}

/// Puts the rows of each measure together: the log-likelihood is linear in their fractions.
fn together(rows: &[Observation]) -> Vec<Observation> {
    let mut sorted = rows.to_vec();
    sorted.sort_by(|one, other| one.measures[0].total_cmp(&other.measures[0]));
    for row in &mut sorted {
        row.fraction *= row.weight;
    }
    sorted.dedup_by(|next, sum| {
        let is_same = next.measures == sum.measures;
        if is_same {
            sum.fraction += next.fraction;
            sum.weight += next.weight;
        }
        is_same
    });
    for sum in &mut sorted {
        sum.fraction = (sum.fraction / sum.weight).min(1.0);
    }
    sorted
}

/// A root between two points `(x, f(x))` with opposite signs. The value there is at most `accuracy`.
///
/// The Illinois method: the secant through both points; a point that stays twice counts half (M. Dowell, P. Jarratt, A modified
/// regula falsi method, BIT 11 (1971) 168–174).
fn secant(
    (mut a, mut at_a): (f64, f64),
    (mut b, mut at_b): (f64, f64),
    accuracy: f64,
    mut f: impl FnMut(f64) -> f64,
) -> f64 {
    const MAX_SECANTS: usize = 200;
    for _ in 0..MAX_SECANTS {
        let next = b - at_b * (b - a) / (at_b - at_a);
        let at_next = f(next);
        if at_next * at_b < 0.0 {
            (a, at_a) = (b, at_b);
        } else {
            at_a *= 0.5;
        }
        (b, at_b) = (next, at_next);
        if at_b.abs() <= accuracy {
            break;
        }
    }
    b
}

/// The variance of a feature with this gradient.
fn variance([a, b]: [f64; 2], covariance: &DMatrix<f64>) -> f64 {
    a * a * covariance[(0, 0)] + 2.0 * a * b * covariance[(0, 1)] + b * b * covariance[(1, 1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragility::likelihood::Link;

    /// Rows at levels have the intervals of rows at measures that differ by round-off. The latter are not put together.
    #[test]
    fn rows_of_one_measure_count_as_each_of_them() {
        let row = |i: u64| {
            let level = 0.2 * (1 + i % 6) as f64;
            (level, (i * i + 3 * i) % 7 < 2 + i % 6)
        };
        let of = |apart: f64| {
            let rows = (0..60).map(|i| Observation::of(&[row(i).0 * (1.0 + apart * i as f64)], row(i).1)).collect();
            let data = Data::new(rows).unwrap();
            let fit = data.fit(Link::Probit).unwrap();
            let profile = LikelihoodProfile::new(&data, &fit, 0.95, &[]).unwrap();
            let ends = [profile.median(), profile.dispersion(), profile.probability(0.5)];
            (ends.map(|interval| interval.map(Option::unwrap)), profile.observations.len())
        };
        let ((together, six), (apart, sixty)) = (of(0.0), of(1e-13));
        assert_eq!((six, sixty), (6, 60));
        for (one, other) in together.as_flattened().iter().zip(apart.as_flattened()) {
            assert!((one / other - 1.0).abs() < 1e-9, "{one} {other}");
        }
    }

    /// Records with equal counts at each level have a clustered variance of zero. The intervals are those of independent rows with the
    /// deviate of t, and say so.
    #[test]
    fn records_that_agree_give_no_interval_of_zero_width() {
        for records in [2, 5, 12] {
            // Of each record, 0, 1, 2 and 3 of 3 rows at four levels exceed the limit.
            let rows =
                (0..records).flat_map(|_| (0..12).map(|i| Observation::of(&[f64::from(1 + i / 3)], i % 3 < i / 3)));
            let of: Vec<usize> = (0..12 * records).map(|row| row / 12).collect();
            let data = Data::new(rows.collect()).unwrap();
            let fit = data.fit(Link::Probit).unwrap();
            let profile = LikelihoodProfile::new(&data, &fit, 0.95, &of).unwrap();
            let deviate = Independence::of(&of).deviate(0.95);
            let free = LikelihoodProfile::clustered(&data, &fit, deviate, Some(fit.covariance.clone()));
            assert!(profile.is_too_alike() && !free.is_too_alike());
            for (found, expected) in [
                (profile.median(), free.median()),
                (profile.dispersion(), free.dispersion()),
                (profile.probability(2.0), free.probability(2.0)),
            ] {
                assert_eq!(found, expected, "{records}");
                let [low, high] = [found[0].unwrap_or(f64::NEG_INFINITY), found[1].unwrap_or(f64::INFINITY)];
                assert!(low < high, "{records}: {found:?}");
            }
        }
    }

    /// Without the halving, regula falsi takes hundreds of evaluations.
    #[test]
    fn a_curved_root_is_found_in_a_few_evaluations() {
        let mut calls = 0;
        let root = secant((0.0, -0.1), (2.0, 1023.9), 1e-12, |x| {
            calls += 1;
            x.powi(10) - 0.1
        });
        assert!((root - 0.1_f64.powf(0.1)).abs() < 1e-12 && calls < 60, "{root} after {calls} evaluations");
    }
}
