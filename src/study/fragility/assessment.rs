//! Cases and a measure → its curve, how sure that is, and how well it tells the outcomes.

use crate::study::fragility::bootstrap::{Bootstrap, bootstrap};
use crate::study::fragility::clusters::{self, Independence};
use crate::study::fragility::profile::{Interval, Profile};
use crate::study::fragility::quality::{auc, brier, efficiency, sufficiency};
use crate::study::fragility::{Case, Data, Fit, FitError, Link, Observation};

/// How intervals are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncertainty {
    /// By the likelihood, with rows clustered by record where records repeat.
    Profile,
    /// By this many bootstrap samples of the records, from this seed.
    Bootstrap(u32, u64),
}

impl Uncertainty {
    /// The method in words.
    pub fn words(self, independence: Independence) -> String {
        match self {
            Uncertainty::Profile => format!("profile likelihood, {independence}"),
            Uncertainty::Bootstrap(samples, _) => format!("{samples} bootstrap samples, {independence}"),
        }
    }
}

/// A curve of one measure.
pub struct Assessment {
    /// The cases that have the measure.
    pub data: Data,
    /// The curve.
    pub fit: Fit,
    /// Interval of the median.
    pub median: Interval,
    /// Interval of the dispersion.
    pub dispersion: Interval,
    /// Area under the receiver operating characteristic, of probabilities that rise with the measure if the curve does.
    pub auc: f64,
    /// Brier score.
    pub brier: f64,
    /// Scatter of the peaks of the blocks that rock and stand about a power of the measure.
    pub efficiency: Option<f64>,
    /// Number of blocks that rock and stand: they lifted off and reached a thousandth of α.
    pub rocking: usize,
    /// What the intervals take for independent.
    pub independence: Independence,
    /// Standard errors of the coefficients, with rows clustered by record where records repeat; infinite if one record alone
    /// determines them.
    pub standard_errors: Vec<f64>,
    /// Cases that do not have the measure.
    pub without: usize,
    /// The part of the bootstrap's curves or of the confidence that intervals hold.
    confidence: f64,
    records: Vec<usize>,
    bootstrap: Option<Bootstrap>,
}

impl Assessment {
    /// Fits a curve. `measures` has that of each case, nothing where there is none; `confidence` is above 0 and below 1.
    ///
    /// # Errors
    /// Those of [`Data::new`], [`Data::fit`] and [`bootstrap`].
    pub fn new(
        cases: &[Case],
        measures: &[Option<f64>],
        link: Link,
        confidence: f64,
        uncertainty: Uncertainty,
    ) -> Result<Assessment, FitError> {
        let pairs: Vec<(&Case, f64)> =
            cases.iter().zip(measures).filter_map(|(case, measure)| Some((case, (*measure)?))).collect();
        let observation = |(case, measure): &(&Case, f64)| Observation::with_probability(&[*measure], case.fraction);
        let data = Data::new(pairs.iter().map(observation).collect())?;
        let fit = data.fit(link)?;
        let (rocking, peaks): (Vec<f64>, Vec<f64>) =
            pairs.iter().filter_map(|(case, measure)| Some((*measure, rocking_peak(case)?))).unzip();
        let probabilities = fit.probabilities(data.observations());
        let records: Vec<usize> = pairs.iter().map(|(case, _)| case.motion).collect();
        let (median, dispersion, bootstrap) = match uncertainty {
            Uncertainty::Profile => {
                let profile = Profile::new(&data, &fit, confidence, &records)?;
                (profile.median(), profile.dispersion(), None)
            }
            Uncertainty::Bootstrap(samples, seed) => {
                let found = bootstrap(&data, &records, link, samples, seed)?;
                let of = |feature: fn(&Fit) -> f64| found.interval(confidence, feature);
                (of(Fit::median), of(Fit::dispersion), Some(found))
            }
        };
        Ok(Assessment {
            median,
            dispersion,
            auc: auc(data.observations(), &probabilities),
            brier: brier(data.observations(), &probabilities),
            efficiency: efficiency(&rocking, &peaks),
            rocking: rocking.len(),
            independence: Independence::of(&records),
            standard_errors: standard_errors(&data, &fit, &records),
            without: cases.len() - pairs.len(),
            confidence,
            records,
            bootstrap,
            data,
            fit,
        })
    }

    /// Intervals of the probability at these measures, each above zero.
    pub fn band(&self, measures: &[f64]) -> Vec<Interval> {
        match &self.bootstrap {
            Some(found) => {
                let at = |&measure: &f64| found.interval(self.confidence, |fit| fit.probability(&[measure]));
                measures.iter().map(at).collect()
            }
            None => match Profile::new(&self.data, &self.fit, self.confidence, &self.records) {
                Ok(profile) => measures.iter().map(|&measure| profile.probability(measure)).collect(),
                Err(_) => unreachable!("the data have one measure"),
            },
        }
    }

    /// Samples of the bootstrap that had no curve, if it was made.
    pub fn without_curve(&self) -> Option<usize> {
        self.bootstrap.as_ref().map(|found| found.without)
    }
}

/// The least |θ|max/α (1) of a block that rocked. Accelerations just above uplift leave peaks down to 1e-13, whose logarithms
/// would drown all others.
const LEAST_ROCKING: f64 = 1e-3;

fn rocking_peak(case: &Case) -> Option<f64> {
    case.peak.filter(|peak| *peak >= LEAST_ROCKING)
}

/// Standard errors of the coefficients.
fn standard_errors(data: &Data, fit: &Fit, records: &[usize]) -> Vec<f64> {
    match clusters::covariance(data, fit, records) {
        Some(covariance) => covariance.diagonal().iter().map(|variance| variance.sqrt()).collect(),
        None => vec![f64::INFINITY; fit.coefficients.len()],
    }
}

/// A surface of two measures.
pub struct Surface {
    /// The cases that have both.
    pub data: Data,
    /// The surface.
    pub fit: Fit,
    /// Standard errors of the coefficients, as in [`Assessment`].
    pub standard_errors: Vec<f64>,
    /// Area under the receiver operating characteristic.
    pub auc: f64,
    /// Brier score.
    pub brier: f64,
}

impl Surface {
    /// Fits a surface; the measures are those of each case, nothing where there is none.
    ///
    /// # Errors
    /// Those of [`Data::new`] and [`Data::fit`].
    pub fn new(
        cases: &[Case],
        measures: &[Option<f64>],
        others: &[Option<f64>],
        link: Link,
    ) -> Result<Surface, FitError> {
        let both = cases.iter().zip(measures).zip(others).filter_map(|((case, measure), other)| {
            Some((Observation::with_probability(&[(*measure)?, (*other)?], case.fraction), case.motion))
        });
        let (observations, records): (Vec<Observation>, Vec<usize>) = both.unzip();
        let data = Data::new(observations)?;
        let fit = data.fit(link)?;
        let probabilities = fit.probabilities(data.observations());
        let [auc, brier] = [auc, brier].map(|score| score(data.observations(), &probabilities));
        let standard_errors = standard_errors(&data, &fit, &records);
        Ok(Surface { data, fit, standard_errors, auc, brier })
    }
}

/// The [`sufficiency`] of a measure beside another one, of the cases that have both.
///
/// # Errors
/// Those of [`sufficiency`], and of [`Data::new`] for the first measure.
pub fn sufficiency_beside(
    cases: &[Case],
    measures: &[Option<f64>],
    others: &[Option<f64>],
    link: Link,
) -> Result<f64, FitError> {
    let both = cases.iter().zip(measures).zip(others).filter_map(|((case, measure), other)| {
        Some((Observation::with_probability(&[(*measure)?], case.fraction), ((*other)?, case.motion)))
    });
    let (observations, (others, records)): (Vec<Observation>, (Vec<f64>, Vec<usize>)) = both.unzip();
    sufficiency(&Data::new(observations)?, &others, link, &records)
}
