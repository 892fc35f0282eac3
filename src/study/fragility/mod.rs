//! What blocks did over how strong the ground moved → the probability that they overturn or exceed a limit.
//!
//! A curve is `P = F(a + b ln IM)` of an intensity measure IM > 0, a surface the same of two, `F(a + b₁ ln IM₁ + b₂ ln IM₂)`.
//! With the normal distribution for F (probit) it is the lognormal fragility curve of median `exp(−a/b)` and dispersion
//! `β = 1/b`; with the logistic one (logit) it is logistic regression. Coefficients are those of the greatest likelihood
//! (J. W. Baker, Efficient analytical fragility function fitting using dynamic structural analysis, Earthquake Spectra 31
//! (2015) 579–599, without his grouping of levels); intervals and bands are those of the profile likelihood, with rows
//! clustered by record, or of a bootstrap of whole records.
//!
//! ```
//! use rocking_block::study::fragility::{Data, Link, Observation};
//!
//! let rows = [(0.2, false), (0.3, false), (0.4, true), (0.5, false), (0.6, true), (0.9, true)];
//! let data = Data::new(rows.map(|(pgv, overturned)| Observation::of(&[pgv], overturned)).to_vec())?;
//! let fit = data.fit(Link::Probit)?;
//! assert!((0.4..0.5).contains(&fit.median()));
//! # Ok::<(), rocking_block::study::fragility::FitError>(())
//! ```

mod assessment;
mod bootstrap;
mod clusters;
mod ida;
mod likelihood;
mod profile;
mod quality;
mod regression;
mod separation;
mod table;

pub use assessment::{Assessment, Surface, Uncertainty, sufficiency_beside};
pub use bootstrap::{Bootstrap, bootstrap};
pub use clusters::Independence;
pub use ida::{Ida, Response};
pub use likelihood::Link;
pub use profile::{Interval, Profile};
pub use quality::{auc, brier, efficiency, sufficiency};
pub use regression::Fit;
pub use table::{Case, Cases, Limit, Table, TableError};

use regression::{Design, maximize};

/// What blocks did at one strength of the ground motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// One or two intensity measures, above zero, in units of their own.
    pub measures: Vec<f64>,
    /// The part of them that overturned or exceeded the limit, 0 to 1.
    pub fraction: f64,
    /// How many independent outcomes the part stands for, above zero.
    pub weight: f64,
}

impl Observation {
    /// A single run.
    pub fn of(measures: &[f64], exceeded: bool) -> Observation {
        Observation::with_probability(measures, f64::from(u8::from(exceeded)))
    }

    /// A probability, such as that of an ensemble, that counts as much as a single run: samples of an ensemble differ by
    /// little and are not independent of each other.
    pub fn with_probability(measures: &[f64], probability: f64) -> Observation {
        Observation { measures: measures.to_vec(), fraction: probability, weight: 1.0 }
    }

    /// So many of so many independent runs.
    pub fn counted(measures: &[f64], exceeded: u64, trials: u64) -> Observation {
        let (exceeded, trials) = (exceeded as f64, trials as f64);
        Observation { measures: measures.to_vec(), fraction: exceeded / trials, weight: trials }
    }
}

/// Why there is no best curve. Rows are numbered from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// There is nothing.
    #[error("found no rows; expected some of which the limit is exceeded and some of which it is not")]
    Empty,
    /// A row has another number of measures, or none that a curve is made of.
    #[error("found {found} measures in row {row}; expected {expected}")]
    Measures {
        /// The row.
        row: usize,
        /// How many it has.
        found: usize,
        /// What the others have, or what there may be.
        expected: &'static str,
    },
    /// A measure of which there is no logarithm.
    #[error("found the measure {found} in row {row}; expected a number above 0, of which the logarithm is taken")]
    Measure {
        /// The row.
        row: usize,
        /// Its measure.
        found: f64,
    },
    /// No part of a number of runs.
    #[error("found the part {fraction} of {weight} outcomes in row {row}; expected 0 to 1 of a number above 0")]
    Outcome {
        /// The row.
        row: usize,
        /// The part.
        fraction: f64,
        /// The number.
        weight: f64,
    },
    /// All rows did the same.
    #[error("found one class: the limit is {} in all {rows} rows; expected rows of both kinds", if *.exceeded { "exceeded" } else { "not exceeded" })]
    OneClass {
        /// Whether the limit is exceeded in all of them, or in none.
        exceeded: bool,
        /// How many there are.
        rows: usize,
    },
    /// The measure does not change.
    #[error("found the measure {value} in all {rows} rows; expected several values")]
    Alike {
        /// The measure.
        value: f64,
        /// How many rows there are.
        rows: usize,
    },
    /// One measure follows from the other.
    #[error("found two measures of which one is a power of the other in all {rows} rows; expected two that differ")]
    Collinear {
        /// How many rows there are.
        rows: usize,
    },
    /// One class lies below a value, the other one above it.
    #[error(
        "found separable data: the limit is {} in all rows up to {below} and {} in all from {above} on; any curve that rises \
         between them fits the better the steeper it is, and expected are classes that overlap",
        if *.falls { "exceeded" } else { "not exceeded" },
        if *.falls { "not exceeded" } else { "exceeded" }
    )]
    Separable {
        /// Greatest measure of the lower class.
        below: f64,
        /// Least measure of the upper class.
        above: f64,
        /// Whether the lower class is the one in which the limit is exceeded.
        falls: bool,
    },
    /// A line in the plane of both logarithms parts the classes.
    #[error(
        "found separable data: a line in the plane of the logarithms of both measures parts the {exceeded} rows in which the \
         limit is exceeded from the {others} others; expected classes that overlap"
    )]
    SeparablePlane {
        /// Rows in which the limit is exceeded.
        exceeded: usize,
        /// The others.
        others: usize,
    },
    /// There is nothing to draw samples of.
    #[error("found {found} ground motion; expected two or more, of which a bootstrap draws samples")]
    OneMotion {
        /// How many there are.
        found: usize,
    },
    /// The search for the greatest likelihood did not end.
    #[error("found no greatest likelihood in {iterations} iterations; the last step was {step:e}")]
    NotConverged {
        /// How many there were.
        iterations: u32,
        /// Length of the last step.
        step: f64,
    },
}

/// Observations of which a best curve, or surface, exists and is unique.
#[derive(Clone, Debug, PartialEq)]
pub struct Data {
    observations: Vec<Observation>,
}

impl Data {
    /// Checks the observations, all with one measure or all with two.
    ///
    /// # Errors
    /// The first row that is not valid, a single class, measures that do not vary, or
    /// classes that do not overlap.
    pub fn new(observations: Vec<Observation>) -> Result<Data, FitError> {
        let measures = observations.first().ok_or(FitError::Empty)?.measures.len();
        for (row, observation) in observations.iter().enumerate() {
            let Observation { measures: of_row, fraction, weight } = observation;
            let expected = match measures {
                1 => "1, as in row 0",
                2 => "2, as in row 0",
                _ => "1 or 2",
            };
            if of_row.len() != measures || !(1..=2).contains(&measures) {
                return Err(FitError::Measures { row, found: of_row.len(), expected });
            }
            if let Some(&found) = of_row.iter().find(|&&measure| !(measure > 0.0 && measure.is_finite())) {
                return Err(FitError::Measure { row, found });
            }
            if !((0.0..=1.0).contains(fraction) && *weight > 0.0 && weight.is_finite()) {
                return Err(FitError::Outcome { row, fraction: *fraction, weight: *weight });
            }
        }
        separation::check(&observations)?;
        Ok(Data { observations })
    }

    /// The observations.
    pub fn observations(&self) -> &[Observation] {
        &self.observations
    }

    /// How many measures each has.
    pub fn measures(&self) -> usize {
        self.observations[0].measures.len()
    }

    /// The curve, or the surface, of the greatest likelihood, by Newton's method: the likelihood has one maximum only.
    ///
    /// # Errors
    /// [`FitError::NotConverged`], for data that are next to separable.
    pub fn fit(&self, link: Link) -> Result<Fit, FitError> {
        let maximum = maximize(&Design::full(&self.observations), link)?;
        Ok(Fit::new(link, self, &maximum))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(rows: &[(f64, f64)]) -> Vec<Observation> {
        rows.iter().map(|&(measure, fraction)| Observation::with_probability(&[measure], fraction)).collect()
    }

    #[track_caller]
    fn refused(observations: Vec<Observation>, words: &[&str]) {
        let told = Data::new(observations).unwrap_err().to_string();
        assert!(words.iter().all(|word| told.contains(word)), "{told}");
        assert!(!told.contains('\n'), "{told}");
    }

    #[test]
    fn what_has_no_best_curve_is_refused_with_what_was_found() {
        refused(Vec::new(), &["found no rows"]);
        refused(rows(&[(1.0, 0.0), (2.0, 0.0)]), &["one class", "not exceeded in all 2 rows"]);
        refused(rows(&[(1.0, 1.0), (2.0, 1.0)]), &["one class", "is exceeded in all 2 rows"]);
        refused(rows(&[(1.0, 1.0), (0.0, 0.0)]), &["found the measure 0 in row 1"]);
        refused(rows(&[(1.0, 1.0), (2.0, 1.5)]), &["found the part 1.5", "row 1"]);
        refused(rows(&[(3.0, 1.0), (3.0, 0.0)]), &["found the measure 3 in all 2 rows"]);
        // Complete separation, both ways, and that in which both classes have one value in common.
        refused(rows(&[(1.0, 0.0), (2.0, 0.0), (3.0, 1.0)]), &["not exceeded in all rows up to 2", "from 3 on"]);
        refused(rows(&[(1.0, 1.0), (2.0, 0.0), (3.0, 0.0)]), &["exceeded in all rows up to 1", "from 2 on"]);
        refused(rows(&[(1.0, 0.0), (2.0, 0.5), (3.0, 1.0)]), &["up to 2", "from 2 on"]);
        refused(vec![Observation::of(&[1.0, 2.0, 3.0], true)], &["found 3 measures in row 0"]);
        refused(
            vec![Observation::of(&[1.0], true), Observation::of(&[1.0, 2.0], false)],
            &["found 2 measures in row 1"],
        );
    }

    #[test]
    fn classes_that_a_line_parts_are_refused_and_others_are_not() {
        let plane = |points: &[(f64, f64, bool)]| {
            points.iter().map(|&(a, b, exceeded)| Observation::of(&[f64::exp(a), f64::exp(b)], exceeded)).collect()
        };
        let parted = [(0.0, 0.0, false), (1.0, 0.0, false), (0.0, 1.0, false), (1.0, 1.0, true), (2.0, 0.3, true)];
        refused(plane(&parted), &["separable", "2 rows", "3 others"]);
        let mixed = [&parted[..], &[(0.3, 0.3, true), (2.0, 2.0, false)]].concat();
        let data = Data::new(plane(&mixed)).unwrap();
        assert!(data.fit(Link::Logit).unwrap().coefficients.iter().all(|c| c.is_finite()));
        // ln IM₂ = 2 ln IM₁ + 1, though both classes overlap.
        let line: Vec<_> =
            (0..9).map(|i| (f64::from(i), 2.0 * f64::from(i) + 1.0, [1, 4, 5, 8].contains(&i))).collect();
        refused(plane(&line), &["one is a power of the other"]);
    }

    /// With as many runs of each kind at two levels the curve goes through both parts: Φ⁻¹(0.2), Φ⁻¹(0.7).
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

    /// Nine runs with seven exceeding are the same as nine rows, seven of them exceeding; a fraction has the same curve
    /// and the standard errors of one row.
    #[test]
    fn counts_and_fractions_are_what_they_stand_for() {
        let counts = [(1.0, 1), (1.5, 4), (2.2, 3), (3.0, 8)];
        let of = |observations: Vec<Observation>| Data::new(observations).unwrap().fit(Link::Probit).unwrap();
        let counted = of(counts.map(|(measure, count)| Observation::counted(&[measure], count, 9)).to_vec());
        let single =
            counts.iter().flat_map(|&(measure, count)| (0..9).map(move |i| Observation::of(&[measure], i < count)));
        let single = of(single.collect());
        let parts =
            of(counts.map(|(measure, count)| Observation::with_probability(&[measure], count as f64 / 9.0)).to_vec());
        for i in 0..2 {
            assert!((counted.coefficients[i] - single.coefficients[i]).abs() < 1e-12);
            assert!((counted.standard_errors()[i] - single.standard_errors()[i]).abs() < 1e-12);
            assert!((counted.coefficients[i] - parts.coefficients[i]).abs() < 1e-12);
            assert!((3.0 * counted.standard_errors()[i] - parts.standard_errors()[i]).abs() < 1e-12);
        }
    }
}
