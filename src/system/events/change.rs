//! A change of the pose in progress, with the regimes passed.

use std::ops::{Add, AddAssign};

use crate::block::{Contact, Corner, Creep, Regime};
use crate::excitation::Excitation;
use crate::numerics::dual::Dual;
use crate::numerics::scalar::Elementary;
use crate::system::System;
use crate::system::evaluation::{Evaluation, Motion};
use crate::system::events::placement::Placement;
use crate::system::instant::Footing;
use crate::system::instant::Pose;

/// Counts and sums of a transition, or of a part of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[must_use = "the caller adds them to its own"]
pub struct TransitionCounts {
    /// Landings to which the impact map (or e, on the rigid base) was applied.
    pub impacts: u32,
    /// Corners that lifted.
    pub liftoffs: u32,
    /// Energy per unit mass (m²/s²) added by changes of the horizontal constraint.
    pub constraint: f64,
    /// Evaluations of the equations of motion.
    pub evaluations: u64,
}

impl TransitionCounts {
    /// Those of a part in which nothing is counted.
    pub(super) const NONE: TransitionCounts =
        TransitionCounts { impacts: 0, liftoffs: 0, constraint: 0.0, evaluations: 0 };

    /// One evaluation of the equations of motion.
    pub(super) const EVALUATION: TransitionCounts = TransitionCounts { evaluations: 1, ..TransitionCounts::NONE };

    /// A corner that lifts.
    pub(super) const LIFTOFF: TransitionCounts = TransitionCounts { liftoffs: 1, ..TransitionCounts::NONE };

    /// Returns the counts of this many landings.
    pub(super) fn impacts(impacts: u32) -> TransitionCounts {
        TransitionCounts { impacts, ..TransitionCounts::NONE }
    }

    /// Returns the energy per unit mass (m²/s²) that a change of the horizontal constraint adds.
    pub(super) fn constraint(constraint: f64) -> TransitionCounts {
        TransitionCounts { constraint, ..TransitionCounts::NONE }
    }
}

impl Add for TransitionCounts {
    type Output = TransitionCounts;

    fn add(self, other: TransitionCounts) -> TransitionCounts {
        TransitionCounts {
            impacts: self.impacts + other.impacts,
            liftoffs: self.liftoffs + other.liftoffs,
            constraint: self.constraint + other.constraint,
            evaluations: self.evaluations + other.evaluations,
        }
    }
}

impl AddAssign for TransitionCounts {
    fn add_assign(&mut self, other: TransitionCounts) {
        *self = *self + other;
    }
}

/// The regimes through which a pose passes in one instant. After the first one corners only leave: both touch, then one, then none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Path {
    regimes: [Option<Regime>; 3],
    /// Whether there were more regimes.
    overflows: bool,
}

impl Path {
    fn push(&mut self, regime: Regime) {
        let count = self.iter().count();
        if self.iter().last() == Some(regime) {
            return;
        }
        match self.regimes.get_mut(count) {
            Some(next) => *next = Some(regime),
            None => self.overflows = true,
        }
    }

    /// Returns the regimes in their order.
    pub fn iter(&self) -> impl Iterator<Item = Regime> {
        self.regimes.into_iter().flatten()
    }

    /// Whether the pose passed through more regimes than an instant can hold.
    pub fn overflows(&self) -> bool {
        self.overflows
    }
}

/// Round-off of a zero relative to its largest term: about 450 ulp.
pub const ROUNDING: f64 = 1e-13;

/// The fate of a corner that no longer bears anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Release {
    /// It lifts.
    Lifts,
    /// It stays on its support and slides.
    Slides,
    /// It stays, and is held.
    Held,
}

/// A change of the pose in progress. Its methods return their [counts](TransitionCounts); a copy tries a change out.
#[derive(Clone, Copy)]
pub struct PoseUpdate<'a, T = f64> {
    pub(super) system: &'a System<T>,
    excitation: &'a Excitation<T>,
    pub pose: Pose<T>,
    pub path: Path,
    /// Whether a corner has landed on its support in this instant.
    pub(super) landed: bool,
}

impl<'a, T: Elementary> PoseUpdate<'a, T> {
    pub fn begin(system: &'a System<T>, pose: &Pose<T>, excitation: &'a Excitation<T>) -> PoseUpdate<'a, T> {
        PoseUpdate { system, excitation, pose: *pose, path: Path::default(), landed: false }
    }

    pub(super) fn regime(&self) -> Regime {
        self.pose.contacts.regime()
    }

    /// Evaluates the block in the present pose.
    pub(super) fn now(&self) -> Evaluation<'a, T> {
        Motion::from_pose(&self.system.block, &self.pose, self.excitation).at_outlined(self.pose.time, self.pose.state)
    }

    /// Takes the state of a placement on the present contacts.
    pub(super) fn place(&mut self, placement: &Placement<T>) {
        let regime = self.regime();
        self.pose.state = placement.state(regime).into();
        self.path.push(regime);
    }

    /// Lets the foot grip, with the velocities of a placement that suits it.
    pub(super) fn grip_at(&mut self, placement: &Placement<T>) -> TransitionCounts {
        self.path.push(self.regime());
        self.grip_here(placement)
    }

    /// Lets the foot grip at its present position.
    pub(super) fn grip_here(&mut self, placement: &Placement<T>) -> TransitionCounts {
        self.pose.footing = Footing::Grips { offset: T::from(0.0) };
        self.pose.state = placement.state(self.regime()).into();
        let offset = placement.u - self.now().instant.u;
        self.pose.footing = Footing::Grips { offset };
        TransitionCounts::EVALUATION
    }

    /// Returns the height of the support under a lifted corner (m), and its rate (m/s).
    pub(super) fn support(&self, corner: Corner) -> Dual<T> {
        self.pose.contacts.top(corner, &self.system.block, self.pose.time)
    }

    /// Puts `corner` on its support, at the height of the support.
    pub(super) fn set_down(&mut self, corner: Corner, placement: &mut Placement<T>) {
        self.landed = true;
        placement.corners[corner.index()].0 = self.support(corner).re;
        self.pose.contacts.set(corner, Contact::Bearing);
    }

    /// Returns the recovery of a support from this height (m), which begins now.
    pub(super) fn creep_from(&self, corner: Corner, height: T) -> Creep<T> {
        Creep { depth: self.system.block.free_height(corner) - height, since: self.pose.time }
    }

    /// Takes the state of a placement; without any corner on the base, the block flies.
    pub(super) fn continue_from(&mut self, placement: &Placement<T>) {
        self.place(placement);
        if self.regime() == Regime::Separated {
            self.pose.footing = Footing::Free { u: placement.u, u_dot: placement.velocities.u_dot };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners that only leave pass through at most three regimes. A repeated regime does not count.
    #[test]
    fn a_fourth_regime_in_one_instant_overflows() {
        let mut path = Path::default();
        for regime in [Regime::FullContact, Regime::FullContact, Regime::TiltingLeft, Regime::Separated] {
            path.push(regime);
        }
        let passed = [Regime::FullContact, Regime::TiltingLeft, Regime::Separated];
        assert!(path.iter().eq(passed) && !path.overflows(), "{path:?}");
        path.push(Regime::TiltingRight);
        assert!(path.iter().eq(passed) && path.overflows(), "{path:?}");
    }
}
