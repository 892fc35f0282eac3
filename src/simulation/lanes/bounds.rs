//! Functions of the motion at both ends of a step, in each lane → where one may fall through zero or rise to a new peak inside.
//!
//! They decide as [`roots::may_fall`](crate::numerics::roots::may_fall) and
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

    /// The lanes in which it may rise above both ends, and higher than this.
    #[inline(always)]
    pub fn may_rise_inside(self, above: Wide<V>) -> u32 {
        let turns = self.turns();
        if !turns.any() {
            return 0;
        }
        turns.bits() & (above.less(self.greater_end()).bits() | above.less(self.tip()).bits())
    }

    /// The lanes in which it may fall through zero.
    #[inline(always)]
    pub fn may_fall(self, rounding: Wide<V>) -> u32 {
        let Ends { start, end, duration } = self;
        let zero = Wide::default();
        let negated = Ends { start: start.negated(), end: end.negated(), duration };
        let above = rounding.less(start.value).bits();
        let dips = negated.may_rise_inside(zero) | zero.less(negated.greater_end()).bits();
        let near = start.value.less(-rounding).bits() | rounding.less(end.value.abs()).bits();
        (above & dips) | (!above & near)
    }
}
