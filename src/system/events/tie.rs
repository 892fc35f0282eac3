//! Ties: one is taut where its stretch rises through zero, goes slack where its tension falls through zero, and breaks where its
//! tension reaches its strength.

use crate::block::{Block, Foundation, Tie, TieState};
use crate::numerics::dual::Dual;
use crate::numerics::roots::Sample;
use crate::numerics::scalar::{CombinesWith, Elementary};
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{Change, ROUNDING};
use crate::system::events::placement::Placement;
use crate::system::forces::tie;
use crate::system::instant::{Instant, Place};

/// The stretch of a tie (m).
#[inline(never)]
pub(super) fn stretch<T: Elementary>(at: &Evaluation<T>, tie: usize) -> Sample<T> {
    tie::length(at.block, &at.block.ties.all()[tie], &at.instant)
}

/// The tension of a tie if it is taut (N).
#[inline(never)]
pub(super) fn tension<T: Elementary>(at: &Evaluation<T>, tie: usize) -> Sample<T>
where
    Dual<T>: CombinesWith<T>,
{
    tie::tension_with_rate(at.block, &at.block.ties.all()[tie], &at.rates())
}

/// The strength of a taut tie less its tension (N).
#[inline(never)]
pub(super) fn rest_of_strength<T: Elementary>(at: &Evaluation<T>, tie: usize) -> Sample<T>
where
    Dual<T>: CombinesWith<T>,
{
    let Sample { value, rate } = tension(at, tie);
    Sample { value: at.block.ties.all()[tie].strength - value, rate: -rate }
}

/// Round-off of a stretch at zero (m).
#[inline(never)]
pub(super) fn rounding_of_stretch<T: Elementary>(block: &Block<T>, tie: usize) -> f64 {
    ROUNDING * length(block, tie)
}

/// Round-off of a tension at zero (N).
#[inline(never)]
pub(super) fn rounding_of_tension<T: Elementary>(block: &Block<T>, tie: usize) -> f64 {
    let Tie { stiffness, damping, .. } = block.ties.all()[tie];
    let (spring, dashpot) = (stiffness.value() * length(block, tie), (damping * block.p * block.r0).value());
    let largest = spring.max(dashpot).max((block.mass * block.gravity).value());
    ROUNDING * largest
}

/// Size of the terms of a stretch (m).
fn length<T: Elementary>(block: &Block<T>, tie: usize) -> f64 {
    block.ties.all()[tie].length().value().max(block.r0.value())
}

impl<T: Elementary> Change<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Sets the state of a tie.
    pub(super) fn set_tie(&mut self, tie: usize, state: TieState) {
        self.pose.ties[tie] = state;
    }

    /// Continues after the pull of a tie has changed.
    pub(super) fn go_on_tied(&mut self, now: &Evaluation<T>) {
        self.let_ties_follow(&now.instant);
        match self.system.block.foundation {
            Foundation::Rigid => {
                self.settle_on_rigid_base();
            }
            Foundation::Viscoelastic => self.rub(&mut Placement::of(&now.instant)),
        }
    }

    /// Updates ties with dashpots after an event has changed velocities; a tie beyond its strength breaks.
    pub(super) fn let_ties_follow(&mut self, x: &Instant<T>) {
        let block = &self.system.block;
        for (i, tie) in block.ties.all().iter().enumerate() {
            let state = &mut self.pose.ties[i];
            if *state == TieState::Broken || *state == TieState::Slack {
                continue;
            }
            let tension = tie::taut_tension(tie, &tie::stretch(block, tie, &Place::of(x))).value();
            let rounding = rounding_of_tension(block, i);
            if tie.damping.value() > 0.0 && tension.abs() > rounding {
                *state = if tension > 0.0 { TieState::Taut } else { TieState::Limp };
            }
            if *state == TieState::Taut && tie.strength.value() > 0.0 && tension > tie.strength.value() + rounding {
                *state = TieState::Broken;
            }
        }
    }

    /// Sets the states of the ties at the beginning.
    pub(in crate::system) fn begin_ties(&mut self) {
        let (block, x) = (&self.system.block, &self.now().instant);
        for (i, tie) in block.ties.all().iter().enumerate().filter(|(_, tie)| tie.stiffness.value() > 0.0) {
            let stretch = tie::stretch(block, tie, &Place::of(x));
            let stretched = stretch.length.value() > rounding_of_stretch(block, i);
            self.pose.ties[i] = if stretched { TieState::Taut } else { TieState::Slack };
        }
        self.let_ties_follow(x);
    }
}
