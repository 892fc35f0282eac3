//! Functions of the motion at both ends of a step, in each lane → where one may fall through zero or rise to a new peak inside.
//!
//! They decide as [`roots::may_fall_by_bounds`](crate::numerics::roots::may_fall_by_bounds) and
//! [`Peaks`](crate::simulation::peaks::Peaks) do, with the same operations.

use crate::numerics::roots::Sample;
use crate::numerics::wide::{Lanes, Simd, Wide};

/// A function at both ends of a step of `duration`.
#[derive(Clone, Copy)]
pub struct Ends<V> {
    pub start: Sample<Wide<V>>,
    pub end: Sample<Wide<V>>,
    pub duration: Wide<V>,
}

impl<V: Simd> Ends<V> {
    /// The lanes in which it rises at the beginning and falls at the end.
    #[inline(always)]
    fn turns(self) -> Lanes<V> {
        let zero = Wide::default();
        zero.less(self.start.rate).and(self.end.rate.less(zero))
    }

    /// Where the tangents at the ends meet.
    #[inline(always)]
    fn tip(self) -> Wide<V> {
        let Ends { start, end, duration } = self;
        let meeting = (end.value - start.value - end.rate * duration) / (start.rate - end.rate);
        start.value + start.rate * meeting
    }

    /// The greater end.
    #[inline(always)]
    pub fn greater_end(self) -> Wide<V> {
        self.start.value.max(self.end.value)
    }

    /// The greater of the two inner control points of the cubic with these ends.
    #[inline(always)]
    fn polygon(self) -> Wide<V> {
        let Ends { start, end, duration } = self;
        let third = duration * (1.0 / 3.0);
        (start.value + third * start.rate).max(end.value - third * end.rate)
    }

    /// The lanes in which it may rise above both ends, and higher than this.
    #[inline(always)]
    pub fn may_rise_inside(self, above: Wide<V>) -> u32 {
        let above = above.max(self.greater_end());
        let rises = above.less(self.polygon()).bits();
        let turns = self.turns();
        if !turns.any() {
            return rises;
        }
        rises | (turns.bits() & above.less(self.tip()).bits())
    }

    /// The lanes in which it may fall through zero.
    #[inline(always)]
    pub fn may_fall(self, rounding: Wide<V>) -> u32 {
        let Ends { start, end, duration } = self;
        let zero = Wide::default();
        let negated = Ends { start: start.negated(), end: end.negated(), duration };
        let depth = zero.in_lanes(rounding.less(start.value), rounding);
        negated.may_rise_inside(depth) | depth.less(negated.greater_end()).bits()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::numerics::roots;
    use crate::numerics::wide::{Array, Task, VectorWidth};

    /// Ends of steps, and numbers beside which they are seen.
    #[derive(Debug)]
    struct Cases {
        start: Sample<Array>,
        end: Sample<Array>,
        duration: Array,
        above: Array,
        rounding: Array,
    }

    impl Task for &Cases {
        type Output = [u32; 2];

        fn run<V: Simd>(self) -> [u32; 2] {
            let wide = |numbers: &Array| Wide::<V>::load(numbers);
            let sample = |of: &Sample<Array>| Sample { value: wide(&of.value), rate: wide(&of.rate) };
            let ends = Ends { start: sample(&self.start), end: sample(&self.end), duration: wide(&self.duration) };
            [ends.may_rise_inside(wide(&self.above)), ends.may_fall(wide(&self.rounding))]
        }
    }

    /// Numbers among which some are the same.
    fn numbers(scale: f64) -> impl Strategy<Value = Array> {
        let number = prop_oneof![(-4..=4).prop_map(f64::from), -4.0..4.0];
        prop::array::uniform8(number.prop_map(move |number| scale * number))
    }

    prop_compose! {
        fn cases()(
            values in (numbers(1.0), numbers(1.0)),
            rates in (numbers(3.0), numbers(3.0)),
            (duration, above, rounding) in (numbers(1.0), numbers(1.0), numbers(0.5)),
        ) -> Cases {
            Cases {
                start: Sample { value: values.0, rate: rates.0 },
                end: Sample { value: values.1, rate: rates.1 },
                duration: duration.map(|x| 0.5 * x.abs() + 0.1),
                above,
                rounding: rounding.map(f64::abs),
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

        #[test]
        fn each_lane_decides_as_a_run_alone_does(cases in cases()) {
            for width in [2, 4, 8].into_iter().filter_map(VectorWidth::at_most) {
                let [may_rise, may_fall] = width.run(&cases);
                for i in 0..width.lanes() {
                    let at = |of: &Sample<Array>| Sample { value: of.value[i], rate: of.rate[i] };
                    let (start, end, duration) = (at(&cases.start), at(&cases.end), cases.duration[i]);
                    let rises = roots::may_rise_inside(cases.above[i], start, end, duration);
                    prop_assert_eq!(may_rise >> i & 1 == 1, rises, "{} of {:?}", i, &cases);
                    let falls = roots::may_fall_by_bounds(start, end, cases.rounding[i], duration);
                    prop_assert_eq!(may_fall >> i & 1 == 1, falls, "{} of {:?}", i, &cases);
                }
            }
        }
    }
}
