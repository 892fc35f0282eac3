//! The stretch of a call over which the excitation is smooth.

use std::cell::Cell;

use crate::block::Block;
use crate::excitation::Excitation;
use crate::simulation::AtEvent;
use crate::system::swing::Swing;

/// A piece of time in which the excitation is smooth, and the treatment of events in it.
pub(super) struct SmoothPiece<'a> {
    pub(super) block: &'a Block,
    pub(super) excitation: &'a Excitation,
    /// Where it begins (s).
    pub(super) since: f64,
    /// Where steps end (s).
    pub(super) stop: f64,
    /// Its end (s); if it is later than `stop`, only a block at rest reaches it.
    pub(super) end: f64,
    pub(super) at_event: AtEvent,
    /// Whether a single step is taken, or all steps to the end.
    pub(super) single: bool,
    /// Receives the swing of a step, for those who repeat it.
    pub(super) swing: Option<&'a Cell<Option<Swing>>>,
    /// The first swing from the present time, if it is already known.
    pub(super) known_swing: Option<&'a Swing>,
}
