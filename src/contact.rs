//! What each corner does (it bears on its support, is held there, or has lifted) → the regime.

use serde::{Deserialize, Serialize};

use crate::block::{Block, Foundation};
use crate::regime::{Corner, Regime};
use crate::roots::Sample;

/// A support that its corner has left: it creeps back to its free height δ_s.
///
/// `C ẏ = K (δ_s − y)`: `δ_s − y = depth · exp(−(t − since) K/C)`. A support without damping is back at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Creep {
    /// δ_s − y₀ (m) at lift-off.
    pub depth: f64,
    /// Time of lift-off (s).
    pub since: f64,
}

impl Creep {
    /// Height of the support's top above its place under the block at rest (m), and its rate (m/s).
    pub fn top(&self, block: &Block, time: f64) -> Sample {
        match block.foundation {
            Foundation::Rigid => Sample::default(),
            Foundation::Viscoelastic => {
                let rate = block.creep_rate();
                let sunk = if self.depth == 0.0 { 0.0 } else { self.depth * decay(rate * (time - self.since)) };
                // Without damping `rate` is infinite and `sunk` zero: no rate is left then.
                let rising = if sunk == 0.0 { 0.0 } else { rate * sunk };
                Sample { value: block.static_deflection() - sunk, rate: rising }
            }
        }
    }
}

/// `exp(−x)` for x ≥ 0; 1 at the start of an infinitely fast decay would be wrong, so infinity gives 0 and so does
/// `0 · ∞`.
fn decay(x: f64) -> f64 {
    if x >= 0.0 { libm::exp(-x) } else { 0.0 }
}

/// What a corner does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Contact {
    /// It stands on its support, or on the rigid base.
    Bearing,
    /// It bears nothing, and is held in contact since it would come down at once if it were let go: see docs/model.md.
    Held,
    /// It has left its support, which creeps back to its free height.
    Lifted(Creep),
}

/// What both corners do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contacts([Contact; 2]);

impl Contacts {
    /// Both corners bear.
    pub const FULL: Contacts = Contacts([Contact::Bearing; 2]);

    /// Bearing on the corners that touch; the supports of the others are at their free height.
    pub fn touching(touching: [bool; 2], time: f64) -> Contacts {
        let free = Contact::Lifted(Creep { depth: 0.0, since: time });
        Contacts(touching.map(|touches| if touches { Contact::Bearing } else { free }))
    }

    /// What a corner does.
    #[inline]
    pub fn of(&self, corner: Corner) -> Contact {
        self.0[corner.index()]
    }

    /// Lets a corner do something else.
    #[inline]
    pub fn set(&mut self, corner: Corner, contact: Contact) {
        self.0[corner.index()] = contact;
    }

    /// Whether a corner is on its support.
    #[inline]
    pub fn touches(&self, corner: Corner) -> bool {
        match self.of(corner) {
            Contact::Bearing | Contact::Held => true,
            Contact::Lifted(_) => false,
        }
    }

    /// The regime: which corners touch.
    #[inline]
    pub fn regime(&self) -> Regime {
        Regime::of_touching(Corner::BOTH.map(|corner| self.touches(corner)))
    }

    /// The corner that is held, if one is.
    #[inline]
    pub fn held(&self) -> Option<Corner> {
        Corner::BOTH.into_iter().find(|&corner| self.of(corner) == Contact::Held)
    }

    /// A corner that was held bears from here on.
    pub fn let_bear(&mut self) {
        for contact in &mut self.0 {
            if *contact == Contact::Held {
                *contact = Contact::Bearing;
            }
        }
    }

    /// Height of the support's top that a corner has left, above its place under the block at rest (m), and its rate (m/s);
    /// zeros where the corner touches.
    #[inline]
    pub fn top(&self, corner: Corner, block: &Block, time: f64) -> Sample {
        match self.of(corner) {
            Contact::Bearing | Contact::Held => Sample::default(),
            Contact::Lifted(creep) => creep.top(block, time),
        }
    }

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.0.iter().all(|contact| match contact {
            Contact::Bearing | Contact::Held => true,
            Contact::Lifted(Creep { depth, since }) => depth.is_finite() && since.is_finite(),
        })
    }
}
