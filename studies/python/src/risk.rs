//! A hazard curve and a fragility curve → an annual rate.

use std::path::PathBuf;

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use rocking_studies::fragility::Interval;
use rocking_studies::intensity;
use rocking_studies::risk::{self, AnnualRate as Rate, FragilityCurve, HazardCurve, HazardOptions};

use crate::fragility::Fragility;
use crate::measures::{behind, column};
use crate::options::{finite, invalid};

/// Levels, rates, measure, unit and remarks of a hazard curve.
type Hazard<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Option<String>, Option<String>, Vec<String>);

fn fields<'py>(py: Python<'py>, curve: &HazardCurve) -> Hazard<'py> {
    let [levels, rates] = [curve.levels(), curve.rates()].map(|all| PyArray1::from_slice(py, all));
    (levels, rates, curve.measure.clone(), curve.unit.clone(), curve.remarks.clone())
}

/// Reads the hazard curve of a file.
#[pyfunction]
#[pyo3(signature = (path, *, im, unit, site, investigation_time, kind, g))]
#[allow(clippy::too_many_arguments)]
pub fn read_hazard(
    py: Python<'_>,
    path: PathBuf,
    im: Option<String>,
    unit: Option<String>,
    site: Option<String>,
    investigation_time: Option<f64>,
    kind: Option<String>,
    g: f64,
) -> PyResult<Hazard<'_>> {
    finite("g", g, |x| x > 0.0, "an acceleration above 0")?;
    let text = std::fs::read_to_string(&path)?;
    let options = HazardOptions { measure: im, unit, site, years: investigation_time, kind, gravity: g };
    let name = path.display().to_string();
    let curve = risk::read_hazard(&name, &text, &options).map_err(|error| invalid(format!("{name}: {error}")))?;
    Ok(fields(py, &curve))
}

/// Checks levels and rates, and converts the levels to the SI unit of their unit.
#[pyfunction]
pub fn check_hazard<'py>(
    py: Python<'py>,
    levels: PyReadonlyArray1<f64>,
    rates: PyReadonlyArray1<f64>,
    unit: Option<&str>,
    g: f64,
) -> PyResult<Hazard<'py>> {
    let mut curve = hazard(&levels, &rates)?;
    curve.unit = unit.map(String::from);
    if let Some((unit, factor)) = unit.and_then(|unit| intensity::si(unit, g)) {
        curve = curve.scaled(factor);
        curve.unit = Some(unit.into());
    }
    Ok(fields(py, &curve))
}

fn hazard(levels: &PyReadonlyArray1<f64>, rates: &PyReadonlyArray1<f64>) -> PyResult<HazardCurve> {
    HazardCurve::new(&levels.as_array().to_vec(), &rates.as_array().to_vec()).map_err(invalid)
}

/// Returns a hazard curve over the measure of a fragility curve, in its unit.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn hazard_over<'py>(
    py: Python<'py>,
    levels: PyReadonlyArray1<f64>,
    rates: PyReadonlyArray1<f64>,
    im: &str,
    unit: &str,
    over: (String, String),
    alpha: Option<f64>,
    p: Option<f64>,
    g: f64,
) -> PyResult<Hazard<'py>> {
    let mut curve = hazard(&levels, &rates)?;
    let known = |word: &str| Some(word.to_string()).filter(|word| !word.is_empty());
    (curve.measure, curve.unit) = (known(im), known(unit));
    let column = column(&over);
    let curve = curve.over(&column, &behind(&column, alpha, p, g)?).map_err(invalid)?;
    Ok(fields(py, &curve))
}

/// An annual rate; the Python class of the same name has the documentation.
#[pyclass(frozen, subclass, module = "rocking_block._engine")]
pub struct AnnualRate {
    result: Rate,
    interval: Option<Interval>,
}

#[pymethods]
impl AnnualRate {
    /// Integrates a curve over the hazard. It is a fitted one, a lognormal one of a median and a dispersion, or a table of levels and
    /// probabilities.
    #[new]
    #[pyo3(signature = (levels, rates, fit, lognormal, table))]
    fn new(
        py: Python,
        levels: PyReadonlyArray1<f64>,
        rates: PyReadonlyArray1<f64>,
        fit: Option<PyRef<Fragility>>,
        lognormal: Option<(f64, f64)>,
        table: Option<(PyReadonlyArray1<f64>, PyReadonlyArray1<f64>)>,
    ) -> PyResult<AnnualRate> {
        let hazard = hazard(&levels, &rates)?;
        let curve = match (&fit, lognormal, table) {
            (Some(fit), ..) => FragilityCurve::of(&fit.0.fit),
            (None, Some((median, beta)), _) => FragilityCurve::lognormal(median, beta),
            (None, None, Some((levels, probabilities))) => {
                FragilityCurve::tabulated(&levels.as_array().to_vec(), &probabilities.as_array().to_vec())
            }
            (None, None, None) => return Err(invalid("no fragility curve")),
        };
        let curve = curve.map_err(invalid)?;
        let interval = fit.as_deref().map(|fit| {
            let assessment = &fit.0;
            py.detach(|| risk::interval(&hazard, assessment))
        });
        let result = Rate::new(&hazard, &curve);
        if !result.rate.is_finite() {
            let message = "found a hazard that grows faster towards small measures than the logistic curve falls; expected a hazard \
                           curve from lower levels, or link = \"probit\"";
            return Err(invalid(message));
        }
        Ok(AnnualRate { result, interval })
    }

    #[getter]
    fn rate(&self) -> f64 {
        self.result.rate
    }

    #[getter]
    fn rate_ci(&self) -> Option<(f64, f64)> {
        self.interval.map(|[low, high]| (low.unwrap_or(0.0), high.unwrap_or(f64::INFINITY)))
    }

    #[getter]
    fn below_hazard(&self) -> f64 {
        self.result.below_hazard
    }

    #[getter]
    fn above_hazard(&self) -> f64 {
        self.result.above_hazard
    }

    fn between(&self, low: f64, high: f64) -> PyResult<f64> {
        finite("low", low, |x| x >= 0.0, "a measure of at least 0")?;
        if high.is_nan() || high < low {
            return Err(invalid(format!("high = {high}; expected a measure of at least low = {low}")));
        }
        Ok(self.result.between(low, high))
    }

    fn quantile(&self, share: f64) -> PyResult<f64> {
        finite("share", share, |x| x > 0.0 && x < 1.0, "a number above 0 and below 1")?;
        Ok(self.result.quantile(share).unwrap_or(f64::NAN))
    }

    /// Returns lower ends, upper ends, rates and shares of the parts.
    fn parts<'py>(&self, py: Python<'py>) -> [Bound<'py, PyArray1<f64>>; 4] {
        let parts = self.result.deaggregation();
        [
            parts.iter().map(|part| part.from).collect::<Vec<_>>(),
            parts.iter().map(|part| part.to).collect(),
            parts.iter().map(|part| part.rate).collect(),
            parts.iter().map(|part| part.fraction).collect(),
        ]
        .map(|column| PyArray1::from_vec(py, column))
    }

    fn probability(&self, years: f64) -> PyResult<f64> {
        finite("years", years, |x| x > 0.0, "a number of years above 0")?;
        Ok(risk::probability_in(years, self.result.rate))
    }
}
