//! The motion of a block and its rates → the functions that are watched, their round-off, and the change of the block at their zeros.
//!
//! No event changes places and velocities of the body, and each concerns one foot, so that events in one instant have no order.

mod landing;
mod lift_off;
mod overturning;
mod sliding;
mod toppling;

use std::borrow::Borrow;

use serde::{Deserialize, Serialize};

use crate::numerics::dual::Dual;
use crate::space::body::SpaceBody;
use crate::space::equations::SpaceEquations;
use crate::space::forces::{FootContact, FootForces};
use crate::space::motion::{BodyMotion, FEET_FROM, of_foot};

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

/// The value of a watched function with its rate, and its round-off.
#[derive(Clone, Copy, Debug)]
pub struct SpaceSample {
    /// The function.
    pub function: SpaceFunction,
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

/// A block at an instant: a state with its rates, and the contacts.
#[derive(Clone, Debug)]
pub struct Poised<'a> {
    /// The block.
    pub body: &'a SpaceBody,
    /// Time (s).
    pub time: f64,
    /// The state.
    state: &'a [f64],
    /// Its rates.
    rates: &'a [f64],
    /// The contacts of its feet.
    contacts: &'a [FootContact],
    /// The motion of the body with its rates.
    motion: BodyMotion<Dual>,
    round_off: RoundOff,
}

impl<'a> Poised<'a> {
    /// Returns the instant of a state with its rates.
    #[inline]
    pub fn of(equations: &SpaceEquations<'a>, time: f64, state: &'a [f64], rates: &'a [f64]) -> Poised<'a> {
        let &SpaceEquations { body, contacts, .. } = equations;
        let numbers: [Dual; FEET_FROM] = std::array::from_fn(|i| Dual::new(state[i], rates[i]));
        let motion = BodyMotion::of(&numbers);
        let plain = |v: &nalgebra::Vector3<Dual>| v.map(|x| x.re).norm();
        let round_off = RoundOff {
            height: ROUND_OFF * (body.reach + motion.displacement.z.re.abs()),
            velocity: ROUND_OFF * (plain(&motion.velocity) + body.reach * plain(&motion.omega)),
        };
        Poised { body, time, state, rates, contacts, motion, round_off }
    }

    /// Returns the forces of a foot, with their rates.
    #[inline]
    fn forces(&self, foot: usize) -> FootForces<Dual> {
        let at = self.motion.foot(&self.body.feet[foot].place);
        let stretch = [0, 1].map(|i| of_foot(foot) + i).map(|i| Dual::new(self.state[i], self.rates[i]));
        FootForces::of(self.body, &self.body.feet[foot], FootContact::Sticks, &at, stretch)
    }

    /// Returns the motion of the body with its rates.
    pub fn motion(&self) -> &BodyMotion<Dual> {
        &self.motion
    }

    /// Takes the samples of the functions that are watched. Those of a foot are next to each other, its lift-off first.
    pub fn take_samples(&self, mut put: impl FnMut(SpaceSample)) {
        for (i, contact) in self.contacts.iter().enumerate() {
            let functions = watched(self.body, i, contact).into_iter().flatten();
            if contact.touches() {
                let forces = self.forces(i);
                functions.for_each(|function| put(self.sample_with(function, |_| &forces)));
            } else {
                functions.for_each(|function| put(self.sample(function)));
            }
        }
        put(self.sample(SpaceFunction::Overturning));
    }

    /// Returns the sample of a function.
    pub fn sample(&self, function: SpaceFunction) -> SpaceSample {
        self.sample_with(function, |foot| self.forces(foot))
    }

    /// Returns the sample of a function, with the forces of its foot if it needs them.
    #[inline]
    fn sample_with<F: Borrow<FootForces<Dual>>>(
        &self,
        function: SpaceFunction,
        forces: impl FnOnce(usize) -> F,
    ) -> SpaceSample {
        let (value, rounding) = match function {
            SpaceFunction::LiftOff(foot) => lift_off::sample(self.body, forces(foot).borrow(), self.round_off),
            SpaceFunction::Landing(foot) => landing::sample(self, foot),
            SpaceFunction::Slides(foot) => sliding::room(self, foot, forces(foot).borrow()),
            SpaceFunction::Sticks(foot) => {
                let (room, rounding) = sliding::room(self, foot, forces(foot).borrow());
                (-room, rounding)
            }
            SpaceFunction::Overturning => overturning::sample(&self.motion.turn),
        };
        SpaceSample { function, value, rounding }
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

/// Returns the change of a foot at the zero of one of its functions at a time (s), or `None` if it stays as it is.
pub fn change(body: &SpaceBody, time: f64, state: &[f64], function: SpaceFunction) -> Option<(usize, FootChange)> {
    match function {
        SpaceFunction::LiftOff(foot) => Some((foot, lift_off::apply(body, time, state, foot))),
        SpaceFunction::Landing(foot) => landing::apply(body, state, foot).map(|change| (foot, change)),
        SpaceFunction::Slides(foot) => Some((foot, sliding::slides(foot))),
        SpaceFunction::Sticks(foot) => Some((foot, sliding::sticks(foot))),
        SpaceFunction::Overturning => None,
    }
}
