//! A study → its expected cost, from a sample of its rows.

use std::io;
use std::time::{Duration, Instant};

use rocking_block::numerics::wide::VectorWidth;

use crate::output::csv::lines;
use crate::output::runner::Study;

/// Strata of rows of equal size, each with one block of the sample.
const STRATA: u64 = 64;

/// Most rows of a block.
const MAX_BLOCK: u64 = 128;

/// Most rows of a block of single runs, which take longer.
const MAX_SINGLE_BLOCK: u64 = 4;

/// The sample ends after this time, with at least [`MIN_TASKS`] blocks.
const LIMIT: Duration = Duration::from_secs(4);

/// Least number of blocks, for a standard error that means something.
const MIN_TASKS: usize = 8;

/// The expected cost of a study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Number of rows.
    pub rows: u64,
    /// Expected CPU time of one core (s).
    pub seconds: f64,
    /// Its relative standard error from the choice of rows.
    pub uncertainty: f64,
    /// Expected size of the table as CSV (bytes).
    pub bytes: f64,
    /// Rows of the sample.
    pub tried: u64,
}

impl Forecast {
    /// Makes a sample of the rows of a study on this thread, within some seconds. `clock` is the CPU time of the thread.
    ///
    /// # Errors
    /// None in practice: the rows are written to memory.
    pub fn of(study: &impl Study, width: Option<VectorWidth>, clock: impl Fn() -> Duration) -> io::Result<Forecast> {
        let (rows, together) = (study.rows(), study.rows_together());
        let strata = STRATA.min(rows.div_ceil(together)).max(1);
        let begin = Instant::now();
        let (mut costs, mut bytes, mut tried) = (Vec::new(), 0, 0);
        // Strides through the strata, so that an early end leaves an even sample.
        let stride =
            (1..=strata).rev().find(|&stride| stride * 8 <= strata * 5 && gcd(stride, strata) == 1).unwrap_or(1);
        for number in 0..strata {
            if costs.len() >= MIN_TASKS && begin.elapsed() > LIMIT {
                break;
            }
            let stratum = number * stride % strata;
            let [first, end] = [stratum, stratum + 1].map(|stratum| rows / together * stratum / strata * together);
            let most = if study.uses_lanes() { MAX_BLOCK } else { MAX_SINGLE_BLOCK };
            let block = (end - first).min(most.next_multiple_of(together));
            let first = first + (end - first - block) / 2 / together * together;
            let before = clock();
            let made = study.make_range(first..first + block, width);
            if made.table.rows() > 0 {
                costs.push((clock() - before).as_secs_f64() / block as f64);
                bytes += lines(&made.table)?.len();
                tried += block;
            }
        }
        let count = costs.len().max(1) as f64;
        let mean = costs.iter().sum::<f64>() / count;
        let variance = costs.iter().map(|cost| (cost - mean) * (cost - mean)).sum::<f64>() / (count - 1.0).max(1.0);
        Ok(Forecast {
            rows,
            seconds: mean * rows as f64,
            uncertainty: if mean > 0.0 { (variance / count).sqrt() / mean } else { 0.0 },
            bytes: bytes as f64 / tried.max(1) as f64 * rows as f64,
            tried,
        })
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}
