//! Numbered tasks → their results in order, made on all cores, with bounded memory.

use std::collections::VecDeque;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::Path;
use std::sync::mpsc::sync_channel;

use crate::numerics::wide::Width;
use crate::simulation::SimulationError;
use crate::study::resumable::{Failures, Head, Opening, ResumableTable, TableError};

/// Tasks under way or waiting for their turn, for each thread: so many that a task which takes that many times longer
/// than the others keeps nobody waiting.
const AHEAD: u64 = 32;

/// The same of batches of rows.
const BATCHES_AHEAD: u64 = 4;

/// Runs that a thread makes together, at most, but those of one row.
pub(super) const MOST_RUNS: u64 = 512;

/// Many runs, a row each.
pub trait Study: Sync {
    /// What stands over the rows.
    fn head(&self) -> Head;
    /// How many rows there are.
    fn rows(&self) -> u64;
    /// How many runs a row takes.
    fn runs_in_a_row(&self) -> u64;
    /// Makes some rows, their fields without the rows' numbers. A row depends on its number alone; runs are stepped together with
    /// vectors of this width, or each by itself.
    fn make(&self, numbers: Range<u64>, width: Option<Width>) -> Vec<StudyRow>;
    /// Opens the study's table, in a file of this name.
    ///
    /// # Errors
    /// Those of [`ResumableTable::open`].
    fn open(&self, path: &Path, opening: Opening) -> Result<ResumableTable, TableError> {
        ResumableTable::open(path, &self.head(), self.rows(), opening)
    }
}

/// A row of a study.
pub struct StudyRow {
    /// Its fields.
    pub fields: Vec<String>,
    /// Why its run failed, if it did.
    pub failure: Option<SimulationError>,
}

/// What became of a study.
#[derive(Debug)]
pub struct Made {
    /// Rows of the whole table.
    pub rows: u64,
    /// Rows that were there before.
    pub before: u64,
    /// Rows of runs that failed, those that were there before included.
    pub failures: Failures,
    /// Why the first of those that were made now failed.
    pub reason: Option<SimulationError>,
}

/// Makes the rows of a study that are not in its table yet; `progress` gets how many rows were there before and how
/// many there are. The table is the same bytes whatever the number of threads and however often it was interrupted.
pub fn run(
    study: &impl Study,
    pool: &rayon::ThreadPool,
    width: Option<Width>,
    table: &mut ResumableTable,
    mut progress: impl FnMut(u64, u64),
) -> Result<Made, TableError> {
    let before = table.rows();
    progress(before, before);
    let mut reason = None;
    let take = |number: u64, row: StudyRow| {
        table.push(row.fields)?;
        reason = reason.take().or(row.failure);
        progress(before, number + 1);
        Ok::<(), TableError>(())
    };
    let rows = before..study.rows();
    in_batches(pool, rows, width, study.runs_in_a_row(), |numbers| study.make(numbers, width), take)?;
    Ok(Made { rows: study.rows(), before, failures: table.failures(), reason })
}

/// A pool of so many threads; without a number, one for each core.
pub fn pool(threads: Option<usize>) -> Result<rayon::ThreadPool, rayon::ThreadPoolBuildError> {
    rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()
}

/// Rows that a thread makes together: so many that the lanes of this width are full most of the time, and so few that all
/// threads have some; one where each run is made by itself.
pub(super) fn batch(width: Option<Width>, rows: u64, runs_in_a_row: u64, threads: u64) -> u64 {
    if width.is_none() {
        return 1;
    }
    rows.div_ceil(BATCHES_AHEAD * threads).min(MOST_RUNS / runs_in_a_row).max(1)
}

/// Makes rows in batches, `runs_in_a_row` runs each, and gives them to `take` in their order; otherwise as [`in_order`].
///
/// A batch has so many rows that the lanes of vectors of this width are full most of the time while its runs are stepped together.
/// `make` gives the rows of the numbers it gets.
pub fn in_batches<T: Send, E>(
    pool: &rayon::ThreadPool,
    rows: Range<u64>,
    width: Option<Width>,
    runs_in_a_row: u64,
    make: impl Fn(Range<u64>) -> Vec<T> + Sync,
    mut take: impl FnMut(u64, T) -> Result<(), E>,
) -> Result<(), E> {
    let size = batch(width, rows.end - rows.start, runs_in_a_row, pool.current_num_threads() as u64);
    let ahead = if width.is_none() { AHEAD } else { BATCHES_AHEAD };
    let of = |number: u64| rows.start + number * size..rows.end.min(rows.start + (number + 1) * size);
    let batches = 0..(rows.end - rows.start).div_ceil(size);
    in_order_ahead(
        pool,
        ahead,
        batches,
        |number| make(of(number)),
        |batch, made| of(batch).zip(made).try_for_each(|(number, row)| take(number, row)),
    )
}

/// Makes each task of `tasks` on the pool, in any order, and gives the results to `take` in the order of the tasks.
///
/// At most 32 tasks a thread are under way or done ahead of their turn, however many there are. The first error of `take`
/// ends the work; so does a panic of a task, which goes on in the caller.
pub fn in_order<T: Send, E>(
    pool: &rayon::ThreadPool,
    tasks: Range<u64>,
    make: impl Fn(u64) -> T + Sync,
    take: impl FnMut(u64, T) -> Result<(), E>,
) -> Result<(), E> {
    in_order_ahead(pool, AHEAD, tasks, make, take)
}

/// The same with so many tasks a thread under way or done ahead of their turn.
fn in_order_ahead<T: Send, E>(
    pool: &rayon::ThreadPool,
    ahead: u64,
    tasks: Range<u64>,
    make: impl Fn(u64) -> T + Sync,
    mut take: impl FnMut(u64, T) -> Result<(), E>,
) -> Result<(), E> {
    let window = ahead * pool.current_num_threads() as u64;
    // There is room for all tasks under way, so that no thread ever waits.
    let (sender, receiver) = sync_channel(window as usize);
    let make = &make;
    pool.in_place_scope_fifo(|scope| {
        let receiver = receiver;
        // The results of the tasks from that whose turn it is, as far as they are there.
        let mut waiting: VecDeque<Option<T>> = VecDeque::new();
        let (mut next, mut turn) = (tasks.start, tasks.start);
        while turn < tasks.end {
            while next < tasks.end && next < turn + window {
                waiting.push_back(None);
                let (sender, task) = (sender.clone(), next);
                scope.spawn_fifo(move |_| {
                    // Nobody listens any more if the work was ended.
                    let _ = sender.send((task, catch_unwind(AssertUnwindSafe(|| make(task)))));
                });
                next += 1;
            }
            let Ok((task, result)) = receiver.recv() else {
                unreachable!("a sender is held here");
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

    /// The first task is the slowest: the others wait for it, but not more of them than there is room for.
    #[test]
    fn results_come_in_order_and_few_wait() {
        let (taken, furthest) = (AtomicU64::new(0), AtomicU64::new(0));
        let mut order = Vec::new();
        let make = |task: u64| {
            furthest.fetch_max(task - taken.load(Ordering::SeqCst), Ordering::SeqCst);
            if task == 5 {
                std::thread::sleep(std::time::Duration::from_millis(50));
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
    fn an_error_of_the_taker_ends_the_work() {
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
    fn a_panic_of_a_task_goes_on_in_the_caller() {
        let make = |task: u64| assert_ne!(task, 7, "task 7");
        in_order(&pool(Some(2)).unwrap(), 0..100, make, |_, ()| Ok::<(), ()>(())).unwrap();
    }
}
