//! Rows that share ground motions → covariance of the coefficients, clustered by motion.

use nalgebra::{DMatrix, DVector};

use crate::fragility::data::Data;
use crate::fragility::regression::{CurveFit, Predictor};
use crate::statistics::{normal, student};

/// The independent units of intervals and tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Independence {
    /// Rows: no motion occurs twice.
    Rows,
    /// This number of motions, each with its rows as a cluster.
    Motions(usize),
    /// Rows of the only motion: intervals hold for this motion alone.
    OneMotion,
}

impl Independence {
    /// Determines the independent units from the motion of each row.
    pub fn of(records: &[usize]) -> Independence {
        let mut distinct = records.to_vec();
        distinct.sort_unstable();
        distinct.dedup();
        Independence::of_counts(distinct.len(), records.len())
    }

    /// Determines the independent units from the numbers of motions and rows.
    pub(super) fn of_counts(records: usize, rows: usize) -> Independence {
        match records {
            count if count == rows => Independence::Rows,
            1 => Independence::OneMotion,
            count => Independence::Motions(count),
        }
    }

    /// The two-sided deviate of a confidence. It is normal for independent rows, else Student's t with one degree of freedom less than the
    /// number of motions.
    pub(super) fn deviate(self, confidence: f64) -> f64 {
        match self {
            Independence::Rows | Independence::OneMotion => normal::quantile(0.5 + 0.5 * confidence),
            Independence::Motions(count) => student::quantile(1.0 - confidence, (count - 1) as f64),
        }
    }

    /// The two-sided p-value of a deviate.
    pub(super) fn p_value(self, deviate: f64) -> f64 {
        match self {
            Independence::Rows | Independence::OneMotion => normal::p_value(deviate),
            Independence::Motions(count) => student::p_value(deviate, (count - 1) as f64),
        }
    }
}

impl Independence {
    /// The words in reports. `cluster` is the column of the clusters instead of the ground motions.
    pub fn words(self, cluster: Option<&str>) -> String {
        match (self, cluster) {
            (Independence::Rows, _) => "rows independent".into(),
            (Independence::Motions(count), None) => format!("clustered by {count} motions"),
            (Independence::Motions(count), Some(column)) => format!("clustered by {count} values of {column}"),
            (Independence::OneMotion, None) => "for the only motion".into(),
            (Independence::OneMotion, Some(column)) => format!("for the only value of {column}"),
        }
    }
}

/// Whether a variance clustered by motion is far below that of independent rows: the motions agree too well for it. Few motions that happen
/// to agree, such as those with equal counts at each level, have a clustered variance near zero, which is no knowledge.
pub(super) fn is_too_alike(clustered: f64, independent: f64) -> bool {
    /// Fraction of the variance of independent rows. Of ten independent motions one estimate in 10⁷ is as small.
    const FAR_BELOW: f64 = 0.01;
    clustered < FAR_BELOW * independent
}

/// Greatest number of records for a jackknife with full refits. With more, one Newton step is as accurate.
pub(super) const MAX_REFITS: usize = 100;

/// Change of the coefficients when a record is left out. It is `None` if the others have no best fit.
fn without(data: &Data, fit: &CurveFit, records: &[usize], record: usize) -> Option<DVector<f64>> {
    let kept = data.observations().iter().zip(records).filter(|(_, of)| **of != record);
    let others = Data::new(kept.map(|(row, _)| row.clone()).collect()).ok()?.fit(fit.link).ok()?;
    Some(others.coefficients - &fit.coefficients)
}

/// Covariance of the coefficients if only rows of different records are independent.
///
/// A jackknife that leaves out one record at a time and refits, or takes a Newton step where the others are separable (CV3 of
/// J. G. MacKinnon, M. Ø. Nielsen, M. D. Webb, Cluster-robust inference: a guide to empirical practice, J. Econometrics 232
/// (2023) 272–299). `records` has the record of each row; independent rows have the covariance of the fit. `None` if one record
/// alone determines a coefficient.
pub(super) fn covariance(data: &Data, fit: &CurveFit, records: &[usize]) -> Option<DMatrix<f64>> {
    let size = fit.coefficients.len();
    let Independence::Motions(count) = Independence::of(records) else {
        return Some(fit.covariance.clone());
    };
    let design = Predictor::full(data.observations());
    let terms = design.terms(fit.link, &fit.coefficients);
    let last = records.iter().max().map_or(0, |last| last + 1);
    let mut sums = vec![(DVector::zeros(size), DMatrix::zeros(size, size)); last];
    for ((row, term), &record) in design.x.row_iter().zip(&terms).zip(records) {
        let (score, information) = &mut sums[record];
        *score += term.score * row.transpose();
        *information += term.information * row.transpose() * row;
    }
    let mut has_rows = vec![false; last];
    records.iter().for_each(|&record| has_rows[record] = true);
    let whole: DMatrix<f64> = sums.iter().map(|(_, information)| information).sum();
    let sums = sums.iter().enumerate().filter(|(record, _)| has_rows[*record]);
    let shifts = sums.map(|(record, (score, information))| {
        let refitted = if count <= MAX_REFITS { without(data, fit, records, record) } else { None };
        refitted.or_else(|| step(&whole, score, information))
    });
    of_shifts(shifts, size, count)
}

/// Change of the coefficients by a Newton step without a record. It follows from its score and information and the information of all.
pub(super) fn step(whole: &DMatrix<f64>, score: &DVector<f64>, information: &DMatrix<f64>) -> Option<DVector<f64>> {
    Some((whole - information).cholesky()?.solve(score))
}

/// The covariance from the changes of the coefficients without each of the records.
pub(super) fn of_shifts(
    shifts: impl Iterator<Item = Option<DVector<f64>>>,
    size: usize,
    count: usize,
) -> Option<DMatrix<f64>> {
    let mut covariance = DMatrix::zeros(size, size);
    for shift in shifts {
        let shift = shift?;
        covariance += &shift * shift.transpose();
    }
    Some(covariance * ((count - 1) as f64 / count as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragility::{Link, Observation};

    #[test]
    fn independent_units_are_rows_or_motions() {
        assert_eq!(Independence::of(&[4, 2, 9]), Independence::Rows);
        assert_eq!(Independence::of(&[4, 2, 4]), Independence::Motions(2));
        assert_eq!(Independence::of(&[4, 4, 4]), Independence::OneMotion);
    }

    /// Ten copies of each row carry no more information than one. The covariance is the jackknife of the single rows.
    #[test]
    fn copies_of_rows_add_no_information() {
        let once: Vec<Observation> =
            (0..24).map(|i| Observation::of(&[1.0 + 0.1 * f64::from(i)], i * 5 % 7 < i / 4)).collect();
        let coefficients = |rows: &[Observation]| {
            let fit = Data::new(rows.to_vec()).unwrap().fit(Link::Probit).unwrap();
            [fit.coefficients[0], fit.coefficients[1]]
        };
        let whole = coefficients(&once);
        let mut exact = [0.0; 3];
        for left_out in 0..once.len() {
            let others: Vec<Observation> = [&once[..left_out], &once[left_out + 1..]].concat();
            let [a, b] = [0, 1].map(|i| coefficients(&others)[i] - whole[i]);
            exact = [exact[0] + a * a, exact[1] + a * b, exact[2] + b * b];
        }
        let ten: Vec<Observation> = once.iter().flat_map(|row| std::iter::repeat_n(row.clone(), 10)).collect();
        let records: Vec<usize> = (0..ten.len()).map(|row| row / 10).collect();
        let data = Data::new(ten).unwrap();
        let fit = data.fit(Link::Probit).unwrap();
        let found = covariance(&data, &fit, &records).unwrap();
        for (found, exact) in [found[(0, 0)], found[(0, 1)], found[(1, 1)]].into_iter().zip(exact) {
            assert!((found / (exact * 23.0 / 24.0) - 1.0).abs() < 1e-9, "{found} beside {exact}");
        }
        // Copies counted as independent rows would lower the standard error of the slope by √10.
        assert!(found[(1, 1)] > 5.0 * fit.covariance[(1, 1)]);
    }
}
