//! Events, a file each: the watched function, its round-off, and the change of the pose when it falls through zero.
//!
//! | module | watched → change |
//! | --- | --- |
//! | [`lift_off`] | the reaction of a touching corner → it leaves its support, slips, or is held |
//! | `slip` | the last corner bears nothing but would be pressed on again → it slides |
//! | `held` | whether a held corner would be pressed on, or lifted; the slide of the standing corner → it lifts, or bears again |
//! | [`landing`] | the gap of a lifted corner while the other one stands → the impact map |
//! | `pivot` | the gap of a lifted corner on a rigid base → Housner's change of the pivot |
//! | `flight` | the gap of a corner in flight, or while the other one slides → landing with or without grip |
//! | [`grip`] | the pressure on a sliding foot without a limit of friction, if it gripped → it grips |
//! | `friction` | the distance of H from Coulomb's limit, the speed of a sliding foot → it slides, or grips |
//! | `restraint` | an event function of a restraint → its state changes |
//! | [`quarter_turn`] | the rest of the quarter turn → the run ends |
//!
//! [`watched`] is the table of the watched functions in each regime, for the driver, Model Exchange's indicators and the lanes. After
//! each event `settle` decides the regime again, in a `change` of the pose.

pub(in crate::system) mod change;
mod event;
mod flight;
mod friction;
pub mod grip;
mod held;
pub mod landing;
pub mod lift_off;
mod pivot;
pub(in crate::system) mod placement;
pub mod quarter_turn;
mod restraint;
mod settle;
mod slip;

use serde::{Deserialize, Serialize};

use crate::block::restraints;
use crate::block::{Block, Corner, Foundation, Kinematics, Regime};
use crate::numerics::dual::Dual;
use crate::numerics::roots::Sample;
use crate::numerics::scalar::{CombinesWith, Elementary};
use crate::system::System;
use crate::system::evaluation::Evaluation;
use crate::system::instant::Pose;
use crate::system::law::Law;
use change::{Change, Leaving};
use placement::Placement;

pub(crate) use change::ROUNDING;
pub use change::{Path, TransitionCounts};
pub use event::{Event, EventKind};
pub use lift_off::gap_opening;

/// A function of the motion that is positive within a regime and falls through zero when the regime ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Surface {
    /// The reaction N_I/M of a touching corner (m/s²).
    Reaction(Corner),
    /// The gap `v_I − y_I` between a lifted corner and its support (m).
    Gap(Corner),
    /// The acceleration with which a held corner would be pressed on if it were let go (m/s²); see [`gap_opening`].
    Held(Corner),
    /// The acceleration with which full contact would lift a held corner (m/s²).
    Unloaded(Corner),
    /// The distance of a sliding foot from being pressed on if it gripped (m/s²): on supports see
    /// [`grip::pressure_if_gripped`], on the rigid base p times the vertical rate with which gripping would throw the corner up.
    Slide,
    /// The distance of H, which pushes the foot, from its limit `μ N` (m/s²): from L to the right, from R to the left.
    Friction(Corner),
    /// The speed of a foot that slides (m/s).
    Speed,
    /// The speed of the corner that stands while the other one is held and the middle of the base slides (m/s).
    StandingSlide,
    /// A function of a restraint.
    Restraint(restraints::Surface),
    /// The rest of the quarter turn, `π/2 − |θ|` (rad).
    QuarterTurn,
}

/// Returns the watched surfaces under a law, in the order of Model Exchange's indicators.
///
/// They are those of L, of R, of the quarter turn, and of a sliding foot or a held corner. If two fall at the same time, the first counts.
#[inline(always)]
pub fn watched(law: impl Law) -> [Option<Surface>; 4] {
    use Corner::{Left, Right};
    use Surface::{Gap, Held, QuarterTurn, Reaction, Slide, Unloaded};
    let (left, right, contact) = match (law.regime(), law.held()) {
        (Regime::FullContact, None) => (Reaction(Left), Reaction(Right), None),
        (Regime::FullContact, Some(Left)) => (Held(Left), Reaction(Right), Some(Unloaded(Left))),
        (Regime::FullContact, Some(Right)) => (Reaction(Left), Held(Right), Some(Unloaded(Right))),
        (Regime::TiltingLeft, _) => (Reaction(Left), Gap(Right), None),
        (Regime::TiltingRight, _) => (Gap(Left), Reaction(Right), None),
        (Regime::Separated, _) => (Gap(Left), Gap(Right), None),
    };
    let slides = match law.regime() {
        Regime::FullContact | Regime::TiltingLeft | Regime::TiltingRight => !law.grips() && !law.has_friction(),
        Regime::Separated => false,
    };
    [Some(left), Some(right), Some(QuarterTurn), if slides { Some(Slide) } else { contact }]
}

/// Returns the further surfaces of a block with friction or restraints: two of the foot, then those of the restraints.
#[inline(never)]
pub fn watched_beyond(law: impl Law, block: &Block) -> [Option<Surface>; BEYOND] {
    let mut watched = [None; BEYOND];
    if law.has_friction() && law.regime() != Regime::Separated {
        if law.grips() {
            watched[0] = Some(Surface::Friction(Corner::Left));
            watched[1] = Some(Surface::Friction(Corner::Right));
        } else {
            watched[0] = Some(Surface::Speed);
            watched[1] = law.held().map(|_| Surface::StandingSlide);
        }
    }
    if !block.restraints.is_empty() {
        for (slot, surface) in watched[2..].iter_mut().zip(restraints::watched(block, &law.restraints())) {
            *slot = surface.map(Surface::Restraint);
        }
    }
    watched
}

/// Number of surfaces of [`watched_beyond`].
pub const BEYOND: usize = 2 + restraints::WATCHED;

/// Number of Model Exchange's event indicators: the surfaces of [`watched`], and those of [`watched_beyond`] with variables of the FMU.
pub const INDICATORS: usize = 4 + 2 + restraints::INDICATORS;

impl Surface {
    /// Returns value and rate at an instant.
    #[inline(always)]
    pub fn sample<T: Elementary>(self, at: &Evaluation<T>) -> Sample<T>
    where
        Dual<T>: CombinesWith<T>,
    {
        self.sample_on(at.block.foundation, at)
    }

    /// Returns value and rate at an instant; `foundation` is that of the block, and may be a constant.
    #[inline(always)]
    pub fn sample_on<T: Elementary>(self, foundation: Foundation, at: &Evaluation<T>) -> Sample<T>
    where
        Dual<T>: CombinesWith<T>,
    {
        match self {
            Surface::Reaction(corner) => lift_off::reaction(foundation, at, corner),
            Surface::Gap(corner) => landing::gap(&at.instant, at.support_heights, corner),
            Surface::Held(corner) => held::pressed_on(at, corner),
            Surface::Unloaded(corner) => held::unloading(at, corner),
            Surface::Slide => grip::slide(at),
            Surface::Friction(push) => friction::margin(at, push),
            Surface::Speed => friction::speed(at),
            Surface::StandingSlide => held::standing_slide(at),
            Surface::Restraint(surface) => restraint::sample(surface, at),
            Surface::QuarterTurn => quarter_turn::rest([at.instant.theta, at.instant.theta_dot]),
        }
    }

    /// Returns the value at an instant.
    pub fn value<T: Elementary>(self, at: &Evaluation<T>) -> T {
        match self {
            Surface::Reaction(corner) => at.instant.reaction[corner.index()],
            Surface::Gap(corner) => landing::gap(&at.instant, at.support_heights, corner).value,
            Surface::Held(corner) => held::pressed_on(at, corner).value,
            Surface::Unloaded(corner) => held::unloading(at, corner).value,
            Surface::Slide => grip::distance(at.block, at.regime, &at.instant),
            Surface::Friction(push) => friction::distance(at.block, &at.instant, push),
            Surface::Speed => friction::speed(at).value,
            Surface::StandingSlide => held::standing_slide(at).value,
            Surface::Restraint(surface) => surface.value(at.block, &Kinematics::of(&at.instant)),
            Surface::QuarterTurn => quarter_turn::rest([at.instant.theta, at.instant.theta_dot]).value,
        }
    }

    /// Whether value and rate follow from the state and its rate, without the rates of the inputs, and an event may leave it at zero.
    pub fn follows_from_state(self, foundation: Foundation) -> bool {
        match self {
            Surface::Gap(_) | Surface::Slide | Surface::Speed | Surface::StandingSlide => true,
            Surface::Restraint(surface) => surface.follows_from_state(),
            Surface::Reaction(_) => match foundation {
                Foundation::Viscoelastic => true,
                Foundation::Rigid => false,
            },
            Surface::Held(_) | Surface::Unloaded(_) | Surface::Friction(_) | Surface::QuarterTurn => false,
        }
    }

    /// Whether the block has the watched restraint, if this surface belongs to one.
    pub fn is_of(self, block: &Block) -> bool {
        match self {
            Surface::Restraint(surface) => surface.is_of(block),
            Surface::Reaction(_)
            | Surface::Gap(_)
            | Surface::Held(_)
            | Surface::Unloaded(_)
            | Surface::Slide
            | Surface::Friction(_)
            | Surface::Speed
            | Surface::StandingSlide
            | Surface::QuarterTurn => true,
        }
    }

    /// Returns the round-off of a zero of this surface.
    #[inline]
    pub fn rounding<T: Elementary>(self, block: &Block<T>) -> f64 {
        match self {
            Surface::Reaction(_) | Surface::Held(_) | Surface::Unloaded(_) => lift_off::rounding(block),
            Surface::Gap(_) => landing::rounding(block),
            Surface::Slide => grip::rounding(block),
            Surface::Friction(_) => friction::margin_rounding(block),
            Surface::Speed | Surface::StandingSlide => friction::speed_rounding(block),
            Surface::Restraint(surface) => ROUNDING * surface.size(block),
            Surface::QuarterTurn => ROUNDING * quarter_turn::SIZE,
        }
    }
}

/// The pose after an event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<T = f64> {
    /// The pose right after.
    pub pose: Pose<T>,
    /// The reported event; `None` if a corner becomes held or bears again.
    pub event: Option<EventKind>,
    /// Its contributions to the counters and sums of a run.
    pub counts: TransitionCounts,
    /// The regimes passed in this instant.
    pub path: Path,
}

impl<T: Elementary> System<T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Returns the transition of a pose at `now`, when the motion has fallen through a surface.
    pub fn transition(&self, pose: &Pose<T>, now: &Evaluation<T>, surface: Surface) -> Transition<T> {
        let mut change = Change::begin(self, pose, now.excitation);
        let event = match surface {
            Surface::Reaction(corner) | Surface::Held(corner) => {
                match change.lift_off(corner, matches!(surface, Surface::Held(_)), now) {
                    Leaving::Lifts => Some(EventKind::LiftOff(corner)),
                    Leaving::Slides => Some(EventKind::Slip),
                    Leaving::Held => None,
                }
            }
            Surface::Gap(corner) => {
                match (self.block.foundation, pose.footing.grips()) {
                    (Foundation::Viscoelastic, _) if self.block.friction.value() > 0.0 => {
                        change.land_with_friction(corner, now)
                    }
                    (Foundation::Rigid, _) if self.block.friction.value() > 0.0 && now.regime != Regime::Separated => {
                        change.change_pivot(corner, now);
                    }
                    (Foundation::Viscoelastic, true) => change.land(corner, now),
                    (Foundation::Viscoelastic, false) => change.land_freely(corner, now),
                    (Foundation::Rigid, true) => change.change_pivot(corner, now),
                    (Foundation::Rigid, false) => change.land_on_rigid_base(corner, now),
                }
                Some(EventKind::Landing(corner))
            }
            Surface::Slide => {
                change.grip_from(Placement::of(&now.instant));
                Some(EventKind::Grip)
            }
            Surface::Unloaded(_) => {
                change.pose.contacts.let_bear();
                None
            }
            Surface::Friction(push) => Some(change.slide_or_grip(Some(push), now)),
            Surface::Speed => Some(change.slide_or_grip(None, now)),
            Surface::StandingSlide => now.held.map(|held| {
                change.stop_standing_corner(&held, now);
                EventKind::LiftOff(held.corner)
            }),
            Surface::Restraint(surface) => change.switch(surface, now),
            Surface::QuarterTurn => Some(EventKind::Overturning),
        };
        let Change { pose, counts, path, .. } = change;
        Transition { pose, event, counts, path }
    }

    /// Returns the surface that a jump of the excitation has taken below zero, if any.
    ///
    /// It is a reaction on the rigid base, or the distance of H from the limit of friction.
    #[inline]
    pub fn fallen(&self, now: &Evaluation<T>) -> Option<Surface> {
        if self.block.friction.value() > 0.0 && now.footing.grips() && now.regime != Regime::Separated {
            let slides = |surface: &Surface| surface.value(now).value() < -surface.rounding(&self.block);
            // Friction first, since a sliding foot has other reactions.
            if let Some(surface) = Corner::BOTH.map(Surface::Friction).into_iter().find(slides) {
                return Some(surface);
            }
        }
        self.leaving_rigid_base(now).map(Surface::Reaction)
    }

    /// Returns the pose right after `now` if a corner cannot stay on the rigid base, or if the foot slides.
    pub fn released(&self, pose: &Pose<T>, now: &Evaluation<T>) -> Option<Pose<T>> {
        Some(self.transition(pose, now, self.fallen(now)?).pose)
    }
}
