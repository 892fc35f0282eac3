//! A restraint changes its state when one of its event functions falls through zero.

use crate::block::Kinematics;
use crate::block::restraints::{self, RestraintFunction};
use crate::excitation::Excitation;
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary};
use crate::system::System;
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{PoseUpdate, ROUNDING};
use crate::system::events::event::EventKind;
use crate::system::instant::Pose;

/// Returns value and rate of an event function at an instant.
#[inline(never)]
pub(super) fn sample<T: Elementary>(function: RestraintFunction, at: &Evaluation<T>) -> Dual<T>
where
    Dual<T>: CombinesWith<T>,
{
    function.sample(at.body, &at.forcing.restraints, || Kinematics::of(&at.instant), || Kinematics::of(&at.rates()))
}

impl<T: Elementary> Evaluation<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Returns the plastic elongations of the restraints (m), by their numbers, positive for longer ones.
    pub fn plastic_elongations(&self) -> [T; restraints::MAX] {
        restraints::plastic_elongations(self.body, &self.forcing.restraints, &Kinematics::of(&self.instant))
    }

    /// Returns the pull of the restraint with this number (N) and its rate (N/s).
    pub fn pull(&self, number: usize) -> Dual<T> {
        self.forcing.restraints.pull_of(number).map_or_else(Dual::default, |function| sample(function, self))
    }

    /// Returns the elongation (m) of the restraint with this number and its rate (m/s) if it pushes, too, and acts. Of one that only pulls
    /// it is the shortening, slack and broken as well: its ends approach.
    pub fn stroke(&self, number: usize) -> Dual<T> {
        let elongation = || restraints::elongation(self.body, &Kinematics::of(&self.instant), number);
        match self.body.restraints.pushes(number) {
            false => -elongation(),
            true if self.forcing.restraints.pull_of(number).is_some() => elongation(),
            true => Dual::default(),
        }
    }
}

impl<T: Elementary> PoseUpdate<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Changes the state of a restraint after `function` has fallen through zero.
    pub(super) fn switch(&mut self, function: RestraintFunction, now: &Evaluation<T>) -> Option<EventKind> {
        let kinematics = || Kinematics::of(&now.instant);
        function.switch(&self.system.block, &mut self.pose.restraints, kinematics, ROUNDING).map(EventKind::Restraint)
    }
}

impl<T: Elementary> System<T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Returns the pose at the beginning with the states of its restraints.
    pub(in crate::system) fn switched(&self, mut pose: Pose<T>, excitation: &Excitation<T>) -> Pose<T> {
        if !self.block.restraints.is_empty() {
            let kinematics = Kinematics::of(&PoseUpdate::begin(self, &pose, excitation).now().instant);
            pose.restraints = restraints::at_beginning(&self.block, &kinematics, ROUNDING);
        }
        pose
    }
}
