//! A parameter and its range → where the outcome of a run changes.
//!
//! Outcomes of rocking blocks are not monotonic: a block may stand more and fall under less. So a range is scanned, and
//! every change that the scan sees is closed in by bisection. What lies between two scanned values of the same outcome is
//! not seen; [`Found::spacing`] says how wide that can be.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::iter::ParallelIterator;
use rayon::slice::ParallelSlice;

use crate::block::{Block, BlockError, Common, Dimensionless, Foundation};
use crate::excitation::Pulse;
use crate::numerics::wide::Width;
use crate::records::ground::Ground;
use crate::simulation::{Initial, Settings};
use crate::study::history::Run;
use crate::study::outcome::End;
use crate::study::runner;
use crate::study::sweep::Levels;
use crate::study::together::outcomes;

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
    /// How far apart the values are.
    fn spacing(&self) -> f64 {
        (self.to - self.from) / (self.points - 1) as f64
    }

    /// How often a stretch between two values is divided until it is as narrow as the resolution.
    fn halvings(&self) -> u64 {
        libm::log2(self.spacing() / self.resolution).ceil().max(0.0) as u64
    }

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

/// The value at which a block first does something, as far as a scan can tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Threshold {
    /// The upper end of the change, which is closed in to the resolution.
    At(f64),
    /// An upper bound: the block does it at the least value of the scan, or the runs below this value failed.
    AtMost(f64),
    /// A lower bound, the greatest value of the scan: the block does it nowhere.
    Above(f64),
}

impl Threshold {
    /// The value, unless it lies beyond the scan.
    pub fn value(self) -> Option<f64> {
        match self {
            Threshold::At(value) | Threshold::AtMost(value) => Some(value),
            Threshold::Above(_) => None,
        }
    }

    /// How the scan bounds the threshold, as tables say it: `none` where it is found, else `upper` or `lower`.
    pub fn bound(self) -> &'static str {
        match self {
            Threshold::At(_) => "none",
            Threshold::AtMost(_) => "upper",
            Threshold::Above(_) => "lower",
        }
    }
}

impl Found<End> {
    /// The least strength that overturns the block.
    pub fn overturning(&self) -> Threshold {
        let stretches = self.stretches();
        match stretches.iter().position(|stretch| stretch.2 == End::Overturned) {
            // A block that stands or separates does not overturn there; of a failed run nobody knows.
            Some(place) if place > 0 && matches!(stretches[place - 1].2, End::Completed | End::Separated) => {
                Threshold::At(stretches[place].0)
            }
            Some(place) => Threshold::AtMost(stretches[place].0),
            None => Threshold::Above(self.last.0),
        }
    }

    /// The least damping ratio from which on the block does not separate within the scan. None lies below zero.
    pub fn damping_against_separation(&self) -> Threshold {
        match self.least_without(End::Separated) {
            Some(least) if least > self.first.0 || least == 0.0 => Threshold::At(least),
            Some(least) => Threshold::AtMost(least),
            None => Threshold::Above(self.last.0),
        }
    }
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

/// Looks for all changes of outcome in a range, in so many searches side by side: scans it, and bisects every stretch whose ends
/// differ. `outcomes` gets the numbers of searches and the values that are looked at next: first those of all scans, then,
/// again and again, the middles of all stretches that are wider than the resolution. It gives their outcomes in this order.
pub fn changes<K: PartialEq + Copy>(
    scan: &Scan,
    searches: usize,
    mut outcomes: impl FnMut(&[(usize, f64)]) -> Vec<K>,
) -> Vec<Found<K>> {
    let points = scan.points.max(2);
    let scanned: Vec<(usize, f64)> =
        (0..searches).flat_map(|search| (0..points).map(move |number| (search, scan.value(number)))).collect();
    let ends = outcomes(&scanned);
    let seen: Vec<(f64, K)> = scanned.into_iter().zip(ends).map(|((_, value), outcome)| (value, outcome)).collect();
    let begin = |seen: &[(f64, K)]| Found {
        first: seen[0],
        last: seen[seen.len() - 1],
        changes: seen
            .windows(2)
            .filter(|pair| pair[0].1 != pair[1].1)
            .map(|pair| Change::new(pair[0], pair[1]))
            .collect(),
        spacing: scan.spacing(),
    };
    let mut found: Vec<Found<K>> = seen.chunks(points as usize).map(begin).collect();
    loop {
        let middles = |(search, found): (usize, &Found<K>)| {
            let middles: Vec<f64> = found.changes.iter().filter_map(|change| change.middle(scan.resolution)).collect();
            middles.into_iter().map(move |middle| (search, middle))
        };
        let middles: Vec<(usize, f64)> = found.iter().enumerate().flat_map(middles).collect();
        if middles.is_empty() {
            return found;
        }
        let mut outcomes = outcomes(&middles).into_iter();
        for found in &mut found {
            let divide = |change: &Change<K>| match change.middle(scan.resolution) {
                Some(middle) => change.divided(middle, outcomes.next().expect("an outcome for each middle")),
                None => [Some(*change), None],
            };
            found.changes = found.changes.iter().flat_map(divide).flatten().collect();
        }
    }
}

impl<K: PartialEq + Copy> Change<K> {
    fn new(below: (f64, K), above: (f64, K)) -> Change<K> {
        Change { below: below.0, above: above.0, from: below.1, to: above.1 }
    }

    /// The value at which to look next; none once the change is closed in, to the resolution or to rounding.
    fn middle(&self, resolution: f64) -> Option<f64> {
        let middle = self.below + 0.5 * (self.above - self.below);
        (self.above - self.below > resolution && middle > self.below && middle < self.above).then_some(middle)
    }

    /// What is left of the change when its middle has this outcome: two changes where it is a third one.
    fn divided(&self, middle: f64, outcome: K) -> [Option<Change<K>>; 2] {
        let halves = [
            Change::new((self.below, self.from), (middle, outcome)),
            Change::new((middle, outcome), (self.above, self.to)),
        ];
        halves.map(|half| (half.from != half.to).then_some(half))
    }
}

/// The changes of what becomes of a run, on the threads of the rayon pool in which it is called, of which each steps several
/// runs together with vectors of this width. What is found depends on neither. `progress` is called after each run how many
/// are done, and how many there are as far as is known: those of the scan, then those of the bisections too.
fn changes_of_run(
    scan: &Scan,
    width: Option<Width>,
    run: impl Fn(f64) -> Run + Sync,
    progress: impl Fn(u64, u64) + Sync,
) -> Found<End> {
    let (done, mut known) = (AtomicU64::new(0), scan.points);
    let outcomes = |values: &[(usize, f64)]| {
        let before = done.load(Ordering::Relaxed);
        // A stretch in which a third outcome turns up takes more.
        known = known.max(before + values.len() as u64 * if before == scan.points { scan.halvings() } else { 1 });
        let ended = || progress(done.fetch_add(1, Ordering::Relaxed) + 1, known);
        let size = runner::batch(width, values.len() as u64, 1, rayon::current_num_threads() as u64);
        // Of millions of runs no more is kept than how they ended.
        let ends = |values: &[(usize, f64)]| {
            let made = outcomes(width, values.iter().map(|&(_, value)| run(value)), ended);
            made.iter().map(|outcome| outcome.end).collect::<Vec<End>>()
        };
        values.par_chunks(size as usize).map(ends).collect::<Vec<Vec<End>>>().concat()
    };
    let mut found = changes(scan, 1, outcomes);
    found.swap_remove(0)
}

/// Outcomes of free vibration from rest on the supports with θ̇(0) = `rate` α p over the damping ratio ξ_v, until the block
/// has come down; the ξ_v of `block` is not read. [`Found::damping_against_separation`] is the damping needed
/// against separation while the block may still stand.
pub fn damping_against_separation(
    block: &Dimensionless,
    common: &Common,
    rate: f64,
    settings: Settings,
    scan: &Scan,
    width: Option<Width>,
    progress: impl Fn(u64, u64) + Sync,
) -> Result<Found<End>, BlockError> {
    let of = |xi_v: f64| Block::from_dimensionless(&Dimensionless { xi_v, ..*block }, common);
    of(scan.from).and(of(scan.to))?;
    let initial = Initial { theta_dot: rate * block.alpha * block.p, ..Initial::default() };
    let run = |xi_v| Run {
        // What is good at both ends of a range is good between.
        block: of(xi_v).unwrap_or_else(|error| unreachable!("{error}")),
        settings,
        initial,
        pulse: Pulse::NONE,
        ground: Ground::default(),
        duration: None,
        output_step: f64::INFINITY,
    };
    Ok(changes_of_run(scan, width, run, progress))
}

/// What moves the ground, up to the number that is searched for.
#[derive(Clone, Debug)]
pub enum Shaking {
    /// A pulse over its amplitude a_p (m/s²); that which it has is not read.
    Pulse(Pulse),
    /// Records over the factor on them.
    Records(Ground),
}

/// The range of strengths in which a block is likely to overturn first, up to ten times a PGA of g tan α.
///
/// It begins at g tan α where the base is rigid and the ground moves horizontally, since no such block rocks below that, and
/// at zero elsewhere: supports are excited by less, and a vertical motion takes weight away.
pub fn usual_strengths(block: &Block, shaking: &Shaking) -> [f64; 2] {
    let (pga, is_horizontal) = match shaking {
        Shaking::Pulse(_) => (1.0, true),
        Shaking::Records(Ground { horizontal, vertical }) => {
            (horizontal.as_ref().map_or(0.0, |record| record.peak().acceleration.abs()), vertical.is_none())
        }
    };
    let static_limit = block.gravity * libm::tan(block.alpha) / pga;
    let from = if block.foundation == Foundation::Rigid && is_horizontal { static_limit } else { 0.0 };
    [from, 10.0 * static_limit]
}

/// Outcomes of a block over the strength of the ground motion, followed until it has come down.
/// [`Found::overturning`] is the minimum overturning amplitude, or factor.
pub fn overturning(
    block: &Block,
    shaking: &Shaking,
    settings: Settings,
    scan: &Scan,
    width: Option<Width>,
    progress: impl Fn(u64, u64) + Sync,
) -> Found<End> {
    let run = |strength: f64| {
        let (ground, pulse) = match shaking {
            Shaking::Pulse(pulse) => (Ground::default(), Pulse { amplitude: strength, ..*pulse }),
            Shaking::Records(ground) => (ground.clone().scaled(strength), Pulse::NONE),
        };
        Run {
            block: *block,
            settings,
            initial: Initial::default(),
            pulse,
            output_step: f64::INFINITY,
            ground,
            duration: None,
        }
    };
    changes_of_run(scan, width, run, progress)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(from: f64, to: f64, points: u64) -> Scan {
        Scan { from, to, points, resolution: 1e-9 }
    }

    /// One search of `outcome`.
    fn found<K: PartialEq + Copy>(scan: &Scan, outcome: impl Fn(f64) -> K) -> Found<K> {
        let mut found = changes(scan, 1, |values| values.iter().map(|&(_, value)| outcome(value)).collect());
        found.remove(0)
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
        let found = found(&scan(0.0, 1.0, 11), outcome);
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

    /// Searches side by side find what each finds alone, and look at no other values.
    #[test]
    fn searches_side_by_side_are_those_alone() {
        let edges = [[0.3, 0.31], [0.05, 0.9], [2.0, 2.0], [0.55, 0.8]];
        let outcome = |search: usize, x: f64| edges[search].iter().filter(|&&edge| x > edge).count();
        let scan = scan(0.0, 1.0, 11);
        let mut looked = vec![Vec::new(); edges.len()];
        let together = changes(&scan, edges.len(), |values| {
            values.iter().for_each(|&(search, value)| looked[search].push(value));
            values.iter().map(|&(search, value)| outcome(search, value)).collect()
        });
        for (search, together) in together.into_iter().enumerate() {
            let alone = std::cell::RefCell::new(Vec::new());
            let found = found(&scan, |x| {
                alone.borrow_mut().push(x);
                outcome(search, x)
            });
            assert_eq!(together, found, "search {search}");
            assert_eq!(looked[search], alone.into_inner(), "search {search}");
        }
    }

    /// A resolution below rounding ends at neighbouring numbers.
    #[test]
    fn a_resolution_that_cannot_be_had_ends() {
        let outcome = |x: f64| x > std::f64::consts::FRAC_1_SQRT_2;
        let found = found(&Scan { resolution: 1e-300, ..scan(0.0, 1.0, 2) }, outcome);
        let [change] = found.changes.as_slice() else { panic!("{found:?}") };
        assert_eq!(change.below.next_up(), change.above);
    }
}
