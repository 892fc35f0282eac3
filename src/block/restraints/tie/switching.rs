//! A tie becomes taut when its stretch rises through zero, slack when its tension falls through zero, and breaks when its tension
//! reaches its strength.

use serde::{Deserialize, Serialize};

use super::pull::{stretch, taut_tension};
use super::{NO_TIES, Tie, TieState, TieStates, Ties};
use crate::block::{Block, Kinematics};
use crate::numerics::dual::Dual;
use crate::numerics::roots::Sample;
use crate::numerics::scalar::{CombinesWith, Elementary};

/// An event function of a tie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TieFunction {
    /// The opposite of the stretch of a slack tie (m).
    Shortness,
    /// The stretch of a limp tie (m).
    Stretch,
    /// The tension of a taut tie (N).
    Tension,
    /// The opposite of the tension that a limp tie would have if taut (N).
    Limpness,
    /// Strength minus tension of a taut tie (N).
    Strength,
}

/// A reported event of a tie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TieEvent {
    /// It begins to pull.
    Taut,
    /// It stops pulling.
    Slack,
    /// It breaks.
    Break,
}

impl TieEvent {
    /// Returns its name in tables.
    pub fn word(self) -> &'static str {
        match self {
            TieEvent::Taut => "taut",
            TieEvent::Slack => "slack",
            TieEvent::Break => "break",
        }
    }
}

impl std::fmt::Display for TieEvent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            TieEvent::Taut => "is taut",
            TieEvent::Slack => "is slack",
            TieEvent::Break => "breaks",
        })
    }
}

/// Returns the watched functions of a tie in this state.
pub fn watched(tie: &Tie, state: TieState) -> [Option<TieFunction>; 2] {
    use TieFunction::{Limpness, Shortness, Strength, Stretch, Tension};
    match state {
        TieState::Slack => [Some(Shortness), None],
        TieState::Taut => [Some(Tension), (tie.strength > 0.0).then_some(Strength)],
        TieState::Limp => [Some(Stretch), Some(Limpness)],
        TieState::Broken => [None; 2],
    }
}

/// Returns the function whose value is the tension of a tie in this state, if it pulls.
pub fn of_pull(state: TieState) -> Option<TieFunction> {
    match state {
        TieState::Taut => Some(TieFunction::Tension),
        TieState::Slack | TieState::Limp | TieState::Broken => None,
    }
}

impl TieFunction {
    /// Returns value and rate; `rates` has the rates of `kinematics` in the dual parts.
    #[inline(never)]
    pub fn sample<T: Elementary>(
        self,
        block: &Block<T>,
        tie: &Tie<T>,
        kinematics: impl Fn() -> Kinematics<T>,
        rates: impl Fn() -> Kinematics<Dual<T>>,
    ) -> Sample<T>
    where
        Dual<T>: CombinesWith<T>,
    {
        let stretch_with_rate = || {
            let stretch = stretch(block, tie, &kinematics());
            Sample { value: stretch.length, rate: stretch.rate }
        };
        let tension = || {
            let Dual { re, eps } = taut_tension(tie, &stretch(block, tie, &rates()));
            Sample { value: re, rate: eps }
        };
        match self {
            TieFunction::Shortness => stretch_with_rate().negated(),
            TieFunction::Stretch => stretch_with_rate(),
            TieFunction::Tension => tension(),
            TieFunction::Limpness => tension().negated(),
            TieFunction::Strength => {
                let Sample { value, rate } = tension();
                Sample { value: tie.strength - value, rate: -rate }
            }
        }
    }

    /// Returns the value.
    pub fn value<T: Elementary>(self, block: &Block<T>, tie: &Tie<T>, kinematics: &Kinematics<T>) -> T {
        let stretch = stretch(block, tie, kinematics);
        match self {
            TieFunction::Shortness => -stretch.length,
            TieFunction::Stretch => stretch.length,
            TieFunction::Tension => taut_tension(tie, &stretch),
            TieFunction::Limpness => -taut_tension(tie, &stretch),
            TieFunction::Strength => tie.strength - taut_tension(tie, &stretch),
        }
    }

    /// Whether value and rate follow from the state and its rate alone.
    pub fn follows_from_state(self) -> bool {
        match self {
            TieFunction::Shortness | TieFunction::Stretch => true,
            TieFunction::Tension | TieFunction::Limpness | TieFunction::Strength => false,
        }
    }

    /// Returns the size of its terms.
    #[inline(never)]
    pub fn size<T: Elementary>(self, block: &Block<T>, tie: &Tie<T>) -> f64 {
        match self {
            TieFunction::Shortness | TieFunction::Stretch => size_of_stretch(block, tie),
            TieFunction::Tension | TieFunction::Limpness | TieFunction::Strength => size_of_tension(block, tie),
        }
    }

    /// Returns the state of the tie and the reported event after this function has fallen through zero.
    pub fn switched<T: Elementary>(
        self,
        block: &Block<T>,
        tie: &Tie<T>,
        kinematics: impl Fn() -> Kinematics<T>,
    ) -> (TieState, Option<TieEvent>) {
        match self {
            TieFunction::Shortness | TieFunction::Limpness => (TieState::Taut, Some(TieEvent::Taut)),
            TieFunction::Tension => {
                let stretched = stretch(block, tie, &kinematics()).length.value() > 0.0;
                let damped = tie.damping.value() > 0.0 && stretched;
                (if damped { TieState::Limp } else { TieState::Slack }, Some(TieEvent::Slack))
            }
            TieFunction::Stretch => (TieState::Slack, None),
            TieFunction::Strength => (TieState::Broken, Some(TieEvent::Break)),
        }
    }
}

/// Size of the terms of a stretch (m).
fn size_of_stretch<T: Elementary>(block: &Block<T>, tie: &Tie<T>) -> f64 {
    tie.length().value().max(block.r0.value())
}

/// Size of the terms of a tension (N).
fn size_of_tension<T: Elementary>(block: &Block<T>, tie: &Tie<T>) -> f64 {
    let spring = tie.stiffness.value() * size_of_stretch(block, tie);
    let dashpot = (tie.damping * block.p * block.r0).value();
    spring.max(dashpot).max((block.mass * block.gravity).value())
}

/// Returns the states of ties at the beginning: one without slack is taut, and one beyond its strength is broken. `rounding` is the round-off
/// of a zero relative to its largest term.
pub fn at_beginning<T: Elementary>(
    block: &Block<T>,
    ties: &Ties<T>,
    kinematics: &Kinematics<T>,
    rounding: f64,
) -> TieStates {
    let mut states = NO_TIES;
    for (state, tie) in states.iter_mut().zip(ties.all()).filter(|(_, tie)| tie.stiffness.value() > 0.0) {
        let stretch = stretch(block, tie, kinematics);
        let (tension, strength) = (taut_tension(tie, &stretch).value(), tie.strength.value());
        let rounding_of_tension = rounding * size_of_tension(block, tie);
        let rounding_of_stretch = rounding * size_of_stretch(block, tie);
        let shortens = stretch.rate.value() < -rounding_of_stretch * block.p.value();
        *state = if stretch.length.value() < if shortens { rounding_of_stretch } else { -rounding_of_stretch } {
            TieState::Slack
        } else if tension < -rounding_of_tension {
            TieState::Limp
        } else if strength > 0.0 && tension > strength + rounding_of_tension {
            TieState::Broken
        } else {
            TieState::Taut
        };
    }
    states
}
