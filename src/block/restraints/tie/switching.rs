//! The watched functions of a tie and its states.
//!
//! A tie becomes taut when its elastic elongation rises through zero, slack when its tension falls through zero, and breaks when its
//! tension reaches its strength, that of a damper in either sense. It yields when the force of its spring reaches the yield surface, and
//! unloads when its rate of elongation changes its sign, also while it is limp.

use serde::{Deserialize, Serialize};

use super::pull::{self, elastic, plastic, size_of_stretch, stretch, taut_tension, yielding_at_rest};
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

/// Returns the watched functions of a tie in its state. Where a landing turns its rate, it unloads before it is limp.
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
    let [pull, strength] = acting;
    let [stretch, limpness] = [TieFunction::Stretch, TieFunction::Limpness].map(Some);
    let yields = |direction| link.tie.yields().then_some(TieFunction::Yield(direction));
    let unloads = |direction| Some(TieFunction::Unload(direction));
    match link.state {
        TieState::Slack => [Some(TieFunction::Shortness), None, None, None],
        TieState::Taut => [pull, strength, yields(Longer), yields(Shorter)],
        TieState::Yields(direction) => [unloads(direction), pull, strength, None],
        TieState::Limp => [stretch, limpness, yields(Shorter), None],
        TieState::LimpYields => [unloads(Shorter), stretch, limpness, None],
        TieState::Broken => [None; WATCHED],
    }
}

/// Returns the function whose value is the tension of a tie, if it pulls.
pub fn of_pull(state: TieState) -> Option<TieFunction> {
    state.acts().then_some(TieFunction::Tension)
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
            // While the spring yields, its elastic elongation changes by r ṡ.
            let share = if link.state.yields().is_some() { tie.hardening } else { T::from(1.0) };
            Dual::new(elastic(link, stretch.length), stretch.rate * share)
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

    /// Returns the state of the tie and the reported event after this function's fall. `rounding` is the round-off of a zero over its largest
    /// term.
    pub fn switched<T: Elementary>(
        self,
        body: &Body<T>,
        link: Link<T, T>,
        kinematics: impl Fn() -> Kinematics<T>,
        rounding: f64,
    ) -> (TieState, Option<TieEvent>) {
        let Link { tie, state, .. } = link;
        let elongation = || elastic(link, stretch(body, tie, &kinematics()).length).value();
        match self {
            TieFunction::Shortness => (TieState::Taut, Some(TieEvent::Taut)),
            TieFunction::Limpness => (state.yields().map_or(TieState::Taut, TieState::Yields), Some(TieEvent::Taut)),
            TieFunction::Tension => {
                let stretched = elongation() > 0.0;
                let after = match state.yields() {
                    _ if !stretched || tie.damping.value() == 0.0 => TieState::Slack,
                    Some(YieldDirection::Shorter) => TieState::LimpYields,
                    Some(YieldDirection::Longer) | None => TieState::Limp,
                };
                (after, Some(TieEvent::Slack))
            }
            TieFunction::Stretch => (TieState::Slack, None),
            TieFunction::Strength | TieFunction::Thrust => (TieState::Broken, Some(TieEvent::Break)),
            // Where `h s_p` is F_y, a tie reaches its yield surface as its spring becomes loose.
            TieFunction::Yield(YieldDirection::Shorter)
                if tie.kind == LinkKind::Tie && elongation() <= rounding * size_of_stretch(body, tie) =>
            {
                (TieState::Slack, state.acts().then_some(TieEvent::Slack))
            }
            TieFunction::Yield(direction) => {
                let after = if state.acts() { TieState::Yields(direction) } else { TieState::LimpYields };
                (after, Some(TieEvent::Yield))
            }
            TieFunction::Unload(_) => {
                (if state.acts() { TieState::Taut } else { TieState::Limp }, Some(TieEvent::Unload))
            }
        }
    }
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
    let (mut states, mut plastics) = (NO_TIES, [T::from(0.0); MAX_TIES]);
    let all = states.iter_mut().zip(&mut plastics).zip(ties.all());
    for ((state, plastic), tie) in all.filter(|(_, tie)| tie.is_present()) {
        let stretch = stretch(body, tie, kinematics);
        let rounding_of_tension = rounding * size_of_tension(body, tie);
        let rounding_of_stretch = rounding * size_of_stretch(body, tie);
        let yielding = yielding_at_rest(tie, stretch.length, rounding_of_tension);
        let taut = yielding.map_or(TieState::Taut, TieState::Yields);
        let link = Link { tie, state: taut, plastic: None };
        let (tension, strength) = (taut_tension::<_, T, _>(link, &stretch).value(), tie.strength.value());
        let shortens = stretch.rate.value() < -rounding_of_stretch * body.p.value();
        let is_short = pull::slackens(tie, stretch.length, rounding_of_stretch)
            .unwrap_or(stretch.length.value() < if shortens { rounding_of_stretch } else { -rounding_of_stretch });
        *state = if tie.kind == LinkKind::Tie && is_short {
            TieState::Slack
        } else if tie.kind == LinkKind::Tie && tension < -rounding_of_tension {
            *plastic = pull::plastic(link, stretch.length);
            TieState::Limp
        } else if strength > 0.0 && tension.abs() > strength + rounding_of_tension {
            TieState::Broken
        } else {
            taut
        };
    }
    (states, ties.all().iter().any(Tie::yields).then_some(plastics))
}

impl TieState {
    /// Returns the event that brings a tie into this state before a run begins, if it is reported.
    pub(in crate::block) fn event_at_beginning(self) -> Option<TieEvent> {
        match self {
            TieState::Yields(_) | TieState::LimpYields => Some(TieEvent::Yield),
            TieState::Broken => Some(TieEvent::Break),
            TieState::Slack | TieState::Taut | TieState::Limp => None,
        }
    }
}
