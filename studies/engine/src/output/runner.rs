//! Numbered tasks → their results in order, computed on all cores in bounded memory.

use std::collections::VecDeque;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::Path;
use std::sync::mpsc::sync_channel;

use crate::output::csv::lines;
use crate::output::resumable::{Failures, ResumableTable, TableHeader, TableOptions, TableWriteError};
use crate::output::table::Table;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::SimulationError;

/// Tasks per thread in progress or waiting for their turn. A task this many times longer than the others delays none.
const AHEAD: u64 = 32;

/// Batches of rows per thread in progress or waiting for their turn.
const BATCHES_AHEAD: u64 = 4;

/// Maximum number of runs per batch; a row is never split.
pub(crate) const MAX_RUNS: u64 = 512;

/// Maximum number of runs per batch without vectors: passing on a batch costs little beside 16 runs.
const MAX_SINGLE_RUNS: u64 = 16;

/// A study: a table of rows, each from one or several runs.
pub trait Study: Sync {
    /// Description and columns of the table.
    fn header(&self) -> TableHeader;
    /// Number of rows.
    fn rows(&self) -> u64;
    /// Number of runs per row.
    fn runs_in_a_row(&self) -> u64;
    /// Number of neighbouring rows that are made together.
    fn rows_together(&self) -> u64 {
        1
    }
    /// Whether its runs are stepped in vectors; otherwise batches of rows are small.
    fn uses_lanes(&self) -> bool {
        true
    }
    /// Makes rows by their ascending numbers, in the columns of the header. Each row depends on its number alone.
    ///
    /// Runs are stepped in vectors of this width, or one by one without.
    fn make(&self, numbers: &[u64], width: Option<VectorWidth>) -> StudyRows;
    /// Makes neighbouring rows, as [`Study::make`] does.
    fn make_range(&self, numbers: Range<u64>, width: Option<VectorWidth>) -> StudyRows {
        self.make(&numbers.collect::<Vec<_>>(), width)
    }
    /// Opens the table of the study in this file.
    ///
    /// # Errors
    /// Those of [`ResumableTable::open`].
    fn open(&self, path: &Path, options: TableOptions) -> Result<ResumableTable, TableWriteError> {
        ResumableTable::open(path, &self.header(), self.rows(), options)
    }
}

/// A batch of rows of a study.
#[derive(Debug, Default)]
pub struct StudyRows {
    /// The rows.
    pub table: Table,
    /// Reason of the first failed run.
    pub failure: Option<SimulationError>,
}

impl StudyRows {
    /// Appends the next batch.
    pub fn append(&mut self, next: StudyRows) {
        self.table.append(next.table);
        self.failure = self.failure.take().or(next.failure);
    }
}

/// The number of rows and failures of a study.
#[derive(Debug)]
pub struct StudySummary {
    /// Rows of the whole table.
    pub rows: u64,
    /// Rows made earlier and resumed.
    pub resumed: u64,
    /// Rows of failed runs, including resumed ones.
    pub failures: Failures,
    /// Reason of the first failure since the study was resumed.
    pub reason: Option<SimulationError>,
}

/// Makes the missing rows of a study. `progress` receives the numbers of resumed and of complete rows.
///
/// `follow` receives all rows in batches, resumed ones as well. The bytes of the table depend neither on the number of threads nor on
/// interruptions.
///
/// # Errors
/// The table cannot be read or written.
pub fn run(
    study: &impl Study,
    pool: &rayon::ThreadPool,
    width: Option<VectorWidth>,
    table: &mut ResumableTable,
    mut follow: Option<Follower>,
    mut progress: impl FnMut(u64, u64),
) -> Result<StudySummary, TableWriteError> {
    let resumed = table.rows();
    progress(resumed, resumed);
    if let Some(follow) = &mut follow {
        table.read_resumed(&study.header(), follow)?;
    }
    let width = width.filter(|_| study.uses_lanes());
    let mut reason = None;
    let is_text = table.is_text();
    let make = |numbers: Range<u64>| {
        let rows = study.make_range(numbers, width);
        // Here, since this part is done on all cores.
        (if is_text { lines(&rows.table) } else { Ok(String::new()) }, rows)
    };
    let take = |(lines, StudyRows { table: rows, failure })| {
        table.push(lines, &rows)?;
        reason = reason.take().or(failure);
        progress(resumed, table.rows());
        follow.as_mut().map_or(Ok(()), |follow| follow(rows))
    };
    in_batches(pool, resumed..study.rows(), width, study.runs_in_a_row(), make, take)?;
    Ok(StudySummary { rows: study.rows(), resumed, failures: table.failures(), reason })
}

/// A function that receives rows in batches.
pub type Follower<'a> = &'a mut dyn FnMut(Table) -> Result<(), TableWriteError>;

/// A pool of this number of threads; without a number, one per core.
///
/// # Errors
/// The system refuses a thread.
pub fn pool(threads: Option<usize>) -> Result<rayon::ThreadPool, rayon::ThreadPoolBuildError> {
    rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()
}

/// Makes numbered results on the current pool of threads, or one after the other outside of a pool. The global pool of the library is
/// never started: a forked process lacks its threads, and would wait for them for ever.
pub fn in_parallel<T: Send>(count: usize, make: impl Fn(usize) -> T + Sync) -> Vec<T> {
    match rayon::current_thread_index() {
        Some(_) => (0..count).into_par_iter().map(&make).collect(),
        None => (0..count).map(&make).collect(),
    }
}

/// Returns the rows per batch. They fill the lanes of this width most of the time, and occupy all threads.
pub(crate) fn batch(width: Option<VectorWidth>, rows: u64, runs_in_a_row: u64, threads: u64) -> u64 {
    let (ahead, most) = if width.is_none() { (AHEAD, MAX_SINGLE_RUNS) } else { (BATCHES_AHEAD, MAX_RUNS) };
    rows.div_ceil(ahead * threads).min(most / runs_in_a_row).max(1)
}

/// Makes rows of `runs_in_a_row` runs in batches, and passes these to `take` in order. It proceeds as [`in_order`].
///
/// `make` makes the rows with the given numbers; the size of a batch suits vectors of this width.
///
/// # Errors
/// The first error of `take`.
pub fn in_batches<T: Send, E>(
    pool: &rayon::ThreadPool,
    rows: Range<u64>,
    width: Option<VectorWidth>,
    runs_in_a_row: u64,
    make: impl Fn(Range<u64>) -> T + Sync,
    mut take: impl FnMut(T) -> Result<(), E>,
) -> Result<(), E> {
    let size = batch(width, rows.end - rows.start, runs_in_a_row, pool.current_num_threads() as u64);
    let ahead = if width.is_none() { AHEAD } else { BATCHES_AHEAD };
    let of = |number: u64| rows.start + number * size..rows.end.min(rows.start + (number + 1) * size);
    let batches = 0..(rows.end - rows.start).div_ceil(size);
    in_order_ahead(pool, ahead, batches, |number| make(of(number)), |_, rows| take(rows))
}

/// Makes tasks on the pool, and passes the results to `take` in order. The tasks are made in any order.
///
/// At most 32 tasks per thread are in progress or waiting for their turn. The first error of `take` ends the work; so does a panic
/// of a task, which continues in the caller.
///
/// # Errors
/// The first error of `take`.
pub fn in_order<T: Send, E>(
    pool: &rayon::ThreadPool,
    tasks: Range<u64>,
    make: impl Fn(u64) -> T + Sync,
    take: impl FnMut(u64, T) -> Result<(), E>,
) -> Result<(), E> {
    in_order_ahead(pool, AHEAD, tasks, make, take)
}

/// As [`in_order`], with `ahead` tasks per thread in progress or waiting.
fn in_order_ahead<T: Send, E>(
    pool: &rayon::ThreadPool,
    ahead: u64,
    tasks: Range<u64>,
    make: impl Fn(u64) -> T + Sync,
    mut take: impl FnMut(u64, T) -> Result<(), E>,
) -> Result<(), E> {
    let window = ahead * pool.current_num_threads() as u64;
    // Room for all tasks of the window: no thread waits to send its result.
    let (sender, receiver) = sync_channel(window as usize);
    let make = &make;
    pool.in_place_scope_fifo(|scope| {
        let receiver = receiver;
        // Results from the task whose turn it is, as far as available.
        let mut waiting: VecDeque<Option<T>> = VecDeque::new();
        let (mut next, mut turn) = (tasks.start, tasks.start);
        while turn < tasks.end {
            while next < tasks.end && next < turn + window {
                waiting.push_back(None);
                let (sender, task) = (sender.clone(), next);
                scope.spawn_fifo(move |_| {
                    // The receiver is gone once the work has ended.
                    let _ = sender.send((task, catch_unwind(AssertUnwindSafe(|| make(task)))));
                });
                next += 1;
            }
            let Ok((task, result)) = receiver.recv() else {
                unreachable!("this thread holds a sender");
            };
            waiting[(task - turn) as usize] = Some(result.unwrap_or_else(|panic| resume_unwind(panic)));
            while let Some(result) = waiting.front_mut().and_then(Option::take) {
                waiting.pop_front();
                take(turn, result)?;
                turn += 1;
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};

    /// While the first task runs, the others fill the window, and no more begin.
    #[test]
    fn results_come_in_order_within_the_window() {
        let (taken, furthest, begun) = (AtomicU64::new(0), AtomicU64::new(0), AtomicU64::new(0));
        let mut order = Vec::new();
        let make = |task: u64| {
            furthest.fetch_max(task - taken.load(Ordering::SeqCst), Ordering::SeqCst);
            begun.fetch_add(1, Ordering::SeqCst);
            while task == 5 && begun.load(Ordering::SeqCst) < 3 * AHEAD {
                std::thread::yield_now();
            }
            task * task
        };
        let done = in_order(&pool(Some(3)).unwrap(), 5..1000, make, |task, result| {
            assert_eq!(result, task * task);
            order.push(task);
            taken.store(task, Ordering::SeqCst);
            Ok::<(), ()>(())
        });
        assert_eq!(done, Ok(()));
        assert!(order.into_iter().eq(5..1000));
        let furthest = furthest.into_inner();
        assert!((2..=3 * AHEAD + 5).contains(&furthest), "{furthest} tasks ahead");
    }

    #[test]
    fn an_error_of_the_receiver_ends_the_work() {
        let made = AtomicU64::new(0);
        let make = |task: u64| {
            made.fetch_add(1, Ordering::SeqCst);
            task
        };
        let ended =
            in_order(&pool(Some(2)).unwrap(), 0..100_000, make, |task, _| if task == 3 { Err(task) } else { Ok(()) });
        assert_eq!(ended, Err(3));
        assert!(made.into_inner() <= 4 + 2 * AHEAD);
    }

    #[test]
    #[should_panic(expected = "task 7")]
    fn a_panic_of_a_task_continues_in_the_caller() {
        let make = |task: u64| assert_ne!(task, 7, "task 7");
        in_order(&pool(Some(2)).unwrap(), 0..100, make, |_, ()| Ok::<(), ()>(())).unwrap();
    }
}
