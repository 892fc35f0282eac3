//! Polynomials of several lanes → bounds, zeros and greatest values: the operations of single polynomials, in their order.
//!
//! Only polynomials whose coefficients change their sign once are followed to a zero or a maximum; results name the other lanes.

use super::{Bernstein, DEGREE, Highest, MAX_NEWTON, Pair, ROUNDING, Row, Searched, WIDTH, slopes, value_and_slope};
use crate::numerics::scalar::{Real, Runs, greatest};
use crate::numerics::wide::{Lanes, Simd, Wide};

/// The changes of sign in a sequence.
struct Signs<V: Simd> {
    /// The lanes in which all numbers are positive, or all are negative.
    constant: Lanes<V>,
    /// The lanes in which positive numbers are followed by negative ones.
    falls: Lanes<V>,
    /// The lanes in which negative numbers are followed by positive ones.
    rises: Lanes<V>,
    /// Where the sequence falls, as a fraction of its length.
    crossing: Wide<V>,
}

/// The changes of sign of the first `count` numbers.
#[inline(always)]
fn signs<V: Simd>(numbers: &Row<Wide<V>>, count: usize) -> Signs<V> {
    let zero = Wide::default();
    let first = numbers[0];
    let (mut before, mut after) = (first, numbers[1]);
    let mut index = zero;
    let [begins_above, begins_below] = [zero.less(first), first.less(zero)];
    // Lanes whose numbers all have the first sign so far, and those in which they changed it once.
    let mut same = begins_above.or(begins_below);
    let mut changed = same.except(same);
    for k in 0..count - 1 {
        let [here, next] = [numbers[k], numbers[k + 1]];
        let (above, below) = (zero.less(next), next.less(zero));
        let keeps = begins_above.and(above).or(begins_below.and(below));
        let leaves = begins_above.and(below).or(begins_below.and(above));
        let crosses = (here * next).less(zero).and(same).and(leaves);
        (before, after) = (crosses.choose(here, before), crosses.choose(next, after));
        index = crosses.choose(Wide::from(k as f64), index);
        changed = changed.and(leaves).or(crosses);
        same = same.and(keeps);
    }
    Signs {
        constant: same,
        falls: changed.and(begins_above),
        rises: changed.and(begins_below),
        crossing: (index + before / (before - after)) / Wide::from((count - 1) as f64),
    }
}

/// The lanes in which inner coefficients exceed `most` and both ends, and the polynomial may.
#[inline(always)]
fn exceeding<V: Simd>(coefficients: &Row<Wide<V>>, most: Wide<V>) -> Lanes<V> {
    let value = greatest(greatest(coefficients[0], coefficients[DEGREE]), most);
    let mut exceeds = value.less(value);
    for &coefficient in &coefficients[1..DEGREE] {
        exceeds = exceeds.or(value.less(coefficient));
    }
    exceeds
}

impl<V: Simd> Searched for Wide<V> {
    #[inline(always)]
    #[expect(clippy::needless_range_loop, reason = "`zip` is not inlined")]
    fn highest(pair: &Pair<Self>, lanes: Lanes<V>, [a, b]: [Self; 2], most: Self) -> Highest<Self> {
        let zero = Wide::default();
        let (mut powers, mut coefficients) = ([zero; DEGREE + 1], [zero; DEGREE + 1]);
        for k in 0..DEGREE + 1 {
            let [p, q] = pair.coefficients[k];
            coefficients[k] = a * p + b * q;
        }
        if !exceeding(&coefficients, most).and(lanes).any() {
            return Highest { place: zero, exceeds: lanes.except(lanes), known: lanes };
        }
        for k in 0..DEGREE + 1 {
            let [p, q] = pair.powers[k];
            powers[k] = a * p + b * q;
        }
        Bernstein { degree: pair.degree, powers, coefficients }.highest_in_lanes(lanes, most)
    }
}

impl<V: Simd> Bernstein<Wide<V>> {
    /// The lanes in which all coefficients are positive, and so the polynomial.
    #[inline(always)]
    pub fn is_positive(&self) -> Lanes<V> {
        let zero = Wide::default();
        let mut positive = zero.less(self.coefficients[0]);
        for k in 1..DEGREE + 1 {
            positive = positive.and(zero.less(self.coefficients[k]));
        }
        positive
    }

    /// The zeros in the lanes whose coefficients fall through zero once, and these lanes. See [`zero`](super::Bernstein::zero).
    #[inline(always)]
    pub fn only_zero(&self, lanes: Lanes<V>) -> (Wide<V>, Lanes<V>) {
        let Signs { falls, crossing, .. } = signs(&self.coefficients, DEGREE + 1);
        let lanes = lanes.and(falls);
        let (zero, mut active) = (Wide::default(), lanes);
        let (mut low, mut high, mut place) = (zero, Wide::from(1.0), crossing);
        for _ in 0..MAX_NEWTON {
            if !active.any() {
                break;
            }
            let [value, slope] = value_and_slope(&self.powers, self.degree, place);
            let (next, step) = newton([value, slope], zero.less(value), &mut low, &mut high, place);
            place = active.choose(next, place);
            active = active.and((place * ROUNDING).less(step));
        }
        (place, lanes)
    }

    /// Place and size of the greatest value inside the interval in some lanes. Returns also the lanes in which they are known. The value
    /// exceeds `most` and both ends; if none does, the result is one that does not. See [`highest`](super::Bernstein::highest).
    #[inline(always)]
    pub fn highest_in_lanes(&self, lanes: Lanes<V>, most: Wide<V>) -> Highest<Wide<V>> {
        let (zero, coefficients) = (Wide::default(), &self.coefficients);
        let value = greatest(greatest(coefficients[0], coefficients[DEGREE]), most);
        let exceeds = exceeding(coefficients, most).and(lanes);
        let nothing = lanes.except(exceeds);
        if !exceeds.any() {
            return Highest { place: zero, exceeds, known: nothing };
        }
        let mut differences = [zero; DEGREE + 1];
        for k in 0..DEGREE {
            differences[k] = coefficients[k + 1] - coefficients[k];
        }
        let Signs { constant, falls, rises, crossing } = signs(&differences, DEGREE);
        let (slopes, tops) = (slopes(&self.powers), exceeds.and(falls));
        let (mut low, mut high, mut place, mut active) = (zero, Wide::from(1.0), crossing, tops);
        for _ in 0..MAX_NEWTON {
            if !active.any() {
                break;
            }
            let [slope, curvature] = value_and_slope(&slopes, self.degree, place);
            let (next, step) = newton([slope, curvature], zero.less(slope), &mut low, &mut high, place);
            place = active.choose(next, place);
            active = active.and(Wide::from(WIDTH).less(step));
        }
        let [top, _] = value_and_slope(&self.powers, self.degree, place);
        let known = nothing.or(tops).or(exceeds.and(constant.or(rises)));
        Highest { place, exceeds: tops.and(value.less(top)), known }
    }
}

/// A step of Newton's method to the zero of a falling function, and its size. `value` and `slope` are those at `place`. The interval
/// shrinks; a step that would leave it is one of bisection.
#[inline(always)]
fn newton<V: Simd>(
    [value, slope]: [Wide<V>; 2],
    above: Lanes<V>,
    low: &mut Wide<V>,
    high: &mut Wide<V>,
    place: Wide<V>,
) -> (Wide<V>, Wide<V>) {
    (*low, *high) = (above.choose(place, *low), above.choose(*high, place));
    let next = place - value / slope;
    let outside = next.less(*low).or(high.less(next));
    let next = outside.choose((*low + *high) * 0.5, next);
    (next, (next - place).abs())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::numerics::bernstein::Zero;
    use crate::numerics::wide::{Array, MAX_LANES, Task, VectorWidth};

    /// Polynomials, and numbers that they may exceed.
    struct Cases<'c> {
        powers: &'c [Vec<f64>],
        most: Array,
    }

    impl Task for Cases<'_> {
        /// The result of each function for all lanes, in the order of the calls below.
        type Output = (u32, Array, u32, Array, u32, u32);

        fn run<V: Simd>(self) -> Self::Output {
            let mut powers = [Wide::<V>::default(); DEGREE + 1];
            for (k, power) in powers.iter_mut().enumerate() {
                *power = Wide::each(|lane| self.powers[lane].get(k).copied().unwrap_or(0.0));
            }
            let all = Wide::<V>::default().less(Wide::from(1.0));
            let form = Bernstein::of(powers, DEGREE);
            let (zeros, falls) = form.only_zero(all);
            let Highest { place, exceeds, known } = form.highest_in_lanes(all, Wide::load(&self.most));
            (form.is_positive().bits(), zeros.store(), falls.bits(), place.store(), exceeds.bits(), known.bits())
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

        #[test]
        fn each_lane_decides_as_a_single_polynomial_does(
            powers in prop::collection::vec(prop::collection::vec(-1.0..1.0_f64, 2..9), MAX_LANES),
            most in prop::array::uniform8(-2.0..2.0_f64),
        ) {
            for width in [2, 4, 8].into_iter().filter_map(VectorWidth::at_most) {
                let (positive, zeros, falls, places, exceeds, known) = width.run(Cases { powers: &powers, most });
                for lane in 0..width.lanes() {
                    let mut row = [0.0; DEGREE + 1];
                    row[..powers[lane].len()].copy_from_slice(&powers[lane]);
                    let alone = Bernstein::of(row, powers[lane].len() - 1);
                    let is = |lanes: u32| lanes >> lane & 1 == 1;
                    if is(positive) {
                        prop_assert_eq!(alone.zero(), Zero::None);
                    }
                    if is(falls) {
                        prop_assert_eq!(alone.zero(), Zero::At(zeros[lane]));
                    }
                    if is(known) {
                        prop_assert_eq!(alone.highest(most[lane]), is(exceeds).then_some(places[lane]));
                    }
                }
            }
        }
    }
}
