//! Swings of several runs → the peaks of their forces: the search of a run alone, in its order.

use crate::excitation::Excitation;
use crate::numerics::Real;
use crate::numerics::bernstein::DEGREE;
use crate::numerics::bernstein::lanes::{Highest, Pairs};
use crate::numerics::wide::{Lanes, Simd, Wide};
use crate::simulation::force_peaks::{MAX_ROUNDS, PRESSED, friction_demand};
use crate::system::swing::Pivoting;
use crate::system::swing::lanes::Swings;

/// Swings up to a part, with what acts on them.
pub struct SwingSegments<'a, V: Simd> {
    pub pivoting: &'a Pivoting<Wide<V>>,
    pub mass: Wide<V>,
    pub excitation: &'a Excitation<Wide<V>>,
    pub time: Wide<V>,
    pub swings: &'a Swings<V>,
    pub part: Wide<V>,
}

impl<V: Simd> SwingSegments<'_, V> {
    /// N/M and H/M (m/s²) at a place, by the equations of motion.
    #[inline(always)]
    fn forces_at(&self, place: Wide<V>) -> [Wide<V>; 2] {
        let part = place * self.part;
        let time = self.time + part * self.swings.size();
        self.pivoting.forces(self.swings.at(part), &self.excitation.at(time))
    }
}

/// Peaks of N (N), H (N) and the friction demand (1).
pub struct ForcePeaks<V> {
    pub reaction: Wide<V>,
    pub horizontal: Wide<V>,
    pub friction_demand: Wide<V>,
    /// The number of evaluations of the equations of motion.
    pub evaluations: Wide<V>,
}

impl<V: Simd> ForcePeaks<V> {
    /// Includes N/M and H/M (m/s²) in some lanes.
    #[inline(always)]
    fn include(&mut self, lanes: Lanes<V>, mass: Wide<V>, [n, h]: [Wide<V>; 2]) {
        self.reaction = self.reaction.max(mass * n).in_lanes(lanes, self.reaction);
        self.horizontal = self.horizontal.max(mass * h.abs()).in_lanes(lanes, self.horizontal);
        let demand = friction_demand([n, h]);
        self.friction_demand = self.friction_demand.max(demand).in_lanes(lanes, self.friction_demand);
    }

    /// Includes the forces at a place of some lanes, by the equations of motion.
    #[inline(always)]
    fn include_at(&mut self, lanes: Lanes<V>, segments: &SwingSegments<V>, place: Wide<V>) {
        if lanes.any() {
            self.include(lanes, segments.mass, segments.forces_at(place));
            self.evaluations = (self.evaluations + 1.0).in_lanes(lanes, self.evaluations);
        }
    }

    /// Includes the forces on the segments of some lanes, those at the end unless the next swing begins with them. Returns the lanes in which the
    /// corner is certainly pressed on and all peaks are known.
    #[inline(always)]
    pub fn raise(
        &mut self,
        lanes: Lanes<V>,
        segments: &SwingSegments<V>,
        next_is_swing: Lanes<V>,
        visible: Wide<V>,
    ) -> Lanes<V> {
        let (forces, mass) = (segments.swings.forces(segments.part, segments.pivoting.gravity), segments.mass);
        let (coefficients, pressed) = (forces.coefficients(), segments.pivoting.gravity * PRESSED);
        self.include(lanes, mass, coefficients[0]);
        let (most, steepest, demand) = (self.reaction / mass, self.horizontal / mass, self.friction_demand);
        let (mut holds, mut exceeds) = (lanes, lanes.except(lanes));
        let mut exceeds_at_end = exceeds;
        for &[n, h] in coefficients {
            holds = holds.and(pressed.less(n));
            exceeds_at_end = most.less(n).or(steepest.less(h.abs())).or((demand * n).less(h.abs()));
            exceeds = exceeds.or(exceeds_at_end);
        }
        let exceeds = exceeds.and(holds);
        if !exceeds.any() {
            return holds;
        }
        self.include_at(exceeds.and(exceeds_at_end).except(next_is_swing), segments, Wide::from(1.0));
        let unknown = exceeds.except(self.search(exceeds, segments, &forces, visible));
        holds.except(unknown)
    }

    /// Includes the forces at the places in some lanes at which one of them exceeds its peak and its values at both ends. Returns the lanes
    /// in which all of these places are known.
    #[inline(always)]
    fn search(
        &mut self,
        lanes: Lanes<V>,
        segments: &SwingSegments<V>,
        forces: &Pairs<V>,
        visible: Wide<V>,
    ) -> Lanes<V> {
        let (zero, one, per_mass) = (Wide::default(), Wide::from(1.0), visible / segments.mass);
        let mut searched = lanes;
        let Highest { place, exceeds, known } = forces.highest(searched, [one, zero], per_mass * self.reaction);
        searched = searched.and(known);
        self.include_at(exceeds, segments, place);
        let at_end = friction_demand(forces.coefficients()[DEGREE]);
        for side in [one, -one] {
            let Highest { place, exceeds, known } = forces.highest(searched, [zero, side], per_mass * self.horizontal);
            searched = searched.and(known);
            self.include_at(exceeds, segments, place);
            let mut demand = self.friction_demand.max(at_end);
            let (mut steepest, mut rising, mut found) = (zero, searched, searched.except(searched));
            for _ in 0..MAX_ROUNDS {
                let Highest { place, exceeds, known } = forces.highest(rising, [-visible * demand, side], zero);
                searched = searched.except(rising.except(known));
                rising = exceeds;
                if !rising.any() {
                    break;
                }
                found = found.or(rising);
                steepest = place.in_lanes(rising, steepest);
                demand = friction_demand(forces.at(place)).in_lanes(rising, demand);
            }
            self.include_at(found, segments, steepest);
        }
        searched
    }
}
