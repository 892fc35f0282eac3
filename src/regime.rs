//! Which corners touch: the regimes of motion and the two corners.

use serde::{Deserialize, Serialize};

/// A corner of the base.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Corner {
    /// L, the left corner.
    Left,
    /// R, the right corner.
    Right,
}

impl Corner {
    /// Both corners, left first.
    pub const BOTH: [Corner; 2] = [Corner::Left, Corner::Right];

    /// `s` of the equations: +1 on L, −1 on R.
    #[inline]
    pub fn sign(self) -> f64 {
        match self {
            Corner::Left => 1.0,
            Corner::Right => -1.0,
        }
    }

    /// The other corner.
    #[inline]
    pub fn other(self) -> Corner {
        match self {
            Corner::Left => Corner::Right,
            Corner::Right => Corner::Left,
        }
    }

    /// Place in a pair of values `[left, right]`.
    #[inline]
    pub fn index(self) -> usize {
        match self {
            Corner::Left => 0,
            Corner::Right => 1,
        }
    }
}

/// The regime of motion: which corners stand on their supports.
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
    /// The regime in which just these corners touch.
    pub fn of_touching([left, right]: [bool; 2]) -> Regime {
        match (left, right) {
            (true, true) => Regime::FullContact,
            (true, false) => Regime::TiltingLeft,
            (false, true) => Regime::TiltingRight,
            (false, false) => Regime::Separated,
        }
    }

    /// The regime in which only this corner touches.
    pub fn on(corner: Corner) -> Regime {
        match corner {
            Corner::Left => Regime::TiltingLeft,
            Corner::Right => Regime::TiltingRight,
        }
    }

    /// Whether this corner touches.
    #[inline]
    pub fn touches(self, corner: Corner) -> bool {
        match self {
            Regime::FullContact => true,
            Regime::TiltingLeft => corner == Corner::Left,
            Regime::TiltingRight => corner == Corner::Right,
            Regime::Separated => false,
        }
    }

    /// The corner on which the block stands, if it is just one.
    pub fn pivot(self) -> Option<Corner> {
        match self {
            Regime::TiltingLeft => Some(Corner::Left),
            Regime::TiltingRight => Some(Corner::Right),
            Regime::FullContact | Regime::Separated => None,
        }
    }

    /// The number of the paper and of the FMU: −1, 0, 1 or 2.
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
