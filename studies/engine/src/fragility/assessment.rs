//! Cases and a measure → its curve with intervals and quality.

use nalgebra::DMatrix;

use crate::fragility::bootstrap::{Bootstrap, MIN_GROUPS, bootstrap};
use crate::fragility::cases::{Case, Motions};
use crate::fragility::clusters::{self, Independence};
use crate::fragility::data::Data;
use crate::fragility::goodness::{Goodness, Group, groups};
use crate::fragility::likelihood::Link;
use crate::fragility::many::{ManyRows, Quality};
use crate::fragility::observation::{CurveFitError, Observation};
use crate::fragility::profile::{Interval, LikelihoodProfile};
use crate::fragility::quality::{auc, brier, efficiency, p_value, sufficiency};
use crate::fragility::regression::CurveFit;
use crate::fragility::store::{CaseStore, StoredRows};
use crate::output::runner::in_parallel;

/// The method for intervals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncertainty {
    /// Profile likelihood, with rows clustered by motion where motions repeat.
    Profile,
    /// Bootstrap of whole motions: number of samples and seed.
    Bootstrap(u32, u64),
}

impl Uncertainty {
    /// The method in words, with the independent units.
    fn words(self, units: &str) -> String {
        match self {
            Uncertainty::Profile => format!("profile likelihood, {units}"),
            Uncertainty::Bootstrap(samples, _) => format!("{samples} bootstrap samples, {units}"),
        }
    }

    /// Makes the bootstrap with its number of samples and seed, if this is the method.
    fn bootstrap(
        self,
        make: impl FnOnce(u32, u64) -> Result<Bootstrap, CurveFitError>,
    ) -> Result<Option<Bootstrap>, CurveFitError> {
        match self {
            Uncertainty::Profile => Ok(None),
            Uncertainty::Bootstrap(samples, seed) => make(samples, seed).map(Some),
        }
    }
}

/// The curve of one measure with its intervals and its quality.
pub struct Assessment {
    /// The cases with a value of the measure. Of many rows, fewer observations with the same likelihood.
    pub data: Data,
    /// Number of cases with a value of the measure.
    pub rows: usize,
    /// Number of cases without one, which are left out.
    pub without_measure: usize,
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
    /// Scatter of the peaks about a power law of the measure. It is that of the blocks that rock and stand.
    pub efficiency: Option<f64>,
    /// Number of blocks that rock and stand: lift-off and a peak of at least α/1000.
    pub rocking: usize,
    /// The independent units behind the intervals.
    pub independence: Independence,
    /// The column of the clusters, if it is not the motions.
    cluster: Option<String>,
    /// The method of the intervals.
    uncertainty: Uncertainty,
    /// Confidence level of the intervals.
    confidence: f64,
    /// Covariance of the coefficients, clustered by motion where motions repeat.
    covariance: Option<DMatrix<f64>>,
    bootstrap: Option<Bootstrap>,
    /// Some of many rows.
    marks: Option<Vec<Observation>>,
}

impl Assessment {
    /// Fits a curve to stored cases with these ground motions. `confidence` is above 0 and below 1.
    ///
    /// # Errors
    /// Those of [`Data::new`], [`Data::fit`] and [`bootstrap`].
    pub fn of(
        store: CaseStore,
        motions: &Motions,
        link: Link,
        confidence: f64,
        uncertainty: Uncertainty,
    ) -> Result<Assessment, CurveFitError> {
        let without_measure = store.without_measure();
        let found = match store.rows(motions)? {
            StoredRows::Few(rows, records) => Assessment::of_list(&rows, &records, link, confidence, uncertainty),
            StoredRows::Many(rows) => Assessment::of_many(&rows, link, confidence, uncertainty),
        }?;
        Ok(Assessment { cluster: motions.cluster.clone(), without_measure, ..found })
    }

    fn of_list(
        rows: &[(Case, [f64; 2])],
        records: &[usize],
        link: Link,
        confidence: f64,
        uncertainty: Uncertainty,
    ) -> Result<Assessment, CurveFitError> {
        let data = data(rows, 1)?;
        let fit = data.fit(link)?;
        let (rocking, peaks): (Vec<f64>, Vec<f64>) =
            rows.iter().filter_map(|(case, [measure, _])| Some((*measure, case.peak?))).unzip();
        let probabilities = fit.probabilities(data.observations());
        let independence = Independence::of(records);
        let covariance = clusters::covariance(&data, &fit, records);
        let bootstrap = uncertainty.bootstrap(|samples, seed| bootstrap(&data, records, link, samples, seed))?;
        let profile = LikelihoodProfile::clustered(&data, &fit, independence.deviate(confidence), covariance.clone());
        let [median, dispersion] = intervals(&profile, bootstrap.as_ref(), independence, confidence);
        Ok(Assessment {
            rows: rows.len(),
            without_measure: 0,
            median,
            dispersion,
            auc: auc(data.observations(), &probabilities),
            brier: brier(data.observations(), &probabilities),
            groups: groups(data.observations(), &probabilities, records),
            efficiency: efficiency(&rocking, &peaks),
            rocking: rocking.len(),
            independence,
            cluster: None,
            uncertainty,
            confidence,
            covariance,
            bootstrap,
            marks: None,
            data,
            fit,
        })
    }

    fn of_many(
        rows: &ManyRows,
        link: Link,
        confidence: f64,
        uncertainty: Uncertainty,
    ) -> Result<Assessment, CurveFitError> {
        let (data, fit, width) = rows.curve(link)?;
        let covariance = rows.covariance(&fit, Some(width));
        let bootstrap = uncertainty.bootstrap(|samples, seed| rows.bootstrap(link, samples, seed, width))?;
        let independence = rows.independence();
        let profile = LikelihoodProfile::clustered(&data, &fit, independence.deviate(confidence), covariance.clone());
        let [median, dispersion] = intervals(&profile, bootstrap.as_ref(), independence, confidence);
        let Quality { auc, brier, groups, marks } = rows.quality(&fit);
        Ok(Assessment {
            rows: rows.count,
            without_measure: 0,
            median,
            dispersion,
            auc,
            brier,
            groups,
            efficiency: rows.scatter.efficiency(),
            rocking: rows.scatter.rows,
            independence,
            cluster: None,
            uncertainty,
            confidence,
            covariance,
            bootstrap,
            marks: Some(marks),
            data,
            fit,
        })
    }

    /// The independent units in words.
    pub fn units(&self) -> String {
        self.independence.words(self.cluster.as_deref())
    }

    /// The method of the intervals and their independent units in words.
    pub fn intervals(&self) -> String {
        match self.independence {
            Independence::OneMotion => format!("none {}", self.units()),
            Independence::Rows | Independence::Motions(_) => self.uncertainty.words(&self.units()),
        }
    }

    /// Standard errors of the coefficients, clustered by motion where motions repeat.
    ///
    /// Infinite if one motion alone determines a coefficient.
    pub fn standard_errors(&self) -> Vec<f64> {
        standard_errors(self.covariance.as_ref(), &self.fit)
    }

    /// Whether the curve fits the groups; `None` for fewer than three.
    pub fn goodness(&self) -> Option<Goodness> {
        Goodness::of(&self.groups)
    }

    /// The rows to draw: all, or some 10,000 of many. They are in the order of their measures, with the first and the last one.
    pub fn marks(&self) -> &[Observation] {
        self.marks.as_deref().unwrap_or_else(|| self.data.observations())
    }

    /// Pointwise intervals of the probability at these measures, each above zero.
    pub fn band(&self, measures: &[f64]) -> Vec<Interval> {
        match &self.bootstrap {
            _ if self.independence == Independence::OneMotion => vec![[None; 2]; measures.len()],
            Some(found) => {
                let at = |&measure: &f64| found.interval(self.confidence, |fit| fit.probability(&[measure]));
                measures.iter().map(at).collect()
            }
            None => {
                let deviate = self.independence.deviate(self.confidence);
                let profile = LikelihoodProfile::clustered(&self.data, &self.fit, deviate, self.covariance.clone());
                in_parallel(measures.len(), |number| profile.probability(measures[number]))
            }
        }
    }

    /// Interval of a feature over the curves of the bootstrap, if a bootstrap was made.
    pub fn bootstrap_interval(&self, of: impl Fn(&CurveFit) -> f64) -> Option<Interval> {
        self.bootstrap.as_ref().map(|found| found.interval(self.confidence, of))
    }

    /// Returns warnings of rows without the measure, of missing intervals, and of a falling curve. `heading` is the name and unit of the measure.
    pub fn warnings(&self, heading: &str) -> Vec<String> {
        let without = self.bootstrap.as_ref().and_then(|found| {
            let units = if self.independence == Independence::Rows { "rows" } else { "motions" };
            let instead = "intervals of the profile likelihood";
            match found.groups {
                groups if groups < MIN_GROUPS => Some(format!(
                    "no intervals: a bootstrap of {groups} {units} understates the scatter; expected at least {MIN_GROUPS} {units}, or \
                     {instead}"
                )),
                groups if found.is_too_alike() => Some(format!(
                    "no intervals: all curves of the bootstrap of {groups} {units} are the same; expected {units} that differ, or {instead}"
                )),
                _ => None,
            }
        });
        let deviate = self.independence.deviate(self.confidence);
        let profile = LikelihoodProfile::clustered(&self.data, &self.fit, deviate, self.covariance.clone());
        let alike = (self.bootstrap.is_none() && profile.is_too_alike()).then(|| {
            format!(
                "{heading}: the motions agree too well for intervals {}; the intervals are those of independent rows",
                self.units()
            )
        });
        let alone = (self.independence == Independence::OneMotion).then(|| {
            let units = self.units();
            format!("{heading}: no intervals {units}: its rows tell nothing of the scatter of others; expected several")
        });
        let beta = self.fit.dispersion();
        let falls = (beta < 0.0).then(|| {
            format!(
                "{heading}: the probability of exceeding the limit falls as the measure grows (beta {beta:.4}); expected a measure with \
                 which it grows"
            )
        });
        let missing = (self.without_measure > 0)
            .then(|| format!("{heading}: {} rows without the measure are left out of the curve", self.without_measure));
        missing.into_iter().chain(without).chain(alone).chain(alike).chain(falls).collect()
    }

    /// Number of bootstrap samples without a curve, if a bootstrap was made.
    pub fn without_curve(&self) -> Option<usize> {
        self.bootstrap.as_ref().map(|found| found.without)
    }
}

/// The intervals of the median and of the dispersion: those of the bootstrap if there is one. Rows of a single motion do not tell how others
/// scatter.
fn intervals(
    profile: &LikelihoodProfile,
    bootstrap: Option<&Bootstrap>,
    independence: Independence,
    confidence: f64,
) -> [Interval; 2] {
    match bootstrap {
        _ if independence == Independence::OneMotion => [[None; 2]; 2],
        None => [profile.median(), profile.dispersion()],
        Some(found) => [CurveFit::median, CurveFit::dispersion].map(|feature| found.interval(confidence, feature)),
    }
}

/// The data of a list of rows over the first of their measures.
fn data(rows: &[(Case, [f64; 2])], measures: usize) -> Result<Data, CurveFitError> {
    let observation =
        |(case, values): &(Case, [f64; 2])| Observation::with_probability(&values[..measures], case.fraction);
    Data::new(rows.iter().map(observation).collect())
}

/// Standard errors of the coefficients of a fit from their covariance, clustered by motion.
fn standard_errors(covariance: Option<&DMatrix<f64>>, fit: &CurveFit) -> Vec<f64> {
    match covariance {
        Some(covariance) => covariance.diagonal().iter().map(|variance| variance.sqrt()).collect(),
        None => vec![f64::INFINITY; fit.coefficients.len()],
    }
}

/// The surface of two measures with its quality.
pub struct Surface {
    /// Number of cases with values of both.
    pub rows: usize,
    /// The surface.
    pub fit: CurveFit,
    /// [`Assessment::standard_errors`].
    pub standard_errors: Vec<f64>,
    /// Area under the receiver operating characteristic.
    pub auc: f64,
    /// Brier score.
    pub brier: f64,
    /// The rows to draw: all, or some of many.
    pub marks: Vec<Observation>,
}

impl Surface {
    /// Fits a surface to stored cases with values of both measures.
    ///
    /// # Errors
    /// Those of [`Data::new`] and [`Data::fit`].
    pub fn of(store: CaseStore, motions: &Motions, link: Link) -> Result<Surface, CurveFitError> {
        match store.rows(motions)? {
            StoredRows::Few(rows, records) => {
                let data = data(&rows, 2)?;
                let fit = data.fit(link)?;
                let probabilities = fit.probabilities(data.observations());
                let [auc, brier] = [auc, brier].map(|score| score(data.observations(), &probabilities));
                let standard_errors = standard_errors(clusters::covariance(&data, &fit, &records).as_ref(), &fit);
                Ok(Surface { rows: rows.len(), fit, standard_errors, auc, brier, marks: data.observations().to_vec() })
            }
            StoredRows::Many(rows) => {
                let fit = rows.surface(link)?;
                let standard_errors = standard_errors(rows.covariance(&fit, None).as_ref(), &fit);
                let (auc, brier, marks) = rows.quality_of_surface(&fit);
                Ok(Surface { rows: rows.count, fit, standard_errors, auc, brier, marks })
            }
        }
    }
}

/// The [`sufficiency`] of the first measure of stored cases with respect to the second one.
///
/// # Errors
/// Those of [`sufficiency`].
pub fn sufficiency_of(store: CaseStore, motions: &Motions, link: Link) -> Result<f64, CurveFitError> {
    match store.rows(motions)? {
        StoredRows::Few(rows, records) => {
            let others: Vec<f64> = rows.iter().map(|(_, [_, other])| *other).collect();
            sufficiency(&data(&rows, 1)?, &others, link, &records)
        }
        StoredRows::Many(rows) => {
            let (_, curve, _) = rows.curve(link)?;
            let surface = rows.surface(link)?;
            let covariance = rows.covariance(&surface, None);
            Ok(p_value(&curve, &surface, covariance.as_ref(), rows.independence()))
        }
    }
}
