//! Rows that share records → covariance of the coefficients, clustered by record.

use nalgebra::{DMatrix, DVector};

use crate::fragility::data::Data;
use crate::fragility::regression::{CurveFit, Predictor};
use crate::statistics::normal;
use rocking_block::numerics::roots::sign_change;

/// The independent units of intervals and tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Independence {
    /// Rows: no record occurs twice.
    Rows,
    /// This number of records, each with its rows as a cluster.
    Records(usize),
    /// Rows of the only record: intervals hold for this record alone.
    OneRecord,
}

impl Independence {
    /// Determines the independent units from the record of each row.
    pub fn of(records: &[usize]) -> Independence {
        let mut distinct = records.to_vec();
        distinct.sort_unstable();
        distinct.dedup();
        Independence::of_counts(distinct.len(), records.len())
    }

    /// Determines the independent units from the numbers of records and rows.
    pub(super) fn of_counts(records: usize, rows: usize) -> Independence {
        match records {
            count if count == rows => Independence::Rows,
            1 => Independence::OneRecord,
            count => Independence::Records(count),
        }
    }

    /// The two-sided deviate of a confidence. It is normal for independent rows, else Student's t with one degree of freedom less than the
    /// number of records.
    pub(super) fn deviate(self, confidence: f64) -> f64 {
        match self {
            Independence::Rows | Independence::OneRecord => normal::quantile(0.5 + 0.5 * confidence),
            Independence::Records(count) => student_quantile(1.0 - confidence, (count - 1) as f64),
        }
    }

    /// The two-sided p-value of a deviate.
    pub(super) fn exceedance(self, deviate: f64) -> f64 {
        match self {
            Independence::Rows | Independence::OneRecord => libm::erfc(deviate / std::f64::consts::SQRT_2),
            Independence::Records(count) => student_exceedance(deviate, (count - 1) as f64),
        }
    }
}

/// The words in reports.
impl std::fmt::Display for Independence {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Independence::Rows => f.write_str("rows independent"),
            Independence::Records(count) => write!(f, "clustered by {count} records"),
            Independence::OneRecord => f.write_str("for the only record"),
        }
    }
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
    let Independence::Records(count) = Independence::of(records) else {
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

/// The deviate t of Student's t distribution with P(|T| > t) = `exceedance`. The exceedance is above 0 and below 1.
fn student_quantile(exceedance: f64, freedom: f64) -> f64 {
    let excess = |t: f64| student_exceedance(t, freedom) - exceedance;
    let mut high = 1.0;
    while excess(high) > 0.0 {
        high *= 2.0;
    }
    sign_change(0.0, high, 1.0 - exceedance, excess(high), excess)
}

/// P(|T| > t) of Student's t distribution, as an incomplete beta function (M. Abramowitz, I. A. Stegun, Handbook of
/// mathematical functions, 26.7.1).
fn student_exceedance(t: f64, freedom: f64) -> f64 {
    let x = freedom / (freedom + t * t);
    let [a, b] = [0.5 * freedom, 0.5];
    match x < (a + 1.0) / (a + b + 2.0) {
        true => beta_ratio(a, b, x, 1.0 - x),
        false => 1.0 - beta_ratio(b, a, 1.0 - x, x),
    }
}

/// The incomplete beta function I_x(a, b), y = 1 − x, by its continued fraction (W. H. Press et al., Numerical recipes,
/// 6.4), which converges fast for x < (a + 1)/(a + b + 2).
fn beta_ratio(a: f64, b: f64, x: f64, y: f64) -> f64 {
    const MAX_TERMS: u32 = 100_000;
    if x <= 0.0 {
        return 0.0;
    }
    let front = libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * libm::log(x) + b * libm::log(y);
    let mut d = 1.0 / (1.0 - (a + b) * x / (a + 1.0));
    let (mut c, mut fraction) = (1.0, d);
    for m in (1..MAX_TERMS).map(f64::from) {
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let before = fraction;
        for term in [even, odd] {
            d = 1.0 / (1.0 + term * d);
            c = 1.0 + term / c;
            fraction *= d * c;
        }
        if (fraction - before).abs() <= 1e-15 * fraction.abs() {
            break;
        }
    }
    libm::exp(front) * fraction / a
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragility::{Link, Observation};

    /// Compares with table 26.10 of Abramowitz and Stegun. One and two degrees of freedom have closed forms.
    #[test]
    fn student_deviates_match_the_tables() {
        for (freedom, exact) in [(1.0, 12.706), (2.0, 4.303), (5.0, 2.571), (20.0, 2.086), (120.0, 1.980)] {
            assert!((student_quantile(0.05, freedom) - exact).abs() < 6e-4, "{freedom}");
        }
        for t in [0.01_f64, 0.7, 3.0, 500.0] {
            let exact = 2.0 / std::f64::consts::PI * (1.0 / t).atan();
            assert!((student_exceedance(t, 1.0) / exact - 1.0).abs() < 1e-12, "{t}");
            let exact = 2.0 / ((2.0 + t * t).sqrt() * ((2.0 + t * t).sqrt() + t));
            assert!((student_exceedance(t, 2.0) / exact - 1.0).abs() < 1e-12, "{t}");
        }
        let [near, normal] = [student_quantile(0.05, 1e6), normal::quantile(0.975)];
        assert!((near / normal - 1.0).abs() < 1e-5);
        assert_eq!(student_exceedance(f64::INFINITY, 7.0), 0.0);
    }

    #[test]
    fn independent_units_are_rows_or_records() {
        assert_eq!(Independence::of(&[4, 2, 9]), Independence::Rows);
        assert_eq!(Independence::of(&[4, 2, 4]), Independence::Records(2));
        assert_eq!(Independence::of(&[4, 4, 4]), Independence::OneRecord);
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
