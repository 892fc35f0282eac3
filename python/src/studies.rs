//! Many blocks under many ground motions → a column each.

use std::path::{Path, PathBuf};

use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rocking_block::model::variables::Variable;
use rocking_block::simulation::{Initial, OnSeparation};
use rocking_block::study::ground::Ground;
use rocking_block::study::history::Run;
use rocking_block::study::outcome::Outcome;
use rocking_block::study::runner::{self, Study, StudyRow};
use rocking_block::study::study_file::StudyFileError;
use rocking_block::study::sweep_file;

use crate::block::Blocks;
use crate::options::{PulseOptions, RunOptions, ground, invalid, word};
use crate::record::Record;
use crate::work::{Progress, wait};

/// A horizontal and a vertical record, each of which may be missing, and the factor on both.
type Motion<'py> = (Option<Bound<'py, Record>>, Option<Bound<'py, Record>>, f64);

/// Headings, columns, and why the first run failed that did.
type Table<'py> = (Vec<String>, Vec<Bound<'py, PyAny>>, Option<String>);

/// Results of work of which nobody has lost interest, in the order of their numbers.
fn rows<T: Send>(
    threads: Option<usize>,
    count: u64,
    progress: &Progress,
    make: impl Fn(u64) -> T + Sync,
) -> Result<Vec<T>, String> {
    let pool = runner::pool(threads).map_err(|error| error.to_string())?;
    let mut rows = Vec::new();
    let make = |number| (!progress.is_abandoned()).then(|| make(number));
    let done = runner::in_order(&pool, 0..count, make, |number, row| match row {
        Some(row) => {
            rows.push(row);
            progress.show(number + 1, count);
            Ok(())
        }
        None => Err("interrupted".to_string()),
    });
    done.map(|()| rows)
}

/// What becomes of each block under each ground motion: the columns, one row after the other block by block and then motion
/// by motion, and why the first of the runs failed that did.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn outcomes<'py>(
    py: Python<'py>,
    blocks: &Bound<'py, Blocks>,
    motions: Vec<Motion<'py>>,
    pulse: Option<PulseOptions>,
    options: RunOptions,
    threads: Option<usize>,
    tick: &Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyDict>, Option<String>)> {
    let pulse = PulseOptions::pulse_or_none(pulse.as_ref())?;
    let settings = options.settings()?;
    options.check_times()?;
    let grounds = motions.iter().map(|(along, up, scale)| ground(along.as_ref(), up.as_ref(), *scale));
    let grounds: Vec<Ground> = grounds.collect::<PyResult<_>>()?;
    let blocks = blocks.get().blocks.clone();
    let RunOptions { duration, step, .. } = options;
    let count = (blocks.len() * grounds.len()) as u64;
    let made = wait(py, tick, move |progress| {
        rows(threads, count, progress, |number| {
            let (motion, block) = (number as usize / blocks.len(), number as usize % blocks.len());
            let run = Run {
                block: blocks[block],
                settings,
                initial: Initial::default(),
                pulse,
                ground: grounds[motion].clone(),
                duration,
                output_step: step.unwrap_or(f64::INFINITY),
            };
            (run.outcome(), run.block.alpha)
        })
    })?;
    let made = made.map_err(invalid)?;
    let failure = made.iter().find_map(|(outcome, _)| outcome.failure.as_ref()).map(ToString::to_string);
    Ok((columns(py, &made)?, failure))
}

/// The columns of outcomes, each with the slenderness of its block (rad).
fn columns<'py>(py: Python<'py>, made: &[(Outcome, f64)]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    columns.set_item("outcome", made.iter().map(|(outcome, _)| outcome.end.word()).collect::<Vec<_>>())?;
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
    for (name, of) in numbers {
        columns.set_item(name, PyArray1::from_iter(py, made.iter().map(|(outcome, alpha)| of(outcome, *alpha))))?;
    }
    type Count = fn(&Outcome) -> u32;
    let counts: [(&str, Count); 3] = [
        ("flights", |outcome| outcome.flights.count),
        ("events.impacts", |outcome| outcome.counts.impacts),
        ("events.liftoffs", |outcome| outcome.counts.liftoffs),
    ];
    for (name, of) in counts {
        columns.set_item(name, PyArray1::from_iter(py, made.iter().map(|(outcome, _)| i64::from(of(outcome)))))?;
    }
    Ok(columns)
}

/// The table of a study file; columns with a unit are numbers.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn sweep<'py>(
    py: Python<'py>,
    name: Option<&str>,
    text: &str,
    folder: PathBuf,
    on_separation: Option<&str>,
    threads: Option<usize>,
    tick: &Bound<'py, PyAny>,
) -> PyResult<Table<'py>> {
    // Lines are told of a file; the text of a dictionary was seen by nobody.
    let told = |error: StudyFileError| if name.is_some() { invalid(error) } else { invalid(error.message) };
    let name_shown = name.unwrap_or("the study");
    let mut study = py.detach(|| sweep_file::read(name_shown, text, Path::new(&folder))).map_err(told)?;
    if let Some(on_separation) = on_separation {
        let words = [("terminate", OnSeparation::Terminate), ("fly", OnSeparation::Fly)];
        if study.factors.iter().any(|factor| factor.parameter.metadata.variable == Variable::OnSeparation) {
            let message = format!("on_separation: {name_shown} names it as well; expected one of the two");
            return Err(PyValueError::new_err(message));
        }
        study.on_separation = word("on_separation", on_separation, &words)?;
    }
    let headings = study.head().columns;
    let count = study.rows();
    let made = wait(py, tick, move |progress| rows(threads, count, progress, |number| study.row(number)))?;
    let made: Vec<StudyRow> = made.map_err(invalid)?;
    let failure = made.iter().find_map(|row| row.failure.as_ref()).map(ToString::to_string);
    let column = |(number, heading): (usize, &String)| {
        let fields = made.iter().map(|row| row.fields[number].as_str());
        if !heading.ends_with(']') {
            return Ok(fields.collect::<Vec<_>>().into_pyobject(py)?.into_any());
        }
        // Nothing stands where there is no such number.
        let numbers = fields.map(|field| if field.is_empty() { Ok(f64::NAN) } else { field.parse::<f64>() });
        let numbers = numbers.collect::<Result<Vec<f64>, _>>().map_err(invalid)?;
        Ok(PyArray1::from_vec(py, numbers).into_any())
    };
    let columns = headings.iter().enumerate().map(column).collect::<PyResult<Vec<_>>>()?;
    Ok((headings, columns, failure))
}
