//! A block, a parameter, a range → the values at which the outcome changes.
//!
//! | module | in → out |
//! | --- | --- |
//! | `bisection` | a scan and a function of a value → the changes of its result |

mod bisection;

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::iter::ParallelIterator;
use rayon::slice::ParallelSlice;

use crate::output::runner;
use crate::run::Run;
use crate::run::batch::outcomes;
use crate::run::outcome::End;
pub use bisection::{OutcomeBoundary, OutcomeMap, Scan, Threshold, changes};
use rocking_block::block::{Block, BlockError, Corner, Foundation};
use rocking_block::excitation::Pulse;
use rocking_block::excitation::records::Ground;
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::{Initial, Settings};

/// Receives the number of runs done and the number known to be needed, after each run.
pub type SearchProgress<'a> = &'a (dyn Fn(u64, u64) + Sync);

/// Finds the changes of a run's end over a range, in parallel. The threads are those of the current rayon pool.
///
/// Each thread steps several runs at once in vectors of this width; the result depends neither on the threads nor on the width.
/// The runs known to be needed are first those of the scan, then those of the bisections too.
fn changes_of_end(
    scan: &Scan,
    width: Option<VectorWidth>,
    run: impl Fn(f64) -> Run + Sync,
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
            let outcomes = outcomes(width, values.iter().map(|&(_, value)| run(value)), ended);
            outcomes.iter().map(|outcome| outcome.end).collect::<Vec<End>>()
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

/// The ground motion whose strength is searched.
#[derive(Clone, Debug)]
pub enum Shaking {
    /// A pulse; the search varies its amplitude a_p (m/s²).
    Pulse(Pulse),
    /// Records; the search varies the factor on them.
    Records(Ground),
}

/// The range of strengths in which a block is likely to overturn first. It goes up to ten times a PGA of g tan α.
///
/// On a rigid base under horizontal motion it begins at g tan α (the smaller one of both sides), below which no block rocks. Otherwise
/// it begins at zero: viscoelastic supports respond to weaker motions, vertical motion reduces the weight, and ties may pull to a side.
pub fn usual_strengths(block: &Block, shaking: &Shaking) -> [f64; 2] {
    let (pga, is_horizontal) = match shaking {
        Shaking::Pulse(_) => (1.0, true),
        Shaking::Records(Ground { horizontal, vertical }) => {
            (horizontal.as_ref().map_or(0.0, |record| record.peak().acceleration.abs()), vertical.is_none())
        }
    };
    let static_limit = |alpha: f64| block.gravity * libm::tan(alpha) / pga;
    let holds = block.foundation == Foundation::Rigid && is_horizontal && block.ties().is_empty();
    let [left, right] = Corner::each(|corner| static_limit(block.alpha_of(corner)));
    [if holds { left.min(right) } else { 0.0 }, 10.0 * static_limit(block.alpha)]
}

/// Scans the strength of the ground motion of a block that starts from rest. Each run ends when the block has come down.
///
/// [`OutcomeMap::overturning`] gives the minimum overturning amplitude, or factor.
pub fn overturning(
    block: &Block,
    shaking: &Shaking,
    settings: Settings,
    scan: &Scan,
    width: Option<VectorWidth>,
    progress: SearchProgress,
) -> OutcomeMap<End> {
    let run = |strength: f64| {
        let run = Run::at_rest(*block, settings);
        match shaking {
            Shaking::Pulse(pulse) => Run { pulse: Pulse { amplitude: strength, ..*pulse }, ..run },
            Shaking::Records(ground) => Run { ground: ground.clone().scaled(strength), ..run },
        }
    };
    changes_of_end(scan, width, run, progress)
}
