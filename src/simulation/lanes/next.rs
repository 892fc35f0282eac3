//! A run in a lane → its next step: the kind that is stepped together, and the knowledge from earlier attempts.

use crate::block::{Corner, Foundation, Regime};
use crate::numerics::control::Attempt;
use crate::numerics::dop853::DenseStep;
use crate::simulation::Simulation;
use crate::simulation::step::FirstStep;
use crate::system::forces;
use crate::system::swing::Swing;

/// The next action of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Nothing: it has reached the requested time, or its end.
    Arrived,
    /// A step alone.
    Alone,
    /// A step together with runs whose next step is of this kind.
    Together(BatchKind),
}

/// The way in which runs are stepped together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LaneMode {
    /// By steps on supports in this stance.
    Steps(Stance),
    /// By swings about a corner of the rigid base.
    Swings,
}

/// The kind of a step. Runs whose next steps are of the same kind are stepped together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BatchKind {
    /// A step on supports.
    Step {
        /// How the blocks stand.
        stance: Stance,
        /// Whether it is a short step, or one of order 8.
        short: bool,
    },
    /// A swing about either corner of the rigid base.
    Swing {
        /// Whether a pulse acts, or an excitation linear in time alone.
        is_wave: bool,
        /// Whether it probably ends with a landing, which takes several iterations.
        lands: bool,
    },
}

impl BatchKind {
    /// The number of kinds.
    pub const COUNT: usize = 10;

    /// Its number, from 0.
    pub fn number(self) -> usize {
        match self {
            BatchKind::Step { stance, short } => stance.index() + if short { 0 } else { 3 },
            BatchKind::Swing { is_wave, lands } => 6 + usize::from(is_wave) + 2 * usize::from(lands),
        }
    }

    /// The kind of a number.
    pub fn numbered(number: usize) -> BatchKind {
        match number {
            0..6 => BatchKind::Step { stance: Stance::ALL[number % 3], short: number < 3 },
            _ => BatchKind::Swing { is_wave: number % 2 == 1, lands: number >= 8 },
        }
    }
}

/// A regime in which lanes take steps: any but flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stance {
    /// Both corners touch.
    FullContact,
    /// Only L touches.
    OnLeft,
    /// Only R touches.
    OnRight,
}

impl Stance {
    const ALL: [Stance; 3] = [Stance::FullContact, Stance::OnLeft, Stance::OnRight];

    /// Returns that of a regime; `None` in flight.
    #[inline]
    pub(super) fn of(regime: Regime) -> Option<Stance> {
        match regime {
            Regime::FullContact => Some(Stance::FullContact),
            Regime::TiltingLeft => Some(Stance::OnLeft),
            Regime::TiltingRight => Some(Stance::OnRight),
            Regime::Separated => None,
        }
    }

    /// Returns its index, from 0.
    #[inline]
    pub(super) fn index(self) -> usize {
        self as usize
    }
}

/// How a run in its present contacts is stepped with others; `None` if alone.
pub(super) fn lane_mode(simulation: &Simulation) -> Option<LaneMode> {
    let (block, pose) = (simulation.block(), &simulation.run.pose);
    let gripping = pose.footing.grips() && pose.contacts.held().is_none();
    if !gripping || forces::switch(block) {
        return None;
    }
    let regime = pose.contacts.regime();
    match block.foundation {
        Foundation::Viscoelastic => Stance::of(regime).map(LaneMode::Steps),
        Foundation::Rigid => regime.pivot().is_some().then_some(LaneMode::Swings),
    }
}

/// The next step, as far as earlier attempts determine it.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "a step allocates nothing")]
pub(super) enum NextStep {
    /// Any step.
    Open {
        /// Whether the smooth piece begins here.
        begins_piece: bool,
    },
    /// A step of order 8. A short one makes too great an error, or may hold an event or a peak.
    NotShort,
    /// The lane's attempt of order 8. A longer one made too great an error.
    Shorter,
    /// This step of order 8, made by a lane. It may hold an event or a peak.
    Made(DenseStep),
    /// This swing, which a lane has made, and in which something may happen.
    Swing {
        made: Box<Swing>,
        /// Whether the smooth piece begins here.
        begins_piece: bool,
    },
    /// No step but an impact: the block has turned about this pivot and come down on the other corner.
    Landing(Corner),
}

impl NextStep {
    /// Whether the smooth piece begins here.
    pub(super) fn begins_piece(&self) -> bool {
        match *self {
            NextStep::Open { begins_piece } | NextStep::Swing { begins_piece, .. } => begins_piece,
            NextStep::NotShort | NextStep::Shorter | NextStep::Made(_) | NextStep::Landing(_) => false,
        }
    }

    /// The known part of the step, for a run that takes it alone. `attempt` is that of the lane.
    pub(super) fn first_step(&self, attempt: Attempt) -> FirstStep<'_> {
        match self {
            NextStep::Open { .. } | NextStep::Landing(_) => FirstStep::Open,
            NextStep::NotShort => FirstStep::NotShort,
            NextStep::Shorter => FirstStep::Attempt(attempt),
            NextStep::Made(step) => FirstStep::Made(step),
            NextStep::Swing { made, .. } => FirstStep::Swing(made),
        }
    }
}
