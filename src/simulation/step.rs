//! The interface of steps: the excitation, the stop, and any knowledge of the first step → an event, or none.

use std::cell::Cell;

use crate::block::Block;
use crate::excitation::Excitation;
use crate::numerics::control::Attempt;
use crate::numerics::dop853::DenseStep;
use crate::run::{SimulationError, spend_step};
use crate::simulation::limits;
use crate::simulation::state::Setup;
use crate::system::evaluation::Evaluation;
use crate::system::events::EventFunction;
use crate::system::swing::Swing;

/// The way in which a run went on.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "a step allocates nothing")]
#[cfg_attr(not(feature = "lanes"), expect(dead_code, reason = "only runs with derivatives repeat steps"))]
pub enum StepKind {
    /// It stayed where it was: an event happens at once.
    Stayed,
    /// By a step of order 8, or by its beginning up to an event.
    Step,
    /// By a [short step](crate::numerics::short), or at rest on the rigid base.
    ShortStep,
    /// By this [swing](crate::system::swing), or by its beginning.
    Swing(Swing),
    /// The block rests to the stop.
    Rested,
}

/// Steps over a smooth piece of the excitation, beside the state of the run.
#[derive(Clone, Copy)]
pub(super) struct StepsInput<'a> {
    pub(super) setup: &'a Setup,
    pub(super) excitation: &'a Excitation,
    /// Where steps end (s).
    pub(super) stop: f64,
    /// Whether the piece begins at the present time.
    pub(super) begins_piece: bool,
    /// Whether a single step is taken, or all steps under the present mode.
    pub(super) single: bool,
    pub(super) first: FirstStep<'a>,
    /// Receives the kind of a step, for a caller that repeats it.
    pub(super) kind: Option<&'a Cell<StepKind>>,
}

/// The known part of a step before it is taken.
#[derive(Clone, Copy)]
#[cfg_attr(not(feature = "lanes"), expect(dead_code, reason = "only lanes take steps before"))]
pub(super) enum FirstStep<'a> {
    /// Nothing is known.
    Open,
    /// It is of order 8. A short one made too great an error.
    NotShort,
    /// It is of order 8, and no longer than this attempt. Longer ones made too great errors.
    Attempt(Attempt),
    /// It is this step of order 8.
    Made(&'a DenseStep),
    /// It is this swing.
    Swing(&'a Swing),
}

/// The end of steps.
#[expect(clippy::large_enum_variant, reason = "a step allocates nothing")]
pub(super) enum StepsOutcome<'a> {
    /// No event has happened. The caller continues unless this is the stop.
    Lasts,
    /// The event function has reached zero; the block there, before the event.
    Event(EventFunction, Evaluation<'a>),
}

impl<'a> StepsInput<'a> {
    /// Describes all steps under the present mode from here to a stop (s).
    pub(super) fn of_piece(setup: &'a Setup, excitation: &'a Excitation, stop: f64) -> StepsInput<'a> {
        StepsInput { setup, excitation, stop, begins_piece: true, single: false, first: FirstStep::Open, kind: None }
    }

    /// The block.
    #[inline(always)]
    pub(super) fn block(&self) -> &'a Block {
        &self.setup.system.block
    }

    /// Tells a caller that repeats steps the kind of the present one.
    #[inline(always)]
    pub(super) fn report(&self, kind: impl FnOnce() -> StepKind) {
        if let Some(place) = self.kind {
            place.set(kind());
        }
    }

    /// Takes a step from the budget of a call.
    ///
    /// # Errors
    /// The budget is spent, or the clock does not resolve steps of `longest` (s) at `time`.
    pub(super) fn spend(&self, budget: &mut u64, time: f64, longest: f64) -> Result<(), SimulationError> {
        spend_step(budget, [time, self.stop], longest, || limits::fastest_number(self.block()))
    }
}
