//! Geometry of the two corners: the centre of mass as seen from the point on which the block stands.

use serde::{Deserialize, Serialize};

use crate::block::Body;
use crate::numerics::scalar::{CombinesWith, Scalar};

/// Position and motion of the block, from which its restraints follow.
#[derive(Clone, Copy, Debug)]
pub struct Kinematics<T> {
    /// Sine and cosine of θ.
    pub sin_cos: [T; 2],
    /// θ̇ (rad/s).
    pub theta_dot: T,
    /// Displacement of the centre of mass from its position at rest, `[u, v]` (m).
    pub center: [T; 2],
    /// Its velocity relative to the ground (m/s).
    pub velocity: [T; 2],
}

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

    /// Applies `f` to both corners, left first.
    #[inline(always)]
    pub fn each<T>(mut f: impl FnMut(Corner) -> T) -> [T; 2] {
        [f(Corner::Left), f(Corner::Right)]
    }

    /// Returns `s` of the equations: +1 on L, −1 on R.
    #[inline]
    pub fn sign(self) -> f64 {
        match self {
            Corner::Left => 1.0,
            Corner::Right => -1.0,
        }
    }

    /// Returns the other corner.
    #[inline]
    pub fn other(self) -> Corner {
        match self {
            Corner::Left => Corner::Right,
            Corner::Right => Corner::Left,
        }
    }

    /// Returns the index in a pair of values `[left, right]`.
    #[inline]
    pub fn index(self) -> usize {
        match self {
            Corner::Left => 0,
            Corner::Right => 1,
        }
    }
}

/// The point of the base on the ground that cannot slide while the block grips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Foot {
    /// The middle of the base, in full contact.
    Middle,
    /// The one corner that stands.
    Corner(Corner),
}

/// Position of the centre of mass relative to a point of the base (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lever<T> {
    /// Horizontal distance X, positive to the right of the point.
    ///
    /// It is `R0 sin(α+θ)` from L, and `−R0 sin(α−θ)` from R.
    pub x: T,
    /// Height Q over the point: `R0 cos(α+θ)` from L, `R0 cos(α−θ)` from R.
    pub q: T,
}

impl<T> Lever<T> {
    /// Returns the lever at a rotation with this sine and cosine. The distances (m) are those of the upright block.
    #[inline(always)]
    pub fn of<P: Copy>(offset: P, h: P, sin: T, cos: T) -> Lever<T>
    where
        T: CombinesWith<P>,
    {
        Lever { x: sin * h + cos * offset, q: cos * h - sin * offset }
    }
}

impl<P: Scalar> Body<P> {
    /// Returns the horizontal position of the base's middle relative to a corner (m). It is b from L, and −b from R.
    #[inline(always)]
    pub fn half_base(&self, corner: Corner) -> P {
        self.b * corner.sign()
    }

    /// Returns the horizontal position of the upright block's centre relative to a corner (m). It is `b + e_x` from L, and `e_x − b` from
    /// R.
    #[inline(always)]
    pub fn offset(&self, corner: Corner) -> P {
        self.half_base(corner) + self.eccentricity
    }

    /// Returns the horizontal position of the upright block's centre relative to the foot (m). It is e_x from the middle of the base.
    #[inline(always)]
    pub fn offset_from(&self, foot: Foot) -> P {
        match foot {
            Foot::Middle => self.eccentricity,
            Foot::Corner(corner) => self.offset(corner),
        }
    }

    /// Returns the position of a corner relative to the foot (m), positive to the right. `None` for the foot itself.
    #[inline(always)]
    pub fn from_foot(&self, corner: Corner, foot: Foot) -> Option<P> {
        match foot {
            Foot::Middle => Some(-self.half_base(corner)),
            Foot::Corner(standing) if standing == corner => None,
            Foot::Corner(standing) => Some(self.b * (2.0 * standing.sign())),
        }
    }

    /// Returns the position of the centre of mass relative to the foot. The rotation has this sine and cosine.
    ///
    /// `Q = h cos θ − x_F sin θ` and `X = h sin θ + x_F cos θ`, with x_F the distance to the right of the foot at θ = 0.
    #[inline(always)]
    pub fn lever<T: CombinesWith<P>>(&self, foot: Foot, sin: T, cos: T) -> Lever<T> {
        Lever::of(self.offset_from(foot), self.h, sin, cos)
    }
}
