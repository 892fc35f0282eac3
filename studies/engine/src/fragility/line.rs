//! Points that share ground motions → their least-squares line, with errors clustered by motion.

use nalgebra::{DMatrix, DVector};

use crate::fragility::clusters::{self, Independence};
use crate::fragility::profile::Interval;
use crate::statistics::student;

/// The least-squares line y = a + b x through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// a and b.
    pub coefficients: [f64; 2],
    /// Standard deviation of the points about the line, with two degrees of freedom less than there are points.
    pub deviation: f64,
    /// y − a − b x of each point.
    pub residuals: Vec<f64>,
    /// The independent units of the errors.
    pub independence: Independence,
    /// Standard errors of a and b; infinite if one motion alone determines one of them.
    pub standard_errors: [f64; 2],
    /// Whether the points lie on the line to round-off: their scatter, and with it any interval, is unknown.
    is_exact: bool,
}

impl Line {
    /// Fits a line. `motions` has the ground motion of each point; only points of different motions have independent errors.
    ///
    /// Where motions repeat, the errors are those of a jackknife that leaves out one motion at a time (CV3, as for
    /// [curves](crate::fragility::Assessment)), otherwise those of independent points of equal variance. The latter also hold where the
    /// motions agree too well. `None` for fewer than three points, or a constant x.
    pub fn of(x: &[f64], y: &[f64], motions: &[usize]) -> Option<Line> {
        let count = x.len() as f64;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
        let (mean_x, mean_y) = (mean(x), mean(y));
        let product = |a: &[f64], mean_a: f64, b: &[f64], mean_b: f64| -> f64 {
            a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum()
        };
        let (xx, xy) = (product(x, mean_x, x, mean_x), product(x, mean_x, y, mean_y));
        // Round-off keeps the sum of a constant above zero.
        if x.len() < 3 || x.iter().all(|value| *value == x[0]) {
            return None;
        }
        let slope = xy / xx;
        let residuals: Vec<f64> = x.iter().zip(y).map(|(x, y)| y - mean_y - slope * (x - mean_x)).collect();
        let deviation = (residuals.iter().map(|residual| residual * residual).sum::<f64>() / (count - 2.0)).sqrt();
        let independence = Independence::of(motions);
        // About the mean of x, the level of the line and its slope have independent errors if all points have.
        let variance = deviation * deviation;
        let independent = DMatrix::from_row_slice(2, 2, &[variance / count, 0.0, 0.0, variance / xx]);
        let centred = match independence {
            Independence::Motions(motions_in_all) => jackknife(x, mean_x, &residuals, motions, motions_in_all)
                .map(|of| if is_too_alike(&of, &independent) { independent } else { of }),
            Independence::Rows | Independence::OneMotion => Some(independent),
        };
        let standard_errors = centred.map_or([f64::INFINITY; 2], |of| {
            let of_intercept = of[(0, 0)] - 2.0 * mean_x * of[(0, 1)] + mean_x * mean_x * of[(1, 1)];
            [of_intercept, of[(1, 1)]].map(f64::sqrt)
        });
        let coefficients = [mean_y - slope * mean_x, slope];
        let greatest = y.iter().fold(0.0, |greatest: f64, y| greatest.max(y.abs()));
        let is_exact = deviation <= ROUND_OFF * greatest;
        Some(Line { coefficients, deviation, residuals, independence, standard_errors, is_exact })
    }

    /// Degrees of freedom of Student's t: one less than the number of motions, or two less than that of independent points.
    fn freedom(&self) -> f64 {
        match self.independence {
            Independence::Motions(count) => count as f64 - 1.0,
            Independence::Rows | Independence::OneMotion => self.residuals.len() as f64 - 2.0,
        }
    }

    /// Intervals of a and b at a confidence above 0 and below 1. An end without a bound is `None`, and both are where the points lie on the
    /// line: an interval without width would claim certainty.
    pub fn intervals(&self, confidence: f64) -> [Interval; 2] {
        if self.is_exact {
            return [[None; 2]; 2];
        }
        let deviate = student::quantile(1.0 - confidence, self.freedom());
        let ends = |(coefficient, error): (f64, f64)| {
            [-1.0, 1.0].map(|side| Some(coefficient + side * deviate * error).filter(|end| end.is_finite()))
        };
        let [a, b] = [0, 1].map(|i| ends((self.coefficients[i], self.standard_errors[i])));
        [a, b]
    }

    /// Probability of at least this slope, to either side, if x has no effect.
    pub fn p(&self) -> f64 {
        let [_, slope] = self.coefficients;
        let [_, error] = self.standard_errors;
        if error > 0.0 { student::p_value(slope.abs() / error, self.freedom()) } else { 0.0 }
    }
}

/// Scatter over the greatest value below which points lie on their line.
const ROUND_OFF: f64 = 1e-12;

/// Whether the variance of the slope or of the level, clustered by motion, is far below that of independent points.
fn is_too_alike(clustered: &DMatrix<f64>, independent: &DMatrix<f64>) -> bool {
    (0..2).any(|i| clusters::is_too_alike(clustered[(i, i)], independent[(i, i)]))
}

/// Fraction of the determinant of independent columns below which x does not vary, to round-off.
const SINGULAR: f64 = 1e-10;

/// Covariance of the level at the mean of x and of the slope, by leaving out one motion at a time. A line is linear in its coefficients, so
/// that one Newton step refits it.
fn jackknife(x: &[f64], mean: f64, residuals: &[f64], motions: &[usize], count: usize) -> Option<DMatrix<f64>> {
    let last = motions.iter().max().map_or(0, |last| last + 1);
    let mut sums = vec![(DVector::zeros(2), DMatrix::zeros(2, 2)); last];
    for ((x, residual), &motion) in x.iter().zip(residuals).zip(motions) {
        let off = x - mean;
        let (score, information) = &mut sums[motion];
        *score += DVector::from_column_slice(&[*residual, off * residual]);
        *information += DMatrix::from_row_slice(2, 2, &[1.0, off, off, off * off]);
    }
    let whole: DMatrix<f64> = sums.iter().map(|(_, information)| information).sum();
    let present = sums.iter().filter(|(_, information)| information[(0, 0)] > 0.0);
    let shift = |(score, information): &(DVector<f64>, DMatrix<f64>)| {
        // Motions that share one x leave no slope, to round-off.
        let rest = &whole - information;
        let spread = rest[(0, 0)] * rest[(1, 1)];
        let has_slope = spread - rest[(0, 1)] * rest[(0, 1)] > SINGULAR * spread;
        has_slope.then(|| clusters::step(&whole, score, information)).flatten()
    };
    clusters::of_shifts(present.map(shift), 2, count)
}

#[cfg(test)]
mod tests {
    use chacha20::rand_core::Rng;

    use super::*;
    use crate::statistics::{normal, sampling};

    /// The closed form of independent points, and the whole fit of each jackknife sample.
    #[test]
    fn errors_are_those_of_the_points_or_of_their_motions() {
        let x: Vec<f64> = (0..12).map(|i| f64::from(i * i % 7) + 0.1 * f64::from(i)).collect();
        let y: Vec<f64> = x.iter().enumerate().map(|(i, x)| 2.0 - 0.7 * x + f64::from((i * 5 % 9) as u8)).collect();
        let alone: Vec<usize> = (0..12).collect();
        let line = Line::of(&x, &y, &alone).unwrap();
        let mean = x.iter().sum::<f64>() / 12.0;
        let xx: f64 = x.iter().map(|x| (x - mean) * (x - mean)).sum();
        let exact = [line.deviation * (1.0 / 12.0 + mean * mean / xx).sqrt(), line.deviation / xx.sqrt()];
        assert!(line.standard_errors.iter().zip(exact).all(|(found, exact)| (found / exact - 1.0).abs() < 1e-12));
        let motions: Vec<usize> = (0..12).map(|i| i / 3).collect();
        let clustered = Line::of(&x, &y, &motions).unwrap();
        let mut variances = [0.0; 2];
        for motion in 0..4 {
            let kept = |values: &[f64]| -> Vec<f64> {
                values.iter().zip(&motions).filter(|(_, of)| **of != motion).map(|(value, _)| *value).collect()
            };
            let others = Line::of(&kept(&x), &kept(&y), &alone[..9]).unwrap();
            for (i, variance) in variances.iter_mut().enumerate() {
                *variance += 0.75 * (others.coefficients[i] - line.coefficients[i]).powi(2);
            }
        }
        for (found, exact) in clustered.standard_errors.iter().zip(variances) {
            assert!((found / exact.sqrt() - 1.0).abs() < 1e-12, "{found} beside {}", exact.sqrt());
        }
        assert_eq!((clustered.coefficients, clustered.independence), (line.coefficients, Independence::Motions(4)));
        assert_eq!((Line::of(&x[..2], &y[..2], &alone[..2]), Line::of(&[1.0; 5], &y[..5], &alone[..5])), (None, None));
        // One motion has all that varies.
        let lonely = Line::of(&[0.0, 1.0, 2.0, 0.5, 0.5], &[0.0, 1.0, 1.0, 2.0, 3.0], &[0, 0, 0, 1, 2]).unwrap();
        assert_eq!((lonely.standard_errors[1], lonely.intervals(0.95)[1], lonely.p()), (f64::INFINITY, [None; 2], 1.0));
        // Each of two motions has one x, as a property of records has.
        let x = [0.313, 0.313, 0.313, 0.787, 0.787].map(|x: f64| x * 1.1);
        let property = Line::of(&x, &[0.0, 1.0, 1.0, 2.0, 3.0], &[0, 0, 0, 1, 1]).unwrap();
        assert_eq!((property.standard_errors, property.p()), ([f64::INFINITY; 2], 1.0));
    }

    /// Motions with the same residuals at the same x have a clustered variance of zero, and points on a line no variance at all: neither is
    /// an interval without width.
    #[test]
    fn points_that_agree_give_no_interval_of_zero_width() {
        let x = [0.0, 1.0, 2.0, 0.0, 1.0, 2.0, 0.0, 1.0, 2.0];
        let motions = [0, 0, 0, 1, 1, 1, 2, 2, 2];
        let y = x.map(|x| x + if x == 1.0 { 0.3 } else { 0.0 });
        let (line, rows) =
            (Line::of(&x, &y, &motions).unwrap(), Line::of(&x, &y, &[0, 1, 2, 3, 4, 5, 6, 7, 8]).unwrap());
        assert_eq!(line.standard_errors, rows.standard_errors);
        assert!(line.intervals(0.95).iter().all(|interval| interval[0] < interval[1]), "{line:?}");
        let exact = x.map(|x| 0.1 + 0.7 * x);
        for motions in [motions, [0, 1, 2, 3, 4, 5, 6, 7, 8]] {
            assert_eq!(Line::of(&x, &exact, &motions).unwrap().intervals(0.95), [[None; 2]; 2]);
        }
    }

    /// Coverage of the 95 % interval of a slope, and rejections of a property without effect at 5 %, in trials with rows that share the
    /// motion's strength, property and error. Errors of independent rows cover a third and reject in two thirds.
    #[test]
    fn intervals_cover_and_tests_reject_as_they_say() {
        const TRIALS: u32 = 600;
        const ROWS: usize = 20;
        for (motions, seed) in [(10, 1), (20, 2), (40, 3)] {
            let mut random = sampling::stream(seed, 0);
            let mut normal = || normal::quantile(((random.next_u64() >> 12) as f64 + 0.5) * 2.0_f64.powi(-52));
            let [mut covers, mut rejects, mut naive_covers, mut naive_rejects] = [0; 4];
            for _ in 0..TRIALS {
                let (mut x, mut y, mut property, mut of) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
                for motion in 0..motions {
                    let [strength, magnitude, error] = [0.6 * normal(), normal(), 0.4 * normal()];
                    for _ in 0..ROWS {
                        x.push(strength);
                        y.push(1.1 * strength + error + 0.2 * normal());
                        property.push(magnitude);
                        of.push(motion);
                    }
                }
                let alone: Vec<usize> = (0..x.len()).collect();
                let count = |motions: &[usize], covers: &mut u32, rejects: &mut u32| {
                    let line = Line::of(&x, &y, motions).unwrap();
                    let [low, high] = line.intervals(0.95)[1].map(Option::unwrap);
                    *covers += u32::from((low..=high).contains(&1.1));
                    *rejects += u32::from(Line::of(&property, &line.residuals, motions).unwrap().p() < 0.05);
                };
                count(&of, &mut covers, &mut rejects);
                count(&alone, &mut naive_covers, &mut naive_rejects);
            }
            let [covers, rejects, naive_covers, naive_rejects] =
                [covers, rejects, naive_covers, naive_rejects].map(|count| f64::from(count) / f64::from(TRIALS));
            // Three standard deviations of 600 trials are 2.7 %.
            let found =
                format!("{motions} motions: covers {covers}, rejects {rejects}, naive {naive_covers}, {naive_rejects}");
            assert!((0.92..0.98).contains(&covers) && (0.02..0.08).contains(&rejects), "{found}");
            assert!(naive_covers < 0.5 && naive_rejects > 0.5, "{found}");
        }
    }
}
