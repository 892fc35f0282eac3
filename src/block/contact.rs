//! The contact of each corner (bearing, held on its support, or lifted) → the regime.

use serde::{Deserialize, Serialize};

use crate::block::{Body, Corner, Creep, Foot};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::Elementary;

/// The regime of motion, by the corners in contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(i32)]
pub enum Regime {
    /// Only L touches: the block tilts to the left, θ < 0.
    TiltingLeft = -1,
    /// Both corners touch.
    FullContact = 0,
    /// Only R touches: the block tilts to the right, θ > 0.
    TiltingRight = 1,
    /// No corner touches: complete separation.
    Separated = 2,
}

impl Regime {
    /// Returns the regime in which only these corners touch.
    pub fn of_touching([left, right]: [bool; 2]) -> Regime {
        match (left, right) {
            (true, true) => Regime::FullContact,
            (true, false) => Regime::TiltingLeft,
            (false, true) => Regime::TiltingRight,
            (false, false) => Regime::Separated,
        }
    }

    /// Returns the regime in which only this corner touches.
    pub fn on(corner: Corner) -> Regime {
        match corner {
            Corner::Left => Regime::TiltingLeft,
            Corner::Right => Regime::TiltingRight,
        }
    }

    /// Returns true if this corner touches.
    #[inline]
    pub fn touches(self, corner: Corner) -> bool {
        match self {
            Regime::FullContact => true,
            Regime::TiltingLeft => corner == Corner::Left,
            Regime::TiltingRight => corner == Corner::Right,
            Regime::Separated => false,
        }
    }

    /// Returns the point on which the block stands, or `None` in flight.
    #[inline(always)]
    pub fn foot(self) -> Option<Foot> {
        match self {
            Regime::FullContact => Some(Foot::Middle),
            Regime::TiltingLeft => Some(Foot::Corner(Corner::Left)),
            Regime::TiltingRight => Some(Foot::Corner(Corner::Right)),
            Regime::Separated => None,
        }
    }

    /// Returns the only corner on which the block stands, or `None`.
    #[inline]
    pub fn pivot(self) -> Option<Corner> {
        match self {
            Regime::TiltingLeft => Some(Corner::Left),
            Regime::TiltingRight => Some(Corner::Right),
            Regime::FullContact | Regime::Separated => None,
        }
    }

    /// Returns the regime's number in the paper and the FMU: −1, 0, 1 or 2.
    pub fn number(self) -> i32 {
        self as i32
    }
}

impl std::fmt::Display for Regime {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Regime::TiltingLeft => "tilting left",
            Regime::FullContact => "full contact",
            Regime::TiltingRight => "tilting right",
            Regime::Separated => "separated",
        })
    }
}

/// The slide of the standing corner while the other is held and the base slides.
///
/// The velocities of both points differ by `b sin θ θ̇`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum StandingSlide {
    /// To the side of the middle of the base, or neither slides.
    Follows,
    /// To the opposite side.
    Opposes,
}

/// The contact of a corner.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Contact<T = f64> {
    /// Standing on its support, or on the rigid base.
    Bearing,
    /// On its support without load, while the support creeps to its free height. Full contact would lift the corner, and the regime without
    /// it would press it back. See docs/unit/model.md.
    Held(Creep<T>, StandingSlide),
    /// Off its support, which creeps back to its free height.
    Lifted(Creep<T>),
}

impl<T> Contact<T> {
    /// Returns the contact with each number converted.
    #[cfg(feature = "lanes")]
    pub fn map<U>(self, number: impl Fn(T) -> U) -> Contact<U> {
        let creep = |Creep { depth, since }| Creep { depth: number(depth), since: number(since) };
        match self {
            Contact::Bearing => Contact::Bearing,
            Contact::Held(at, slide) => Contact::Held(creep(at), slide),
            Contact::Lifted(at) => Contact::Lifted(creep(at)),
        }
    }
}

/// The contacts of both corners.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contacts<T = f64>([Contact<T>; 2]);

impl<T: Elementary> Contacts<T> {
    /// Both corners bear.
    pub const FULL: Contacts<T> = Contacts([Contact::Bearing; 2]);

    /// Returns contacts in which these corners bear. The supports of the others are at their free height.
    pub fn touching(touching: [bool; 2], time: T) -> Contacts<T> {
        let free = Contact::Lifted(Creep { depth: T::from(0.0), since: time });
        Contacts(touching.map(|touches| if touches { Contact::Bearing } else { free }))
    }

    /// Returns the contact of a corner.
    #[inline]
    pub fn of(&self, corner: Corner) -> Contact<T> {
        self.0[corner.index()]
    }

    /// Returns the contact of a corner for a change.
    #[inline]
    pub fn of_mut(&mut self, corner: Corner) -> &mut Contact<T> {
        &mut self.0[corner.index()]
    }

    /// Sets the contact of a corner.
    #[inline]
    pub fn set(&mut self, corner: Corner, contact: Contact<T>) {
        self.0[corner.index()] = contact;
    }

    /// Returns true if a corner is on its support.
    #[inline]
    pub fn touches(&self, corner: Corner) -> bool {
        match self.of(corner) {
            Contact::Bearing | Contact::Held(..) => true,
            Contact::Lifted(_) => false,
        }
    }

    /// Returns the regime.
    #[inline]
    pub fn regime(&self) -> Regime {
        Regime::of_touching(Corner::each(|corner| self.touches(corner)))
    }

    /// Returns the held corner, if any.
    #[inline]
    pub fn held(&self) -> Option<Corner> {
        Corner::BOTH.into_iter().find(|&corner| matches!(self.of(corner), Contact::Held(..)))
    }

    /// Returns the slide of the standing corner while the other one is held.
    #[inline]
    pub fn standing_slide(&self) -> StandingSlide {
        match self.0 {
            [Contact::Held(_, slide), _] | [_, Contact::Held(_, slide)] => slide,
            [Contact::Bearing | Contact::Lifted(_), Contact::Bearing | Contact::Lifted(_)] => StandingSlide::Follows,
        }
    }

    /// Lets a held corner bear.
    pub fn let_bear(&mut self) {
        if let Some(corner) = self.held() {
            self.set(corner, Contact::Bearing);
        }
    }

    /// Returns the height of a support's top above rest (m), and its rate (m/s). Both are zero if the corner bears.
    #[inline]
    pub fn top(&self, corner: Corner, body: &Body<T>, time: T) -> Dual<T> {
        match self.of(corner) {
            Contact::Bearing => Dual::default(),
            Contact::Held(creep, _) | Contact::Lifted(creep) => creep.top(corner, body, time),
        }
    }

    /// Returns true if all numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.0.iter().all(|contact| match contact {
            Contact::Bearing => true,
            Contact::Held(Creep { depth, since }, _) | Contact::Lifted(Creep { depth, since }) => {
                depth.value().is_finite() && since.value().is_finite()
            }
        })
    }
}
