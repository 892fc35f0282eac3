//! An instant → the block's place and velocities, in numbers that a change of regime leaves as they are.

use crate::block::Block;
use crate::contact::{Corner, Regime};
use crate::system::dynamics::{Instant, State};
use crate::system::impact::{self, Velocities};

/// Where the block is while its regime is decided. Heights and rates of the corners stand beside those of the centre of
/// mass, since their exact values (a rate of zero, say) decide.
#[derive(Clone, Copy)]
pub(super) struct Placement {
    /// Height (m) and vertical rate (m/s) of each corner.
    pub(super) corners: [(f64, f64); 2],
    /// θ (rad).
    pub(super) theta: f64,
    /// Horizontal place of the centre of mass (m).
    pub(super) u: f64,
    /// Its height above its place at rest (m).
    pub(super) v: f64,
    /// Velocities of the block.
    pub(super) velocities: Velocities,
}

impl Placement {
    pub(super) fn of(x: &Instant<f64>) -> Placement {
        Placement {
            corners: [(x.corner[0], x.corner_dot[0]), (x.corner[1], x.corner_dot[1])],
            theta: x.theta,
            u: x.u,
            v: x.v,
            velocities: Velocities { u_dot: x.u_dot, v_dot: x.v_dot, theta_dot: x.theta_dot },
        }
    }

    /// The state by which the motion goes on in a regime.
    pub(super) fn state(&self, regime: Regime) -> State {
        let [left, right] = self.corners;
        let (w, w_dot) = match regime {
            Regime::FullContact => (0.5 * (left.0 + right.0), 0.5 * (left.1 + right.1)),
            Regime::TiltingLeft => left,
            Regime::TiltingRight => right,
            Regime::Separated => (self.v, self.velocities.v_dot),
        };
        State::new(self.theta, self.velocities.theta_dot, w, w_dot)
    }

    /// Gives the block other velocities, and its corners the rates that go with them.
    pub(super) fn strike(&mut self, block: &Block, velocities: Velocities) {
        let Velocities { v_dot, theta_dot, .. } = velocities;
        self.velocities = velocities;
        for corner in Corner::BOTH {
            self.corners[corner.index()].1 = impact::corner_rate(block, corner, self.theta, v_dot, theta_dot);
        }
    }
}
