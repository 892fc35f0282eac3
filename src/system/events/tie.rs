//! Ties: one is taut where its stretch rises through zero, goes slack where its tension falls through zero, and breaks where its
//! tension reaches its strength.

use serde::{Deserialize, Serialize};

use crate::block::{Block, Tie, TieState};
use crate::excitation::Excitation;
use crate::numerics::dual::Dual;
use crate::numerics::roots::Sample;
use crate::numerics::scalar::{CombinesWith, Elementary};
use crate::system::System;
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{Change, ROUNDING};
use crate::system::events::event::EventKind;
use crate::system::forces::tie;
use crate::system::instant::{Place, Pose};

/// A function of a tie that is watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TieSurface {
    /// The stretch of a slack tie, with opposite sign (m).
    Shortness,
    /// The stretch of a limp tie (m).
    Stretch,
    /// The tension of a taut tie (N).
    Tension,
    /// The tension that a limp tie would have if taut, with opposite sign (N).
    Limpness,
    /// The strength of a taut tie less its tension (N).
    Strength,
}

/// The functions that are watched in a state of a tie.
pub(super) fn watched(tie: &Tie, state: TieState) -> [Option<TieSurface>; 2] {
    use TieSurface::{Limpness, Shortness, Strength, Stretch, Tension};
    match state {
        TieState::Slack => [Some(Shortness), None],
        TieState::Taut => [Some(Tension), (tie.strength > 0.0).then_some(Strength)],
        TieState::Limp => [Some(Stretch), Some(Limpness)],
        TieState::Broken => [None; 2],
    }
}

impl TieSurface {
    /// Value and rate at an instant.
    #[inline(never)]
    pub(super) fn sample<T: Elementary>(self, tie: usize, at: &Evaluation<T>) -> Sample<T>
    where
        Dual<T>: CombinesWith<T>,
    {
        let of = &at.block.ties.all()[tie];
        let stretch = || tie::length(at.block, of, &at.instant);
        let tension = || tie::tension_with_rate(at.block, of, &at.rates());
        match self {
            TieSurface::Shortness => stretch().negated(),
            TieSurface::Stretch => stretch(),
            TieSurface::Tension => tension(),
            TieSurface::Limpness => tension().negated(),
            TieSurface::Strength => {
                let Sample { value, rate } = tension();
                Sample { value: of.strength - value, rate: -rate }
            }
        }
    }

    /// Its value alone at an instant.
    pub(super) fn value<T: Elementary>(self, tie: usize, at: &Evaluation<T>) -> T {
        let of = &at.block.ties.all()[tie];
        let stretch = || tie::length(at.block, of, &at.instant).value;
        let tension = || tie::tension_if_taut(at.block, of, &at.instant);
        match self {
            TieSurface::Shortness => -stretch(),
            TieSurface::Stretch => stretch(),
            TieSurface::Tension => tension(),
            TieSurface::Limpness => -tension(),
            TieSurface::Strength => of.strength - tension(),
        }
    }

    /// [`Surface::follows_from_state`](super::Surface::follows_from_state).
    pub(super) fn follows_from_state(self) -> bool {
        match self {
            TieSurface::Shortness | TieSurface::Stretch => true,
            TieSurface::Tension | TieSurface::Limpness | TieSurface::Strength => false,
        }
    }

    /// Round-off of a zero.
    #[inline(never)]
    pub(super) fn rounding<T: Elementary>(self, tie: usize, block: &Block<T>) -> f64 {
        match self {
            TieSurface::Shortness | TieSurface::Stretch => rounding_of_stretch(block, tie),
            TieSurface::Tension | TieSurface::Limpness | TieSurface::Strength => rounding_of_tension(block, tie),
        }
    }
}

/// Round-off of a stretch at zero (m).
fn rounding_of_stretch<T: Elementary>(block: &Block<T>, tie: usize) -> f64 {
    ROUNDING * length(block, tie)
}

/// Round-off of a tension at zero (N).
fn rounding_of_tension<T: Elementary>(block: &Block<T>, tie: usize) -> f64 {
    let Tie { stiffness, damping, .. } = block.ties.all()[tie];
    let (spring, dashpot) = (stiffness.value() * length(block, tie), (damping * block.p * block.r0).value());
    let largest = spring.max(dashpot).max((block.mass * block.gravity).value());
    ROUNDING * largest
}

/// Size of the terms of a stretch (m).
fn length<T: Elementary>(block: &Block<T>, tie: usize) -> f64 {
    block.ties.all()[tie].length().value().max(block.r0.value())
}

impl<T: Elementary> Evaluation<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Tension of a tie (N) and its rate (N/s).
    pub fn tension(&self, tie: usize) -> Sample<T> {
        match self.forcing.ties[tie] {
            TieState::Taut => TieSurface::Tension.sample(tie, self),
            TieState::Slack | TieState::Limp | TieState::Broken => Sample::default(),
        }
    }
}

impl<T: Elementary> Change<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// A tie changes its state where a function of it has fallen through zero.
    pub(super) fn switch_tie(&mut self, tie: u8, surface: TieSurface, now: &Evaluation<T>) -> Option<EventKind> {
        let i = usize::from(tie);
        let (state, event) = match surface {
            TieSurface::Shortness | TieSurface::Limpness => (TieState::Taut, Some(EventKind::Taut(tie))),
            TieSurface::Tension => {
                let stretch = TieSurface::Stretch.sample(i, now).value.value();
                let damped = self.system.block.ties.all()[i].damping.value() > 0.0 && stretch > 0.0;
                (if damped { TieState::Limp } else { TieState::Slack }, Some(EventKind::Slack(tie)))
            }
            TieSurface::Stretch => (TieState::Slack, None),
            TieSurface::Strength => (TieState::Broken, Some(EventKind::Break(tie))),
        };
        self.pose.ties[i] = state;
        event
    }
}

impl<T: Elementary> System<T>
where
    Dual<T>: CombinesWith<T>,
{
    /// The pose at the beginning with its ties as they are stretched; one beyond its strength is broken.
    pub(in crate::system) fn switched(&self, mut pose: Pose<T>, excitation: &Excitation<T>) -> Pose<T> {
        let block = &self.block;
        if block.ties.is_empty() {
            return pose;
        }
        let place = Place::of(&Change::begin(self, &pose, excitation).now().instant);
        for (i, tie) in block.ties.all().iter().enumerate().filter(|(_, tie)| tie.stiffness.value() > 0.0) {
            let stretch = tie::stretch(block, tie, &place);
            let (tension, strength) = (tie::taut_tension(tie, &stretch).value(), tie.strength.value());
            pose.ties[i] = if stretch.length.value() <= rounding_of_stretch(block, i) {
                TieState::Slack
            } else if tension < 0.0 {
                TieState::Limp
            } else if strength > 0.0 && tension > strength + rounding_of_tension(block, i) {
                TieState::Broken
            } else {
                TieState::Taut
            };
        }
        pose
    }
}
