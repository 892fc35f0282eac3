//! A swing, or a step at rest on the rigid base → the peaks of N, H and the friction demand in it, and the lift-off of the corner.

use crate::block::Block;
use crate::excitation::Excitation;
use crate::numerics::Real;
use crate::numerics::bernstein::{DEGREE, Pair, Zero};
use crate::simulation::Simulation;
use crate::simulation::outputs::{MAX_FRICTION_DEMAND, Strain, strain};
use crate::simulation::peaks::{Peaks, greater};
use crate::system::evaluation::Evaluation;
use crate::system::swing::{Bounds, Pivoting, Swing};

/// The least reaction, as a part of the weight, above which a corner is pressed on in spite of the series' error.
pub(super) const PRESSED: f64 = 1e-6;

/// A limit of the search for a peak of the friction demand, which takes two or three rounds.
pub(super) const MAX_ROUNDS: u32 = 8;

/// Whether bounds show that the corner is pressed on all the time, and that no force exceeds its peak.
#[inline]
pub(super) fn is_below_peaks(bounds: &Bounds, block: &Block, peaks: &Peaks) -> bool {
    let [least, most] = bounds.reaction;
    least > PRESSED * block.gravity
        && most * block.mass < peaks.reaction
        && bounds.horizontal * block.mass < peaks.horizontal
        && bounds.horizontal < peaks.friction_demand * least
}

/// The least part of a peak that a force must reach to be searched for.
pub(super) fn visible(tolerance: f64) -> f64 {
    /// Of the tolerance: as much may a force exceed its peak unseen.
    const SHARE: f64 = 0.01;
    1.0 + SHARE * tolerance
}

/// The friction demand of N/M and H/M (m/s²).
#[inline(always)]
pub(super) fn friction_demand<T: Real>([n, h]: [T; 2]) -> T {
    T::select_less(h.abs(), n * MAX_FRICTION_DEMAND, h.abs() / n, T::from(MAX_FRICTION_DEMAND))
}

/// The linear combination of two polynomials that is one of them.
pub(super) fn unit(i: usize) -> [f64; 2] {
    if i == 0 { [1.0, 0.0] } else { [0.0, 1.0] }
}

impl Simulation {
    /// Includes the forces of an instant in the peaks.
    pub(super) fn include_forces(&mut self, now: &Evaluation) {
        self.include_strain(&strain(now.block, now.regime, &now.instant, [0.0; 2]));
    }

    #[inline]
    pub(super) fn include_strain(&mut self, strain: &Strain<f64>) {
        let &Strain { reaction: [left, right], horizontal, friction_demand, .. } = strain;
        let Peaks { reaction, horizontal: shear, friction_demand: demand, .. } = &mut self.peaks;
        *reaction = greater(greater(*reaction, left), right);
        *shear = greater(*shear, horizontal.abs());
        *demand = greater(*demand, friction_demand);
    }

    /// Includes N/M and H/M (m/s²) in the peaks.
    #[inline]
    fn include_reaction(&mut self, [n, h]: [f64; 2]) {
        let mass = self.system.block.mass;
        let Peaks { reaction, horizontal, friction_demand: demand, .. } = &mut self.peaks;
        *reaction = greater(*reaction, mass * n);
        *horizontal = greater(*horizontal, mass * h.abs());
        *demand = greater(*demand, friction_demand([n, h]));
    }

    /// Includes N, H and the friction demand up to a part of a swing in the peaks. Returns the part at which the corner lifts if that comes
    /// before.
    ///
    /// The forces at the end are left to the next swing, which begins with them, unless another motion or the caller comes first.
    #[inline(never)]
    pub(super) fn accumulate_forces(
        &mut self,
        excitation: &Excitation,
        pivoting: &Pivoting,
        swing: &Swing,
        mut part: f64,
        next_is_swing: bool,
    ) -> Zero {
        let (time, pressed) = (self.pose.time, PRESSED * pivoting.gravity);
        let forces_at = |part: f64| pivoting.forces(swing.at(part), &excitation.at(time + part * swing.size));
        let mut lift_off = Zero::None;
        let mut forces = swing.forces(part, pivoting.gravity);
        if !forces.coefficients().iter().all(|&[n, _]| n > pressed) {
            if forces.coefficients()[0][0] <= pressed {
                return Zero::Unclear;
            }
            match forces.combined(unit(0)).zero_of(|place| forces_at(place * part)[0]) {
                Zero::None => {}
                Zero::At(place) => {
                    part *= place;
                    lift_off = Zero::At(part);
                    forces = swing.forces(part, pivoting.gravity);
                }
                Zero::Unclear => return Zero::Unclear,
            }
        }
        let coefficients = forces.coefficients();
        self.include_reaction(coefficients[0]);
        let Peaks { reaction, horizontal, friction_demand, .. } = self.peaks;
        let mass = self.system.block.mass;
        let (most, steepest) = (reaction / mass, horizontal / mass);
        let is_below = |&[n, h]: &[f64; 2]| n <= most && h.abs() <= steepest.min(friction_demand * n);
        if coefficients.iter().all(is_below) {
            return lift_off;
        }
        if (lift_off != Zero::None || !next_is_swing) && !is_below(&coefficients[DEGREE]) {
            self.counts.evaluations += 1;
            self.include_reaction(forces_at(part));
        }
        self.search_peaks(&[(&forces, unit(0))], &forces, |this, place| {
            this.counts.evaluations += 1;
            this.include_reaction(forces_at(place * part));
        });
        lift_off
    }

    /// Finds the places at which one of the `reactions`/M, H/M or the friction demand exceeds its peak and its values at both ends, and
    /// passes them to `include`, which raises the peaks. `resultant` is the sum of the reactions, and H/M.
    pub(super) fn search_peaks(
        &mut self,
        reactions: &[(&Pair, [f64; 2])],
        resultant: &Pair,
        include: impl Fn(&mut Simulation, f64),
    ) {
        let visible = visible(self.settings.tolerance);
        let per_mass = visible / self.system.block.mass;
        for (pair, reaction) in reactions {
            if let Some(place) = pair.highest(*reaction, per_mass * self.peaks.reaction) {
                include(self, place);
            }
        }
        // The end may not have been included.
        let at_end = friction_demand(resultant.coefficients()[DEGREE]);
        for side in [1.0, -1.0] {
            if let Some(place) = resultant.highest([0.0, side], per_mass * self.peaks.horizontal) {
                include(self, place);
            }
            // The greatest quotient: W. Dinkelbach, "On nonlinear fractional programming", Management Science 13 (1967) 492-498.
            let (mut demand, mut steepest) = (greater(self.peaks.friction_demand, at_end), None);
            for _ in 0..MAX_ROUNDS {
                let Some(place) = resultant.highest([-visible * demand, side], 0.0) else { break };
                (demand, steepest) = (friction_demand(resultant.at(place)), Some(place));
            }
            if let Some(place) = steepest {
                include(self, place);
            }
        }
    }
}
