//! Words and numbers of Python → settings and pulses of the engine.

use std::ops::RangeInclusive;

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::ThreadPool;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::{OnOverturning, OnSeparation, Settings};
use rocking_block::words::Words;
use rocking_studies::output::runner;
use rocking_studies::run::{MAX_DURATION, MIN_STEP};

/// Converts an error of the engine to a `ValueError` with the same message.
pub fn invalid(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Returns the choice of a word in any case; the error lists the words of all choices.
pub fn choice<T: Words>(name: &str, found: &str, choices: &[T]) -> PyResult<T> {
    T::named(found).filter(|choice| choices.contains(choice)).ok_or_else(|| {
        let known: Vec<String> = choices.iter().map(|choice| format!("\"{}\"", choice.word())).collect();
        PyValueError::new_err(format!("{name} = \"{found}\"; expected one of {}", known.join(", ")))
    })
}

/// Returns an error that names a value.
pub fn finite(name: &str, value: f64, fits: impl Fn(f64) -> bool, expected: &str) -> PyResult<()> {
    if value.is_finite() && fits(value) {
        return Ok(());
    }
    Err(PyValueError::new_err(format!("{name} = {value}; expected {expected}")))
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
        finite("tolerance", self.tolerance, Settings::admits_tolerance, Settings::EXPECTED_TOLERANCE)?;
        Ok(Settings {
            tolerance: self.tolerance,
            on_separation: choice("on_separation", &self.on_separation, &separations)?,
            on_overturning: choice("on_overturning", &self.on_overturning, &overturnings)?,
        })
    }

    /// Checks that the duration is finite and the stops are not too close.
    pub fn check_times(&self) -> PyResult<()> {
        if let Some(duration) = self.duration {
            finite("duration", duration, |x| x > 0.0 && x <= MAX_DURATION, "a time > 0 s, at most 1e6 s")?;
        }
        match self.step {
            Some(step) => finite("step", step, |x| x >= MIN_STEP, "a time of at least 1e-6 s"),
            None => Ok(()),
        }
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
    /// Returns the pulse; a missing amplitude is replaced by `instead`.
    fn pulse(&self, instead: Option<f64>) -> PyResult<Pulse> {
        let shapes = PulseShape::WORDS.iter().map(|(_, shape)| *shape).filter(|&shape| shape != PulseShape::None);
        let shape = choice("shape", &self.shape, &shapes.collect::<Vec<_>>())?;
        let amplitude = instead.or(self.amplitude);
        let missing = || PyValueError::new_err("amplitude is missing; expected that of the pulse, a_p [m/s2]");
        let amplitude = amplitude.ok_or_else(missing)?;
        let PulseOptions { period, start, phase, cycles, .. } = *self;
        finite("amplitude", amplitude, |_| true, "a finite acceleration")?;
        finite("period", period, |x| x > 0.0, "a time > 0 s")?;
        finite("start", start, |_| true, "a finite time")?;
        finite("phase", phase, |_| true, "a finite angle")?;
        finite("cycles", cycles, |x| x >= 1.0, "a number of at least 1")?;
        for (name, value, default) in [("phase", phase, Pulse::NONE.phase), ("cycles", cycles, Pulse::NONE.cycles)] {
            if shape != PulseShape::Gabor && value != default {
                let message =
                    format!("{name} = {value} has no effect on a {} pulse; expected it with \"gabor\"", shape.word());
                return Err(PyValueError::new_err(message));
            }
        }
        Ok(Pulse { shape, amplitude, period, start, phase, cycles })
    }

    /// Returns the pulse of an option that may be missing.
    pub fn pulse_or_none(pulse: Option<&PulseOptions>) -> PyResult<Pulse> {
        pulse.map_or(Ok(Pulse::NONE), |pulse| pulse.pulse(None))
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
    let pulse = pulse.pulse(None)?;
    Ok(times.into_iter().map(|time| pulse.acceleration(time)).collect())
}

/// Returns the duration of a pulse (s).
#[pyfunction]
pub fn pulse_duration(pulse: PulseOptions) -> PyResult<f64> {
    Ok(pulse.without_amplitude()?.duration())
}
