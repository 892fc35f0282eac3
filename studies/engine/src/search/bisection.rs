//! A scan and a function → the changes of its result, bracketed by bisection.
//!
//! Outcomes of rocking blocks are not monotonic: a block may survive a motion and overturn under a weaker one. A range is
//! therefore scanned, and each change seen by the scan is bisected. A change back and forth between two neighbouring scanned
//! values stays undetected; [`OutcomeMap::spacing`] is the greatest width of such an island.

use crate::run::outcome::End;

/// The values of a scan and the resolution of the bisection.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// Least value.
    pub from: f64,
    /// Greatest value.
    pub to: f64,
    /// Number of values, evenly spaced, both ends included; at least two.
    pub points: u64,
    /// Width to which a change is bracketed, above zero, in the unit of the values. It is never narrower than round-off.
    pub resolution: f64,
}

impl Scan {
    /// Distance between neighbouring values.
    fn spacing(&self) -> f64 {
        (self.to - self.from) / (self.points - 1) as f64
    }

    /// Number of bisections from the spacing to the resolution.
    pub(crate) fn halvings(&self) -> u64 {
        /// Bisections between any two numbers; the quotient of some is infinite.
        const MAX_HALVINGS: f64 = 2100.0;
        libm::log2(self.spacing() / self.resolution).ceil().clamp(0.0, MAX_HALVINGS) as u64
    }

    fn value(&self, number: u64) -> f64 {
        match number as f64 / (self.points - 1) as f64 {
            // Round-off must not move the last value.
            1.0 => self.to,
            fraction => self.from + fraction * (self.to - self.from),
        }
    }
}

/// A change of outcome between two values at most the resolution apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutcomeBoundary<K> {
    /// The value below the change.
    pub below: f64,
    /// The value above it.
    pub above: f64,
    /// Outcome at the value below.
    pub from: K,
    /// Outcome at the value above.
    pub to: K,
}

/// The outcomes found by a search.
#[derive(Clone, Debug, PartialEq)]
pub struct OutcomeMap<K> {
    /// Least value of the scan, and the outcome there.
    pub first: (f64, K),
    /// Greatest value of the scan, and the outcome there.
    pub last: (f64, K),
    /// The changes between them, in the order of the values.
    pub changes: Vec<OutcomeBoundary<K>>,
    /// Spacing of the scan: a narrower island of another outcome may have been missed.
    pub spacing: f64,
}

/// The least value of an outcome, within the limits of a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Threshold {
    /// The upper end of the bracketed change.
    At(f64),
    /// An upper bound. The outcome occurs at the least value of the scan, or the runs below this value failed.
    AtMost(f64),
    /// A lower bound, the greatest value of the scan: the outcome does not occur.
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

    /// The kinds of bound in tables. It is `none` where the threshold is bracketed, else `upper` or `lower`.
    pub const BOUNDS: [&'static str; 3] = ["none", "upper", "lower"];

    /// The position of its kind of bound in [`Threshold::BOUNDS`].
    pub fn bound_position(self) -> usize {
        match self {
            Threshold::At(_) => 0,
            Threshold::AtMost(_) => 1,
            Threshold::Above(_) => 2,
        }
    }

    /// Its kind of bound.
    pub fn bound(self) -> &'static str {
        Threshold::BOUNDS[self.bound_position()]
    }
}

impl OutcomeMap<End> {
    /// The least strength that overturns the block.
    pub fn overturning(&self) -> Threshold {
        let stretches = self.stretches();
        match stretches.iter().position(|stretch| stretch.2 == End::Overturned) {
            // A failed or undecided run below leaves only a bound.
            Some(i) if i > 0 && matches!(stretches[i - 1].2, End::Completed | End::Separated) => {
                Threshold::At(stretches[i].0)
            }
            Some(i) => Threshold::AtMost(stretches[i].0),
            None => Threshold::Above(self.last.0),
        }
    }

    /// The least damping ratio above which no run of the scan separates, zero or more.
    pub fn damping_against_separation(&self) -> Threshold {
        match self.least_without(End::Separated) {
            Some(least) if least > self.first.0 || least == 0.0 => Threshold::At(least),
            Some(least) => Threshold::AtMost(least),
            None => Threshold::Above(self.last.0),
        }
    }
}

impl<K: PartialEq + Copy> OutcomeMap<K> {
    /// Stretches of one outcome: from, to, outcome. Neighbours are separated by a gap of at most the resolution.
    pub fn stretches(&self) -> Vec<(f64, f64, K)> {
        let begins = std::iter::once(self.first).chain(self.changes.iter().map(|change| (change.above, change.to)));
        let ends = self.changes.iter().map(|change| change.below).chain(std::iter::once(self.last.0));
        begins.zip(ends).map(|((from, outcome), to)| (from, to, outcome)).collect()
    }

    /// The least value with this outcome.
    pub fn least(&self, outcome: K) -> Option<f64> {
        self.stretches().into_iter().find(|stretch| stretch.2 == outcome).map(|stretch| stretch.0)
    }

    /// The least value above which this outcome does not recur. `None` if the greatest value has it.
    pub fn least_without(&self, outcome: K) -> Option<f64> {
        let stretches = self.stretches();
        let without = stretches.iter().rev().take_while(|stretch| stretch.2 != outcome);
        without.last().map(|stretch| stretch.0)
    }
}

/// Finds the changes of outcome in a range, in several searches at once. It scans the range, then bisects each change.
///
/// `outcomes` receives the number of the search and the value of each evaluation, and returns the outcomes in the same order:
/// first those of all scans, then repeatedly those at the midpoints of all brackets wider than the resolution.
pub fn changes<K: PartialEq + Copy>(
    scan: &Scan,
    searches: usize,
    mut outcomes: impl FnMut(&[(usize, f64)]) -> Vec<K>,
) -> Vec<OutcomeMap<K>> {
    let points = scan.points.max(2);
    let scanned: Vec<(usize, f64)> =
        (0..searches).flat_map(|search| (0..points).map(move |number| (search, scan.value(number)))).collect();
    let ends = outcomes(&scanned);
    let seen: Vec<(f64, K)> = scanned.into_iter().zip(ends).map(|((_, value), outcome)| (value, outcome)).collect();
    let begin = |seen: &[(f64, K)]| OutcomeMap {
        first: seen[0],
        last: seen[seen.len() - 1],
        changes: seen
            .windows(2)
            .filter(|pair| pair[0].1 != pair[1].1)
            .map(|pair| OutcomeBoundary::new(pair[0], pair[1]))
            .collect(),
        spacing: scan.spacing(),
    };
    let mut found: Vec<OutcomeMap<K>> = seen.chunks(points as usize).map(begin).collect();
    loop {
        let middles = |(search, found): (usize, &OutcomeMap<K>)| {
            let middles: Vec<f64> = found.changes.iter().filter_map(|change| change.middle(scan.resolution)).collect();
            middles.into_iter().map(move |middle| (search, middle))
        };
        let middles: Vec<(usize, f64)> = found.iter().enumerate().flat_map(middles).collect();
        if middles.is_empty() {
            return found;
        }
        let mut outcomes = outcomes(&middles).into_iter();
        for found in &mut found {
            let divide = |change: &OutcomeBoundary<K>| match change.middle(scan.resolution) {
                Some(middle) => change.divided(middle, outcomes.next().expect("an outcome for each middle")),
                None => [Some(*change), None],
            };
            found.changes = found.changes.iter().flat_map(divide).flatten().collect();
        }
    }
}

impl<K: PartialEq + Copy> OutcomeBoundary<K> {
    fn new(below: (f64, K), above: (f64, K)) -> OutcomeBoundary<K> {
        OutcomeBoundary { below: below.0, above: above.0, from: below.1, to: above.1 }
    }

    /// The next value to evaluate. There is none once the bracket is as narrow as the resolution, or round-off.
    fn middle(&self, resolution: f64) -> Option<f64> {
        let middle = self.below + 0.5 * (self.above - self.below);
        (self.above - self.below > resolution && middle > self.below && middle < self.above).then_some(middle)
    }

    /// The changes that remain for this outcome at the midpoint. There are two if it is a third outcome.
    fn divided(&self, middle: f64, outcome: K) -> [Option<OutcomeBoundary<K>>; 2] {
        let halves = [
            OutcomeBoundary::new((self.below, self.from), (middle, outcome)),
            OutcomeBoundary::new((middle, outcome), (self.above, self.to)),
        ];
        halves.map(|half| (half.from != half.to).then_some(half))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(from: f64, to: f64, points: u64) -> Scan {
        Scan { from, to, points, resolution: 1e-9 }
    }

    /// Searches the changes of `outcome`.
    fn found<K: PartialEq + Copy>(scan: &Scan, outcome: impl Fn(f64) -> K) -> OutcomeMap<K> {
        let mut found = changes(scan, 1, |values| values.iter().map(|&(_, value)| outcome(value)).collect());
        found.remove(0)
    }

    #[test]
    fn the_number_of_halvings_is_bounded() {
        let halvings = |resolution: f64| Scan { resolution, ..scan(0.0, 8.0, 3) }.halvings();
        assert_eq!([8.0, 4.0, 1.0, 0.9].map(halvings), [0, 0, 2, 3]);
        assert!((1000..10_000).contains(&halvings(f64::from_bits(1))));
    }

    /// Three outcomes: one is an island, one appears only at the midpoint of a bracket.
    #[test]
    fn every_change_is_bracketed() {
        let outcome = |x: f64| match x {
            x if x < 0.2 => 'a',
            x if x < 0.37 => 'b',
            x if x < 0.6 => 'a',
            // Contains the midpoint of the scanned values 0.6 and 0.7.
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

    /// Simultaneous searches give the results of single ones and evaluate the same values.
    #[test]
    fn simultaneous_searches_equal_single_ones() {
        let edges = [[0.3, 0.31], [0.05, 0.9], [2.0, 2.0], [0.55, 0.8]];
        let outcome = |search: usize, x: f64| edges[search].iter().filter(|&&edge| x > edge).count();
        let scan = scan(0.0, 1.0, 11);
        let mut evaluated = vec![Vec::new(); edges.len()];
        let simultaneous = changes(&scan, edges.len(), |values| {
            values.iter().for_each(|&(search, value)| evaluated[search].push(value));
            values.iter().map(|&(search, value)| outcome(search, value)).collect()
        });
        for (search, simultaneous) in simultaneous.into_iter().enumerate() {
            let alone = std::cell::RefCell::new(Vec::new());
            let found = found(&scan, |x| {
                alone.borrow_mut().push(x);
                outcome(search, x)
            });
            assert_eq!(simultaneous, found, "search {search}");
            assert_eq!(evaluated[search], alone.into_inner(), "search {search}");
        }
    }

    /// A resolution below round-off ends at neighbouring numbers.
    #[test]
    fn a_resolution_below_rounding_terminates() {
        let outcome = |x: f64| x > std::f64::consts::FRAC_1_SQRT_2;
        let found = found(&Scan { resolution: 1e-300, ..scan(0.0, 1.0, 2) }, outcome);
        let [change] = found.changes.as_slice() else { panic!("{found:?}") };
        assert_eq!(change.below.next_up(), change.above);
    }
}
