//! Observations and a curve → quality of the measure: AUC, Brier score, efficiency, sufficiency.

use nalgebra::DMatrix;

use crate::fragility::clusters::{self, Independence};
use crate::fragility::data::Data;
use crate::fragility::likelihood::Link;
use crate::fragility::line::Line;
use crate::fragility::observation::{CurveFitError, Observation};
use crate::fragility::regression::CurveFit;

/// The area under the receiver operating characteristic (1); ½ is chance.
///
/// The probability that a row that exceeds the limit has a greater score than one that does not, ties counting half. A row with a
/// fraction of exceedances counts in both classes, weighted by the fraction and its complement. `scores` has a finite number for
/// each observation that increases with the probability; scores that differ by round-off alone are ties.
pub fn auc(observations: &[Observation], scores: &[f64]) -> f64 {
    let mut rows: Vec<(f64, [f64; 2])> = observations
        .iter()
        .zip(scores)
        .map(|(row, &score)| (score, [row.weight * (1.0 - row.fraction), row.weight * row.fraction]))
        .collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut area = AreaUnderCurve::default();
    rows.iter().for_each(|(score, weights)| area.take(*score, *weights));
    area.finish()
}

/// The area under the receiver operating characteristic, from rows in the order of their scores.
#[derive(Default)]
pub(super) struct AreaUnderCurve {
    score: f64,
    /// Weights of the rows with this score, those that do not exceed the limit first.
    tied: [f64; 2],
    /// Weight below this score of rows that do not exceed the limit.
    below: f64,
    /// Weight of rows that do.
    exceeded: f64,
    ordered: f64,
}

impl AreaUnderCurve {
    /// Takes a row with at least the last score, with its weights in both classes.
    pub fn take(&mut self, score: f64, weights: [f64; 2]) {
        // Equal scores may differ by round-off.
        if (score - self.score).abs() > 1e-12 * score.abs().max(self.score.abs()) {
            self.end_tie();
        }
        self.score = score;
        self.tied = [self.tied[0] + weights[0], self.tied[1] + weights[1]];
    }

    fn end_tie(&mut self) {
        let [others, exceeded] = std::mem::take(&mut self.tied);
        self.ordered += exceeded * (self.below + 0.5 * others);
        self.below += others;
        self.exceeded += exceeded;
    }

    /// Returns the area.
    pub fn finish(mut self) -> f64 {
        self.end_tie();
        self.ordered / (self.below * self.exceeded)
    }
}

/// The Brier score (1): the mean square of probability minus outcome or fraction of exceedances.
///
/// G. W. Brier, Verification of forecasts expressed in terms of probability, Mon. Weather Rev. 78 (1950) 1–3, halved.
pub fn brier(observations: &[Observation], probabilities: &[f64]) -> f64 {
    let weight: f64 = observations.iter().map(|row| row.weight).sum();
    let error = |(row, probability): (&Observation, &f64)| {
        let error = probability - row.fraction;
        row.weight * (error * error)
    };
    observations.iter().zip(probabilities).map(error).sum::<f64>() / weight
}

/// The efficiency of a measure (1): the scatter of log peaks about their regression. The regression is on the log measure; the scatter is a
/// standard deviation.
///
/// Smaller is better (N. Luco, C. A. Cornell, Structure-specific scalar intensity measures for near-source and ordinary earthquake
/// ground motions, Earthquake Spectra 23 (2007) 357–392). Peaks are |θ|/α > 0 of the blocks that rock and stand. `None` for fewer
/// than three pairs, or a constant measure.
pub fn efficiency(measures: &[f64], peaks: &[f64]) -> Option<f64> {
    let [x, y] = [measures, peaks].map(|values| values.iter().map(|&value| libm::log(value)).collect::<Vec<f64>>());
    Line::of(&x, &y, &(0..x.len()).collect::<Vec<_>>()).map(|line| line.deviation)
}

/// The scatter of log peaks about their regression on the log measure. The rows are in any order.
#[derive(Clone, Copy, Default)]
pub(super) struct Scatter {
    /// Number of rows.
    pub rows: usize,
    means: [f64; 2],
    /// Sums of products of the deviations from the means. They are those of the measure, of both, and of the peak.
    products: [f64; 3],
}

impl Scatter {
    /// Takes a measure and a peak.
    pub fn take(&mut self, measure: f64, peak: f64) {
        self.rows += 1;
        let [dx, dy] = [libm::log(measure) - self.means[0], libm::log(peak) - self.means[1]];
        self.means = [self.means[0] + dx / self.rows as f64, self.means[1] + dy / self.rows as f64];
        let after = 1.0 - 1.0 / self.rows as f64;
        let terms = [dx * dx, dx * dy, dy * dy];
        self.products.iter_mut().zip(terms).for_each(|(sum, term)| *sum += after * term);
    }

    /// The [`efficiency`].
    pub fn efficiency(&self) -> Option<f64> {
        let [xx, xy, yy] = self.products;
        (self.rows > 2 && xx > 0.0).then(|| ((yy - xy * xy / xx) / (self.rows as f64 - 2.0)).max(0.0).sqrt())
    }
}

/// The sufficiency of a measure: the p-value of another one as second measure.
///
/// The likelihood ratio test, χ² with one degree of freedom; a small value, below 0.05 say, rejects that the first measure is
/// sufficient. `others` has the other measure of each observation, above zero, and `records` its record. Where records repeat,
/// the statistic is divided by the ratio of the variances of the added coefficient, as in [`LikelihoodProfile`](super::LikelihoodProfile).
///
/// # Errors
/// Those of [`Data::new`] and [`Data::fit`] for the surface of both measures, which may separate classes that overlap in one.
pub fn sufficiency(data: &Data, others: &[f64], link: Link, records: &[usize]) -> Result<f64, CurveFitError> {
    let both = data
        .observations()
        .iter()
        .zip(others)
        .map(|(row, &other)| Observation { measures: [row.measures[0], other].into(), ..row.clone() });
    let curve = data.fit(link)?;
    let both = Data::new(both.collect())?;
    let surface = both.fit(link)?;
    let covariance = clusters::covariance(&both, &surface, records);
    Ok(p_value(&curve, &surface, covariance.as_ref(), Independence::of(records)))
}

/// The p-value of a surface's second measure beside the curve of the first one.
pub(super) fn p_value(
    curve: &CurveFit,
    surface: &CurveFit,
    covariance: Option<&DMatrix<f64>>,
    independence: Independence,
) -> f64 {
    let gain = 2.0 * (surface.log_likelihood - curve.log_likelihood).max(0.0);
    // The added coefficient is the last one. As for intervals, records that agree carry no more information than independent rows.
    let naive = surface.covariance[(2, 2)];
    let clustered = covariance.map_or(f64::INFINITY, |found| found[(2, 2)].max(naive));
    independence.p_value((gain * naive / clustered).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the 3·2 pairs (exceeded, not), five are in order and one is a tie.
    #[test]
    fn auc_is_the_fraction_of_pairs_in_order() {
        let rows = [(1.0, false), (2.0, true), (2.0, false), (3.0, true), (4.0, true)];
        let observations: Vec<Observation> = rows.iter().map(|&(x, y)| Observation::of(&[x], y)).collect();
        let scores = rows.map(|(x, _)| x);
        assert!((auc(&observations, &scores) - 5.5 / 6.0).abs() < 1e-15);
        assert!((auc(&observations, &scores.map(|x| -x)) - 0.5 / 6.0).abs() < 1e-15);
        assert!((auc(&observations, &[7.0; 5]) - 0.5).abs() < 1e-15);
        // A fraction equals its single rows.
        let parts = [Observation::counted(&[1.0], 1, 3), Observation::counted(&[2.0], 2, 3)];
        let single = [(1.0, true), (1.0, false), (1.0, false), (2.0, true), (2.0, true), (2.0, false)];
        let single: Vec<Observation> = single.iter().map(|&(x, y)| Observation::of(&[x], y)).collect();
        let of_single: Vec<f64> = single.iter().map(|row| row.measures[0]).collect();
        assert!((auc(&parts, &[1.0, 2.0]) - auc(&single, &of_single)).abs() < 1e-15);
    }

    #[test]
    fn brier_is_the_mean_square() {
        let rows = [Observation::of(&[1.0], false), Observation::of(&[2.0], true), Observation::counted(&[3.0], 1, 2)];
        let exact = (0.04 + 0.25 + 2.0 * 0.09) / 4.0;
        assert!((brier(&rows, &[0.2, 0.5, 0.8]) - exact).abs() < 1e-15);
    }

    /// A power law with errors of 0.1 in the logarithm. They alternate so that the regression line stays.
    #[test]
    fn efficiency_is_the_scatter_about_a_power_law() {
        let x: Vec<f64> = (0..400).map(|i| (0.01 * f64::from(i)).exp()).collect();
        let signs = [1.0_f64, -1.0, -1.0, 1.0];
        let y: Vec<f64> = x.iter().enumerate().map(|(i, x)| 3.0 * x.powf(1.7) * (0.1 * signs[i % 4]).exp()).collect();
        let exact = 0.1 * (400.0_f64 / 398.0).sqrt();
        assert!((efficiency(&x, &y).unwrap() / exact - 1.0).abs() < 1e-6, "{:?}", efficiency(&x, &y));
        assert_eq!(efficiency(&[1.0, 2.0], &[1.0, 2.0]), None);
        assert_eq!(efficiency(&[1.0; 5], &[1.0; 5]), None);
    }
}
