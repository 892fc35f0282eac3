//! A parameter and its range → where the outcome of a run changes.
//!
//! Outcomes of rocking blocks are not monotonic: a block may stand more and fall under less. So a range is scanned, and
//! every change that the scan sees is closed in by bisection. What lies between two scanned values of the same outcome is
//! not seen; [`Found::spacing`] says how wide that can be.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::iter::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};

use crate::block::{Block, BlockError, Common, Dimensionless};
use crate::excitation::Pulse;
use crate::records::ground::Ground;
use crate::simulation::{Initial, Settings};
use crate::study::history::Run;
use crate::study::outcome::End;
use crate::study::sweep::Levels;

/// The values at which outcomes are looked at, and how closely their changes are found.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// Least value.
    pub from: f64,
    /// Greatest value.
    pub to: f64,
    /// How many values, evenly spaced, both ends included; at least two.
    pub points: u64,
    /// Width to which a change is closed in, in the unit of the values, above zero; below rounding it is taken as that.
    pub resolution: f64,
}

impl Scan {
    fn value(&self, number: u64) -> f64 {
        Levels::Range { from: self.from, to: self.to, logarithmic: false }.at(number as f64 / (self.points - 1) as f64)
    }
}

/// A change of outcome between two values: the first of them has one outcome, the second, which is greater by at most
/// the resolution, another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change<K> {
    /// The value below the change.
    pub below: f64,
    /// The value above it.
    pub above: f64,
    /// Outcome at the value below.
    pub from: K,
    /// Outcome at the value above.
    pub to: K,
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found<K> {
    /// Least value that was looked at, and the outcome there.
    pub first: (f64, K),
    /// Greatest value that was looked at, and the outcome there.
    pub last: (f64, K),
    /// The changes between, in the order of the values.
    pub changes: Vec<Change<K>>,
    /// Distance of two values of the scan: an island of another outcome that is narrower may have been missed.
    pub spacing: f64,
}

impl<K: PartialEq + Copy> Found<K> {
    /// Stretches of one outcome: from, to, outcome. Between two of them lies a gap of the resolution.
    pub fn stretches(&self) -> Vec<(f64, f64, K)> {
        let begins = std::iter::once(self.first).chain(self.changes.iter().map(|change| (change.above, change.to)));
        let ends = self.changes.iter().map(|change| change.below).chain(std::iter::once(self.last.0));
        begins.zip(ends).map(|((from, outcome), to)| (from, to, outcome)).collect()
    }

    /// The least value of this outcome.
    pub fn least(&self, outcome: K) -> Option<f64> {
        self.stretches().into_iter().find(|stretch| stretch.2 == outcome).map(|stretch| stretch.0)
    }

    /// The least value from which on this outcome does not come again; nothing if it is there at the greatest value.
    pub fn least_without(&self, outcome: K) -> Option<f64> {
        let stretches = self.stretches();
        let without = stretches.iter().rev().take_while(|stretch| stretch.2 != outcome);
        without.last().map(|stretch| stretch.0)
    }
}

/// Looks for all changes of outcome in a range: scans it, and bisects every stretch whose ends differ. All is done on the
/// threads of the rayon pool in which it is called, and does not depend on their number. `progress` is called after each
/// run how many are done, and how many there are as far as is known: those of the scan, then those of the bisections too.
pub fn changes<K: PartialEq + Copy + Send + Sync>(
    scan: &Scan,
    outcome: impl Fn(f64) -> K + Sync,
    progress: impl Fn(u64, u64) + Sync,
) -> Found<K> {
    let (done, known) = (AtomicU64::new(0), AtomicU64::new(scan.points));
    let outcome = |value: f64| {
        let outcome = outcome(value);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress(done, known.load(Ordering::Relaxed).max(done));
        outcome
    };
    let spacing = (scan.to - scan.from) / (scan.points - 1) as f64;
    let seen: Vec<(f64, K)> = (0..scan.points.max(2))
        .into_par_iter()
        .map(|number| {
            let value = scan.value(number);
            (value, outcome(value))
        })
        .collect();
    let pairs: Vec<[(f64, K); 2]> =
        seen.windows(2).map(|pair| [pair[0], pair[1]]).filter(|[a, b]| a.1 != b.1).collect();
    // A stretch in which a third outcome turns up takes more.
    known.fetch_add(
        pairs.len() as u64 * libm::log2(spacing / scan.resolution).ceil().max(0.0) as u64,
        Ordering::Relaxed,
    );
    let changes: Vec<Vec<Change<K>>> = pairs
        .par_iter()
        .map(|&[a, b]| {
            let mut found = Vec::new();
            bisect(a, b, scan.resolution, &outcome, &mut found);
            found
        })
        .collect();
    Found { first: seen[0], last: seen[seen.len() - 1], changes: changes.concat(), spacing }
}

/// Needs two values of different outcomes, the lesser one first.
fn bisect<K: PartialEq + Copy>(
    mut below: (f64, K),
    mut above: (f64, K),
    resolution: f64,
    outcome: &impl Fn(f64) -> K,
    found: &mut Vec<Change<K>>,
) {
    while above.0 - below.0 > resolution {
        let middle = below.0 + 0.5 * (above.0 - below.0);
        if middle <= below.0 || middle >= above.0 {
            break;
        }
        let middle = (middle, outcome(middle));
        if middle.1 == below.1 {
            below = middle;
        } else if middle.1 == above.1 {
            above = middle;
        } else {
            bisect(below, middle, resolution, outcome, found);
            below = middle;
        }
    }
    found.push(Change { below: below.0, above: above.0, from: below.1, to: above.1 });
}

/// Outcomes of free vibration from rest on the supports with θ̇(0) = `rate` α p over the damping ratio ξ_v, until the block
/// has come down; the ξ_v of `block` is not read. [`Found::least_without`] of [`End::Separated`] is the damping needed
/// against separation while the block may still stand.
pub fn damping_against_separation(
    block: &Dimensionless,
    common: &Common,
    rate: f64,
    settings: Settings,
    scan: &Scan,
    progress: impl Fn(u64, u64) + Sync,
) -> Result<Found<End>, BlockError> {
    let of = |xi_v: f64| Block::from_dimensionless(&Dimensionless { xi_v, ..*block }, common);
    both_ends(scan, of)?;
    let initial = Initial { theta_dot: rate * block.alpha * block.p, ..Initial::default() };
    let outcome = |xi_v| {
        end(of(xi_v).map(|block| Run {
            block,
            settings,
            initial,
            pulse: Pulse::NONE,
            ground: Ground::default(),
            duration: None,
            output_step: f64::INFINITY,
        }))
    };
    Ok(changes(scan, outcome, progress))
}

/// What moves the ground, up to the number that is searched for.
#[derive(Clone, Debug)]
pub enum Shaking {
    /// A pulse over its amplitude a_p (m/s²); that which it has is not read.
    Pulse(Pulse),
    /// Records over the factor on them.
    Records(Ground),
}

/// The strengths between which a block is likely to overturn first: those of a PGA of g tan α, which rocks no block on a
/// rigid base, and of ten times as much. `pga` is that of strength 1 (m/s²).
pub fn usual_strengths(block: &Block, pga: f64) -> [f64; 2] {
    let least = block.gravity * libm::tan(block.alpha) / pga;
    [least, 10.0 * least]
}

/// Outcomes of a block over the strength of the ground motion, followed until it has come down.
/// [`Found::least`] of [`End::Overturned`] is the minimum overturning amplitude, or factor.
pub fn overturning(
    block: &Block,
    shaking: &Shaking,
    settings: Settings,
    scan: &Scan,
    progress: impl Fn(u64, u64) + Sync,
) -> Found<End> {
    let outcome = |strength: f64| {
        let (ground, pulse) = match shaking {
            Shaking::Pulse(pulse) => (Ground::default(), Pulse { amplitude: strength, ..*pulse }),
            Shaking::Records(ground) => (ground.clone().scaled(strength), Pulse::NONE),
        };
        end(Ok(Run {
            block: *block,
            settings,
            initial: Initial::default(),
            pulse,
            output_step: f64::INFINITY,
            ground,
            duration: None,
        }))
    };
    changes(scan, outcome, progress)
}

/// A damping or a size that is good at both ends of a range is good between.
fn both_ends(scan: &Scan, block: impl Fn(f64) -> Result<Block, BlockError>) -> Result<(), BlockError> {
    [scan.from, scan.to].into_iter().try_for_each(|value| block(value).map(|_| ()))
}

fn end(run: Result<Run, BlockError>) -> End {
    run.map_or(End::Failed, |run| run.outcome().end)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(from: f64, to: f64, points: u64) -> Scan {
        Scan { from, to, points, resolution: 1e-9 }
    }

    /// Three outcomes, one of them an island, one that no scanned value has but that lies in the middle of a change.
    #[test]
    fn every_change_is_closed_in() {
        let outcome = |x: f64| match x {
            x if x < 0.2 => 'a',
            x if x < 0.37 => 'b',
            x if x < 0.6 => 'a',
            // In the middle between the scanned values 0.6 and 0.7.
            x if x < 0.68 && x > 0.64 => 'c',
            x if x <= 0.64 => 'a',
            _ => 'b',
        };
        let found = changes(&scan(0.0, 1.0, 11), outcome, |_, _| ());
        let edges: Vec<(char, char)> = found.changes.iter().map(|change| (change.from, change.to)).collect();
        assert_eq!(edges, [('a', 'b'), ('b', 'a'), ('a', 'c'), ('c', 'b')]);
        for (change, exact) in found.changes.iter().zip([0.2, 0.37, 0.64, 0.68]) {
            assert!(change.below <= exact && exact <= change.above, "{change:?}");
            assert!(change.above - change.below <= 1e-9);
            assert_eq!((outcome(change.below), outcome(change.above)), (change.from, change.to));
        }
        assert_eq!(found.least('b'), Some(found.changes[0].above));
        assert_eq!(found.least_without('a'), Some(found.changes[2].above));
        assert_eq!(found.least_without('b'), None);
        assert_eq!(found.least_without('z'), Some(0.0));
        assert_eq!((found.first, found.last), ((0.0, 'a'), (1.0, 'b')));
        assert!((found.spacing - 0.1).abs() < 1e-15);
    }

    /// A resolution below rounding ends at neighbouring numbers.
    #[test]
    fn a_resolution_that_cannot_be_had_ends() {
        let outcome = |x: f64| x > std::f64::consts::FRAC_1_SQRT_2;
        let found = changes(&Scan { resolution: 1e-300, ..scan(0.0, 1.0, 2) }, outcome, |_, _| ());
        let [change] = found.changes.as_slice() else { panic!("{found:?}") };
        assert_eq!(change.below.next_up(), change.above);
    }
}
