//! A block, measured tests of it, free parameters → estimates with their intervals.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use rocking_studies::fit::{self as engine, Free, Options, Problem, fit as fitted};

use crate::block::Block;
use crate::history::InitialValues;
use crate::options::{PulseOptions, invalid, pool, whole};
use crate::record::{Record, ground};
use crate::work::{Progress, wait};

/// Name, bounds and prior of a free parameter.
type FreeTuple = (String, Option<[f64; 2]>, Option<[f64; 2]>);

/// A test: a dictionary with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Test<'py> {
    t: PyReadonlyArray1<'py, f64>,
    values: PyReadonlyArray1<'py, f64>,
    output: String,
    noise: Option<f64>,
    record: Option<Bound<'py, Record>>,
    vertical: Option<Bound<'py, Record>>,
    scale: f64,
    pulse: Option<PulseOptions>,
    beginning: InitialValues,
    zero: f64,
    delay: f64,
    free: Vec<FreeTuple>,
}

impl Test<'_> {
    fn of_engine(&self) -> PyResult<engine::Test> {
        Ok(engine::Test {
            output: self.output.clone(),
            times: self.t.as_array().to_vec(),
            values: self.values.as_array().to_vec(),
            noise: self.noise,
            initial: self.beginning.initial()?,
            pulse: PulseOptions::pulse_or_none(self.pulse.as_ref())?,
            ground: ground(self.record.as_ref(), self.vertical.as_ref(), 1.0)?,
            scale: self.scale,
            zero: self.zero,
            delay: self.delay,
            free: free(&self.free),
        })
    }
}

fn free(tuples: &[FreeTuple]) -> Vec<Free> {
    tuples.iter().map(|(name, bounds, prior)| Free { name: name.clone(), bounds: *bounds, prior: *prior }).collect()
}

/// Starts, seed, level and tolerance: a dictionary with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct FitOptions {
    starts: i64,
    seed: i64,
    level: f64,
    tolerance: f64,
}

/// Measured values, fitted values and residuals of a test.
type Columns<'py> = [Bound<'py, PyArray1<f64>>; 3];

/// Returns the fit as JSON, and the columns of each test.
#[pyfunction]
pub fn fit<'py>(
    py: Python<'py>,
    block: &Bound<'py, Block>,
    tests: Vec<Test<'py>>,
    shared: Vec<FreeTuple>,
    options: FitOptions,
    threads: Option<i64>,
    tick: &Bound<'py, PyAny>,
) -> PyResult<(String, Vec<Columns<'py>>)> {
    let options = Options {
        starts: whole("starts", options.starts, 1..=100_000)? as u32,
        seed: whole("seed", options.seed, 0..=i64::MAX)?,
        level: options.level,
        tolerance: options.tolerance,
    };
    let tests = tests.iter().map(Test::of_engine).collect::<PyResult<Vec<_>>>()?;
    let (block, ties) = (block.get().block_parameters()?, block.get().block.ties().to_vec());
    let problem = Problem { block, ties, free: free(&shared), tests, options };
    let pool = pool(threads)?;
    let work = move |progress: &Progress| fitted(&problem, &pool, &|done, total| progress.advance(done, total));
    let found = wait(py, tick, work)?.map_err(invalid)?;
    let text = serde_json::to_string(&found).map_err(invalid)?;
    let columns = |test: engine::TestFit| {
        [test.measured, test.fitted, test.residuals].map(|values| PyArray1::from_vec(py, values))
    };
    Ok((text, found.tests.into_iter().map(columns).collect()))
}
