//! Many blocks under many ground motions → a column each.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::ThreadPool;
use rocking_block::block::Block;
use rocking_block::excitation::records::Ground;
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::OnSeparation;
use rocking_block::unit::variables::Variable;
use rocking_studies::doubts;
use rocking_studies::input::study_file::StudyFileError;
use rocking_studies::intensity::Measure;
use rocking_studies::output::format::TableFormat;
use rocking_studies::output::parts::{self, Part, PartNumber, PartState};
use rocking_studies::output::resumable::{TableHeader, TableOptions, TableWriteError};
use rocking_studies::output::runner::{self, Study as _, StudyRows};
use rocking_studies::output::table;
use rocking_studies::run::Run;
use rocking_studies::run::outcome::{self, Holds};
use rocking_studies::run::rows::RunRow;
use rocking_studies::run::sliding;
use rocking_studies::spec::RunSpec;
use rocking_studies::spec::words::Words;
use rocking_studies::sweep::Sweep;
use rocking_studies::sweep::amplified::GreatestScales;
use rocking_studies::sweep::file::{self, Checks};
use rocking_studies::sweep::ground_motion::GroundMotion;

use crate::blocks::Blocks;
use crate::options::{PulseOptions, RunOptions, choice, finite, invalid, pool, unspelled, warn};
use crate::record::{Pair, ground, measures};
use crate::table::{Column, columns};
use crate::work::{Progress, wait};

/// The columns of a table, and the reason of the first failed run.
pub type Columns<'py> = (Vec<Column<'py>>, Option<String>);

pub fn for_python(py: Python, rows: StudyRows) -> PyResult<Columns> {
    Ok((columns(py, rows.table)?, rows.failure.map(|failure| failure.to_string())))
}

/// Makes rows of several runs each in batches, in order; the size of a batch suits vectors of this width. The thread unwinds once they are
/// abandoned.
pub fn batches<T: Send>(
    pool: &ThreadPool,
    width: Option<VectorWidth>,
    count: u64,
    runs_in_a_row: u64,
    progress: &Progress,
    make: impl Fn(Range<u64>) -> T + Sync,
    mut take: impl FnMut(T),
) {
    let mut done = 0;
    // The first rows arrive when their batch is done.
    progress.show(0, count);
    let make = |numbers: Range<u64>| {
        progress.end_if_abandoned();
        (numbers.end - numbers.start, make(numbers))
    };
    let Ok(()) = runner::in_batches(pool, 0..count, width, runs_in_a_row, make, |(rows, batch)| {
        take(batch);
        done += rows;
        progress.show(done, count);
        Ok::<(), Infallible>(())
    });
}

/// Computes the outcome of each block under each ground motion. Rows are ordered block by block, then scale by scale, then pair by pair.
/// `holds`, friction, the numbers of ties and dampers, and whether any yields, chooses the columns; by default those of the blocks.
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
    holds: Option<(bool, usize, usize, bool)>,
    tick: &Bound<'py, PyAny>,
) -> PyResult<Columns<'py>> {
    let pulse = PulseOptions::pulse_or_none(pulse.as_ref())?;
    let pool = pool(threads)?;
    let settings = options.settings()?;
    let RunOptions { duration, step, .. } = options;
    RunSpec { duration, step, friction_demand, ..RunSpec::default() }.settings().map_err(unspelled)?;
    let of_record = measures(&periods)?;
    let has_record = pairs.iter().any(|(along, _)| along.is_some());
    warn(py, doubts::of_end(&pulse, has_record), 3)?;
    let shown: Vec<Measure> = match has_record {
        true => of_record.iter().copied().chain(Measure::OF_BLOCK).collect(),
        false => Vec::new(),
    };
    let grounds = pairs.iter().map(|(horizontal, vertical)| ground(horizontal.as_ref(), vertical.as_ref(), 1.0));
    let grounds: Vec<Ground> = grounds.collect::<PyResult<_>>()?;
    scales.iter().try_for_each(|&scale| finite("scale", scale, |_| true, "a finite factor"))?;
    let blocks = blocks.get().blocks();
    let holds = match holds {
        Some((friction, ties, dampers, yields)) => Holds { friction, ties, dampers, yields },
        None => blocks.iter().map(Holds::of).fold(Holds::default(), Holds::or),
    };
    let count = (blocks.len() * scales.len() * grounds.len()) as u64;
    let made = wait(py, tick, move |progress| {
        let motion = |ground| GroundMotion::new(Default::default(), ground, &of_record, g);
        let motions: Vec<GroundMotion> = grounds.into_iter().map(motion).collect();
        let case = |number: u64| {
            let (motion, block) = (number as usize / blocks.len(), number as usize % blocks.len());
            (&motions[motion / scales.len()], scales[motion % scales.len()], blocks[block])
        };
        let run = |(motion, scale, block): (&GroundMotion, f64, Block)| Run {
            pulse,
            ground: motion.ground.clone().scaled(scale),
            duration,
            output_step: step.unwrap_or(f64::INFINITY),
            ..Run::at_rest(block, settings)
        };
        let of_records = shown.iter().map(|&measure| {
            table::TableColumn::optional(measure.to_string(), measure.unit(), move |row: &Row| {
                let (motion, scale, block) = &row.inputs;
                motion.intensity(measure, *scale, block.into())
            })
        });
        let of_runs = outcome::columns(holds, |row: &Row| &row.outcome);
        let columns: Vec<_> = of_records.chain(of_runs).chain(friction_demand.map(sliding::column)).collect();
        let make = |numbers: Range<u64>| {
            let rows = numbers.map(case).map(|case| (case, run(case))).collect();
            let ended = || progress.end_if_abandoned();
            RunRow::table(&columns, &RunRow::all(VectorWidth::widest(), rows, |_| [], ended))
        };
        let mut made = StudyRows::default();
        batches(&pool, VectorWidth::widest(), count, 1, progress, make, |batch| made.append(batch));
        made
    })?;
    for_python(py, made)
}

/// A row of the outcomes: the ground motion, the factor on it, and the block.
type Row<'a> = RunRow<(&'a GroundMotion, f64, Block)>;

/// A study that ends once its caller has stopped waiting for it.
struct Abandonable<'a> {
    study: &'a Sweep,
    progress: &'a Progress,
}

impl runner::Study for Abandonable<'_> {
    fn header(&self) -> TableHeader {
        self.study.header()
    }

    fn rows(&self) -> u64 {
        self.study.rows()
    }

    fn runs_in_a_row(&self) -> u64 {
        self.study.runs_in_a_row()
    }

    fn uses_lanes(&self) -> bool {
        self.study.uses_lanes()
    }

    fn make(&self, numbers: &[u64], width: Option<VectorWidth>) -> StudyRows {
        self.progress.end_if_abandoned();
        self.study.make(numbers, width)
    }
}

/// Writes the missing rows of a study to its file. Returns the whole table and the reason of the first failed run.
fn written(
    study: &Sweep,
    pool: &ThreadPool,
    out: &Path,
    progress: &Progress,
) -> Result<(table::Table, Option<String>), TableWriteError> {
    let mut file = study.open(out, TableOptions { resume: true, ..TableOptions::default() })?;
    let abandonable = Abandonable { study, progress };
    let mut table = table::Table::default();
    let mut follow = |rows| {
        table.append(rows);
        Ok(())
    };
    let show = |_, done| progress.show(done, study.rows());
    let summary = runner::run(&abandonable, pool, VectorWidth::widest(), &mut file, Some(&mut follow), show)?;
    let earlier = || (summary.failures.count > 0).then(|| "an earlier call has said why".into());
    Ok((table, summary.reason.as_ref().map(ToString::to_string).or_else(earlier)))
}

/// The study of a file or a dictionary.
#[pyclass(frozen, module = "rocking_block._engine")]
pub struct Study {
    study: Arc<Sweep>,
}

/// The greatest factors on the records of a hunt, by their names; empty for other studies.
type Scales = BTreeMap<String, f64>;

fn hunted_scales(study: &Sweep, rows: &table::Table) -> Scales {
    let mut found = study.hunted_scales();
    if let Some(found) = &mut found {
        found.take(rows);
    }
    found.unwrap_or_default().0
}

/// The rows of a study: their columns, the reason of the first failed run, and the greatest factors on records.
type Rows<'py> = (Vec<Column<'py>>, Option<String>, Scales);

/// A part of a study by its number, from 1, and the number of parts.
fn part_of(number: u64, count: u64) -> PyResult<PartNumber> {
    let message = || PyValueError::new_err(format!("part {number} of {count}; expected a number from 1 to {count}"));
    PartNumber::new(number, count).ok_or_else(message)
}

/// Makes the rows of a study; `progress` learns of them.
fn made(study: &impl runner::Study, pool: &ThreadPool, progress: &Progress) -> StudyRows {
    let mut made = StudyRows::default();
    let width = VectorWidth::widest().filter(|_| study.uses_lanes());
    let make = |numbers| study.make_range(numbers, width);
    batches(pool, width, study.rows(), study.runs_in_a_row(), progress, make, |batch| made.append(batch));
    made
}

#[pymethods]
impl Study {
    #[new]
    fn new(
        py: Python,
        name: Option<&str>,
        text: &str,
        folder: PathBuf,
        on_separation: Option<&str>,
        is_checked: bool,
        tick: &Bound<PyAny>,
    ) -> PyResult<Study> {
        // Line numbers are useful only for files: the text of a dictionary is never shown.
        let without_line = |error: StudyFileError| if name.is_some() { invalid(error) } else { invalid(error.message) };
        let name_shown = name.unwrap_or("the study");
        let (file, content) = (name_shown.to_string(), text.to_string());
        // Checking that many combinations make valid blocks takes time.
        let checks = if is_checked { Checks::None } else { Checks::All };
        let read = move |_: &Progress| file::read_for(&file, &content, &folder, checks);
        let mut study = wait(py, tick, read)?.map_err(without_line)?;
        if let Some(on_separation) = on_separation {
            let choices = [OnSeparation::Terminate, OnSeparation::Fly];
            if study.parameters.iter().any(|swept| swept.parameter.variable() == Some(Variable::OnSeparation)) {
                let message = format!("on_separation: {name_shown} names it as well; expected one of the two");
                return Err(PyValueError::new_err(message));
            }
            study.on_separation = choice("on_separation", on_separation, &choices)?;
        }
        Ok(Study { study: Arc::new(study) })
    }

    /// Doubts about records, their scale, blocks and pulses.
    #[getter]
    fn remarks(&self) -> Vec<String> {
        self.study.remarks.clone()
    }

    /// Number of rows.
    #[getter]
    fn rows(&self) -> u64 {
        self.study.rows()
    }

    /// The measure whose levels the study names.
    #[getter]
    fn measure(&self) -> Option<String> {
        self.study.strengths.measure().map(|measure| measure.to_string())
    }

    /// Returns the table. With `out` its rows are those of this file, which is written as they come; an interruption waits for its end,
    /// so that the next call can resume it.
    fn table<'py>(
        &self,
        py: Python<'py>,
        threads: Option<i64>,
        out: Option<PathBuf>,
        tick: &Bound<'py, PyAny>,
    ) -> PyResult<Rows<'py>> {
        let (pool, study) = (pool(threads)?, Arc::clone(&self.study));
        let Some(out) = out else {
            let made = wait(py, tick, move |progress| made(&*study, &pool, progress))?;
            return self.for_python(py, made);
        };
        let busy = Arc::new(Mutex::new(()));
        let writing = Arc::clone(&busy);
        let written = wait(py, tick, move |progress| {
            let _writing = writing.lock();
            written(&study, &pool, &out, progress)
        });
        py.detach(|| drop(busy.lock()));
        let (table, failure) = written?.map_err(invalid)?;
        let scales = hunted_scales(&self.study, &table);
        Ok((columns(py, table)?, failure, scales))
    }

    /// Returns the file of the table in Parquet, and the table.
    fn parquet<'py>(
        &self,
        py: Python<'py>,
        threads: Option<i64>,
        tick: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyBytes>, Rows<'py>)> {
        let (pool, study) = (pool(threads)?, Arc::clone(&self.study));
        let (content, made) = wait(py, tick, move |progress| {
            let made = made(&*study, &pool, progress);
            (parts::file(&study.header(), made.table.clone(), TableFormat::Parquet), made)
        })?;
        Ok((PyBytes::new(py, &content?), self.for_python(py, made)?))
    }

    /// Returns the rows of a part.
    fn part<'py>(
        &self,
        py: Python<'py>,
        number: u64,
        count: u64,
        threads: Option<i64>,
        tick: &Bound<'py, PyAny>,
    ) -> PyResult<Rows<'py>> {
        let (number, pool, study) = (part_of(number, count)?, pool(threads)?, Arc::clone(&self.study));
        let made = wait(py, tick, move |progress| made(&Part::new(&*study, number), &pool, progress))?;
        self.for_python(py, made)
    }

    /// Returns the file of a part, the number of its rows, the reason of the first failed run, and the greatest factors on records.
    fn part_file<'py>(
        &self,
        py: Python<'py>,
        number: u64,
        count: u64,
        format: String,
        threads: Option<i64>,
        tick: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyBytes>, u64, Option<String>, Scales)> {
        let (number, pool, study) = (part_of(number, count)?, pool(threads)?, Arc::clone(&self.study));
        let format = table_format(&format)?;
        let (content, rows, failure, scales) = wait(py, tick, move |progress| {
            let part = Part::new(&*study, number);
            let made = made(&part, &pool, progress);
            let scales = hunted_scales(&study, &made.table);
            let content = parts::file(&part.header(), made.table, format);
            (content, part.rows(), made.failure.map(|failure| failure.to_string()), scales)
        })?;
        Ok((PyBytes::new(py, &content?), rows, failure, scales))
    }

    /// Whether a file has all rows of a part; refuses the part of another study.
    fn is_complete(&self, file: PathBuf, number: u64, count: u64) -> PyResult<bool> {
        let part = Part::new(&*self.study, part_of(number, count)?);
        let state = parts::state(&file, &part.header()).map_err(invalid)?;
        Ok(state == PartState::Complete)
    }
}

impl Study {
    fn for_python<'py>(&self, py: Python<'py>, made: StudyRows) -> PyResult<Rows<'py>> {
        let scales = hunted_scales(&self.study, &made.table);
        let (columns, failure) = for_python(py, made)?;
        Ok((columns, failure, scales))
    }
}

/// Returns doubts about the greatest factors on the records of a hunt.
#[pyfunction]
pub fn strong_scales(scales: Scales) -> Vec<String> {
    GreatestScales(scales).doubts()
}

/// Returns the name of a part's file.
#[pyfunction]
pub fn part_file_name(number: u64, count: u64, format: &str) -> PyResult<String> {
    Ok(part_of(number, count)?.file_name(table_format(format)?))
}

/// Returns the format of parts in a folder with files of these names; refuses those of another set.
#[pyfunction]
pub fn part_format(names: Vec<String>, count: u64, wanted: Option<&str>) -> PyResult<String> {
    let wanted = wanted.map(table_format).transpose()?;
    Ok(parts::format_in(names, count, wanted).map_err(PyValueError::new_err)?.word().into())
}

fn table_format(word: &str) -> PyResult<TableFormat> {
    choice("format", word, &TableFormat::WORDS.iter().map(|(_, format)| *format).collect::<Vec<_>>())
}
