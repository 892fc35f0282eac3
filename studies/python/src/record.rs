//! A file or an array → a record.

use std::io::ErrorKind;
use std::path::PathBuf;

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyPermissionError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rocking_block::excitation::records::Ground;
use rocking_records::{self as engine, Choice, Format, Processing, ReadOptions, RecordError, Unit};
use rocking_studies::input::ground_files::{RecordOption, RecordOptions};
use rocking_studies::input::motion::{self, Motion};
use rocking_studies::intensity::{self as measures_of, Measure, PERIODS, pga, pgv};
use rocking_studies::pulse_fit::{self, PulseFit};
use rocking_studies::spec::records::FileSpec;

use crate::block::hash;
use crate::options::{choice, finite, invalid, unspelled, whole};

/// The samples of a record; the Python class of the same name adds the methods.
#[pyclass(frozen, subclass, module = "rocking_block._engine")]
pub struct Record {
    pub record: engine::Record,
    /// Returns the samples as a read-only array.
    acceleration: Py<PyArray1<f64>>,
}

impl Record {
    fn of(py: Python, record: engine::Record) -> PyResult<Record> {
        let acceleration = PyArray1::from_slice(py, &record.acceleration);
        let flags = PyDict::new(py);
        flags.set_item("write", false)?;
        acceleration.call_method("setflags", (), Some(&flags))?;
        Ok(Record { record, acceleration: acceleration.unbind() })
    }
}

#[pymethods]
impl Record {
    #[new]
    #[pyo3(signature = (acceleration, dt, name="", start=0.0))]
    fn new(py: Python, acceleration: PyReadonlyArray1<f64>, dt: f64, name: &str, start: f64) -> PyResult<Record> {
        finite("dt", dt, |x| x > 0.0, "a time > 0 s")?;
        finite("start", start, |_| true, "a finite time")?;
        let acceleration = acceleration.as_array().to_vec();
        if acceleration.len() < 2 {
            let found = acceleration.len();
            return Err(PyValueError::new_err(format!("acceleration has {found} samples; expected at least two")));
        }
        if let Some((i, a)) = acceleration.iter().enumerate().find(|(_, a)| !a.is_finite()) {
            return Err(PyValueError::new_err(format!("acceleration[{i}] = {a}; expected a finite number")));
        }
        let record = engine::Record {
            title: name.into(),
            format: Format::Columns,
            unit: Unit::MetrePerSecondSquared,
            start_time: start,
            time_step: dt,
            acceleration: acceleration.into(),
            processing: Processing::default(),
        };
        Record::of(py, record)
    }

    fn __getnewargs__(&self, py: Python) -> (Py<PyArray1<f64>>, f64, &str, f64) {
        (self.acceleration.clone_ref(py), self.record.time_step, &self.record.title, self.record.start_time)
    }

    fn __eq__(&self, other: &Bound<PyAny>) -> bool {
        let Ok(other) = other.cast::<Record>() else { return false };
        let other = &other.get().record;
        let engine::Record { title, start_time, time_step, acceleration, .. } = &self.record;
        (title, start_time, time_step, acceleration)
            == (&other.title, &other.start_time, &other.time_step, &other.acceleration)
    }

    fn __hash__(&self) -> u64 {
        let engine::Record { title, start_time, time_step, acceleration, .. } = &self.record;
        let bits = |value: &f64| (value + 0.0).to_bits();
        let samples: Vec<u64> = acceleration.iter().map(bits).collect();
        hash((title, bits(start_time), bits(time_step), samples))
    }

    fn __len__(&self) -> usize {
        self.record.acceleration.len()
    }

    #[getter]
    fn acceleration(&self, py: Python) -> Py<PyArray1<f64>> {
        self.acceleration.clone_ref(py)
    }

    #[getter]
    fn dt(&self) -> f64 {
        self.record.time_step
    }

    #[getter]
    fn name(&self) -> &str {
        &self.record.title
    }

    #[getter]
    fn start(&self) -> f64 {
        self.record.start_time
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.record.duration()
    }

    /// Returns samples and time step (s) of the processed record, and the changes in words.
    #[pyo3(signature = (baseline, band_pass, resample))]
    fn _processed(
        &self,
        py: Python,
        baseline: bool,
        band_pass: Option<[f64; 2]>,
        resample: Option<f64>,
    ) -> PyResult<(Py<PyArray1<f64>>, f64, String)> {
        let processing = Processing { baseline, band_pass, resample };
        let record = self.record.clone();
        let record = py.detach(|| processing.apply(record)).map_err(PyValueError::new_err)?;
        Ok((PyArray1::from_slice(py, &record.acceleration).unbind(), record.time_step, processing.to_string()))
    }

    #[getter]
    fn pga(&self) -> f64 {
        pga(&self.record)
    }

    #[getter]
    fn pgv(&self) -> f64 {
        pgv(&self.record)
    }
}

/// Returns the requested intensity measures of a record. Sa and Sv are at each of `periods` (s), the others have no period.
pub fn measures(periods: &[f64]) -> PyResult<Vec<Measure>> {
    check_periods(periods).map(|()| Measure::of_record(periods))
}

/// Refuses periods out of range.
pub fn check_periods(periods: &[f64]) -> PyResult<()> {
    periods
        .iter()
        .try_for_each(|&period| finite("period", period, |x| PERIODS.contains(&x), "a time from 0.001 to 1000 s"))
}

/// Returns the name and value of each intensity measure of a record.
#[pyfunction]
pub fn intensity(py: Python, record: &Bound<Record>, periods: Vec<f64>, g: f64) -> PyResult<Vec<(String, f64)>> {
    finite("g", g, |x| x > 0.0, "an acceleration > 0 m/s2")?;
    let (record, measures) = (&record.get().record, measures(&periods)?);
    let evaluate = |measure: &Measure| (measure.to_string(), measure.of(record, g).unwrap_or(f64::NAN));
    Ok(py.detach(|| measures.iter().map(evaluate).collect()))
}

/// A column or a channel of a file, by its name or its number from 1.
#[derive(FromPyObject)]
pub enum ChoiceOption {
    Number(i64),
    Name(String),
}

impl ChoiceOption {
    /// Returns the choice of the parameter `name`.
    fn checked(self, name: &str) -> PyResult<Choice> {
        Ok(match self {
            ChoiceOption::Number(number) => Choice::Number(whole(name, number, 1..=100_000)? as usize),
            ChoiceOption::Name(name) => Choice::Name(name),
        })
    }
}

/// Returns samples and title of a component. It is at `angle` (degrees) from a record towards a transverse one.
#[pyfunction]
pub fn rotate(
    py: Python,
    record: &Bound<Record>,
    transverse: &Bound<Record>,
    angle: f64,
) -> PyResult<(Py<PyArray1<f64>>, String)> {
    let rotated = measures_of::rotated(&record.get().record, &transverse.get().record, angle);
    let engine::Record { acceleration, title, .. } = rotated.map_err(PyValueError::new_err)?;
    Ok((PyArray1::from_slice(py, &acceleration).unbind(), title))
}

/// Returns each intensity measure's name and a percentile of it over all directions of two components.
#[pyfunction]
pub fn rot_d(
    py: Python,
    record: &Bound<Record>,
    transverse: &Bound<Record>,
    percentile: f64,
    periods: Vec<f64>,
    g: f64,
) -> PyResult<Vec<(String, f64)>> {
    finite("g", g, |x| x > 0.0, "an acceleration > 0 m/s2")?;
    finite("percentile", percentile, |x| (0.0..=100.0).contains(&x), "a number from 0 to 100")?;
    let (pair, measures) = ([&record.get().record, &transverse.get().record], measures(&periods)?);
    let evaluate = |measure: &Measure| {
        let [value] = measures_of::rot_d(*measure, pair, [percentile], g)?.unwrap_or([f64::NAN]);
        Ok((measure.to_string(), value))
    };
    py.detach(|| measures.iter().map(evaluate).collect::<Result<_, String>>()).map_err(PyValueError::new_err)
}

/// Returns the value of a unit (m/s²), with this gravity for g (m/s²).
#[pyfunction]
pub fn unit_factor(unit: &str, g: f64) -> PyResult<f64> {
    finite("g", g, |x| x > 0.0, "an acceleration > 0 m/s2")?;
    Ok(unit.parse::<Unit>().map_err(invalid)?.factor(g))
}

/// Returns the pulse fitted to a record: amplitude, period, start, phase, cycles and R²; `None` if none fits.
#[pyfunction]
pub fn fit_pulse(py: Python, record: &Bound<Record>, shape: &str) -> PyResult<Option<[f64; 6]>> {
    let shape = choice("shape", shape, &pulse_fit::SHAPES)?;
    let record = &record.get().record;
    let found = py.detach(|| pulse_fit::fit(record, shape));
    Ok(found.map(|PulseFit { pulse, r_squared }| {
        [pulse.amplitude, pulse.period, pulse.start, pulse.phase, pulse.cycles, r_squared]
    }))
}

/// Samples, time step (s), title and start (s) of a file. The last one is the reason to doubt them, if any.
type Reading = (Py<PyArray1<f64>>, f64, String, f64, Option<String>);

/// Reads a record from a file.
#[pyfunction]
#[pyo3(signature = (path, *, unit, dt, format, channel, layout, skip, npts, value_scale, time_column, acceleration_column, g))]
#[allow(clippy::too_many_arguments)]
pub fn read_record(
    py: Python,
    path: PathBuf,
    unit: Option<String>,
    dt: Option<f64>,
    format: Option<String>,
    channel: Option<ChoiceOption>,
    layout: Option<String>,
    skip: Option<i64>,
    npts: Option<i64>,
    value_scale: Option<f64>,
    time_column: Option<ChoiceOption>,
    acceleration_column: Option<ChoiceOption>,
    g: f64,
) -> PyResult<Reading> {
    let spec = FileSpec {
        unit,
        dt,
        format,
        channel: channel.map(|channel| channel.checked("channel")).transpose()?,
        layout,
        skip: skip.map(|lines| whole("skip", lines, 0..=100_000)).transpose()?,
        npts: npts.map(|values| whole("npts", values, 2..=100_000_000)).transpose()?,
        value_scale,
        acceleration_column: acceleration_column.map(|column| column.checked("acceleration_column")).transpose()?,
        time_column: time_column.map(|column| column.checked("time_column")).transpose()?,
    };
    let options = ReadOptions { gravity: g, ..spec.options().map_err(unspelled)? };
    let (record, doubt) = py.detach(|| engine::read_with_doubt(&path, &options)).map_err(refused)?;
    let record_options = RecordOptions { both: options, ..RecordOptions::default() };
    let ground = Ground { horizontal: Some(record.clone()), vertical: None };
    if let Some((name, needed)) = record_options.unread(&[ground]) {
        return Err(PyValueError::new_err(format!("{} has no effect without {needed}", name.key())));
    }
    let engine::Record { title, start_time, time_step, acceleration, .. } = record;
    Ok((PyArray1::from_slice(py, &acceleration).unbind(), time_step, title, start_time, doubt))
}

/// Converts errors of the operating system to an `OSError`. Errors in a file become a `ValueError`.
fn refused(error: RecordError) -> PyErr {
    let message = error.to_string();
    match &error {
        RecordError::Unreadable { error, .. } => match error.kind() {
            ErrorKind::NotFound => PyFileNotFoundError::new_err(message),
            ErrorKind::PermissionDenied => PyPermissionError::new_err(message),
            _ => PyOSError::new_err(message),
        },
        _ => PyValueError::new_err(error.naming(|setting| RecordOption { setting, vertical: false }.key())),
    }
}

/// A horizontal and a vertical record; each may be missing.
pub type Pair<'py> = (Option<Bound<'py, Record>>, Option<Bound<'py, Record>>);

/// Returns a word for the ground motion of each pair of records with these names. `None` if the names tell the motions as well.
#[pyfunction]
pub fn motion_words(pairs: Vec<Pair<'_>>, names: Vec<[String; 2]>) -> PyResult<Option<Vec<String>>> {
    let grounds = pairs.iter().map(|(horizontal, vertical)| ground(horizontal.as_ref(), vertical.as_ref(), 1.0));
    let grounds: Vec<Ground> = grounds.collect::<PyResult<_>>()?;
    let motions = Motion::of_grounds(grounds.iter().zip(&names).map(|(ground, names)| (ground, names, names)));
    Ok(motion::column(&motions, names.iter().map(|names| names.each_ref().map(String::as_str))))
}

/// Horizontal and vertical ground motion, scaled.
pub fn ground(horizontal: Option<&Bound<Record>>, vertical: Option<&Bound<Record>>, scale: f64) -> PyResult<Ground> {
    finite("scale", scale, |_| true, "a finite factor")?;
    let record = |record: Option<&Bound<Record>>| record.map(|record| record.get().record.clone());
    Ok(Ground { horizontal: record(horizontal), vertical: record(vertical) }.scaled(scale))
}
