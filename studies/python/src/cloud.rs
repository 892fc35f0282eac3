//! Rows over an intensity measure → clouds and stripes.

use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use rocking_studies::fragility::{self as engine, CloudColumns, CloudRow, Share, ShareCurve, Stripe};

use crate::fragility::{Ends, at, ends};
use crate::options::{finite, invalid, pool};

/// A cloud with its rows; the Python class of the same name has the documentation of its numbers.
#[pyclass(frozen, module = "rocking_block._engine")]
pub struct Cloud {
    found: engine::Cloud,
    rows: Vec<CloudRow>,
    columns: CloudColumns,
}

/// Arguments of [`Cloud::new`].
type Arguments<'py> = (
    String,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i64>>,
    Vec<String>,
    Bound<'py, PyArray2<f64>>,
    f64,
    Option<String>,
);

/// Measures, whether rows do, and the numbers of their motions.
type Cases<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<bool>>, Bound<'py, PyArray1<i64>>);

#[pymethods]
impl Cloud {
    /// Fits a cloud to rows with these measures, overturned or not, peaks of those that rock and stand, and numbers of their ground motions,
    /// negative for rows with their own. A missing number is nan. `beside` has a row of numbers for each of the named properties.
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        im: String,
        measures: PyReadonlyArray1<f64>,
        overturned: PyReadonlyArray1<bool>,
        peaks: PyReadonlyArray1<f64>,
        motions: PyReadonlyArray1<i64>,
        names: Vec<String>,
        beside: PyReadonlyArray2<f64>,
        ci: f64,
        cluster: Option<String>,
    ) -> PyResult<Cloud> {
        finite("ci", ci, |x| x > 0.0 && x < 1.0, "a number above 0 and below 1")?;
        let known = |value: f64| Some(value).filter(|value| !value.is_nan());
        let (measures, overturned, peaks) = (measures.as_array(), overturned.as_array(), peaks.as_array());
        let (motions, beside) = (motions.as_array(), beside.as_array());
        let row = |row: usize| CloudRow {
            measure: known(measures[row]),
            overturned: overturned[row],
            peak: known(peaks[row]),
            motion: usize::try_from(motions[row]).ok(),
            beside: beside.column(row).iter().map(|&number| known(number)).collect(),
        };
        let rows: Vec<CloudRow> = (0..measures.len()).map(row).collect();
        let columns = CloudColumns { im, beside: names, cluster };
        let pool = pool(None)?;
        let found = py.detach(|| pool.install(|| engine::Cloud::of(&rows, &columns, ci))).map_err(invalid)?;
        Ok(Cloud { found, rows, columns })
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> Arguments<'py> {
        let rows = self.rows.iter();
        let numbers = |of: fn(&CloudRow) -> Option<f64>| {
            PyArray1::from_iter(py, self.rows.iter().map(move |row| of(row).unwrap_or(f64::NAN)))
        };
        let CloudColumns { im, beside, cluster } = self.columns.clone();
        let of_rows = rows.clone().map(|row| row.motion.map_or(-1, |motion| motion as i64));
        let mut properties = numpy::ndarray::Array2::zeros((beside.len(), self.rows.len()));
        for ((property, row), number) in properties.indexed_iter_mut() {
            *number = self.rows[row].beside[property].unwrap_or(f64::NAN);
        }
        (
            im,
            numbers(|row| row.measure),
            PyArray1::from_iter(py, rows.clone().map(|row| row.overturned)),
            numbers(|row| row.peak),
            PyArray1::from_iter(py, of_rows),
            beside,
            PyArray2::from_owned_array(py, properties),
            self.found.confidence,
            cluster,
        )
    }

    #[getter]
    fn coefficients(&self) -> (f64, f64) {
        self.found.line.coefficients.into()
    }

    #[getter]
    fn deviation(&self) -> f64 {
        self.found.line.deviation
    }

    #[getter]
    fn standard_errors(&self) -> (f64, f64) {
        self.found.line.standard_errors.into()
    }

    #[getter]
    fn intervals(&self) -> (Ends, Ends) {
        self.found.intervals.map(|interval| ends(interval, f64::NEG_INFINITY, f64::INFINITY)).into()
    }

    #[getter]
    fn independence(&self) -> String {
        self.found.units()
    }

    #[getter]
    fn r_squared(&self) -> f64 {
        self.found.r_squared
    }

    #[getter]
    fn proficiency(&self) -> f64 {
        self.found.proficiency()
    }

    #[getter]
    fn unknown(&self) -> usize {
        self.found.unknown
    }

    /// Slope and p-value of each property.
    #[getter]
    fn sufficiency(&self) -> Vec<(f64, f64)> {
        self.found.sufficiency.iter().map(|(_, test)| (test.slope, test.p)).collect()
    }

    /// Measures and peaks behind the line.
    fn points<'py>(&self, py: Python<'py>) -> [Bound<'py, PyArray1<f64>>; 2] {
        [0, 1].map(|i| PyArray1::from_iter(py, self.found.points.iter().map(move |point| point[i])))
    }

    fn warnings(&self) -> Vec<String> {
        self.found.warnings()
    }

    /// Returns the median rotations at measures above zero.
    fn medians<'py>(&self, py: Python<'py>, measures: PyReadonlyArray1<f64>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let medians = at(&measures)?.into_iter().map(|measure| self.found.median(measure));
        Ok(PyArray1::from_iter(py, medians))
    }

    /// Returns the probabilities of exceeding a rotation above zero at measures above zero.
    fn exceedances<'py>(
        &self,
        py: Python<'py>,
        rotation: f64,
        measures: PyReadonlyArray1<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let exceedances = at(&measures)?.into_iter().map(|measure| self.found.exceedance(rotation, measure));
        Ok(PyArray1::from_iter(py, exceedances))
    }

    /// Returns the cases of overturning or of rocking.
    fn cases<'py>(&self, py: Python<'py>, is_rocking: bool) -> Cases<'py> {
        let cases = self.share(is_rocking).cases.iter();
        (
            PyArray1::from_iter(py, cases.clone().map(|(measure, ..)| *measure)),
            PyArray1::from_iter(py, cases.clone().map(|(_, does, _)| *does)),
            PyArray1::from_iter(py, cases.map(|(.., motion)| *motion as i64)),
        )
    }

    /// Returns the measure from which all rows overturn or rock, if that is their curve.
    fn threshold(&self, is_rocking: bool) -> Option<f64> {
        match self.share(is_rocking).curve {
            ShareCurve::Step(threshold) => Some(threshold),
            ShareCurve::Logistic(_) => None,
        }
    }

    /// Returns the probabilities of overturning or of rocking at measures above zero.
    fn probabilities<'py>(
        &self,
        py: Python<'py>,
        is_rocking: bool,
        measures: PyReadonlyArray1<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let share = self.share(is_rocking);
        Ok(PyArray1::from_iter(py, at(&measures)?.into_iter().map(|measure| share.probability(measure))))
    }
}

impl Cloud {
    fn share(&self, is_rocking: bool) -> &Share {
        if is_rocking { &self.found.rocking } else { &self.found.overturning }
    }
}

/// Levels, the number of their runs, and the sum of their fractions.
type Stripes<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f64>>);

/// Merges rows with these measures and fractions to levels; `im` is the measure in errors.
#[pyfunction]
pub fn stripes<'py>(
    py: Python<'py>,
    measures: PyReadonlyArray1<f64>,
    fractions: PyReadonlyArray1<f64>,
    im: &str,
) -> PyResult<Stripes<'py>> {
    let rows = measures.as_array().into_iter().zip(fractions.as_array());
    let mut rows: Vec<(f64, f64, usize)> = rows.map(|(&measure, &fraction)| (measure, fraction, 1)).collect();
    rows.sort_by(|(one, ..), (other, ..)| one.total_cmp(other));
    let found = Stripe::all(&rows, im).map_err(invalid)?;
    Ok((
        PyArray1::from_iter(py, found.iter().map(|stripe| stripe.level)),
        PyArray1::from_iter(py, found.iter().map(|stripe| stripe.runs as i64)),
        PyArray1::from_iter(py, found.iter().map(|stripe| stripe.exceeded)),
    ))
}

/// Rows of levels, and whether their runs exceed the limit.
type Unrolled<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<bool>>);

/// Returns the level of each run, and whether it exceeds the limit, from the counts at levels.
#[pyfunction]
pub fn unrolled<'py>(
    py: Python<'py>,
    runs: PyReadonlyArray1<f64>,
    exceeded: PyReadonlyArray1<f64>,
) -> PyResult<Unrolled<'py>> {
    let rows = engine::unrolled(&runs.as_array().to_vec(), &exceeded.as_array().to_vec()).map_err(invalid)?;
    Ok((
        PyArray1::from_iter(py, rows.iter().map(|(row, _)| *row as i64)),
        PyArray1::from_iter(py, rows.iter().map(|(_, exceeds)| *exceeds)),
    ))
}
