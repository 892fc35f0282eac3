//! Rows of a table at levels of a measure → curves of incremental dynamic analysis.

use numpy::PyArray1;
use pyo3::prelude::*;
use rocking_studies::fragility::{self as engine, Response, SweepTable};

use crate::options::invalid;
use crate::table::{GivenColumn, table};

/// Curves with their fractiles; the Python class of the same name has the documentation. Overturning is an infinite peak, and an unknown one
/// nan.
#[pyclass(frozen, subclass, module = "rocking_block._engine")]
pub struct Ida(engine::Ida);

/// A curve: its name, its levels and the peaks at them.
type Curve<'py> = (String, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

#[pymethods]
impl Ida {
    /// Sorts the rows of a table into curves over the measure of their levels.
    #[new]
    fn new(columns: Vec<GivenColumn>, im: &str) -> PyResult<Ida> {
        let columns = table(columns);
        let headings = columns.headings().iter().map(ToString::to_string).collect();
        let read = SweepTable::batch("table", columns, headings, 0).and_then(|table| engine::Ida::read(&table, im));
        read.map(Ida).map_err(invalid)
    }

    /// The rotation whose peaks the curves have.
    #[getter]
    fn rotation(&self) -> &'static str {
        self.0.rotation
    }

    /// Returns the least level at which a tie or damper breaks of each curve, nan where none does; `None` for blocks without either.
    fn breaking_levels<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let breaks = self.0.breaks.as_ref()?;
        Some(PyArray1::from_iter(py, breaks.iter().map(|level| level.unwrap_or(f64::NAN))))
    }

    /// Returns the levels of the fractiles.
    #[getter]
    fn levels<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.0.levels)
    }

    fn all<'py>(&self, py: Python<'py>) -> Vec<Curve<'py>> {
        let curve = |curve: &engine::IdaCurve| {
            let peaks = curve.responses.iter().map(|response| peak(*response));
            (curve.name.clone(), PyArray1::from_slice(py, &curve.levels), PyArray1::from_iter(py, peaks))
        };
        self.0.curves.iter().map(curve).collect()
    }

    /// Returns the least level that overturns each curve, and the greatest below that does not. Both are nan where none overturns.
    fn brackets(&self) -> Vec<(f64, f64)> {
        let bracket =
            |curve: &engine::IdaCurve| curve.overturning().map_or((f64::NAN, f64::NAN), |[low, high]| (low, high));
        self.0.curves.iter().map(bracket).collect()
    }

    fn peaks<'py>(&self, py: Python<'py>, fraction: f64) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.0.fractile(fraction).into_iter().map(peak))
    }

    /// Returns the least and the greatest level of a fractile, of a peak or of overturning.
    fn level_bounds(&self, fraction: f64, peak: Option<f64>) -> [f64; 2] {
        peak.map_or_else(|| self.0.overturning(fraction), |peak| self.0.reaching(fraction, peak))
    }
}

fn peak(response: Response) -> f64 {
    match response {
        Response::Stands(peak) => peak,
        Response::Overturns => f64::INFINITY,
        Response::Unknown => f64::NAN,
    }
}
