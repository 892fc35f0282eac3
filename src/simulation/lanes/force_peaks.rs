//! Swings of several runs → the peaks of their forces: the search of a run alone, in its order.

use crate::excitation::Excitation;
use crate::numerics::bernstein::lanes::Pairs;
use crate::numerics::bernstein::{Highest, Row};
use crate::numerics::wide::{Lanes, Simd, Wide};
use crate::simulation::force_peaks::{ForcePair, ForcePeaks, ForceSegment, Runs};
use crate::system::swing::Pivoting;
use crate::system::swing::lanes::Swings;

impl<V: Simd> Runs<Wide<V>> for Lanes<V> {
    #[inline(always)]
    fn less(one: Wide<V>, other: Wide<V>) -> Lanes<V> {
        one.less(other)
    }

    #[inline(always)]
    fn and(self, other: Lanes<V>) -> Lanes<V> {
        Lanes::and(self, other)
    }

    #[inline(always)]
    fn or(self, other: Lanes<V>) -> Lanes<V> {
        Lanes::or(self, other)
    }

    #[inline(always)]
    fn except(self, other: Lanes<V>) -> Lanes<V> {
        Lanes::except(self, other)
    }

    #[inline(always)]
    fn any(self) -> bool {
        Lanes::any(self)
    }

    #[inline(always)]
    fn choose(self, one: Wide<V>, other: Wide<V>) -> Wide<V> {
        one.in_lanes(self, other)
    }
}

impl<V: Simd> ForcePair for Pairs<V> {
    type Number = Wide<V>;
    type Runs = Lanes<V>;

    #[inline(always)]
    fn coefficients(&self) -> &Row<[Wide<V>; 2]> {
        Pairs::coefficients(self)
    }

    #[inline(always)]
    fn at(&self, place: Wide<V>) -> [Wide<V>; 2] {
        Pairs::at(self, place)
    }

    #[inline(always)]
    fn highest(&self, lanes: Lanes<V>, combination: [Wide<V>; 2], most: Wide<V>) -> Highest<Wide<V>, Lanes<V>> {
        Pairs::highest(self, lanes, combination, most)
    }
}

/// Swings up to a fraction, and the forces that act on them.
pub struct LaneSwingForces<'a, V: Simd> {
    pub pivoting: &'a Pivoting<Wide<V>>,
    pub mass: Wide<V>,
    pub excitation: &'a Excitation<Wide<V>>,
    pub time: Wide<V>,
    pub swings: &'a Swings<V>,
    pub fraction: Wide<V>,
}

impl<V: Simd> ForceSegment for LaneSwingForces<'_, V> {
    type Pair = Pairs<V>;

    #[inline(always)]
    fn include_at(&self, peaks: &mut ForcePeaks<Wide<V>>, lanes: Lanes<V>, place: Wide<V>) {
        if lanes.any() {
            let fraction = place * self.fraction;
            let time = self.time + fraction * self.swings.size();
            peaks.include(lanes, self.mass, self.pivoting.forces(self.swings.at(fraction), &self.excitation.at(time)));
            peaks.evaluations = (peaks.evaluations + 1.0).in_lanes(lanes, peaks.evaluations);
        }
    }
}
