//! Ties: one is taut where its stretch rises through zero, goes slack where its tension falls through zero, and breaks where its
//! tension reaches its strength.

use crate::block::{Block, Tie, TieState};
use crate::numerics::dual::Dual;
use crate::numerics::roots::Sample;
use crate::numerics::scalar::{CombinesWith, Elementary};
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{Change, ROUNDING};
use crate::system::forces::tie;
use crate::system::instant::Place;

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

/// The same without its rate.
pub(super) fn taut<T: Elementary>(at: &Evaluation<T>, tie: usize) -> T {
    tie::tension_if_taut(at.block, &at.block.ties.all()[tie], &at.instant)
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

    /// Sets the states of the ties at the beginning; one beyond its strength is broken.
    pub(in crate::system) fn begin_ties(&mut self) {
        let (block, x) = (&self.system.block, &self.now().instant);
        for (i, tie) in block.ties.all().iter().enumerate().filter(|(_, tie)| tie.stiffness.value() > 0.0) {
            let stretch = tie::stretch(block, tie, &Place::of(x));
            let (tension, strength) = (tie::taut_tension(tie, &stretch).value(), tie.strength.value());
            self.pose.ties[i] = if stretch.length.value() <= rounding_of_stretch(block, i) {
                TieState::Slack
            } else if tension < 0.0 {
                TieState::Limp
            } else if strength > 0.0 && tension > strength + rounding_of_tension(block, i) {
                TieState::Broken
            } else {
                TieState::Taut
            };
        }
    }
}
