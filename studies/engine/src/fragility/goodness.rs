//! Observations and a curve → groups of rows, and the deviance of the curve.

use std::collections::BTreeMap;

use crate::fragility::clusters::Independence;
use crate::fragility::observation::Observation;
use crate::statistics::chi_squared;

/// Maximum number of groups.
const MAX_GROUPS: usize = 12;
/// Minimum number of rows per group, for a meaningful fraction.
const MIN_ROWS: usize = 5;

/// Rows with adjacent measures.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Mean of their measures.
    pub measure: f64,
    /// Mean of their fractions.
    pub fraction: f64,
    /// Number of rows.
    pub rows: usize,
    /// Mean of their fitted probabilities.
    expected: f64,
    /// Number of runs, or of rows with fractions.
    runs: f64,
    /// Variance of their sum over that of independent rows; `None` for one record.
    inflation: Option<f64>,
}

/// A test whether a curve fits the fractions of groups of rows: deviance against χ².
///
/// The deviance is twice the sum of k ln(k/(n P)) + (n − k) ln((n − k)/(n (1 − P))) over groups with k exceedances in n rows. Rows of the same
/// record are not independent: where records repeat, it is divided by the mean inflation of the variances of the groups, the first-order
/// correction of J. N. K. Rao and A. J. Scott, On chi-squared tests for multiway contingency tables, Ann. Statist. 12 (1984) 46–60.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Goodness {
    /// Deviance (1), corrected for records that repeat.
    pub deviance: f64,
    /// Number of groups less the two coefficients.
    pub degrees_of_freedom: usize,
    /// Probability of at least this deviance if the curve is true.
    pub p: f64,
}

impl Goodness {
    /// Tests a curve against groups; `None` for fewer than three.
    pub fn of(groups: &[Group]) -> Option<Goodness> {
        let degrees_of_freedom = groups.len().checked_sub(2).filter(|&freedom| freedom > 0)?;
        let term = |found: f64, expected: f64| if found > 0.0 { found * libm::log(found / expected) } else { 0.0 };
        let deviance = |group: &Group| {
            let terms = term(group.fraction, group.expected) + term(1.0 - group.fraction, 1.0 - group.expected);
            2.0 * group.runs * terms
        };
        let inflations: Vec<f64> = groups.iter().filter_map(|group| group.inflation).collect();
        let inflation = inflations.iter().sum::<f64>() / (inflations.len() as f64).max(1.0);
        let deviance = groups.iter().map(deviance).sum::<f64>() / inflation.max(1.0);
        Some(Goodness { deviance, degrees_of_freedom, p: chi_squared::p_value(deviance, degrees_of_freedom) })
    }
}

/// Sorts rows by measure into groups of similar size. Rows with the same measure share a group.
///
/// `probabilities` and `records` have the fitted probability and the record of each row.
pub(super) fn groups(observations: &[Observation], probabilities: &[f64], records: &[usize]) -> Vec<Group> {
    let measure = |row: usize| observations[row].measures[0];
    let mut rows: Vec<usize> = (0..observations.len()).collect();
    rows.sort_by(|&a, &b| measure(a).total_cmp(&measure(b)));
    let mut groups = Grouping::new(rows.len(), matches!(Independence::of(records), Independence::Motions(_)));
    for row in rows {
        let Observation { fraction, weight, .. } = observations[row];
        let fitted = Fitted { measure: measure(row), fraction, probability: probabilities[row] };
        groups.take(fitted, weight, 1, Some(records[row]));
    }
    groups.finish()
}

/// A row with its fitted probability.
#[derive(Clone, Copy)]
pub(super) struct Fitted {
    pub measure: f64,
    pub fraction: f64,
    pub probability: f64,
}

/// Groups in the making, from rows in the order of their measures.
pub(super) struct Grouping {
    /// Rows of a group, at least.
    size: usize,
    is_clustered: bool,
    groups: Vec<Group>,
    last: f64,
    rows: usize,
    /// Weighted sums over the rows of a group. They are of the weight alone, the measure, the fraction, the probability and the variance.
    sums: [f64; 5],
    /// Sums of the residuals and of the weights of each record.
    records: BTreeMap<usize, [f64; 2]>,
    /// Number, residuals and squared residuals of rows with a motion of their own.
    alone: [f64; 3],
}

impl Grouping {
    /// Begins the groups of this number of rows.
    pub fn new(rows: usize, is_clustered: bool) -> Grouping {
        let size = rows.div_ceil((rows / MIN_ROWS).clamp(1, MAX_GROUPS));
        let (groups, records) = (Vec::new(), BTreeMap::new());
        Grouping { size, is_clustered, groups, last: 0.0, rows: 0, sums: [0.0; 5], records, alone: [0.0; 3] }
    }

    /// Takes equal rows with at least the last measure. They have a weight, and a record shared with other rows.
    pub fn take(&mut self, row: Fitted, weight: f64, count: usize, record: Option<usize>) {
        let Fitted { measure, fraction, probability } = row;
        // A scaled record meets its level to round-off.
        if self.rows >= self.size && measure - self.last > 1e-9 * measure {
            self.end_group();
        }
        (self.last, self.rows) = (measure, self.rows + count);
        let terms = [1.0, measure, fraction, probability, probability * (1.0 - probability)];
        self.sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * term);
        if !self.is_clustered {
            return;
        }
        let residual = fraction - probability;
        match record {
            Some(record) => {
                let [sum, weights] = self.records.entry(record).or_default();
                (*sum, *weights) = (*sum + weight * residual, *weights + weight);
            }
            None => {
                let terms = [1.0, residual, residual * residual];
                self.alone.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * term);
            }
        }
    }

    fn end_group(&mut self) {
        let [runs, measure, fraction, expected, independent] = std::mem::take(&mut self.sums);
        let [measure, fraction, expected] = [measure, fraction, expected].map(|sum| sum / runs);
        let excess = fraction - expected;
        let [alone, residuals, squares] = std::mem::take(&mut self.alone);
        let records = std::mem::take(&mut self.records);
        let count = records.len() as f64 + alone;
        let square = |[sum, weights]: &[f64; 2]| {
            let residual = sum - excess * weights;
            residual * residual
        };
        let of_records = records.values().map(square).sum::<f64>();
        let of_alone = squares - 2.0 * excess * residuals + excess * excess * alone;
        let clustered = (of_records + of_alone) * count / (count - 1.0);
        let inflation = (self.is_clustered && count > 1.0).then_some(clustered / independent);
        let rows = std::mem::take(&mut self.rows);
        self.groups.push(Group { measure, fraction, rows, expected, runs, inflation });
    }

    /// Returns the groups.
    pub fn finish(mut self) -> Vec<Group> {
        self.end_group();
        self.groups
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragility::{Data, Link};

    /// Each level with its count of exceedances of 40 rows, each row by its record.
    fn goodness(counts: &[usize], record: impl Fn(usize) -> usize) -> Goodness {
        let rows =
            counts.iter().enumerate().flat_map(|(level, &count)| (0..40).map(move |row| (level, row, row < count)));
        let (observations, records): (Vec<Observation>, Vec<usize>) = rows
            .map(|(level, row, exceeded)| {
                (Observation::of(&[0.2 * 1.3_f64.powi(level as i32)], exceeded), record(40 * level + row))
            })
            .unzip();
        let data = Data::new(observations).unwrap();
        let fit = data.fit(Link::Probit).unwrap();
        let groups = groups(data.observations(), &fit.probabilities(data.observations()), &records);
        assert_eq!(groups.len(), counts.len());
        Goodness::of(&groups).unwrap()
    }

    /// Twice the difference of the log-likelihoods of the fractions themselves and of the curve.
    #[test]
    fn the_deviance_is_that_of_the_saturated_model() {
        let counts = [3, 5, 20, 18, 36, 35];
        let found = goodness(&counts, |row| row);
        let observations = |(level, &count): (usize, &usize)| {
            Observation::counted(&[0.2 * 1.3_f64.powi(level as i32)], count as u64, 40)
        };
        let data = Data::new(counts.iter().enumerate().map(observations).collect()).unwrap();
        let saturated: f64 =
            counts.iter().map(|&k| k as f64 / 40.0).map(|f| 40.0 * (f * f.ln() + (1.0 - f) * (1.0 - f).ln())).sum();
        let exact = 2.0 * (saturated - data.fit(Link::Probit).unwrap().log_likelihood);
        assert!((found.deviance / exact - 1.0).abs() < 1e-9, "{found:?} {exact}");
        assert_eq!(found.degrees_of_freedom, 4);
    }

    /// Fractions on a lognormal curve fit; a step among them does not. Copies of rows by record add no evidence.
    #[test]
    fn a_step_in_the_fractions_does_not_fit() {
        let (smooth, step) = ([1, 4, 11, 20, 29, 36], [9, 8, 9, 31, 32, 31]);
        assert!(goodness(&smooth, |row| row).p > 0.9);
        let alone = goodness(&step, |row| row);
        assert!(alone.p < 0.01, "{alone:?}");
        // Ten copies of each row, of one record: a tenth of the deviance.
        let copies = goodness(&[10, 10, 10, 30, 30, 30], |row| row / 10);
        let rows = goodness(&[10, 10, 10, 30, 30, 30], |row| row);
        assert!(copies.deviance < 0.12 * rows.deviance, "{copies:?} {rows:?}");
    }
}
