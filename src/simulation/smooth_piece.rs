//! The stretches of a call over which the excitation is smooth, and the steps to the end of each.

use std::cell::Cell;

use crate::block::Block;
use crate::excitation::Excitation;
use crate::numerics::control::{Attempt, is_resolved};
#[cfg(feature = "lanes")]
use crate::numerics::dop853::DenseStep;
use crate::simulation::{AtEvent, Simulation, SimulationError};
use crate::system::events::Event;
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

impl<'a> SmoothPiece<'a> {
    /// The piece from `since` to a stop and an end (s), with all its steps.
    pub(super) fn new(
        block: &'a Block,
        excitation: &'a Excitation,
        since: f64,
        [stop, end]: [f64; 2],
        at_event: AtEvent,
    ) -> SmoothPiece<'a> {
        SmoothPiece { block, excitation, since, stop, end, at_event, single: false, swing: None, known_swing: None }
    }
}

/// The history of the instant at which steps begin.
#[derive(Clone, Copy)]
pub(super) struct StepStart {
    /// Whether the smooth piece begins here.
    pub(super) of_piece: bool,
    /// Whether a short step from exactly here has already made too great an error.
    pub(super) short_failed: bool,
    /// The step of order 8 that comes next, if one from exactly here has already made too great an error.
    pub(super) attempt: Option<Attempt>,
}

/// Maximum number of steps in a call. Reasonable calls take far fewer; one with this many ends in seconds.
pub(super) const MAX_STEPS: u64 = 2_000_000;

/// A bound on the time that a call advances, relative to [`MAX_STEPS`] divided by the fastest circular frequency: far more than
/// the longest step, and little enough that the clock resolves the motion.
const OUT_OF_REACH: f64 = 1e3;

impl Simulation {
    /// Steps from the present time to `stop`, over which the excitation is smooth, or to the end of the run, or to an event at
    /// which the motion is to stop.
    pub(super) fn smooth_piece(
        &mut self,
        stop: f64,
        block: &Block,
        excitation: &Excitation,
        budget: &mut u64,
        at_event: AtEvent,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        let (end, stop) = (stop, self.within_reach(stop));
        let since = self.pose.time;
        let piece = SmoothPiece::new(block, excitation, since, [stop, end], at_event);
        self.counts.evaluations += 1;
        self.all_steps(&piece, true, budget, observer)
    }

    /// Steps to the end of a piece, or of the run, or to an event at which the motion is to stop. `begins` tells whether the piece
    /// begins here.
    fn all_steps(
        &mut self,
        piece: &SmoothPiece,
        begins: bool,
        budget: &mut u64,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        let mut start = StepStart { of_piece: begins, short_failed: false, attempt: None };
        while self.pose.time < piece.stop && self.ending.is_none() && self.pending.is_none() {
            self.steps(piece, start, None, budget, observer)?;
            start.of_piece = false;
        }
        Ok(())
    }

    /// Replaces a stop so far away that the clock would not resolve the motion by one that no call reaches: by then the block
    /// rests, or the call has failed.
    fn within_reach(&self, stop: f64) -> f64 {
        let Block { omega_v, p, .. } = *self.block();
        let beyond = self.pose.time + OUT_OF_REACH * MAX_STEPS as f64 / omega_v.max(p);
        if self.pose.time < beyond { stop.min(beyond) } else { stop }
    }

    /// A single step from the present time towards `stop`, over which the excitation is smooth: `accepted` or `known_swing`, if that is
    /// already known.
    #[cfg(feature = "lanes")]
    #[expect(clippy::too_many_arguments, reason = "the step, in one of two forms")]
    pub(super) fn single_step(
        &mut self,
        stop: f64,
        block: &Block,
        excitation: &Excitation,
        single: bool,
        start: StepStart,
        accepted: Option<&DenseStep>,
        known_swing: Option<&Swing>,
        budget: &mut u64,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        let (since, end, at_event) = (self.pose.time, stop, AtEvent::Apply);
        let piece = SmoothPiece::new(block, excitation, since, [stop, end], at_event);
        let piece = SmoothPiece { single, known_swing, ..piece };
        self.steps(&piece, start, accepted, budget, observer)
    }

    /// Takes a step from the budget of a call, or fails if none is left or the clock does not resolve the motion.
    pub(super) fn spend(&self, budget: &mut u64, piece: &SmoothPiece, longest: f64) -> Result<(), SimulationError> {
        let time = self.pose.time;
        if *budget == 0 || !is_resolved(piece.stop - time, longest) {
            return Err(SimulationError::TooManySteps { time, until: piece.end, steps: MAX_STEPS - *budget });
        }
        *budget -= 1;
        Ok(())
    }
}
