//! A block, a parameter, a range → the values at which the outcome changes.
//!
//! | module | in → out |
//! | --- | --- |
//! | `bisection` | a scan and a function of a value → the changes of its result |
//! | `shaken` | a run, in the plane or in space → the same run at another strength, and the usual strengths |

mod bisection;
mod shaken;

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::iter::ParallelIterator;
use rayon::slice::ParallelSlice;

use crate::output::runner;
use crate::run::Run;
use crate::run::outcome::End;
use crate::run::rows::{Experiment, RunOutcome};
pub use bisection::{OutcomeBoundary, OutcomeMap, Scan, Threshold, changes};
use rocking_block::block::{Block, BlockError};
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::{Initial, Settings};
pub use shaken::Shaken;

/// Receives the number of runs done and the number known to be needed, after each run.
pub type SearchProgress<'a> = &'a (dyn Fn(u64, u64) + Sync);

/// Finds the changes of a run's end over a range, in parallel. The threads are those of the current rayon pool.
///
/// Each thread steps several runs at once in vectors of this width; the result depends neither on the threads nor on the width.
/// The runs known to be needed are first those of the scan, then those of the bisections too.
fn changes_of_end<E: Experiment>(
    scan: &Scan,
    width: Option<VectorWidth>,
    run: impl Fn(f64) -> E + Sync,
    progress: SearchProgress,
) -> OutcomeMap<End> {
    let (done, mut known) = (AtomicU64::new(0), scan.points);
    let outcomes = |values: &[(usize, f64)]| {
        let before = done.load(Ordering::Relaxed);
        // A third outcome inside a bracket adds runs later.
        known = known.max(before + values.len() as u64 * if before == scan.points { scan.halvings() } else { 1 });
        let ended = || progress(done.fetch_add(1, Ordering::Relaxed) + 1, known);
        let size = runner::batch(width, values.len() as u64, 1, rayon::current_num_threads() as u64);
        // A scan may have millions of values: only the ends are kept.
        let ends = |values: &[(usize, f64)]| {
            let outcomes = E::outcomes(width, values.iter().map(|&(_, value)| run(value)), ended);
            outcomes.iter().map(RunOutcome::end).collect::<Vec<End>>()
        };
        values.par_chunks(size as usize).map(ends).collect::<Vec<Vec<End>>>().concat()
    };
    let mut found = changes(scan, 1, outcomes);
    found.swap_remove(0)
}

/// Scans the damping ratio ξ_v of a block thrown from its supports. It starts with θ̇(0) = `rate` α p.
///
/// It vibrates freely until it has come down.
/// [`OutcomeMap::damping_against_separation`] gives the damping needed against separation.
///
/// # Errors
/// An invalid block at an end of the range.
pub fn damping_against_separation(
    block: &Block,
    rate: f64,
    settings: Settings,
    scan: &Scan,
    width: Option<VectorWidth>,
    progress: SearchProgress,
) -> Result<OutcomeMap<End>, BlockError> {
    block.with_damping_ratio(scan.from).and(block.with_damping_ratio(scan.to))?;
    let run = |xi_v| {
        // A block that is valid at both ends of the range is valid between them.
        let block = block.with_damping_ratio(xi_v).unwrap_or_else(|error| unreachable!("{error}"));
        let initial = Initial { theta_dot: rate * block.alpha * block.p, ..Initial::default() };
        Run { initial, ..Run::at_rest(block, settings) }
    };
    Ok(changes_of_end(scan, width, run, progress))
}

/// Scans the strength of the ground motion of a run. Each run ends when the block has come down.
///
/// [`OutcomeMap::overturning`] gives the minimum overturning amplitude, or factor.
pub fn overturning<E: Shaken>(
    run: &E,
    scan: &Scan,
    width: Option<VectorWidth>,
    progress: SearchProgress,
) -> OutcomeMap<End> {
    changes_of_end(scan, width, |strength| run.at_strength(strength), progress)
}
