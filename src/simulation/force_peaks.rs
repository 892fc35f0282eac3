//! Forces over a fraction of a step on the rigid base → the peaks of N, H and the friction demand in it. Single runs and lanes share the
//! search.

use crate::numerics::Real;
use crate::numerics::bernstein::{DEGREE, Highest, Pair, Row};
use crate::numerics::scalar::greatest;
use crate::simulation::outputs::{MAX_FRICTION_DEMAND, PeakQuantities, peak_quantities};
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

/// Some of the runs in lanes, or whether it is a single run.
pub(super) trait Runs<R>: Copy {
    /// The runs in which one number is less than another.
    fn less(one: R, other: R) -> Self;
    /// The runs in both.
    fn and(self, other: Self) -> Self;
    /// The runs in either.
    fn or(self, other: Self) -> Self;
    /// These runs without the others.
    fn except(self, other: Self) -> Self;
    /// Whether there is one.
    fn any(self) -> bool;
    /// One number in these runs, the other elsewhere.
    fn choose(self, one: R, other: R) -> R;
}

impl Runs<f64> for bool {
    #[inline(always)]
    fn less(one: f64, other: f64) -> bool {
        one < other
    }

    #[inline(always)]
    fn and(self, other: bool) -> bool {
        self && other
    }

    #[inline(always)]
    fn or(self, other: bool) -> bool {
        self || other
    }

    #[inline(always)]
    fn except(self, other: bool) -> bool {
        self && !other
    }

    #[inline(always)]
    fn any(self) -> bool {
        self
    }

    #[inline(always)]
    fn choose(self, one: f64, other: f64) -> f64 {
        if self { one } else { other }
    }
}

/// Two forces per mass (m/s²) as polynomials on [0, 1], a fraction of a step.
pub(super) trait ForcePair {
    type Number: Real;
    type Runs: Runs<Self::Number>;

    /// See [`Pair::coefficients`].
    fn coefficients(&self) -> &Row<[Self::Number; 2]>;

    /// See [`Pair::at`].
    fn at(&self, place: Self::Number) -> [Self::Number; 2];

    /// See [`Pair::highest`].
    fn highest(
        &self,
        runs: Self::Runs,
        combination: [Self::Number; 2],
        most: Self::Number,
    ) -> Highest<Self::Number, Self::Runs>;
}

impl ForcePair for Pair {
    type Number = f64;
    type Runs = bool;

    #[inline(always)]
    fn coefficients(&self) -> &Row<[f64; 2]> {
        self.coefficients()
    }

    #[inline(always)]
    fn at(&self, place: f64) -> [f64; 2] {
        self.at(place)
    }

    #[inline(always)]
    fn highest(&self, run: bool, combination: [f64; 2], most: f64) -> Highest<f64, bool> {
        let place = if run { self.highest(combination, most) } else { None };
        Highest { place: place.unwrap_or(0.0), exceeds: place.is_some(), known: run }
    }
}

/// A segment of a step on which forces are searched for peaks.
pub(super) trait ForceSegment {
    type Pair: ForcePair;

    /// Includes the forces at a place in some runs, by the equations of motion.
    fn include_at(&self, peaks: &mut ForcePeaks<NumberOf<Self>>, runs: RunsOf<Self>, place: NumberOf<Self>);
}

/// The number of a segment.
pub(super) type NumberOf<G> = <<G as ForceSegment>::Pair as ForcePair>::Number;

/// The runs of a segment.
pub(super) type RunsOf<G> = <<G as ForceSegment>::Pair as ForcePair>::Runs;

/// Peaks of N (N), H (N) and the friction demand (1).
#[derive(Clone, Copy)]
pub(super) struct ForcePeaks<R> {
    pub(super) reaction: R,
    pub(super) horizontal: R,
    pub(super) friction_demand: R,
    /// The number of evaluations of the equations of motion.
    pub(super) evaluations: R,
}

impl<R: Real> ForcePeaks<R> {
    /// The runs in which bounds of N/M and |H|/M (m/s²) exclude new peaks. There the corner is pressed on all the time, and no force
    /// exceeds its peak.
    #[inline(always)]
    pub(super) fn are_above<S: Runs<R>>(&self, [least, most]: [R; 2], horizontal: R, [mass, gravity]: [R; 2]) -> S {
        S::less(gravity * PRESSED, least)
            .and(S::less(most * mass, self.reaction))
            .and(S::less(horizontal * mass, self.horizontal))
            .and(S::less(horizontal, self.friction_demand * least))
    }

    /// Includes N/M and H/M (m/s²) in some runs.
    #[inline(always)]
    pub(super) fn include<S: Runs<R>>(&mut self, runs: S, mass: R, [n, h]: [R; 2]) {
        self.reaction = runs.choose(greatest(self.reaction, mass * n), self.reaction);
        self.horizontal = runs.choose(greatest(self.horizontal, mass * h.abs()), self.horizontal);
        let demand = friction_demand([n, h]);
        self.friction_demand = runs.choose(greatest(self.friction_demand, demand), self.friction_demand);
    }

    /// Includes the forces on a segment of some runs; `with_end` also those at its end. Returns the runs in which all peaks are known.
    #[inline(always)]
    pub(super) fn raise<G: ForceSegment>(
        &mut self,
        runs: RunsOf<G>,
        segment: &G,
        forces: &G::Pair,
        [mass, visible]: [R; 2],
        with_end: RunsOf<G>,
    ) -> RunsOf<G>
    where
        G::Pair: ForcePair<Number = R>,
    {
        let coefficients = forces.coefficients();
        self.include(runs, mass, coefficients[0]);
        let (most, peak_shear, demand) = (self.reaction / mass, self.horizontal / mass, self.friction_demand);
        let mut exceeds = runs.except(runs);
        let mut exceeds_at_end = exceeds;
        for &[n, h] in coefficients {
            exceeds_at_end = <RunsOf<G>>::less(most, n)
                .or(<RunsOf<G>>::less(peak_shear, h.abs()))
                .or(<RunsOf<G>>::less(demand * n, h.abs()));
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
    pub(super) fn search<G: ForceSegment>(
        &mut self,
        runs: RunsOf<G>,
        segment: &G,
        reactions: &[(&G::Pair, [R; 2])],
        resultant: &G::Pair,
        [mass, visible]: [R; 2],
    ) -> RunsOf<G>
    where
        G::Pair: ForcePair<Number = R>,
    {
        let (zero, one, per_mass) = (R::from(0.0), R::from(1.0), visible / mass);
        let mut searched = runs;
        for (pair, reaction) in reactions {
            let Highest { place, exceeds, known } = pair.highest(searched, *reaction, per_mass * self.reaction);
            searched = searched.and(known);
            segment.include_at(self, exceeds, place);
        }
        // The force at the end is not included yet in some runs.
        let at_end = friction_demand(resultant.coefficients()[DEGREE]);
        for side in [one, -one] {
            let Highest { place, exceeds, known } =
                resultant.highest(searched, [zero, side], per_mass * self.horizontal);
            searched = searched.and(known);
            segment.include_at(self, exceeds, place);
            // The greatest quotient: W. Dinkelbach, "On nonlinear fractional programming", Management Science 13 (1967) 492-498.
            let mut demand = greatest(self.friction_demand, at_end);
            let (mut demand_place, mut rising, mut found) = (zero, searched, searched.except(searched));
            for _ in 0..MAX_ROUNDS {
                let Highest { place, exceeds, known } = resultant.highest(rising, [-visible * demand, side], zero);
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
        self.include_quantities(&peak_quantities(now.body, now.regime, &now.instant, [0.0; 2]));
    }

    /// Includes the forces of a block.
    #[inline]
    pub(super) fn include_quantities(&mut self, quantities: &PeakQuantities<f64>) {
        let &PeakQuantities { reaction: [left, right], horizontal, friction_demand, .. } = quantities;
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
