//! Rows of a large table, in any order → the same rows sorted and counted. This takes little memory.
//!
//! Rows are sorted in runs, which fill a temporary file, and merged to another one. The result depends on the rows, not on their order.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};

use rayon::prelude::*;

use crate::fragility::observation::CurveFitError;

/// Rows of a run.
const RUN: usize = 1 << 20;
/// Rows of a batch.
const BATCH: usize = 1 << 16;
/// Rows that a merge reads of a run at a time.
const BLOCK: usize = 1 << 11;
/// Bytes of a row in a file.
const SIZE: usize = 32;

/// The motion of a row that shares it with no other row.
pub(super) const OWN: u32 = u32::MAX;

/// Equal rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EqualRows {
    /// Measures above zero; the second one is 1 for a curve of one.
    pub measures: [f64; 2],
    /// Fraction of its runs that exceeded the limit.
    pub fraction: f64,
    /// Number of its ground motion.
    pub motion: u32,
    /// Number of rows.
    pub count: u32,
}

impl EqualRows {
    /// The row in words that sort as rows do: the bits of numbers from zero on are in the order of the numbers. The count is last.
    fn words(&self) -> [u64; 4] {
        let [first, second] = self.measures;
        let last = u64::from(self.motion) << 32 | u64::from(self.count);
        [first.to_bits(), second.to_bits(), self.fraction.to_bits(), last]
    }

    fn of_words([first, second, fraction, last]: [u64; 4]) -> EqualRows {
        let measures = [f64::from_bits(first), f64::from_bits(second)];
        EqualRows { measures, fraction: f64::from_bits(fraction), motion: (last >> 32) as u32, count: last as u32 }
    }

    fn order(&self, other: &EqualRows) -> Ordering {
        let key = |row: &EqualRows| {
            (row.measures[0].to_bits(), row.measures[1].to_bits(), row.fraction.to_bits(), row.motion)
        };
        key(self).cmp(&key(other))
    }

    fn write(&self, file: &mut impl Write) -> io::Result<()> {
        self.words().iter().try_for_each(|word| file.write_all(&word.to_le_bytes()))
    }

    fn of_bytes(bytes: &[u8]) -> EqualRows {
        let mut words = [0; 4];
        words.iter_mut().zip(bytes.as_chunks().0).for_each(|(word, bytes)| *word = u64::from_le_bytes(*bytes));
        EqualRows::of_words(words)
    }
}

/// Rows in the making.
pub(super) struct RowSorter {
    /// Rows of a run.
    run: usize,
    buffer: Vec<EqualRows>,
    runs: Option<BufWriter<File>>,
    /// Rows of each run.
    lengths: Vec<u64>,
}

impl Default for RowSorter {
    fn default() -> RowSorter {
        RowSorter { run: RUN, buffer: Vec::new(), runs: None, lengths: Vec::new() }
    }
}

impl RowSorter {
    /// Takes a row with a fraction and measures from zero on.
    ///
    /// # Errors
    /// Rows that cannot be kept on disk.
    pub fn push(&mut self, row: EqualRows) -> Result<(), CurveFitError> {
        if self.buffer.len() == self.run {
            self.sort();
            // Rows at few levels stay in memory.
            if self.buffer.len() > self.run / 2 {
                self.end_run().map_err(refused)?;
            }
        }
        self.buffer.push(row);
        Ok(())
    }

    /// Ends with the rows in order.
    ///
    /// # Errors
    /// Rows that cannot be kept on disk.
    pub fn finish(mut self) -> Result<SortedRows, CurveFitError> {
        self.sort();
        let ended = if self.runs.is_some() { self.end_run() } else { Ok(()) };
        ended.and_then(|()| self.merged()).map_err(refused)
    }

    fn sort(&mut self) {
        self.buffer.par_sort_unstable_by(EqualRows::order);
        self.buffer.dedup_by(|next, first| take_equal(first, next));
    }

    fn end_run(&mut self) -> io::Result<()> {
        let file = match &mut self.runs {
            Some(file) => file,
            None => self.runs.insert(BufWriter::new(tempfile::tempfile()?)),
        };
        self.buffer.iter().try_for_each(|row| row.write(file))?;
        self.lengths.push(self.buffer.len() as u64);
        self.buffer.clear();
        Ok(())
    }

    fn merged(self) -> io::Result<SortedRows> {
        let Some(runs) = self.runs else { return Ok(SortedRows { kept: self.buffer, file: None }) };
        drop(self.buffer);
        let file = runs.into_inner().map_err(io::IntoInnerError::into_error)?;
        let mut begin = 0;
        let run = |length: u64| {
            let run = Run { next: begin, end: begin + length, block: Vec::new() };
            begin += length;
            run
        };
        let mut runs: Vec<Run> = self.lengths.into_iter().map(run).collect();
        let mut heads = BinaryHeap::new();
        for (number, run) in runs.iter_mut().enumerate() {
            heads.extend(run.pop(&file)?.map(|row| Reverse((row.words(), number))));
        }
        let mut merged = BufWriter::new(tempfile::tempfile()?);
        let mut last: Option<EqualRows> = None;
        while let Some(mut head) = heads.peek_mut() {
            let Reverse((words, number)) = *head;
            let row = EqualRows::of_words(words);
            match runs[number].pop(&file)? {
                Some(next) => *head = Reverse((next.words(), number)),
                None => drop(std::collections::binary_heap::PeekMut::pop(head)),
            }
            match &mut last {
                Some(last) => {
                    if !take_equal(last, &row) {
                        last.write(&mut merged)?;
                        *last = row;
                    }
                }
                None => last = Some(row),
            }
        }
        last.iter().try_for_each(|row| row.write(&mut merged))?;
        let file = merged.into_inner().map_err(io::IntoInnerError::into_error)?;
        Ok(SortedRows { kept: Vec::new(), file: Some(file) })
    }
}

/// Adds the count of an equal row; returns false for another one.
fn take_equal(first: &mut EqualRows, next: &EqualRows) -> bool {
    if first.order(next) != Ordering::Equal {
        return false;
    }
    let Some(count) = first.count.checked_add(next.count) else { return false };
    first.count = count;
    true
}

/// A sorted run of a file.
struct Run {
    /// Place of the next row to read, in rows.
    next: u64,
    end: u64,
    /// Rows that were read, the next one last.
    block: Vec<EqualRows>,
}

impl Run {
    fn pop(&mut self, mut file: &File) -> io::Result<Option<EqualRows>> {
        if self.block.is_empty() && self.next < self.end {
            let mut bytes = vec![0; SIZE * BLOCK.min((self.end - self.next) as usize)];
            file.seek(SeekFrom::Start(SIZE as u64 * self.next))?;
            file.read_exact(&mut bytes)?;
            self.block.extend(bytes.chunks_exact(SIZE).rev().map(EqualRows::of_bytes));
            self.next += self.block.len() as u64;
        }
        Ok(self.block.pop())
    }
}

/// Rows in the order of their measures, fractions and motions, equal ones counted.
pub(super) struct SortedRows {
    kept: Vec<EqualRows>,
    file: Option<File>,
}

impl SortedRows {
    /// Passes all rows on, batch by batch.
    ///
    /// # Errors
    /// Rows that cannot be read back.
    pub fn batches(&self, each: &mut dyn FnMut(&[EqualRows])) -> Result<(), CurveFitError> {
        let Some(mut file) = self.file.as_ref() else {
            self.kept.chunks(BATCH).for_each(each);
            return Ok(());
        };
        file.seek(SeekFrom::Start(0)).map_err(refused)?;
        let mut bytes = Vec::with_capacity(SIZE * BATCH);
        loop {
            bytes.clear();
            file.take((SIZE * BATCH) as u64).read_to_end(&mut bytes).map_err(refused)?;
            if bytes.is_empty() {
                return Ok(());
            }
            each(&bytes.chunks_exact(SIZE).map(EqualRows::of_bytes).collect::<Vec<_>>());
        }
    }

    /// Sums over all rows, with all threads; the result does not depend on their number.
    ///
    /// # Errors
    /// Rows that cannot be read back.
    pub fn sum<T>(&self, of: impl Fn(&EqualRows) -> T + Sync) -> Result<T, CurveFitError>
    where
        T: Copy + Default + Send + Sync + std::ops::Add<Output = T>,
    {
        /// Rows of a chunk, which is summed one by one.
        const CHUNK: usize = 256;
        let mut batches = Vec::new();
        self.batches(&mut |rows| {
            let chunk = |rows: &[EqualRows]| rows.iter().map(&of).fold(T::default(), |sum, term| sum + term);
            let chunks: Vec<T> = rows.par_chunks(CHUNK).map(chunk).collect();
            batches.push(total(&chunks));
        })?;
        Ok(total(&batches))
    }
}

/// Adds halves, whose round-off is small.
pub(super) fn total<T: Copy + Default + std::ops::Add<Output = T>>(parts: &[T]) -> T {
    match parts {
        [] => T::default(),
        [one] => *one,
        _ => {
            let (first, second) = parts.split_at(parts.len() / 2);
            total(first) + total(second)
        }
    }
}

fn refused(error: io::Error) -> CurveFitError {
    CurveFitError(format!(
        "cannot keep rows in a temporary file in {}: {error}; expected 64 bytes of room for each row; TMPDIR names another folder",
        std::env::temp_dir().display()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(rows: &[EqualRows], run: usize) -> (Vec<EqualRows>, bool) {
        let mut sorter = RowSorter { run, ..RowSorter::default() };
        rows.iter().try_for_each(|row| sorter.push(*row)).unwrap();
        let (found, mut all) = (sorter.finish().unwrap(), Vec::new());
        found.batches(&mut |rows| all.extend_from_slice(rows)).unwrap();
        (all, found.file.is_some())
    }

    /// Runs on disk have the rows that one sort in memory has. Their order does not matter, and equal rows are counted.
    #[test]
    fn rows_are_sorted_and_counted_in_runs() {
        let row = |i: u32| {
            let measures = [f64::from(i * i % 1009 + 1), f64::from(i % 3 + 1)];
            EqualRows { measures, fraction: f64::from(i % 2), motion: i % 5, count: 1 }
        };
        let mut rows: Vec<EqualRows> = (0..50_000).map(row).collect();
        let (expected, in_file) = sorted(&rows, usize::MAX);
        assert!(!in_file && expected.is_sorted_by(|a, b| a.order(b) == Ordering::Less));
        assert_eq!(expected.iter().map(|row| row.count).sum::<u32>(), 50_000);
        let count = |wanted: &EqualRows| rows.iter().filter(|row| row.order(wanted) == Ordering::Equal).count() as u32;
        assert!(expected.iter().step_by(501).all(|row| row.count == count(row)));
        assert_eq!(sorted(&rows, 7_000), (expected.clone(), true));
        rows.reverse();
        assert_eq!(sorted(&rows, 999), (expected.clone(), true));
        // Few different rows need no file.
        let levels: Vec<EqualRows> = (0..50_000).map(|i| row(i % 30)).collect();
        assert_eq!(sorted(&levels, 999), (sorted(&levels, usize::MAX).0, false));
    }
}
