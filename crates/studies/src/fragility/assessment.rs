//! Cases and a measure → its curve with intervals and quality.

use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::fragility::bootstrap::{Bootstrap, MIN_GROUPS, bootstrap};
use crate::fragility::clusters::{self, Independence};
use crate::fragility::data::Data;
use crate::fragility::goodness::{Goodness, Group, groups};
use crate::fragility::likelihood::Link;
use crate::fragility::observation::{CurveFitError, Observation};
use crate::fragility::profile::{Interval, LikelihoodProfile};
use crate::fragility::quality::{auc, brier, efficiency, sufficiency};
use crate::fragility::regression::CurveFit;
use crate::fragility::table::Case;

/// The method for intervals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncertainty {
    /// Profile likelihood, with rows clustered by record where records repeat.
    Profile,
    /// Bootstrap of whole records: number of samples and seed.
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

/// The curve of one measure with its intervals and its quality.
pub struct Assessment {
    /// The cases with a value of the measure.
    pub data: Data,
    /// The curve.
    pub fit: CurveFit,
    /// Interval of the median.
    pub median: Interval,
    /// Interval of the dispersion.
    pub dispersion: Interval,
    /// Area under the receiver operating characteristic of the fitted probabilities.
    pub auc: f64,
    /// Brier score.
    pub brier: f64,
    /// Groups of rows with adjacent measures.
    pub groups: Vec<Group>,
    /// Whether the curve fits the groups; `None` for fewer than three.
    pub goodness: Option<Goodness>,
    /// Scatter of the peaks about a power law of the measure, for the blocks that rock and stand.
    pub efficiency: Option<f64>,
    /// Number of blocks that rock and stand: lift-off and a peak of at least α/1000.
    pub rocking: usize,
    /// The independent units behind the intervals.
    pub independence: Independence,
    /// Standard errors of the coefficients, clustered by record where records repeat.
    ///
    /// Infinite if one record alone determines a coefficient.
    pub standard_errors: Vec<f64>,
    /// Number of cases without a value of the measure.
    pub without: usize,
    /// Confidence level of the intervals.
    confidence: f64,
    /// Covariance of the coefficients, clustered by record where records repeat.
    covariance: Option<DMatrix<f64>>,
    bootstrap: Option<Bootstrap>,
}

impl Assessment {
    /// Fits a curve; `measures` has the value of each case, `confidence` is above 0 and below 1.
    ///
    /// # Errors
    /// Those of [`Data::new`], [`Data::fit`] and [`bootstrap`].
    pub fn new(
        cases: &[Case],
        measures: &[Option<f64>],
        link: Link,
        confidence: f64,
        uncertainty: Uncertainty,
    ) -> Result<Assessment, CurveFitError> {
        let pairs: Vec<(&Case, f64)> =
            cases.iter().zip(measures).filter_map(|(case, measure)| Some((case, (*measure)?))).collect();
        let observation = |(case, measure): &(&Case, f64)| Observation::with_probability(&[*measure], case.fraction);
        let data = Data::new(pairs.iter().map(observation).collect())?;
        let fit = data.fit(link)?;
        let (rocking, peaks): (Vec<f64>, Vec<f64>) =
            pairs.iter().filter_map(|(case, measure)| Some((*measure, rocking_peak(case)?))).unzip();
        let probabilities = fit.probabilities(data.observations());
        let records: Vec<usize> = pairs.iter().map(|(case, _)| case.motion).collect();
        let covariance = clusters::covariance(&data, &fit, &records);
        let groups = groups(data.observations(), &probabilities, &records);
        let independence = Independence::of(&records);
        let (median, dispersion, bootstrap) = match uncertainty {
            Uncertainty::Profile => {
                let deviate = independence.deviate(confidence);
                let profile = LikelihoodProfile::clustered(&data, &fit, deviate, covariance.clone())?;
                (profile.median(), profile.dispersion(), None)
            }
            Uncertainty::Bootstrap(samples, seed) => {
                let found = bootstrap(&data, &records, link, samples, seed)?;
                let interval = |feature: fn(&CurveFit) -> f64| found.interval(confidence, feature);
                (interval(CurveFit::median), interval(CurveFit::dispersion), Some(found))
            }
        };
        Ok(Assessment {
            median,
            dispersion,
            auc: auc(data.observations(), &probabilities),
            brier: brier(data.observations(), &probabilities),
            goodness: Goodness::of(&groups),
            groups,
            efficiency: efficiency(&rocking, &peaks),
            rocking: rocking.len(),
            independence,
            standard_errors: standard_errors(covariance.as_ref(), &fit),
            without: cases.len() - pairs.len(),
            confidence,
            covariance,
            bootstrap,
            data,
            fit,
        })
    }

    /// Pointwise intervals of the probability at these measures, each above zero.
    pub fn band(&self, measures: &[f64]) -> Vec<Interval> {
        match &self.bootstrap {
            Some(found) => {
                let at = |&measure: &f64| found.interval(self.confidence, |fit| fit.probability(&[measure]));
                measures.iter().map(at).collect()
            }
            None => {
                let deviate = self.independence.deviate(self.confidence);
                match LikelihoodProfile::clustered(&self.data, &self.fit, deviate, self.covariance.clone()) {
                    Ok(profile) => measures.par_iter().map(|&measure| profile.probability(measure)).collect(),
                    Err(_) => unreachable!("the data have one measure"),
                }
            }
        }
    }

    /// Interval of a feature over the curves of the bootstrap, if a bootstrap was made.
    pub fn bootstrap_interval(&self, of: impl Fn(&CurveFit) -> f64) -> Option<Interval> {
        self.bootstrap.as_ref().map(|found| found.interval(self.confidence, of))
    }

    /// Returns warnings of missing intervals, and of a curve that falls; `heading` is the name and unit of the measure.
    pub fn warnings(&self, heading: &str) -> Vec<String> {
        let few = self.bootstrap.as_ref().filter(|found| found.groups < MIN_GROUPS).map(|found| {
            let units = if self.independence == Independence::Rows { "rows" } else { "records" };
            format!(
                "no intervals: a bootstrap of {} {units} understates the scatter; expected at least {MIN_GROUPS} {units}, or intervals \
                 of the profile likelihood",
                found.groups
            )
        });
        let beta = self.fit.dispersion();
        let falls = (beta < 0.0).then(|| {
            format!(
                "{heading}: the probability of exceeding the limit falls as the measure grows (beta {beta:.4}); expected a measure with \
                 which it grows"
            )
        });
        few.into_iter().chain(falls).collect()
    }

    /// Number of bootstrap samples without a curve, if a bootstrap was made.
    pub fn without_curve(&self) -> Option<usize> {
        self.bootstrap.as_ref().map(|found| found.without)
    }
}

/// Least peak |θ|/α (1) that counts as rocking.
///
/// Accelerations just above uplift leave peaks down to 1e-13, whose logarithms would dominate the efficiency.
const MIN_ROCKING: f64 = 1e-3;

fn rocking_peak(case: &Case) -> Option<f64> {
    case.peak.filter(|peak| *peak >= MIN_ROCKING)
}

/// Standard errors of the coefficients of a fit from their covariance, clustered by record.
fn standard_errors(covariance: Option<&DMatrix<f64>>, fit: &CurveFit) -> Vec<f64> {
    match covariance {
        Some(covariance) => covariance.diagonal().iter().map(|variance| variance.sqrt()).collect(),
        None => vec![f64::INFINITY; fit.coefficients.len()],
    }
}

/// The surface of two measures with its quality.
pub struct Surface {
    /// The cases with values of both.
    pub data: Data,
    /// The surface.
    pub fit: CurveFit,
    /// Standard errors of the coefficients, as in [`Assessment`].
    pub standard_errors: Vec<f64>,
    /// Area under the receiver operating characteristic.
    pub auc: f64,
    /// Brier score.
    pub brier: f64,
}

impl Surface {
    /// Fits a surface; `measures` and `others` have the values of each case.
    ///
    /// # Errors
    /// Those of [`Data::new`] and [`Data::fit`].
    pub fn new(
        cases: &[Case],
        measures: &[Option<f64>],
        others: &[Option<f64>],
        link: Link,
    ) -> Result<Surface, CurveFitError> {
        let both = cases.iter().zip(measures).zip(others).filter_map(|((case, measure), other)| {
            Some((Observation::with_probability(&[(*measure)?, (*other)?], case.fraction), case.motion))
        });
        let (observations, records): (Vec<Observation>, Vec<usize>) = both.unzip();
        let data = Data::new(observations)?;
        let fit = data.fit(link)?;
        let probabilities = fit.probabilities(data.observations());
        let [auc, brier] = [auc, brier].map(|score| score(data.observations(), &probabilities));
        let standard_errors = standard_errors(clusters::covariance(&data, &fit, &records).as_ref(), &fit);
        Ok(Surface { data, fit, standard_errors, auc, brier })
    }
}

/// The [`sufficiency`] of a measure with respect to another, from the cases with values of both.
///
/// # Errors
/// Those of [`sufficiency`], and of [`Data::new`] for the first measure.
pub fn sufficiency_of_cases(
    cases: &[Case],
    measures: &[Option<f64>],
    others: &[Option<f64>],
    link: Link,
) -> Result<f64, CurveFitError> {
    let both = cases.iter().zip(measures).zip(others).filter_map(|((case, measure), other)| {
        Some((Observation::with_probability(&[(*measure)?], case.fraction), ((*other)?, case.motion)))
    });
    let (observations, (others, records)): (Vec<Observation>, (Vec<f64>, Vec<usize>)) = both.unzip();
    sufficiency(&Data::new(observations)?, &others, link, &records)
}
