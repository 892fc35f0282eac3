//! The events that a run reports, with their words.

use crate::block::ties::MOST_TIES;
use crate::block::{Corner, Regime};

/// A reported event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// A corner left its support, or the rigid base.
    LiftOff(Corner),
    /// A corner came down on its support, or on the rigid base.
    Landing(Corner),
    /// The foot slides from here on, or to the other side: friction has reached its limit, or nothing holds the block horizontally though
    /// a support still bears it.
    Slip,
    /// The foot slides no more.
    Grip,
    /// A tie, by its place in the list, begins to pull.
    Taut(u8),
    /// A tie pulls no more.
    Slack(u8),
    /// A tie breaks.
    Break(u8),
    /// The block reached a quarter turn: a side lies on the ground.
    Overturning,
}

impl EventKind {
    /// Its name in tables.
    pub fn word(self) -> &'static str {
        match self {
            EventKind::LiftOff(_) => "lift-off",
            EventKind::Landing(_) => "landing",
            EventKind::Slip => "slip",
            EventKind::Grip => "grip",
            EventKind::Taut(_) => "taut",
            EventKind::Slack(_) => "slack",
            EventKind::Break(_) => "break",
            EventKind::Overturning => "overturning",
        }
    }

    /// The tie to which it belongs, by its place in the list.
    pub fn tie(self) -> Option<u8> {
        match self {
            EventKind::Taut(tie) | EventKind::Slack(tie) | EventKind::Break(tie) => Some(tie),
            EventKind::LiftOff(_)
            | EventKind::Landing(_)
            | EventKind::Slip
            | EventKind::Grip
            | EventKind::Overturning => None,
        }
    }

    /// The name of its corner, `L` or `R`, or of its tie, `tie 1` and so on; none for an event of the whole block.
    pub fn place(self) -> Option<&'static str> {
        const TIES: [&str; MOST_TIES] = ["tie 1", "tie 2", "tie 3", "tie 4", "tie 5", "tie 6", "tie 7", "tie 8"];
        match self {
            EventKind::LiftOff(Corner::Left) | EventKind::Landing(Corner::Left) => Some("L"),
            EventKind::LiftOff(Corner::Right) | EventKind::Landing(Corner::Right) => Some("R"),
            EventKind::Taut(tie) | EventKind::Slack(tie) | EventKind::Break(tie) => TIES.get(usize::from(tie)).copied(),
            EventKind::Slip | EventKind::Grip | EventKind::Overturning => None,
        }
    }
}

/// An event, as it is reported while the simulation runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Time (s).
    pub time: f64,
    /// Its kind.
    pub kind: EventKind,
    /// Regime right before.
    pub before: Regime,
    /// Regime right after, with all that followed in the same instant.
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
            EventKind::Taut(tie) => return write(f, &format_args!("tie {} is taut", tie + 1)),
            EventKind::Slack(tie) => return write(f, &format_args!("tie {} is slack", tie + 1)),
            EventKind::Break(tie) => return write(f, &format_args!("tie {} breaks", tie + 1)),
            EventKind::Overturning => "overturning",
        };
        write(f, &kind)
    }
}
