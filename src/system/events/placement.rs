//! An instant → position and velocities of the block, in coordinates that do not depend on the regime.

use crate::block::{Body, Corner, Foot, Regime};
use crate::numerics::scalar::Elementary;
use crate::system::impact::{self, Velocities};
use crate::system::instant::Instant;

/// Position and velocities of the block while its regime is decided.
///
/// Those of the corners are kept beside those of the centre of mass, because exact values, such as a rate of zero, decide.
#[derive(Clone, Copy)]
pub struct Placement<T = f64> {
    /// Height (m) and vertical rate (m/s) of each corner.
    pub corners: [(T, T); 2],
    /// θ (rad).
    pub theta: T,
    /// Horizontal displacement of the centre of mass (m).
    pub u: T,
    /// Its height above the position at rest (m).
    pub v: T,
    /// Velocities of the block.
    pub velocities: Velocities<T>,
}

impl<T: Elementary> Placement<T> {
    pub fn of(x: &Instant<T>) -> Placement<T> {
        Placement {
            corners: [(x.corner[0], x.corner_dot[0]), (x.corner[1], x.corner_dot[1])],
            theta: x.theta,
            u: x.u,
            v: x.v,
            velocities: Velocities { u_dot: x.u_dot, v_dot: x.v_dot, theta_dot: x.theta_dot },
        }
    }

    /// Returns the state `[θ, θ̇, w, ẇ]` in a regime.
    pub fn state(&self, regime: Regime) -> [T; 4] {
        let [left, right] = self.corners;
        let (w, w_dot) = match regime {
            Regime::FullContact => ((left.0 + right.0) * 0.5, (left.1 + right.1) * 0.5),
            Regime::TiltingLeft => left,
            Regime::TiltingRight => right,
            Regime::Separated => (self.v, self.velocities.v_dot),
        };
        [self.theta, self.velocities.theta_dot, w, w_dot]
    }

    /// Sets the velocities of the block and the matching rates of its corners.
    pub fn set_velocities(&mut self, body: &Body<T>, velocities: Velocities<T>) {
        let Velocities { v_dot, theta_dot, .. } = velocities;
        self.velocities = velocities;
        for corner in Corner::BOTH {
            self.corners[corner.index()].1 = impact::corner_rate(body, corner, self.theta, v_dot, theta_dot);
        }
    }

    /// Returns the placement with the horizontal constraint at the `pivot` instead of the middle. The other corner has left full contact.
    pub fn with_pivot_constraint(mut self, body: &Body<T>, pivot: Corner) -> Placement<T> {
        self.velocities.u_dot = impact::height_over(body, Foot::Corner(pivot), self.theta) * self.velocities.theta_dot;
        self
    }
}
