//! Rows of a large table, in any order → the same rows sorted and counted, in 32 bytes for each that differs from the others.

use std::cmp::Ordering;

use rayon::prelude::*;

/// Rows that are taken before the first sort.
const RUN: usize = 1 << 20;
/// Rows of a batch.
const BATCH: usize = 1 << 16;

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
    fn order(&self, other: &EqualRows) -> Ordering {
        let key = |row: &EqualRows| {
            (row.measures[0].to_bits(), row.measures[1].to_bits(), row.fraction.to_bits(), row.motion)
        };
        key(self).cmp(&key(other))
    }
}

/// Rows in the making.
pub(super) struct RowSorter {
    rows: Vec<EqualRows>,
    /// Number of rows at which equal ones are counted next.
    next: usize,
}

impl Default for RowSorter {
    fn default() -> RowSorter {
        RowSorter { rows: Vec::new(), next: RUN }
    }
}

impl RowSorter {
    /// Takes a row with a fraction and measures from zero on.
    pub fn push(&mut self, row: EqualRows) {
        if self.rows.len() == self.next {
            self.count();
            // Rows at few levels stay few; others are sorted whenever they have doubled.
            self.next = RUN.max(2 * self.rows.len());
        }
        self.rows.push(row);
    }

    /// Ends with the rows in order.
    pub fn finish(mut self) -> SortedRows {
        self.count();
        SortedRows(self.rows)
    }

    fn count(&mut self) {
        self.rows.par_sort_unstable_by(EqualRows::order);
        self.rows.dedup_by(|next, first| take_equal(first, next));
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

/// Rows in the order of their measures, fractions and motions, equal ones counted.
pub(super) struct SortedRows(Vec<EqualRows>);

impl SortedRows {
    /// All rows, in batches.
    pub fn batches(&self) -> impl Iterator<Item = &[EqualRows]> {
        self.0.chunks(BATCH)
    }

    /// Sums over all rows, with all threads; the result does not depend on their number.
    pub fn sum<T>(&self, of: impl Fn(&EqualRows) -> T + Sync) -> T
    where
        T: Copy + Default + Send + Sync + std::ops::Add<Output = T>,
    {
        /// Rows of a chunk, which is summed one by one.
        const CHUNK: usize = 256;
        let chunk = |rows: &[EqualRows]| rows.iter().map(&of).fold(T::default(), |sum, term| sum + term);
        let batch = |rows: &[EqualRows]| total(&rows.par_chunks(CHUNK).map(chunk).collect::<Vec<T>>());
        total(&self.batches().map(batch).collect::<Vec<T>>())
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

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(rows: &[EqualRows], next: usize) -> Vec<EqualRows> {
        let mut sorter = RowSorter { next, ..RowSorter::default() };
        rows.iter().for_each(|row| sorter.push(*row));
        sorter.finish().batches().flatten().copied().collect()
    }

    /// Rows that are counted on the way are those of one sort at the end. Their order does not matter.
    #[test]
    fn rows_are_sorted_and_counted() {
        let row = |i: u32| {
            let measures = [f64::from(i * i % 1009 + 1), f64::from(i % 3 + 1)];
            EqualRows { measures, fraction: f64::from(i % 2), motion: i % 5, count: 1 }
        };
        let mut rows: Vec<EqualRows> = (0..50_000).map(row).collect();
        let expected = sorted(&rows, usize::MAX);
        assert!(expected.is_sorted_by(|a, b| a.order(b) == Ordering::Less));
        assert_eq!(expected.iter().map(|row| row.count).sum::<u32>(), 50_000);
        let count = |wanted: &EqualRows| rows.iter().filter(|row| row.order(wanted) == Ordering::Equal).count() as u32;
        assert!(expected.iter().step_by(501).all(|row| row.count == count(row)));
        assert_eq!(sorted(&rows, 7_000), expected);
        rows.reverse();
        assert_eq!(sorted(&rows, 999), expected);
    }
}
