//! Events, a file each: the watched function, its round-off, and the change of the pose when it falls through zero.
//!
//! | module | watched → change |
//! | --- | --- |
//! | `lift_off` | the reaction of a touching corner → it leaves its support, slips, or is held |
//! | `slip` | the last corner bears nothing but would be pressed on again → it slides |
//! | `held` | whether a held corner would be pressed on, or lifted; the slide of the standing corner → it lifts, or bears again |
//! | `landing` | the gap of a lifted corner while the other one stands → the impact map |
//! | `pivot` | the gap of a lifted corner on a rigid base → Housner's change of the pivot |
//! | `flight` | the gap of a corner in flight, or while the other one slides → landing with or without grip |
//! | [`grip`] | the pressure on a sliding foot without a limit of friction, if it gripped → it grips |
//! | `friction` | the distance of H from Coulomb's limit, the speed of a sliding foot → it slides, or grips |
//! | `restraint` | an event function of a restraint → its state changes |
//! | `quarter_turn` | the remaining angle → the run ends |
//!
//! [`watched`] is the table of the watched functions in each regime, for the driver and Model Exchange's indicators; lanes write those of
//! their modes out, and a test compares them. After each event `settle` decides the regime again, in a `change` of the pose.

pub(in crate::system) mod change;
mod event;
mod flight;
mod friction;
pub mod grip;
mod held;
pub(crate) mod landing;
pub(crate) mod lift_off;
mod pivot;
pub(in crate::system) mod placement;
pub(crate) mod quarter_turn;
mod restraint;
mod settle;
mod slip;

use serde::{Deserialize, Serialize};

use crate::block::restraints;
use crate::block::{Body, Corner, Foundation, Kinematics, Regime};
use crate::numerics::dual::Dual;
use crate::numerics::roots::has_fallen;
use crate::numerics::scalar::{CombinesWith, Elementary};
use crate::system::System;
use crate::system::evaluation::Evaluation;
use crate::system::instant::Pose;
use crate::system::motion_mode::MotionMode;
use change::{PoseUpdate, Release};
use placement::Placement;

pub use change::{Path, ROUNDING, TransitionCounts};
pub use event::{Event, EventKind};
pub use lift_off::gap_opening;

/// A function of the motion that is positive within a regime. It falls through zero when the regime ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EventFunction {
    /// The reaction N_I/M of a touching corner (m/s²).
    Reaction(Corner),
    /// The gap `v_I − y_I` between a lifted corner and its support (m).
    Gap(Corner),
    /// The acceleration that would press a held corner on if it were let go (m/s²). See [`gap_opening`].
    Held(Corner),
    /// The acceleration with which full contact would lift a held corner (m/s²).
    Unloaded(Corner),
    /// The distance of a sliding foot from being pressed on if it gripped (m/s²). On supports see [`grip::pressure_if_gripped`]; on the
    /// rigid base it is p times the vertical rate with which gripping would throw the corner up.
    GripPressure,
    /// The distance of H, which pushes the foot, from its limit `μ N` (m/s²). From L it pushes to the right, from R to the left.
    Friction(Corner),
    /// The speed of a foot that slides (m/s).
    Speed,
    /// The speed of a sliding foot's standing corner while the other is held (m/s).
    StandingSlide,
    /// A function of a restraint.
    Restraint(restraints::RestraintFunction),
    /// The rest of the quarter turn, `π/2 − |θ|` (rad).
    QuarterTurn,
}

/// Returns the watched event functions under a mode, in the order of Model Exchange's indicators.
///
/// They are those of L, of R, of the quarter turn, and of a sliding foot or a held corner. If two fall at the same time, the first counts.
#[inline(always)]
pub fn watched(mode: impl MotionMode) -> [Option<EventFunction>; 4] {
    use Corner::{Left, Right};
    use EventFunction::{Gap, GripPressure, Held, QuarterTurn, Reaction, Unloaded};
    let (left, right, contact) = match (mode.regime(), mode.held()) {
        (Regime::FullContact, None) => (Reaction(Left), Reaction(Right), None),
        (Regime::FullContact, Some(Left)) => (Held(Left), Reaction(Right), Some(Unloaded(Left))),
        (Regime::FullContact, Some(Right)) => (Reaction(Left), Held(Right), Some(Unloaded(Right))),
        (Regime::TiltingLeft, _) => (Reaction(Left), Gap(Right), None),
        (Regime::TiltingRight, _) => (Gap(Left), Reaction(Right), None),
        (Regime::Separated, _) => (Gap(Left), Gap(Right), None),
    };
    let slides = match mode.regime() {
        Regime::FullContact | Regime::TiltingLeft | Regime::TiltingRight => !mode.grips() && !mode.has_friction(),
        Regime::Separated => false,
    };
    [Some(left), Some(right), Some(QuarterTurn), if slides { Some(GripPressure) } else { contact }]
}

/// Returns the event functions of friction and restraints. Two of the foot come before those of the restraints.
#[inline(never)]
pub fn extended_event_functions(mode: impl MotionMode, body: &Body) -> [Option<EventFunction>; EXTENDED_COUNT] {
    let mut watched = [None; EXTENDED_COUNT];
    if mode.has_friction() && mode.regime() != Regime::Separated {
        if mode.grips() {
            watched[0] = Some(EventFunction::Friction(Corner::Left));
            watched[1] = Some(EventFunction::Friction(Corner::Right));
        } else {
            watched[0] = Some(EventFunction::Speed);
            watched[1] = mode.held().map(|_| EventFunction::StandingSlide);
        }
    }
    if !body.restraints.is_empty() {
        for (slot, function) in watched[2..].iter_mut().zip(restraints::watched(body, &mode.restraints())) {
            *slot = function.map(EventFunction::Restraint);
        }
    }
    watched
}

/// Number of event functions of [`extended_event_functions`].
pub const EXTENDED_COUNT: usize = 2 + restraints::WATCHED;

/// Number of event indicators of Model Exchange. They are the event functions of [`watched`], and those of [`extended_event_functions`]
/// with variables of the FMU.
pub const INDICATORS: usize = 4 + 2 + restraints::INDICATORS;

impl EventFunction {
    /// Returns value and rate at an instant.
    #[inline(always)]
    pub fn sample<T: Elementary>(self, at: &Evaluation<T>) -> Dual<T>
    where
        Dual<T>: CombinesWith<T>,
    {
        self.sample_on(at.body.foundation, at)
    }

    /// Returns value and rate at an instant. `foundation` is that of the block, and may be a constant.
    #[inline(always)]
    pub fn sample_on<T: Elementary>(self, foundation: Foundation, at: &Evaluation<T>) -> Dual<T>
    where
        Dual<T>: CombinesWith<T>,
    {
        match self {
            EventFunction::Reaction(corner) => lift_off::reaction(foundation, at, corner),
            EventFunction::Gap(corner) => landing::gap(&at.instant, at.support_heights, corner),
            EventFunction::Held(corner) => held::pressed_on(at, corner),
            EventFunction::Unloaded(corner) => held::unloading(at, corner),
            EventFunction::GripPressure => grip::slide(at),
            EventFunction::Friction(push) => friction::margin(at, push),
            EventFunction::Speed => friction::speed(at),
            EventFunction::StandingSlide => held::standing_slide(at),
            EventFunction::Restraint(function) => restraint::sample(function, at),
            EventFunction::QuarterTurn => quarter_turn::remaining_angle([at.instant.theta, at.instant.theta_dot]),
        }
    }

    /// Returns the value at an instant.
    pub fn value<T: Elementary>(self, at: &Evaluation<T>) -> T {
        match self {
            EventFunction::Reaction(corner) => at.instant.reaction[corner.index()],
            EventFunction::Gap(corner) => landing::gap(&at.instant, at.support_heights, corner).re,
            EventFunction::Held(corner) => held::pressed_on(at, corner).re,
            EventFunction::Unloaded(corner) => held::unloading(at, corner).re,
            EventFunction::GripPressure => grip::distance(at.body, at.regime, &at.instant),
            EventFunction::Friction(push) => friction::distance(at.body, &at.instant, push),
            EventFunction::Speed => friction::speed(at).re,
            EventFunction::StandingSlide => held::standing_slide(at).re,
            EventFunction::Restraint(function) => {
                function.value(at.body, &at.forcing.restraints, &Kinematics::of(&at.instant))
            }
            EventFunction::QuarterTurn => quarter_turn::remaining_angle([at.instant.theta, at.instant.theta_dot]).re,
        }
    }

    /// Whether value and rate follow from the state and its rate alone. An event may leave such a function at zero, with a rate independent
    /// of inputs' rates.
    pub fn follows_from_state(self, foundation: Foundation) -> bool {
        match self {
            EventFunction::Gap(_)
            | EventFunction::GripPressure
            | EventFunction::Speed
            | EventFunction::StandingSlide => true,
            EventFunction::Restraint(function) => function.follows_from_state(),
            EventFunction::Reaction(_) => match foundation {
                Foundation::Viscoelastic => true,
                Foundation::Rigid => false,
            },
            EventFunction::Held(_)
            | EventFunction::Unloaded(_)
            | EventFunction::Friction(_)
            | EventFunction::QuarterTurn => false,
        }
    }

    /// Whether an impact may leave the function below zero. After each event `settle` decides the other functions of velocities anew.
    pub fn jumps_at_impacts(self, foundation: Foundation) -> bool {
        match self {
            EventFunction::GripPressure => foundation == Foundation::Rigid,
            EventFunction::Restraint(function) => function.jumps_at_impacts(),
            EventFunction::Reaction(_)
            | EventFunction::Gap(_)
            | EventFunction::Held(_)
            | EventFunction::Unloaded(_)
            | EventFunction::Friction(_)
            | EventFunction::Speed
            | EventFunction::StandingSlide
            | EventFunction::QuarterTurn => false,
        }
    }

    /// Whether the block has the watched restraint, if this event function belongs to one.
    pub fn is_of(self, body: &Body) -> bool {
        if let EventFunction::Restraint(function) = self { function.is_of(body) } else { true }
    }

    /// Returns the round-off of a zero of this event function.
    #[inline]
    pub fn rounding<T: Elementary>(self, body: &Body<T>) -> f64 {
        match self {
            EventFunction::Reaction(_) | EventFunction::Held(_) | EventFunction::Unloaded(_) => {
                lift_off::rounding(body)
            }
            EventFunction::Gap(_) => landing::rounding(body),
            EventFunction::GripPressure => grip::rounding(body),
            EventFunction::Friction(_) => friction::margin_rounding(body),
            EventFunction::Speed | EventFunction::StandingSlide => friction::speed_rounding(body),
            EventFunction::Restraint(function) => ROUNDING * function.size(body),
            EventFunction::QuarterTurn => ROUNDING * quarter_turn::SIZE,
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
    /// Returns the transition of a pose at `now`, when an event function has reached zero.
    pub fn transition(&self, pose: &Pose<T>, now: &Evaluation<T>, function: EventFunction) -> Transition<T> {
        let mut change = PoseUpdate::begin(self, pose, now.excitation);
        let (event, counts) = match function {
            EventFunction::Reaction(corner) | EventFunction::Held(corner) => {
                let (release, counts) = change.lift_off(corner, matches!(function, EventFunction::Held(_)), now);
                let event = match release {
                    Release::Lifts => Some(EventKind::LiftOff(corner)),
                    Release::Slides => Some(EventKind::Slip),
                    Release::Held => None,
                };
                (event, counts)
            }
            EventFunction::Gap(corner) => {
                let counts = match (self.block.foundation, pose.footing.grips()) {
                    (Foundation::Viscoelastic, _) if self.block.friction.value() > 0.0 => {
                        change.land_with_friction(corner, now)
                    }
                    (Foundation::Rigid, _) if self.block.friction.value() > 0.0 && now.regime != Regime::Separated => {
                        change.change_pivot(corner, now)
                    }
                    (Foundation::Viscoelastic, true) => change.land(corner, now),
                    (Foundation::Viscoelastic, false) => change.land_freely(corner, now),
                    (Foundation::Rigid, true) => change.change_pivot(corner, now),
                    (Foundation::Rigid, false) => change.land_on_rigid_base(corner, now),
                };
                (Some(EventKind::Landing(corner)), counts)
            }
            EventFunction::GripPressure => (Some(EventKind::Grip), change.grip_from(Placement::of(&now.instant))),
            EventFunction::Unloaded(_) => {
                change.pose.contacts.let_bear();
                (None, TransitionCounts::NONE)
            }
            EventFunction::Friction(push) => {
                let (event, counts) = change.slide_or_grip(Some(push), now);
                (Some(event), counts)
            }
            EventFunction::Speed => {
                let (event, counts) = change.slide_or_grip(None, now);
                (Some(event), counts)
            }
            EventFunction::StandingSlide => match now.held {
                Some(held) => (Some(EventKind::LiftOff(held.corner)), change.stop_standing_corner(&held, now)),
                None => (None, TransitionCounts::NONE),
            },
            EventFunction::Restraint(function) => (change.switch(function, now), TransitionCounts::NONE),
            EventFunction::QuarterTurn => (Some(EventKind::Overturning), TransitionCounts::NONE),
        };
        let PoseUpdate { pose, path, .. } = change;
        Transition { pose, event, counts, path }
    }

    /// Returns the event function that a jump of the excitation took below zero, if any.
    ///
    /// It is a reaction on the rigid base, or the distance of H from the limit of friction.
    #[inline]
    pub fn crossed_by_jump(&self, now: &Evaluation<T>) -> Option<EventFunction> {
        if self.block.friction.value() > 0.0 && now.footing.grips() && now.regime != Regime::Separated {
            let slides =
                |function: &EventFunction| has_fallen(function.value(now).value(), function.rounding(&self.block));
            // Friction first, since a sliding foot has other reactions.
            if let Some(function) = Corner::BOTH.map(EventFunction::Friction).into_iter().find(slides) {
                return Some(function);
            }
        }
        self.leaving_rigid_base(now).map(EventFunction::Reaction)
    }

    /// Returns the pose right after `now` if a corner leaves the rigid base or slides.
    pub fn pose_after_jump(&self, pose: &Pose<T>, now: &Evaluation<T>) -> Option<Pose<T>> {
        Some(self.transition(pose, now, self.crossed_by_jump(now)?).pose)
    }
}
