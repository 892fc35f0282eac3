//! The events that a run reports, with their words.

use crate::block::{Corner, Regime, restraints};

/// A reported event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// A corner left its support, or the rigid base.
    LiftOff(Corner),
    /// A corner came down on its support, or on the rigid base.
    Landing(Corner),
    /// The foot began to slide, or changed direction. Friction reached its limit, or a support that bears no load cannot hold it.
    Slip,
    /// The foot stopped sliding.
    Grip,
    /// A restraint changed its state.
    Restraint(restraints::RestraintEvent),
    /// The block reached a quarter turn: a side lies on the ground.
    Overturning,
}

impl EventKind {
    /// Returns its name in tables.
    pub fn word(self) -> &'static str {
        match self {
            EventKind::LiftOff(_) => "lift-off",
            EventKind::Landing(_) => "landing",
            EventKind::Slip => "slip",
            EventKind::Grip => "grip",
            EventKind::Restraint(event) => event.word(),
            EventKind::Overturning => "overturning",
        }
    }

    /// Returns the name of its corner, `L` or `R`, or of its restraint. `None` for an event of the whole block.
    pub fn location(self) -> Option<&'static str> {
        match self {
            EventKind::LiftOff(Corner::Left) | EventKind::Landing(Corner::Left) => Some("L"),
            EventKind::LiftOff(Corner::Right) | EventKind::Landing(Corner::Right) => Some("R"),
            EventKind::Restraint(event) => event.location(),
            EventKind::Slip | EventKind::Grip | EventKind::Overturning => None,
        }
    }
}

/// A reported event of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Time (s).
    pub time: f64,
    /// Its kind.
    pub kind: EventKind,
    /// Regime right before.
    pub before: Regime,
    /// Regime right after, including all changes in the same instant.
    pub after: Regime,
}

impl std::fmt::Display for Event {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let write = |f: &mut std::fmt::Formatter<'_>, kind: &dyn std::fmt::Display| {
            write!(f, "t = {:.9} s: {kind}, {} -> {}", self.time, self.before, self.after)
        };
        let kind = match self.kind {
            EventKind::LiftOff(Corner::Left) => "lift-off of L",
            EventKind::LiftOff(Corner::Right) => "lift-off of R",
            EventKind::Landing(Corner::Left) => "landing on L",
            EventKind::Landing(Corner::Right) => "landing on R",
            EventKind::Slip => "slip",
            EventKind::Grip => "grip",
            EventKind::Restraint(event) => return write(f, &event),
            EventKind::Overturning => "overturning",
        };
        write(f, &kind)
    }
}
