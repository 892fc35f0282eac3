//! Words and numbers of Python → settings and pulses of the engine.

use std::ffi::CString;
use std::ops::RangeInclusive;

use pyo3::exceptions::{PyRuntimeError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use rayon::ThreadPool;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::{OnOverturning, OnSeparation, Settings};
use rocking_studies::output::runner;
use rocking_studies::spec::words::{Words, friction};
use rocking_studies::spec::{GaborSpec, PulseSpec, SingleRunSpec, SpecError};

/// Converts an error of the engine to a `ValueError` with the same message.
pub fn invalid(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Converts an error of a specification, whose names are those of Python.
pub fn unspelled(error: SpecError) -> PyErr {
    PyValueError::new_err(error.spelled(str::to_owned))
}

/// Returns the choice of a word in any case. The error lists the words of all choices.
pub fn choice<T: Words>(name: &str, found: &str, choices: &[T]) -> PyResult<T> {
    T::named(found).filter(|choice| choices.contains(choice)).ok_or_else(|| {
        let known: Vec<String> = choices.iter().map(|choice| format!("\"{}\"", choice.word())).collect();
        PyValueError::new_err(format!("{name} = \"{found}\"; expected one of {}", known.join(", ")))
    })
}

/// Gives warnings; `stack_level` selects the line that they name: 1 is that of the caller.
pub fn warn(py: Python, messages: impl IntoIterator<Item = String>, stack_level: i32) -> PyResult<()> {
    messages
        .into_iter()
        .try_for_each(|message| PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(message)?, stack_level))
}

/// Returns an error that names a value.
pub fn finite(name: &str, value: f64, fits: impl Fn(f64) -> bool, expected: &str) -> PyResult<()> {
    if value.is_finite() && fits(value) {
        return Ok(());
    }
    Err(PyValueError::new_err(format!("{name} = {value}; expected {expected}")))
}

/// Returns the friction of a block of the engine; `None` or infinity is no limit.
pub fn friction_of_block(value: Option<f64>) -> PyResult<f64> {
    let value = value.unwrap_or(f64::INFINITY);
    let expected = "a number > 0, or None for no limit; a block without any friction has no foot to rock about";
    friction::of_user(value).map_err(|_| PyValueError::new_err(format!("friction = {value}; expected {expected}")))
}

/// Returns a whole number in a range, both ends included.
pub fn whole(name: &str, value: i64, range: RangeInclusive<i64>) -> PyResult<u64> {
    match u64::try_from(value) {
        Ok(found) if range.contains(&value) => Ok(found),
        _ => {
            let (from, to) = range.into_inner();
            Err(PyValueError::new_err(format!("{name} = {value}; expected a whole number from {from} to {to}")))
        }
    }
}

/// Returns a pool with this number of threads; by default one per core.
pub fn pool(threads: Option<i64>) -> PyResult<ThreadPool> {
    let threads = threads.map(|threads| whole("threads", threads, 1..=1024)).transpose()?;
    runner::pool(threads.map(|threads| threads as usize)).map_err(|error| PyRuntimeError::new_err(error.to_string()))
}

/// Options of a run: a dictionary with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct RunOptions {
    tolerance: f64,
    on_separation: String,
    on_overturning: String,
    /// Duration (s); by default until the block has come down.
    pub duration: Option<f64>,
    /// Time between rows, or the longest time between two stops (s).
    pub step: Option<f64>,
}

impl RunOptions {
    /// Returns the settings of the engine.
    pub fn settings(&self) -> PyResult<Settings> {
        let separations = [OnSeparation::Terminate, OnSeparation::Hold, OnSeparation::Fly];
        let overturnings = [OnOverturning::Terminate, OnOverturning::Hold];
        let RunOptions { tolerance, duration, step, .. } = *self;
        let spec = SingleRunSpec { tolerance: Some(tolerance), duration, step };
        let settings = spec.settings(choice("on_separation", &self.on_separation, &separations)?).map_err(unspelled)?;
        Ok(Settings { on_overturning: choice("on_overturning", &self.on_overturning, &overturnings)?, ..settings })
    }
}

/// The attributes of a `rocking_block.Pulse`.
#[derive(FromPyObject)]
pub struct PulseOptions {
    shape: String,
    amplitude: Option<f64>,
    period: f64,
    start: f64,
    phase: f64,
    cycles: f64,
}

impl PulseOptions {
    /// Returns the pulse with this amplitude.
    fn pulse(&self, amplitude: Option<f64>) -> PyResult<Pulse> {
        let shapes = PulseShape::WORDS.iter().map(|(_, shape)| *shape).filter(|&shape| shape != PulseShape::None);
        let shape = choice("shape", &self.shape, &shapes.collect::<Vec<_>>())?;
        let missing = || PyValueError::new_err("amplitude is missing; expected that of the pulse, a_p [m/s2]");
        let amplitude = amplitude.ok_or_else(missing)?;
        // The defaults of other shapes are theirs, too.
        let of_gabor = |value: f64, default: f64| (value != default).then_some(value);
        let gabor = GaborSpec {
            phase: of_gabor(self.phase, Pulse::NONE.phase),
            cycles: of_gabor(self.cycles, Pulse::NONE.cycles),
        };
        let (period, start) = (Some(self.period), Some(self.start));
        let spec = PulseSpec { shape: Some(shape), amplitude: None, period, start, gabor };
        let spelled = |name: &str| match name {
            "pulse = gabor" => "shape = \"gabor\"".into(),
            name => name.into(),
        };
        spec.with_amplitude(Some(amplitude)).map_err(|error| PyValueError::new_err(error.spelled(spelled)))
    }

    /// Returns the pulse of an option that may be missing.
    pub fn pulse_or_none(pulse: Option<&PulseOptions>) -> PyResult<Pulse> {
        pulse.map_or(Ok(Pulse::NONE), |pulse| pulse.pulse(pulse.amplitude))
    }

    /// Returns the pulse for a search over its amplitude.
    pub fn without_amplitude(&self) -> PyResult<Pulse> {
        self.pulse(Some(0.0))
    }
}

/// Checks a pulse; its amplitude may be missing.
#[pyfunction]
pub fn check_pulse(pulse: PulseOptions) -> PyResult<()> {
    pulse.pulse(pulse.amplitude.or(Some(0.0))).map(|_| ())
}

/// Returns the ground accelerations of a pulse at these times (m/s²).
#[pyfunction]
pub fn pulse_acceleration(pulse: PulseOptions, times: Vec<f64>) -> PyResult<Vec<f64>> {
    let pulse = pulse.pulse(pulse.amplitude)?;
    Ok(times.into_iter().map(|time| pulse.acceleration(time)).collect())
}

/// Returns the duration of a pulse (s).
#[pyfunction]
pub fn pulse_duration(pulse: PulseOptions) -> PyResult<f64> {
    Ok(pulse.without_amplitude()?.duration())
}
