//! Forces over a fraction of a step on the rigid base → the peaks of N, H and the friction demand in it. Single runs and lanes share the
//! search.

use crate::numerics::Real;
use crate::numerics::bernstein::{DEGREE, Highest, Pair, Searched};
use crate::numerics::scalar::{Runs, greatest};
use crate::simulation::outputs::{Channels, MAX_FRICTION_DEMAND};
use crate::simulation::peaks::{Peaks, greater};
use crate::system::evaluation::Evaluation;

/// Least reaction, over the weight, that presses a corner on despite the series' error.
pub(super) const PRESSED: f64 = 1e-6;

/// Maximum number of rounds of a search for a peak of the friction demand. It takes two or three.
const MAX_ROUNDS: u32 = 8;

/// The least fraction of a peak that a force must reach to be searched for.
pub(super) fn visible(tolerance: f64) -> f64 {
    /// Excess of a force over its recorded peak that may be missed, over the tolerance.
    const MISSED: f64 = 0.01;
    1.0 + MISSED * tolerance
}

/// The friction demand of N/M and H/M (m/s²).
#[inline(always)]
fn friction_demand<T: Real>([n, h]: [T; 2]) -> T {
    T::select_less(h.abs(), n * MAX_FRICTION_DEMAND, h.abs() / n, T::from(MAX_FRICTION_DEMAND))
}

/// Weights that select one polynomial of a pair.
pub(super) const UNITS: [[f64; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];

/// A segment of a step on which forces are searched for peaks.
pub(super) trait ForceSegment<R: Real> {
    /// Includes the forces at a place in some runs, by the equations of motion.
    fn include_at(&self, peaks: &mut ForcePeaks<R>, runs: R::Runs, place: R);
}

/// Peaks of N (N), H (N) and the friction demand (1).
#[derive(Clone, Copy)]
pub(super) struct ForcePeaks<R> {
    pub(super) reaction: R,
    pub(super) horizontal: R,
    pub(super) friction_demand: R,
    /// The number of evaluations of the equations of motion.
    pub(super) evaluations: R,
}

impl<R: Searched> ForcePeaks<R> {
    /// The runs in which bounds of N/M and |H|/M (m/s²) exclude new peaks. There the corner is pressed on all the time, and no force
    /// exceeds its peak.
    #[inline(always)]
    pub(super) fn are_above(&self, [least, most]: [R; 2], horizontal: R, [mass, gravity]: [R; 2]) -> R::Runs {
        (gravity * PRESSED)
            .less(least)
            .and((most * mass).less(self.reaction))
            .and((horizontal * mass).less(self.horizontal))
            .and(horizontal.less(self.friction_demand * least))
    }

    /// Includes N/M and H/M (m/s²) in some runs.
    #[inline(always)]
    pub(super) fn include(&mut self, runs: R::Runs, mass: R, [n, h]: [R; 2]) {
        self.reaction = runs.choose(greatest(self.reaction, mass * n), self.reaction);
        self.horizontal = runs.choose(greatest(self.horizontal, mass * h.abs()), self.horizontal);
        let demand = friction_demand([n, h]);
        self.friction_demand = runs.choose(greatest(self.friction_demand, demand), self.friction_demand);
    }

    /// Includes the forces on a segment of some runs; `with_end` also those at its end. Returns the runs in which all peaks are known.
    #[inline(always)]
    pub(super) fn raise(
        &mut self,
        runs: R::Runs,
        segment: &impl ForceSegment<R>,
        forces: &Pair<R>,
        [mass, visible]: [R; 2],
        with_end: R::Runs,
    ) -> R::Runs {
        let coefficients = forces.coefficients();
        self.include(runs, mass, coefficients[0]);
        let (most, peak_shear, demand) = (self.reaction / mass, self.horizontal / mass, self.friction_demand);
        let mut exceeds = runs.except(runs);
        let mut exceeds_at_end = exceeds;
        for &[n, h] in coefficients {
            exceeds_at_end = most.less(n).or(peak_shear.less(h.abs())).or((demand * n).less(h.abs()));
            exceeds = exceeds.or(exceeds_at_end);
        }
        let exceeds = exceeds.and(runs);
        if !exceeds.any() {
            return runs;
        }
        segment.include_at(self, exceeds.and(exceeds_at_end).and(with_end), R::from(1.0));
        let n = [R::from(1.0), R::from(0.0)];
        runs.except(exceeds.except(self.search(exceeds, segment, &[(forces, n)], forces, [mass, visible])))
    }

    /// Includes the forces inside a segment of some runs where one exceeds its peak. These are one of the `reactions`/M, H/M or the
    /// friction demand; there they also exceed their values at both ends. `resultant` is the sum of the reactions, and H/M. Returns the
    /// runs in which all of these places are known.
    #[inline(always)]
    pub(super) fn search(
        &mut self,
        runs: R::Runs,
        segment: &impl ForceSegment<R>,
        reactions: &[(&Pair<R>, [R; 2])],
        resultant: &Pair<R>,
        [mass, visible]: [R; 2],
    ) -> R::Runs {
        let (zero, one, per_mass) = (R::from(0.0), R::from(1.0), visible / mass);
        let mut searched = runs;
        for (pair, reaction) in reactions {
            let Highest { place, exceeds, known } = R::highest(pair, searched, *reaction, per_mass * self.reaction);
            searched = searched.and(known);
            segment.include_at(self, exceeds, place);
        }
        // The force at the end is not included yet in some runs.
        let at_end = friction_demand(resultant.coefficients()[DEGREE]);
        for side in [one, -one] {
            let Highest { place, exceeds, known } =
                R::highest(resultant, searched, [zero, side], per_mass * self.horizontal);
            searched = searched.and(known);
            segment.include_at(self, exceeds, place);
            // The greatest quotient: W. Dinkelbach, "On nonlinear fractional programming", Management Science 13 (1967) 492-498.
            let mut demand = greatest(self.friction_demand, at_end);
            let (mut demand_place, mut rising, mut found) = (zero, searched, searched.except(searched));
            for _ in 0..MAX_ROUNDS {
                let Highest { place, exceeds, known } = R::highest(resultant, rising, [-visible * demand, side], zero);
                searched = searched.except(rising.except(known));
                rising = exceeds;
                if !rising.any() {
                    break;
                }
                found = found.or(rising);
                demand_place = rising.choose(place, demand_place);
                demand = rising.choose(friction_demand(resultant.at(place)), demand);
            }
            segment.include_at(self, found, demand_place);
        }
        searched
    }
}

impl ForcePeaks<f64> {
    /// Includes the forces of an instant.
    pub(super) fn include_forces(&mut self, now: &Evaluation) {
        self.include_channels(&Channels::of(now.body, now.regime, &now.instant, [0.0; 2]));
    }

    /// Includes the forces of a block.
    #[inline]
    pub(super) fn include_channels(&mut self, channels: &Channels<f64>) {
        let &Channels { reaction: [left, right], horizontal, friction_demand, .. } = channels;
        self.reaction = greater(greater(self.reaction, left), right);
        self.horizontal = greater(self.horizontal, horizontal.abs());
        self.friction_demand = greater(self.friction_demand, friction_demand);
    }
}

impl Peaks {
    /// The peaks of forces.
    #[inline]
    pub(super) fn of_forces(&self) -> ForcePeaks<f64> {
        let Peaks { reaction, horizontal, friction_demand, .. } = *self;
        ForcePeaks { reaction, horizontal, friction_demand, evaluations: 0.0 }
    }

    /// Raises the peaks of forces. Returns the number of evaluations of the equations of motion.
    #[inline]
    pub(super) fn raise_forces(&mut self, raise: impl FnOnce(&mut ForcePeaks<f64>)) -> u64 {
        let mut forces = self.of_forces();
        raise(&mut forces);
        let ForcePeaks { reaction, horizontal, friction_demand, evaluations } = forces;
        (self.reaction, self.horizontal, self.friction_demand) = (reaction, horizontal, friction_demand);
        evaluations as u64
    }
}
