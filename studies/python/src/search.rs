//! A range → the values at which the outcome changes.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use rayon::ThreadPool;
use rocking_block::block::Foundation;
use rocking_block::excitation::Pulse;
use rocking_block::numerics::wide::VectorWidth;
use rocking_studies::run::Run;
use rocking_studies::run::outcome::End;
use rocking_studies::search::{self, OutcomeMap, Scan, Shaken, Threshold};
use rocking_studies::space::RunInSpace;
use rocking_studies::space::ground::ComponentNames;

use crate::block::Block;
use crate::options::{PulseOptions, RunOptions, finite, invalid, pool, whole};
use crate::record::ground;
use crate::space::{self, BlockInSpace, Components};
use crate::work::wait;

/// Range and resolution of a scan: a dictionary with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ScanOptions {
    from: Option<f64>,
    to: Option<f64>,
    points: i64,
    resolution: f64,
    threads: Option<i64>,
}

impl ScanOptions {
    /// Returns the scan; missing ends are those of `instead`.
    fn scan(&self, instead: [f64; 2]) -> PyResult<Scan> {
        let (from, to) = (self.from.unwrap_or(instead[0]), self.to.unwrap_or(instead[1]));
        finite("from_", from, |_| true, "a finite number")?;
        finite("to", to, |x| x > from, &format!("more than from_ = {from}"))?;
        finite("resolution", self.resolution, |x| x > 0.0, "a number > 0")?;
        Ok(Scan { from, to, points: whole("points", self.points, 2..=10_000_000)?, resolution: self.resolution })
    }
}

/// The value found, its bound, the intervals of equal outcome, and the spacing of the scan.
type Answer = (Option<f64>, &'static str, Vec<(f64, f64, &'static str)>, f64);

fn answer(found: &OutcomeMap<End>, threshold: Threshold) -> Answer {
    let stretches = found.stretches().into_iter().map(|(from, to, end)| (from, to, end.word()));
    (threshold.value(), threshold.bound(), stretches.collect(), found.spacing)
}

/// Searches on the threads of a pool, while Python shows the progress.
fn searched<T: Send + 'static>(
    py: Python,
    tick: &Bound<PyAny>,
    pool: ThreadPool,
    search: impl FnOnce(search::SearchProgress) -> T + Send + 'static,
) -> PyResult<T> {
    wait(py, tick, move |progress| pool.install(|| search(&|done, total| progress.advance(done, total))))
}

/// The components by the names of the search.
const COMPONENTS: ComponentNames = ComponentNames { names: ["record", "record_y", "vertical"], ..space::COMPONENTS };

/// Finds intervals of equal outcome over the amplitude of a pulse or the factor on records.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn search_overturning<'py>(
    py: Python<'py>,
    block: &Bound<'py, PyAny>,
    pulse: Option<PulseOptions>,
    components: Components<'py>,
    azimuth: f64,
    scan: ScanOptions,
    options: RunOptions,
    tick: &Bound<'py, PyAny>,
) -> PyResult<Answer> {
    let settings = options.settings()?;
    let has_pulse = match (&pulse, &components) {
        (Some(_), [None, _, None]) | (None, [Some(_), ..]) => pulse.is_some(),
        _ => return Err(PyValueError::new_err("expected either a pulse or a record, whose strength is searched for")),
    };
    let pulse = pulse.as_ref().map_or(Ok(Pulse::NONE), PulseOptions::without_amplitude)?;
    if let Ok(block) = block.cast::<BlockInSpace>() {
        let BlockInSpace { parameters, body, .. } = block.get();
        let ground = space::ground(&components, 1.0, azimuth, has_pulse, COMPONENTS)?;
        let at_rest = RunInSpace::at_rest(parameters.clone(), body.clone(), settings);
        return overturning(py, RunInSpace { ground, ..at_rest.with_pulse(pulse, azimuth) }, scan, tick);
    }
    let Ok(block) = block.cast::<Block>() else {
        return Err(PyTypeError::new_err(format!("block = {block:?}; expected a Block or a BlockInSpace")));
    };
    let [horizontal, y, vertical] = &components;
    if y.is_some() || azimuth != 0.0 {
        let name = if y.is_some() { "record_y" } else { "azimuth" };
        return Err(PyValueError::new_err(format!("{name} is for a block in space; expected a BlockInSpace")));
    }
    let ground = ground(horizontal.as_ref(), vertical.as_ref(), 1.0)?;
    overturning(py, Run { ground, pulse, ..Run::at_rest(block.get().block, settings) }, scan, tick)
}

fn overturning<E: Shaken + Send + 'static>(
    py: Python,
    run: E,
    scan: ScanOptions,
    tick: &Bound<PyAny>,
) -> PyResult<Answer> {
    let pool = pool(scan.threads)?;
    let scan = scan.scan(run.usual_strengths())?;
    let width = VectorWidth::widest();
    let found = searched(py, tick, pool, move |progress| search::overturning(&run, &scan, width, progress))?;
    Ok(answer(&found, found.overturning()))
}

/// Finds intervals of equal outcome over the damping ratio of the supports, in free vibration.
#[pyfunction]
pub fn search_damping<'py>(
    py: Python<'py>,
    block: &Bound<'py, Block>,
    rate: f64,
    scan: ScanOptions,
    options: RunOptions,
    tick: &Bound<'py, PyAny>,
) -> PyResult<Answer> {
    let block = block.get().block;
    if block.foundation == Foundation::Rigid {
        return Err(PyValueError::new_err("a rigid base has no damping; expected a block on viscoelastic supports"));
    }
    finite("rate", rate, |_| true, "a finite number")?;
    let (settings, pool) = (options.settings()?, pool(scan.threads)?);
    let scan = scan.scan([0.0, 1.0])?;
    let width = VectorWidth::widest();
    let found = searched(py, tick, pool, move |progress| {
        search::damping_against_separation(&block, rate, settings, &scan, width, progress)
    })?
    .map_err(invalid)?;
    Ok(answer(&found, found.damping_against_separation()))
}
