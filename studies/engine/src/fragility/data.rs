//! Observations → data with a unique best curve or surface.

use crate::fragility::observation::{CurveFitError, Observation, check_row};
use crate::fragility::separation;

/// Observations with a unique best curve or surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Data {
    observations: Vec<Observation>,
}

impl Data {
    /// Checks the observations, all with one measure or all with two.
    ///
    /// # Errors
    /// The first invalid row, a single class, constant or dependent measures, or classes that do not overlap.
    pub fn new(observations: Vec<Observation>) -> Result<Data, CurveFitError> {
        let Some(first) = observations.first() else {
            let message = "found no rows; expected rows that exceed the limit and rows that do not";
            return Err(CurveFitError(message.into()));
        };
        let measures = first.measures.len();
        for (row, observation) in observations.iter().enumerate() {
            let found = observation.measures.len();
            let expected = match measures {
                1 => "1, as in row 0",
                2 => "2, as in row 0",
                _ => "1 or 2",
            };
            if found != measures || !(1..=2).contains(&measures) {
                return Err(CurveFitError(format!("found {found} measures in row {row}; expected {expected}")));
            }
            check_row(row, &observation.measures, observation.fraction, observation.weight)?;
        }
        separation::check(&observations)?;
        Ok(Data { observations })
    }

    /// Takes observations that have been checked.
    pub(super) fn checked(observations: Vec<Observation>) -> Data {
        Data { observations }
    }

    /// The observations.
    pub fn observations(&self) -> &[Observation] {
        &self.observations
    }

    /// Number of measures of each observation.
    pub fn measures(&self) -> usize {
        self.observations[0].measures.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragility::{CurveFit, Link};

    fn rows(rows: &[(f64, f64)]) -> Vec<Observation> {
        rows.iter().map(|&(measure, fraction)| Observation::with_probability(&[measure], fraction)).collect()
    }

    #[track_caller]
    fn refused(observations: Vec<Observation>, words: &[&str]) {
        let message = Data::new(observations).unwrap_err().to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
        assert!(!message.contains('\n'), "{message}");
    }

    #[test]
    fn data_without_a_best_curve_are_refused_with_the_values_found() {
        refused(Vec::new(), &["found no rows"]);
        refused(rows(&[(1.0, 0.0), (2.0, 0.0)]), &["one class", "not exceeded in all 2 rows"]);
        refused(rows(&[(1.0, 1.0), (2.0, 1.0)]), &["one class", "is exceeded in all 2 rows"]);
        refused(rows(&[(1.0, 1.0), (0.0, 0.0)]), &["found the measure 0 in row 1"]);
        refused(rows(&[(1.0, 1.0), (2.0, 1.5)]), &["found the fraction 1.5", "row 1"]);
        refused(rows(&[(3.0, 1.0), (3.0, 0.0)]), &["found the measure 3 in all 2 rows"]);
        // Complete separation in both directions, and quasi-complete separation with one common value.
        refused(rows(&[(1.0, 0.0), (2.0, 0.0), (3.0, 1.0)]), &["not exceeded in all rows up to 2", "from 3 on"]);
        refused(rows(&[(1.0, 1.0), (2.0, 0.0), (3.0, 0.0)]), &["exceeded in all rows up to 1", "from 2 on"]);
        refused(
            rows(&[(1.0, 0.0), (2.0, 0.5), (3.0, 1.0)]),
            &["not exceeded in all rows below 2, exceeded in 0.5 of 1 at 2, and exceeded in all above"],
        );
        refused(
            rows(&[(1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (2.0, 0.0)]),
            &["not exceeded in all rows below 2, exceeded in 1 of 3 at 2; the steeper"],
        );
        refused(vec![Observation::of(&[1.0, 2.0, 3.0], true)], &["found 3 measures in row 0"]);
        refused(
            vec![Observation::of(&[1.0], true), Observation::of(&[1.0, 2.0], false)],
            &["found 2 measures in row 1"],
        );
    }

    #[test]
    fn classes_separated_by_a_line_are_refused_and_others_are_not() {
        let plane = |points: &[(f64, f64, bool)]| {
            points.iter().map(|&(a, b, exceeded)| Observation::of(&[f64::exp(a), f64::exp(b)], exceeded)).collect()
        };
        let separated = [(0.0, 0.0, false), (1.0, 0.0, false), (0.0, 1.0, false), (1.0, 1.0, true), (2.0, 0.3, true)];
        refused(plane(&separated), &["separable", "2 rows", "3 others"]);
        let mixed = [&separated[..], &[(0.3, 0.3, true), (2.0, 2.0, false)]].concat();
        let data = Data::new(plane(&mixed)).unwrap();
        assert!(data.fit(Link::Logit).unwrap().coefficients.iter().all(|c| c.is_finite()));
        // ln IM₂ = 2 ln IM₁ + 1, though both classes overlap.
        let line: Vec<_> =
            (0..9).map(|i| (f64::from(i), 2.0 * f64::from(i) + 1.0, [1, 4, 5, 8].contains(&i))).collect();
        refused(plane(&line), &["one measure is a power of the other"]);
    }

    /// With two levels, the curve passes through both fractions: Φ⁻¹(0.2), Φ⁻¹(0.7).
    #[test]
    fn two_levels_are_met_exactly() {
        let data = Data::new(vec![Observation::counted(&[2.0], 2, 10), Observation::counted(&[3.0], 7, 10)]).unwrap();
        for (link, deviate) in [
            (Link::Probit, [-0.841621233572914, 0.524400512708041]),
            (Link::Logit, [0.25_f64.ln(), (7.0_f64 / 3.0).ln()]),
        ] {
            let fit = data.fit(link).unwrap();
            let slope = (deviate[1] - deviate[0]) / 1.5_f64.ln();
            assert!((fit.coefficients[1] / slope - 1.0).abs() < 1e-12);
            assert!((fit.dispersion() * slope - 1.0).abs() < 1e-12);
            assert!((fit.median() / (2.0 * (-deviate[0] / slope).exp()) - 1.0).abs() < 1e-12);
            assert!((fit.probability(&[2.0]) - 0.2).abs() < 1e-13 && (fit.probability(&[3.0]) - 0.7).abs() < 1e-13);
        }
    }

    /// Sorted rows, whose long sums have the greatest round-off.
    #[test]
    fn many_sorted_rows_equal_their_counts() {
        let counts = [(1.0, 1000), (2.0, 2000), (3.0, 3000), (4.0, 4000)];
        let row = |(measure, count): (f64, u64)| (0..5000).map(move |i| Observation::of(&[measure], i < count));
        let rows = Data::new(counts.into_iter().flat_map(row).collect()).unwrap();
        let counted =
            Data::new(counts.map(|(measure, count)| Observation::counted(&[measure], count, 5000)).to_vec()).unwrap();
        for link in [Link::Probit, Link::Logit] {
            let [many, few] = [&rows, &counted].map(|data| data.fit(link).unwrap());
            assert!(
                (many.median() / few.median() - 1.0).abs() < 1e-12
                    && (many.dispersion() / few.dispersion() - 1.0).abs() < 1e-12
            );
        }
    }

    /// A count equals its single rows. A fraction has the same curve, but the standard errors of a single row.
    #[test]
    fn counts_equal_their_single_rows() {
        let counts = [(1.0, 1), (1.5, 4), (2.2, 3), (3.0, 8)];
        let of = |observations: Vec<Observation>| Data::new(observations).unwrap().fit(Link::Probit).unwrap();
        let counted = of(counts.map(|(measure, count)| Observation::counted(&[measure], count, 9)).to_vec());
        let single =
            counts.iter().flat_map(|&(measure, count)| (0..9).map(move |i| Observation::of(&[measure], i < count)));
        let single = of(single.collect());
        let parts =
            of(counts.map(|(measure, count)| Observation::with_probability(&[measure], count as f64 / 9.0)).to_vec());
        let error = |fit: &CurveFit, i: usize| fit.covariance[(i, i)].sqrt();
        for i in 0..2 {
            assert!((counted.coefficients[i] - single.coefficients[i]).abs() < 1e-12);
            assert!((error(&counted, i) - error(&single, i)).abs() < 1e-12);
            assert!((counted.coefficients[i] - parts.coefficients[i]).abs() < 1e-12);
            assert!((3.0 * error(&counted, i) - error(&parts, i)).abs() < 1e-12);
        }
    }
}
