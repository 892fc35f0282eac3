//! The motion of a block and its rates → the functions that are watched, their round-off, and the change of the block at their zeros.
//!
//! All states are continuous at all events, so that events in one instant have no order.

mod landing;
mod lift_off;
mod overturning;
mod sliding;
mod toppling;

use serde::{Deserialize, Serialize};

use crate::numerics::dual::Dual;
use crate::space::body::SpaceBody;
use crate::space::forces::{FootContact, FootForces};
use crate::space::motion::{BodyMotion, FEET_FROM, FootMotion, of_foot};

pub use toppling::topples;

/// A function whose fall through zero is an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpaceFunction {
    /// N of a foot.
    LiftOff(usize),
    /// The gap of a foot.
    Landing(usize),
    /// μ N − |F| of a foot that sticks.
    Slides(usize),
    /// |F| − μ N of a foot that slides.
    Sticks(usize),
    /// The vertical component of the body's axis.
    Overturning,
}

/// An event, with the number of its foot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SpaceEventKind {
    /// A foot lifts.
    LiftOff(usize),
    /// A foot lands.
    Landing(usize),
    /// A foot begins to slide.
    Slides(usize),
    /// A foot sticks again.
    Sticks(usize),
    /// The block lies on its side.
    Overturning,
}

/// An event of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpaceEvent {
    /// Its time (s).
    pub time: f64,
    /// Its kind.
    pub kind: SpaceEventKind,
}

impl std::fmt::Display for SpaceEvent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (kind, foot) = match self.kind {
            SpaceEventKind::LiftOff(foot) => ("lift-off of foot", foot),
            SpaceEventKind::Landing(foot) => ("landing on foot", foot),
            SpaceEventKind::Slides(foot) => ("slip of foot", foot),
            SpaceEventKind::Sticks(foot) => ("grip of foot", foot),
            SpaceEventKind::Overturning => return write!(f, "t = {:.9} s: overturning", self.time),
        };
        write!(f, "t = {:.9} s: {kind} {foot}", self.time)
    }
}

/// The most functions of a foot.
pub const PER_CONTACT: usize = 2;

/// Returns the functions of a foot that are watched.
pub fn watched(body: &SpaceBody, foot: usize, contact: &FootContact) -> [Option<SpaceFunction>; PER_CONTACT] {
    match contact {
        FootContact::Sticks => [Some(SpaceFunction::LiftOff(foot)), Some(SpaceFunction::Slides(foot))],
        FootContact::Slides if body.is_frictionless() => [Some(SpaceFunction::LiftOff(foot)), None],
        FootContact::Slides => [Some(SpaceFunction::LiftOff(foot)), Some(SpaceFunction::Sticks(foot))],
        FootContact::Lifted(_) => [Some(SpaceFunction::Landing(foot)), None],
    }
}

/// A block at an instant: a state with its rates, and the contacts.
#[derive(Clone, Copy, Debug)]
pub struct Poised<'a> {
    /// The block.
    pub body: &'a SpaceBody,
    /// Time (s).
    pub time: f64,
    /// The state.
    pub state: &'a [f64],
    /// Its rates.
    pub rates: &'a [f64],
    /// The contacts of its feet.
    pub contacts: &'a [FootContact],
}

/// The value of a function with its rate, and its round-off.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpaceSample {
    /// The value with its rate.
    pub value: Dual,
    /// Its round-off.
    pub rounding: f64,
}

/// Round-off of the motion of a foot.
#[derive(Clone, Copy, Debug)]
struct RoundOff {
    /// Of heights (m).
    height: f64,
    /// Of velocities (m/s).
    velocity: f64,
}

/// Round-off of a sum of few terms, over the greatest of them.
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

impl<'a> Poised<'a> {
    /// Returns the motion of the body with its rates.
    pub fn motion(&self) -> BodyMotion<Dual> {
        let numbers: [Dual; FEET_FROM] = std::array::from_fn(|i| Dual::new(self.state[i], self.rates[i]));
        BodyMotion::of(&numbers)
    }

    /// Returns motion and forces of a foot, with their rates.
    fn foot(&self, motion: &BodyMotion<Dual>, foot: usize) -> (FootMotion<Dual>, FootForces<Dual>) {
        let at = motion.foot(&self.body.feet[foot].place);
        let stretch = [0, 1].map(|i| of_foot(foot) + i).map(|i| Dual::new(self.state[i], self.rates[i]));
        (at, FootForces::of(self.body, &self.body.feet[foot], FootContact::Sticks, &at, stretch))
    }

    fn round_off(&self, motion: &BodyMotion<Dual>) -> RoundOff {
        let reach = self.body.reach;
        let plain = |v: &nalgebra::Vector3<Dual>| v.map(|x| x.re).norm();
        RoundOff {
            height: ROUND_OFF * (reach + motion.displacement.z.re.abs()),
            velocity: ROUND_OFF * (plain(&motion.velocity) + reach * plain(&motion.omega)),
        }
    }

    /// Returns the sample of a function.
    pub fn sample(&self, function: SpaceFunction) -> SpaceSample {
        self.sample_with(&self.motion(), function)
    }

    /// Returns the sample of a function for a known motion of the body.
    pub fn sample_with(&self, motion: &BodyMotion<Dual>, function: SpaceFunction) -> SpaceSample {
        let round_off = self.round_off(motion);
        match function {
            SpaceFunction::LiftOff(foot) => lift_off::sample(self.body, &self.foot(motion, foot).1, round_off),
            SpaceFunction::Landing(foot) => landing::sample(self, foot, &self.foot(motion, foot).0, round_off),
            SpaceFunction::Slides(foot) => sliding::room(self, foot, &self.foot(motion, foot).1, round_off),
            SpaceFunction::Sticks(foot) => {
                let SpaceSample { value, rounding } = sliding::room(self, foot, &self.foot(motion, foot).1, round_off);
                SpaceSample { value: -value, rounding }
            }
            SpaceFunction::Overturning => overturning::sample(&motion.turn),
        }
    }

    /// Returns the functions that are watched.
    pub fn functions(&self) -> impl Iterator<Item = SpaceFunction> + use<'a> {
        let body = self.body;
        let of_feet = self.contacts.iter().enumerate().flat_map(move |(i, contact)| watched(body, i, contact));
        of_feet.flatten().chain([SpaceFunction::Overturning])
    }
}

/// The change of a foot at an event.
#[derive(Clone, Copy, Debug)]
pub struct FootChange {
    /// Its contact after the event. Its stretch is zero after lift-offs and landings.
    pub contact: FootContact,
    /// Energy of its springs that is lost (J).
    pub lost: f64,
    /// The events, in their order.
    pub events: [Option<SpaceEventKind>; 2],
}

/// Returns the change of a foot at the zero of one of its functions, or `None` if it stays as it is.
pub fn change(at: &Poised, function: SpaceFunction) -> Option<(usize, FootChange)> {
    match function {
        SpaceFunction::LiftOff(foot) => Some((foot, lift_off::apply(at, foot))),
        SpaceFunction::Landing(foot) => landing::apply(at, foot).map(|change| (foot, change)),
        SpaceFunction::Slides(foot) => Some((foot, sliding::slides(foot))),
        SpaceFunction::Sticks(foot) => Some((foot, sliding::sticks(foot))),
        SpaceFunction::Overturning => None,
    }
}
