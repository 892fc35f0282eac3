//! A restraint changes its state when one of its event functions falls through zero.

use crate::block::Kinematics;
use crate::block::restraints::{self, Surface};
use crate::excitation::Excitation;
use crate::numerics::dual::Dual;
use crate::numerics::roots::Sample;
use crate::numerics::scalar::{CombinesWith, Elementary};
use crate::system::System;
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{Change, ROUNDING};
use crate::system::events::event::EventKind;
use crate::system::instant::Pose;

/// Returns value and rate of an event function at an instant.
#[inline(never)]
pub(super) fn sample<T: Elementary>(surface: Surface, at: &Evaluation<T>) -> Sample<T>
where
    Dual<T>: CombinesWith<T>,
{
    surface.sample(at.block, || Kinematics::of(&at.instant), || Kinematics::of(&at.rates()))
}

impl<T: Elementary> Evaluation<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Returns the pull of the restraint with this number (N) and its rate (N/s).
    pub fn pull(&self, number: usize) -> Sample<T> {
        self.forcing.restraints.pull_of(number).map_or_else(Sample::default, |surface| sample(surface, self))
    }
}

impl<T: Elementary> Change<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Changes the state of a restraint after `surface` has fallen through zero.
    pub(super) fn switch(&mut self, surface: Surface, now: &Evaluation<T>) -> Option<EventKind> {
        let kinematics = || Kinematics::of(&now.instant);
        surface.switch(&self.system.block, &mut self.pose.restraints, kinematics).map(EventKind::Restraint)
    }
}

impl<T: Elementary> System<T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Returns the pose at the beginning with the states of its restraints, which follow from it.
    pub(in crate::system) fn switched(&self, mut pose: Pose<T>, excitation: &Excitation<T>) -> Pose<T> {
        if !self.block.restraints.is_empty() {
            let kinematics = Kinematics::of(&Change::begin(self, &pose, excitation).now().instant);
            pose.restraints = restraints::at_beginning(&self.block, &kinematics, ROUNDING);
        }
        pose
    }
}
