//! A block and its excitation → columns over time.

use numpy::PyArray1;
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use rocking_block::block::restraints::TieState;
use rocking_block::block::{self as engine, Foundation};
use rocking_block::simulation::Initial;
use rocking_block::simulation::peaks::Peaks;
use rocking_gradients::{Grazing, Parameters};
use rocking_studies::doubts;
use rocking_studies::run::gradients::{Derivatives, Gradients};
use rocking_studies::run::outcome::End;
use rocking_studies::run::outcome::Holds;
use rocking_studies::run::table;
use rocking_studies::run::{History, MemoryError, Run, is_moved};

use crate::block::Block;
use crate::options::{PulseOptions, RunOptions, finite, invalid, warn};
use crate::record::{Record, ground};
use crate::work::wait;

/// The initial state of a block: a dictionary with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct InitialValues {
    theta: f64,
    theta_dot: f64,
    v: Option<f64>,
    v_dot: Option<f64>,
}

impl InitialValues {
    /// Returns the initial state of the engine.
    pub fn initial(&self) -> PyResult<Initial> {
        let InitialValues { theta, theta_dot, v, v_dot } = *self;
        finite("theta", theta, |x| x.abs() < 1.57, "a rotation within ±1.57 rad")?;
        finite("theta_dot", theta_dot, |_| true, "a finite rate")?;
        for (name, value) in [("v", v), ("v_dot", v_dot)] {
            finite(name, value.unwrap_or_default(), |_| true, "a finite number")?;
        }
        let vertical = (v.is_some() || v_dot.is_some()).then_some((v.unwrap_or_default(), v_dot.unwrap_or_default()));
        Ok(Initial { theta, theta_dot, vertical })
    }
}

/// Returns the history of a run: a dictionary with `columns`, `events`, `peak`, `counts` and the outcome.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn history<'py>(
    py: Python<'py>,
    block: &Bound<'py, Block>,
    horizontal: Option<&Bound<'py, Record>>,
    vertical: Option<&Bound<'py, Record>>,
    scale: f64,
    pulse: Option<PulseOptions>,
    beginning: InitialValues,
    options: RunOptions,
    gradients: Vec<String>,
    tick: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    if horizontal.is_none() && vertical.is_none() && scale != 1.0 {
        return Err(PyValueError::new_err("scale has no effect without a record"));
    }
    let ground = ground(horizontal, vertical, scale)?;
    let pulse = PulseOptions::pulse_or_none(pulse.as_ref())?;
    let initial = beginning.initial()?;
    if !is_moved(&ground, &pulse, &initial) {
        return Err(PyValueError::new_err("nothing moves the block; expected a record, a pulse or an initial state"));
    }
    let output_step = options.step.or(ground.time_step()).unwrap_or(0.01);
    let on_supports = block.get().block.foundation == Foundation::Viscoelastic;
    if !on_supports && initial.vertical.is_some() {
        return Err(PyValueError::new_err("v and v_dot have no effect on a rigid base"));
    }
    let block_parameters = block.get().block_parameters()?;
    let (block, settings) = (block.get().block, options.settings()?);
    warn(py, doubts::of_end(&pulse, !ground.is_empty()), 2)?;
    let run = Run { block, settings, initial, pulse, ground, duration: options.duration, output_step };
    run.check_memory(gradients.len()).map_err(|error| match error {
        MemoryError::TooManyRows(_) => invalid(error),
        MemoryError::Refused(message) => PyMemoryError::new_err(message),
    })?;
    let parameters = Parameters {
        block: block_parameters,
        ties: block.ties().to_vec(),
        initial,
        pulse,
        scale: (!run.ground.is_empty()).then_some(scale),
    };
    let known = if gradients.is_empty() { Vec::new() } else { parameters.names() };
    if let Some(name) = gradients.iter().find(|name| !known.contains(name)) {
        let message =
            format!("gradients: {name} is no real parameter of this run; expected one of {}", known.join(", "));
        return Err(PyValueError::new_err(message));
    }
    const PARTS: u64 = 1000;
    let computed = wait(py, tick, move |progress| {
        let mut show = |fraction: f64| progress.advance((fraction * PARTS as f64) as u64, PARTS);
        if gradients.is_empty() {
            return Some(run.history(&mut show).map(|history| (history, Gradients::default())));
        }
        run.history_with_gradients(&parameters, &gradients, &mut show)
    })?;
    let computed = computed.ok_or_else(|| PyValueError::new_err("gradients: a parameter is missing"))?;
    let (history, gradients) = computed.map_err(invalid)?;
    let result = shown(py, &block, &history)?;
    result.set_item("gradients", derivatives(py, &block, &gradients)?)?;
    let grazing = gradients.grazing.map(|Grazing { time, kind }| {
        let (event, corner) = kind.map_or(("held", None), |kind| (kind.word(), kind.location()));
        (time, event, corner)
    });
    result.set_item("grazing", grazing)?;
    Ok(result)
}

/// Returns the derivatives by the names of their parameters: columns, times of events and peaks.
fn derivatives<'py>(py: Python<'py>, block: &engine::Block, gradients: &Gradients) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    for Derivatives { name, rows, events, peaks } in &gradients.parameters {
        let columns = PyDict::new(py);
        for column in table::columns(block) {
            let name = &column.heading().name;
            if table::has_derivative(name) {
                columns.set_item(name, PyArray1::from_iter(py, rows.iter().map(|row| column.number(row))))?;
            }
        }
        let events = PyArray1::from_iter(py, events.iter().copied());
        all.set_item(name, (columns, events, peak(py, block, peaks)?))?;
    }
    Ok(all)
}

/// Peaks in the order of the class `Peak` of Python.
type PeakTuple<'py> = (f64, f64, f64, f64, f64, f64, [Bound<'py, PyTuple>; 4]);

fn peak<'py>(py: Python<'py>, block: &engine::Block, peaks: &Peaks) -> PyResult<PeakTuple<'py>> {
    let Peaks { theta, reaction, horizontal, uplift, friction_demand, slip, pull, plastic, elongation } = *peaks;
    let (count, ties) = (block.ties().len(), Holds::of(block).ties);
    let (tensions, forces) = pull[..count].split_at(ties);
    let [tensions, forces, plastic, strokes] =
        [tensions, forces, &plastic[..count], &elongation[ties..count]].map(|values| PyTuple::new(py, values));
    Ok((theta, reaction, horizontal, uplift, friction_demand, slip, [tensions?, forces?, plastic?, strokes?]))
}

fn shown<'py>(py: Python<'py>, block: &engine::Block, history: &History) -> PyResult<Bound<'py, PyDict>> {
    let History { rows, events, peaks, counts, ending, end, ties, yield_works, .. } = history;
    let columns = PyDict::new(py);
    for column in table::columns(block) {
        let values = rows.iter().map(|row| column.number(row));
        columns.set_item(&column.heading().name, PyArray1::from_iter(py, values))?;
    }
    let events = events.iter().map(|event| {
        let (name, corner) = (event.kind.word(), event.kind.location());
        (event.time, name, corner, event.before.to_string(), event.after.to_string())
    });
    let last = rows.last().map_or(0.0, |row| row.time);
    let result = PyDict::new(py);
    result.set_item("columns", columns)?;
    result.set_item("events", events.collect::<Vec<_>>())?;
    let count = block.ties().len();
    result.set_item("peak", peak(py, block, peaks)?)?;
    let broken: Vec<bool> = ties[..count].iter().map(|state| *state == TieState::Broken).collect();
    result.set_item("broken", broken)?;
    result.set_item("yield_energies", PyTuple::new(py, &yield_works[..count])?)?;
    result.set_item("counts", (counts.impacts, counts.liftoffs, counts.steps, counts.rejected, counts.evaluations))?;
    result.set_item("outcome", end.word())?;
    result.set_item("end_time", ending.map_or(last, |(_, time)| time))?;
    result.set_item("has_come_down", *end == End::Completed)?;
    result.set_item("passed_balance", history.lean.passed_balance())?;
    result.set_item("ends_tilted", history.ends_tilted(block))?;
    Ok(result)
}
