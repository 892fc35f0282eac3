//! What blocks did over how strong the ground moved → a fragility curve.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rocking_block::study::fragility::{
    Bootstrap, Data, Fit, Interval, Link, Observation, Profile, auc, bootstrap, brier,
};

use crate::options::{finite, invalid, whole, word};
use crate::work::wait;

/// Lower and upper end; an end that the data do not bound is that of what is possible.
type Ends = (f64, f64);

/// A curve with what its intervals follow from; the class of the same name in Python adds its documentation.
#[pyclass(frozen, subclass, module = "rocking_block._engine")]
pub struct Fragility {
    data: Data,
    fit: Fit,
    ci: f64,
    /// Curves of resampled records, where the intervals are theirs and not those of the profile likelihood.
    resampled: Option<Bootstrap>,
}

#[pymethods]
impl Fragility {
    /// `groups` are numbers of the records that are resampled; without them intervals are those of the profile likelihood.
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python,
        measures: PyReadonlyArray1<f64>,
        exceeded: PyReadonlyArray1<bool>,
        link: &str,
        ci: f64,
        groups: Option<Vec<usize>>,
        samples: i64,
        seed: i64,
        tick: &Bound<PyAny>,
    ) -> PyResult<Fragility> {
        let link = word("link", link, &[("probit", Link::Probit), ("logit", Link::Logit)])?;
        finite("ci", ci, |x| x > 0.0 && x < 1.0, "a confidence above 0 and below 1, as in 0.95")?;
        let samples = whole("samples", samples, 2..=10_000_000)? as u32;
        let seed = whole("seed", seed, 0..=i64::MAX)?;
        let rows = measures.as_array().into_iter().zip(exceeded.as_array());
        let data = Data::new(rows.map(|(measure, exceeded)| Observation::of(&[*measure], *exceeded)).collect())
            .map_err(invalid)?;
        let fit = data.fit(link).map_err(invalid)?;
        let resampled = match groups {
            Some(groups) => {
                let copy = data.clone();
                let found = wait(py, tick, move |_| bootstrap(&copy, &groups, link, samples, seed))?;
                if found.fits.len() < 2 {
                    let message = format!(
                        "found a curve for {} of {samples} samples of the records; expected at least 2, of more records",
                        found.fits.len()
                    );
                    return Err(PyValueError::new_err(message));
                }
                Some(found)
            }
            None => None,
        };
        Ok(Fragility { data, fit, ci, resampled })
    }

    #[getter]
    fn median(&self) -> f64 {
        self.fit.median()
    }

    #[getter]
    fn beta(&self) -> f64 {
        self.fit.dispersion()
    }

    #[getter]
    fn median_ci(&self) -> PyResult<Ends> {
        let found = match &self.resampled {
            Some(resampled) => resampled.interval(self.ci, Fit::median),
            None => self.profile()?.median(),
        };
        Ok(ends(found, 0.0, f64::INFINITY))
    }

    #[getter]
    fn beta_ci(&self) -> PyResult<Ends> {
        let found = match &self.resampled {
            Some(resampled) => resampled.interval(self.ci, Fit::dispersion),
            None => self.profile()?.dispersion(),
        };
        // The dispersion of a probability that falls as the measure grows is negative.
        let (least, greatest) =
            if self.fit.dispersion() > 0.0 { (0.0, f64::INFINITY) } else { (f64::NEG_INFINITY, 0.0) };
        Ok(ends(found, least, greatest))
    }

    #[getter]
    fn log_likelihood(&self) -> f64 {
        self.fit.log_likelihood
    }

    #[getter]
    fn coefficients(&self) -> (f64, f64) {
        (self.fit.coefficients[0], self.fit.coefficients[1])
    }

    #[getter]
    fn auc(&self) -> f64 {
        let observations = self.data.observations();
        auc(observations, &self.fit.probabilities(observations))
    }

    #[getter]
    fn brier(&self) -> f64 {
        let observations = self.data.observations();
        brier(observations, &self.fit.probabilities(observations))
    }

    /// Probabilities at measures above zero.
    fn probabilities<'py>(
        &self,
        py: Python<'py>,
        measures: PyReadonlyArray1<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let probabilities = at(&measures)?.into_iter().map(|measure| self.fit.probability(&[measure]));
        Ok(PyArray1::from_iter(py, probabilities))
    }

    /// Ends of the interval of the probability at measures above zero, point by point.
    fn intervals<'py>(
        &self,
        py: Python<'py>,
        measures: PyReadonlyArray1<f64>,
    ) -> PyResult<[Bound<'py, PyArray1<f64>>; 2]> {
        let measures = at(&measures)?;
        let of = |interval| ends(interval, 0.0, 1.0);
        let found: Vec<Ends> = match &self.resampled {
            Some(resampled) => {
                let interval = |x: f64| resampled.interval(self.ci, |fit| fit.probability(&[x]));
                measures.into_iter().map(|x| of(interval(x))).collect()
            }
            None => {
                let profile = self.profile()?;
                py.detach(|| measures.into_iter().map(|x| of(profile.probability(x))).collect())
            }
        };
        let (low, high): (Vec<f64>, Vec<f64>) = found.into_iter().unzip();
        Ok([PyArray1::from_vec(py, low), PyArray1::from_vec(py, high)])
    }
}

impl Fragility {
    fn profile(&self) -> PyResult<Profile<'_>> {
        Profile::new(&self.data, &self.fit, self.ci).map_err(invalid)
    }
}

/// Measures of which there is a probability.
fn at(measures: &PyReadonlyArray1<f64>) -> PyResult<Vec<f64>> {
    let measures = measures.as_array().to_vec();
    measures.iter().try_for_each(|&measure| finite("x", measure, |x| x > 0.0, "a measure > 0"))?;
    Ok(measures)
}

fn ends(interval: Interval, least: f64, greatest: f64) -> Ends {
    (interval.low.unwrap_or(least), interval.high.unwrap_or(greatest))
}
