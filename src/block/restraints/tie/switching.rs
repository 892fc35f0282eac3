//! The watched functions of a tie and its states.
//!
//! A tie becomes taut when its elastic elongation rises through zero, slack when its tension falls through zero, and breaks when its
//! tension reaches its strength, that of a damper in either sense. It yields when the force of its spring reaches the yield surface, and
//! unloads when its rate of elongation changes its sign.

use serde::{Deserialize, Serialize};

use super::pull::{elastic, plastic, stretch, taut_tension, yielding_at_rest};
use super::{Link, LinkKind, MAX_TIES, NO_TIES, Plastic, Tie, TieState, TieStates, Ties, YieldDirection};
use crate::block::{Body, Kinematics};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary};

/// An event function of a tie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TieFunction {
    /// The opposite of the elastic elongation of a slack tie (m).
    Shortness,
    /// The elastic elongation of a limp tie (m).
    Stretch,
    /// The tension of a taut tie (N).
    Tension,
    /// The opposite of the tension that a limp tie would have if taut (N).
    Limpness,
    /// Strength minus tension of a taut tie (N).
    Strength,
    /// Strength plus tension of a taut damper (N).
    Thrust,
    /// Elongation (m) that separates a taut tie from yielding in this direction.
    Yield(YieldDirection),
    /// Rate of elongation (m/s) of a tie that yields, in this direction.
    Unload(YieldDirection),
}

/// A reported event of a tie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TieEvent {
    /// It begins to pull.
    Taut,
    /// It stops pulling.
    Slack,
    /// It begins to yield.
    Yield,
    /// It stops yielding.
    Unload,
    /// It breaks.
    Break,
}

impl TieEvent {
    /// Returns its name in tables.
    pub fn word(self) -> &'static str {
        match self {
            TieEvent::Taut => "taut",
            TieEvent::Slack => "slack",
            TieEvent::Yield => "yield",
            TieEvent::Unload => "unload",
            TieEvent::Break => "break",
        }
    }
}

impl std::fmt::Display for TieEvent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            TieEvent::Taut => "is taut",
            TieEvent::Slack => "is slack",
            TieEvent::Yield => "yields",
            TieEvent::Unload => "unloads",
            TieEvent::Break => "breaks",
        })
    }
}

/// Number of functions of a tie that are watched at once, at most.
pub const WATCHED: usize = 4;

/// Returns the watched functions of a tie in its state. Two are of pulling and breaking, two of yielding.
pub fn watched<P, S>(link: Link<P, S>) -> [Option<TieFunction>; WATCHED]
where
    P: Elementary,
{
    use YieldDirection::{Longer, Shorter};
    let (breaks, kind) = (link.tie.strength.value() > 0.0, link.tie.kind);
    let acting = match kind {
        LinkKind::Tie => [Some(TieFunction::Tension), breaks.then_some(TieFunction::Strength)],
        LinkKind::Damper => [TieFunction::Thrust, TieFunction::Strength].map(|function| breaks.then_some(function)),
    };
    let yielding = match link.state {
        TieState::Taut if link.tie.yields() => [Longer, Shorter].map(|direction| Some(TieFunction::Yield(direction))),
        TieState::Yields(direction) => [Some(TieFunction::Unload(direction)), None],
        TieState::Slack | TieState::Taut | TieState::Limp | TieState::Broken => [None; 2],
    };
    let [first, second] = match link.state {
        TieState::Slack => [Some(TieFunction::Shortness), None],
        TieState::Taut | TieState::Yields(_) => acting,
        TieState::Limp => [Some(TieFunction::Stretch), Some(TieFunction::Limpness)],
        TieState::Broken => [None; 2],
    };
    [first, second, yielding[0], yielding[1]]
}

/// Returns the function whose value is the tension of a tie, if it pulls.
pub fn of_pull(state: TieState) -> Option<TieFunction> {
    match state {
        TieState::Taut | TieState::Yields(_) => Some(TieFunction::Tension),
        TieState::Slack | TieState::Limp | TieState::Broken => None,
    }
}

/// Returns the elongation (m) that separates a taut tie from yielding. Stretched by `length` (m), it is `F_y/k − σ (s − s_p/(1 − r))`.
fn margin<T: Elementary>(link: Link<T, T>, length: T, direction: YieldDirection) -> T {
    let Tie { stiffness, yield_force, hardening, .. } = *link.tie;
    let plastic = plastic(link, length);
    yield_force / stiffness - (length - plastic / (T::from(1.0) - hardening)) * direction.sign()
}

impl TieFunction {
    /// Returns value and rate; `rates` has the rates of `kinematics` in the dual parts.
    #[inline(never)]
    pub fn sample<T: Elementary>(
        self,
        body: &Body<T>,
        link: Link<T, T>,
        kinematics: impl Fn() -> Kinematics<T>,
        rates: impl Fn() -> Kinematics<Dual<T>>,
    ) -> Dual<T>
    where
        Dual<T>: CombinesWith<T>,
    {
        let Link { tie, .. } = link;
        let stretch_with_rate = || {
            let stretch = stretch(body, tie, &kinematics());
            Dual::new(elastic(link, stretch.length), stretch.rate)
        };
        let tension = || taut_tension(link, &stretch(body, tie, &rates()));
        match self {
            TieFunction::Shortness => -stretch_with_rate(),
            TieFunction::Stretch => stretch_with_rate(),
            TieFunction::Tension => tension(),
            TieFunction::Limpness => -tension(),
            TieFunction::Strength => -tension() + tie.strength,
            TieFunction::Thrust => tension() + tie.strength,
            TieFunction::Yield(direction) => {
                let stretch = stretch(body, tie, &kinematics());
                Dual::new(margin(link, stretch.length, direction), -stretch.rate * direction.sign())
            }
            TieFunction::Unload(direction) => stretch(body, tie, &rates()).rate * direction.sign(),
        }
    }

    /// Returns the value.
    pub fn value<T: Elementary>(self, body: &Body<T>, link: Link<T, T>, kinematics: &Kinematics<T>) -> T {
        let Link { tie, .. } = link;
        let stretch = stretch(body, tie, kinematics);
        match self {
            TieFunction::Shortness => -elastic(link, stretch.length),
            TieFunction::Stretch => elastic(link, stretch.length),
            TieFunction::Tension => taut_tension(link, &stretch),
            TieFunction::Limpness => -taut_tension(link, &stretch),
            TieFunction::Strength => tie.strength - taut_tension(link, &stretch),
            TieFunction::Thrust => tie.strength + taut_tension(link, &stretch),
            TieFunction::Yield(direction) => margin(link, stretch.length, direction),
            TieFunction::Unload(direction) => stretch.rate * direction.sign(),
        }
    }

    /// Whether value and rate follow from the state and its rate alone.
    pub fn follows_from_state(self) -> bool {
        match self {
            TieFunction::Shortness | TieFunction::Stretch | TieFunction::Yield(_) | TieFunction::Unload(_) => true,
            TieFunction::Tension | TieFunction::Limpness | TieFunction::Strength | TieFunction::Thrust => false,
        }
    }

    /// Whether an impact changes the value, which depends on the rate of elongation.
    pub fn jumps_at_impacts(self) -> bool {
        match self {
            TieFunction::Shortness | TieFunction::Stretch | TieFunction::Yield(_) => false,
            TieFunction::Tension
            | TieFunction::Limpness
            | TieFunction::Strength
            | TieFunction::Thrust
            | TieFunction::Unload(_) => true,
        }
    }

    /// Returns the size of its terms.
    #[inline(never)]
    pub fn size<T: Elementary>(self, body: &Body<T>, tie: &Tie<T>) -> f64 {
        match self {
            TieFunction::Shortness | TieFunction::Stretch | TieFunction::Yield(_) => size_of_stretch(body, tie),
            TieFunction::Tension | TieFunction::Limpness | TieFunction::Strength | TieFunction::Thrust => {
                size_of_tension(body, tie)
            }
            TieFunction::Unload(_) => size_of_stretch(body, tie) * body.p.value(),
        }
    }

    /// Returns the state of the tie and the reported event after this function's fall.
    pub fn switched<T: Elementary>(
        self,
        body: &Body<T>,
        link: Link<T, T>,
        kinematics: impl Fn() -> Kinematics<T>,
    ) -> (TieState, Option<TieEvent>) {
        let Link { tie, .. } = link;
        match self {
            TieFunction::Shortness | TieFunction::Limpness => (TieState::Taut, Some(TieEvent::Taut)),
            TieFunction::Tension => {
                let stretched = elastic(link, stretch(body, tie, &kinematics()).length).value() > 0.0;
                let damped = tie.damping.value() > 0.0 && stretched;
                (if damped { TieState::Limp } else { TieState::Slack }, Some(TieEvent::Slack))
            }
            TieFunction::Stretch => (TieState::Slack, None),
            TieFunction::Strength | TieFunction::Thrust => (TieState::Broken, Some(TieEvent::Break)),
            TieFunction::Yield(direction) => (TieState::Yields(direction), Some(TieEvent::Yield)),
            TieFunction::Unload(_) => (TieState::Taut, Some(TieEvent::Unload)),
        }
    }
}

/// Size of the terms of a stretch (m).
fn size_of_stretch<T: Elementary>(body: &Body<T>, tie: &Tie<T>) -> f64 {
    tie.length().value().max(body.r0.value())
}

/// Size of the terms of a tension (N).
fn size_of_tension<T: Elementary>(body: &Body<T>, tie: &Tie<T>) -> f64 {
    let spring = tie.stiffness.value() * size_of_stretch(body, tie);
    let dashpot = (tie.damping * body.p * body.r0).value();
    spring.max(dashpot).max((body.mass * body.gravity).value())
}

/// Returns the states of ties at the beginning, and their plastic elongations. A tie without slack is taut, one beyond its yield force
/// yields, and one beyond its strength is broken. `rounding` is the round-off of a zero over its largest term.
pub fn at_beginning<T: Elementary>(
    body: &Body<T>,
    ties: &Ties<T>,
    kinematics: &Kinematics<T>,
    rounding: f64,
) -> (TieStates, Plastic<T>) {
    let mut states = NO_TIES;
    let all = states.iter_mut().zip(ties.all());
    for (state, tie) in all.filter(|(_, tie)| tie.is_present()) {
        let stretch = stretch(body, tie, kinematics);
        let rounding_of_tension = rounding * size_of_tension(body, tie);
        let rounding_of_stretch = rounding * size_of_stretch(body, tie);
        let yielding = yielding_at_rest(tie, stretch.length, rounding_of_tension);
        let taut = yielding.map_or(TieState::Taut, TieState::Yields);
        let link = Link { tie, state: taut, plastic: None };
        let (tension, strength) = (taut_tension::<_, T, _>(link, &stretch).value(), tie.strength.value());
        let shortens = stretch.rate.value() < -rounding_of_stretch * body.p.value();
        let is_short = stretch.length.value() < if shortens { rounding_of_stretch } else { -rounding_of_stretch };
        *state = if tie.kind == LinkKind::Tie && is_short {
            TieState::Slack
        } else if tie.kind == LinkKind::Tie && tension < -rounding_of_tension {
            TieState::Limp
        } else if strength > 0.0 && tension.abs() > strength + rounding_of_tension {
            TieState::Broken
        } else {
            taut
        };
    }
    (states, ties.all().iter().any(Tie::yields).then_some([T::from(0.0); MAX_TIES]))
}
