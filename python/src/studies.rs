//! Many blocks under many ground motions → a column each.

use std::convert::Infallible;
use std::ops::Range;
use std::path::PathBuf;

use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::ThreadPool;
use rocking_block::ground::Ground;
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::{Initial, OnSeparation};
use rocking_block::unit::variables::Variable;
use rocking_studies::input::study_file::StudyFileError;
use rocking_studies::intensity::Measure;
use rocking_studies::output::runner::{self, Study, StudyRow};
use rocking_studies::run::Run;
use rocking_studies::run::batch;
use rocking_studies::run::outcome::{Holds, Outcome};
use rocking_studies::run::sliding;
use rocking_studies::sweep::Sweep;
use rocking_studies::sweep::file;
use rocking_studies::sweep::ground_motion::GroundMotion;

use crate::blocks::Blocks;
use crate::options::{PulseOptions, RunOptions, choice, finite, invalid, pool};
use crate::record::{Record, ground, measures};
use crate::work::{Progress, wait};

/// A horizontal and a vertical record; each may be missing.
type Pair<'py> = (Option<Bound<'py, Record>>, Option<Bound<'py, Record>>);

/// Columns, their units, and the reason of the first failed run.
type Outcomes<'py> = (Bound<'py, PyDict>, Vec<(String, &'static str)>, Option<String>);

/// Headings, columns, and the reason of the first failed run.
type Table<'py> = (Vec<String>, Vec<Bound<'py, PyAny>>, Option<String>);

/// Yields rows of several runs each, in order; the thread unwinds once they are abandoned.
fn rows<T: Send>(
    pool: &ThreadPool,
    count: u64,
    runs_in_a_row: u64,
    progress: &Progress,
    make: impl Fn(Range<u64>) -> Vec<T> + Sync,
) -> Vec<T> {
    let mut rows = Vec::new();
    // The first rows arrive when their batch is done.
    progress.show(0, count);
    let make = |numbers| {
        progress.end_if_abandoned();
        make(numbers)
    };
    let done = runner::in_batches(pool, 0..count, VectorWidth::widest(), runs_in_a_row, make, |batch| {
        rows.extend(batch);
        progress.show(rows.len() as u64, count);
        Ok::<(), Infallible>(())
    });
    done.map_or_else(|never| match never {}, |()| rows)
}

/// Computes the outcome of each block under each ground motion: columns with rows ordered block by block, then scale by
/// scale, then pair by pair.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn outcomes<'py>(
    py: Python<'py>,
    blocks: &Bound<'py, Blocks>,
    pairs: Vec<Pair<'py>>,
    scales: Vec<f64>,
    periods: Vec<f64>,
    g: f64,
    pulse: Option<PulseOptions>,
    friction_demand: Option<f64>,
    options: RunOptions,
    threads: Option<i64>,
    tick: &Bound<'py, PyAny>,
) -> PyResult<Outcomes<'py>> {
    if let Some(demand) = friction_demand {
        finite("friction_demand", demand, |x| x > 0.0, "a coefficient of friction > 0")?;
    }
    let pulse = PulseOptions::pulse_or_none(pulse.as_ref())?;
    let pool = pool(threads)?;
    let settings = options.settings()?;
    options.check_times()?;
    let of_record = measures(&periods)?;
    let has_record = pairs.iter().any(|(along, _)| along.is_some());
    let shown: Vec<Measure> = match has_record {
        true => of_record.iter().copied().chain(Measure::OF_BLOCK).collect(),
        false => Vec::new(),
    };
    let grounds = pairs.iter().map(|(horizontal, vertical)| ground(horizontal.as_ref(), vertical.as_ref(), 1.0));
    let grounds: Vec<Ground> = grounds.collect::<PyResult<_>>()?;
    scales.iter().try_for_each(|&scale| finite("scale", scale, |_| true, "a finite factor"))?;
    let blocks = blocks.get().blocks.clone();
    let holds = blocks.iter().map(Holds::of).fold(Holds::default(), Holds::or);
    let RunOptions { duration, step, .. } = options;
    let count = (blocks.len() * scales.len() * grounds.len()) as u64;
    let measures = shown.clone();
    let outcomes = wait(py, tick, move |progress| {
        let motion =
            |number: u64| GroundMotion::new(Default::default(), grounds[number as usize].clone(), &of_record, g);
        let motions =
            rows(&pool, grounds.len() as u64, 1, &Progress::default(), |numbers| numbers.map(motion).collect());
        let case = |number: u64| {
            let (motion, block) = (number as usize / blocks.len(), number as usize % blocks.len());
            (&motions[motion / scales.len()], scales[motion % scales.len()], blocks[block])
        };
        let run = |number: u64| {
            progress.end_if_abandoned();
            let (motion, scale, block) = case(number);
            Run {
                block,
                settings,
                initial: Initial::default(),
                pulse,
                ground: motion.ground.clone().scaled(scale),
                duration,
                output_step: step.unwrap_or(f64::INFINITY),
            }
        };
        let row = |(number, outcome): (u64, Outcome)| {
            let (motion, scale, block) = case(number);
            let evaluate = |measure: &Measure| motion.intensity(*measure, scale, &block).unwrap_or(f64::NAN);
            let above = friction_demand.map(|demand| run(number).longest_above(demand));
            (outcome, block.alpha, shown.iter().map(evaluate).chain(above).collect())
        };
        let width = VectorWidth::widest();
        rows(&pool, count, 1, progress, |numbers| {
            let outcomes = batch::outcomes(width, numbers.clone().map(run), || ());
            numbers.zip(outcomes).map(row).collect()
        })
    })?;
    let outcomes: Vec<(Outcome, f64, Vec<f64>)> = outcomes;
    let failure = outcomes.iter().find_map(|(outcome, ..)| outcome.failure.as_ref()).map(ToString::to_string);
    let columns = columns(py, &outcomes, holds)?;
    for (i, measure) in measures.iter().enumerate() {
        columns.set_item(measure.to_string(), PyArray1::from_iter(py, outcomes.iter().map(|row| row.2[i])))?;
    }
    if let Some(demand) = friction_demand {
        let above = PyArray1::from_iter(py, outcomes.iter().map(|row| row.2[measures.len()]));
        columns.set_item(sliding::name(demand), above)?;
    }
    let units = measures.iter().map(|measure| (measure.to_string(), measure.unit()));
    Ok((columns, units.collect(), failure))
}

/// Returns the columns of outcomes, each with the slenderness of its block (rad).
fn columns<'py>(py: Python<'py>, outcomes: &[(Outcome, f64, Vec<f64>)], holds: Holds) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    columns.set_item("outcome", outcomes.iter().map(|(outcome, ..)| outcome.end.word()).collect::<Vec<_>>())?;
    type Number = fn(&Outcome, f64) -> f64;
    let numbers: [(&str, Number); 7] = [
        ("end_time", |outcome, _| outcome.end_time),
        ("peak.theta/alpha", |outcome, alpha| outcome.peaks.theta / alpha),
        ("peak.uplift", |outcome, _| outcome.peaks.uplift),
        ("peak.N", |outcome, _| outcome.peaks.reaction),
        ("peak.H", |outcome, _| outcome.peaks.horizontal),
        ("peak.friction_demand", |outcome, _| outcome.peaks.friction_demand),
        ("first_separation", |outcome, _| outcome.flights.first.unwrap_or(f64::NAN)),
    ];
    for (name, value) in numbers {
        columns.set_item(
            name,
            PyArray1::from_iter(py, outcomes.iter().map(|(outcome, alpha, _)| value(outcome, *alpha))),
        )?;
    }
    if holds.friction {
        columns
            .set_item("peak.slip", PyArray1::from_iter(py, outcomes.iter().map(|(outcome, ..)| outcome.peaks.slip)))?;
    }
    for tie in 0..holds.ties {
        let tensions = outcomes.iter().map(|(outcome, ..)| outcome.peaks.pull[tie]);
        columns.set_item(format!("peak.tie_{}.tension", tie + 1), PyArray1::from_iter(py, tensions))?;
    }
    type Count = fn(&Outcome) -> u32;
    let counts: [(&str, Count); 3] = [
        ("flights", |outcome| outcome.flights.count),
        ("events.impacts", |outcome| outcome.counts.impacts),
        ("events.liftoffs", |outcome| outcome.counts.liftoffs),
    ];
    for (name, value) in counts {
        columns
            .set_item(name, PyArray1::from_iter(py, outcomes.iter().map(|(outcome, ..)| i64::from(value(outcome)))))?;
    }
    Ok(columns)
}

/// Returns the table of a study file; columns with a unit are numeric, except for overturning ranges.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn sweep<'py>(
    py: Python<'py>,
    name: Option<&str>,
    text: &str,
    folder: PathBuf,
    on_separation: Option<&str>,
    threads: Option<i64>,
    tick: &Bound<'py, PyAny>,
) -> PyResult<Table<'py>> {
    // Line numbers are useful only for files: the text of a dictionary is never shown.
    let without_line = |error: StudyFileError| if name.is_some() { invalid(error) } else { invalid(error.message) };
    let name_shown = name.unwrap_or("the study");
    let (file, content) = (name_shown.to_string(), text.to_string());
    // Checking that many combinations make valid blocks takes time.
    let mut study = wait(py, tick, move |_| file::read(&file, &content, &folder))?.map_err(without_line)?;
    if let Some(on_separation) = on_separation {
        let choices = [OnSeparation::Terminate, OnSeparation::Fly];
        if study.parameters.iter().any(|swept| swept.parameter.metadata.variable == Variable::OnSeparation) {
            let message = format!("on_separation: {name_shown} names it as well; expected one of the two");
            return Err(PyValueError::new_err(message));
        }
        study.on_separation = choice("on_separation", on_separation, &choices)?;
    }
    let pool = pool(threads)?;
    let headings = study.header().columns;
    let count = study.rows();
    let study_rows: Vec<StudyRow> = wait(py, tick, move |progress| {
        let width = VectorWidth::widest();
        rows(&pool, count, study.runs_in_a_row(), progress, |numbers| study.make(numbers, width))
    })?;
    let failure = study_rows.iter().find_map(|row| row.failure.as_ref()).map(ToString::to_string);
    let column = |(number, heading): (usize, &String)| {
        let fields = study_rows.iter().map(|row| row.fields.get(number).unwrap_or_default());
        if !Sweep::is_numeric(heading) {
            return Ok(fields.collect::<Vec<_>>().into_pyobject(py)?.into_any());
        }
        // A missing number is an empty cell.
        let numbers = fields.map(|field| if field.is_empty() { Ok(f64::NAN) } else { field.parse::<f64>() });
        let numbers = numbers.collect::<Result<Vec<f64>, _>>().map_err(invalid)?;
        Ok(PyArray1::from_vec(py, numbers).into_any())
    };
    let columns = headings.iter().enumerate().map(column).collect::<PyResult<Vec<_>>>()?;
    Ok((headings, columns, failure))
}
