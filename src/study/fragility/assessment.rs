//! Cases and a measure → its curve, how sure that is, and how well it tells the outcomes.

use crate::study::fragility::bootstrap::{Bootstrap, bootstrap};
use crate::study::fragility::profile::{Interval, Profile};
use crate::study::fragility::quality::{auc, brier, efficiency, sufficiency};
use crate::study::fragility::{Case, Data, Fit, FitError, Link, Observation};

/// How intervals are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncertainty {
    /// By the likelihood, with each row on its own.
    Profile,
    /// By so many samples of the ground motions, from this seed.
    Bootstrap(u32, u64),
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
    /// Cases that do not have the measure.
    pub without: usize,
    /// The part of the bootstrap's curves or of the confidence that intervals hold.
    confidence: f64,
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
            pairs.iter().filter_map(|(case, measure)| Some((*measure, case.peak?))).unzip();
        let probabilities = fit.probabilities(data.observations());
        let groups: Vec<usize> = pairs.iter().map(|(case, _)| case.motion).collect();
        let (median, dispersion, bootstrap) = match uncertainty {
            Uncertainty::Profile => {
                let profile = Profile::new(&data, &fit, confidence)?;
                (profile.median(), profile.dispersion(), None)
            }
            Uncertainty::Bootstrap(samples, seed) => {
                let found = bootstrap(&data, &groups, link, samples, seed)?;
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
            without: cases.len() - pairs.len(),
            confidence,
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
            None => match Profile::new(&self.data, &self.fit, self.confidence) {
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

/// A surface of two measures.
pub struct Surface {
    /// The cases that have both.
    pub data: Data,
    /// The surface.
    pub fit: Fit,
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
            Some(Observation::with_probability(&[(*measure)?, (*other)?], case.fraction))
        });
        let data = Data::new(both.collect())?;
        let fit = data.fit(link)?;
        let probabilities = fit.probabilities(data.observations());
        let [auc, brier] = [auc, brier].map(|score| score(data.observations(), &probabilities));
        Ok(Surface { data, fit, auc, brier })
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
        Some((Observation::with_probability(&[(*measure)?], case.fraction), (*other)?))
    });
    let (observations, others): (Vec<Observation>, Vec<f64>) = both.unzip();
    sufficiency(&Data::new(observations)?, &others, link)
}
