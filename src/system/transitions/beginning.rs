//! Initial values → the pose at the beginning.

use serde::{Deserialize, Serialize};

use crate::block::{Block, Foundation};
use crate::contact::Contacts;
use crate::excitation::Excitation;
use crate::system::System;
use crate::system::dynamics::{Footing, State};
use crate::system::impact::Velocities;
use crate::system::now::Pose;
use crate::system::transitions::Change;
use crate::system::transitions::placement::Placement;

/// Where the block is at the beginning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Initial {
    /// Rotation θ (rad), positive to the right, |θ| < π/2.
    pub theta: f64,
    /// θ̇ (rad/s).
    pub theta_dot: f64,
    /// `(v, v̇)` of the centre of mass (m, m/s); `None` starts at the vertical equilibrium of `theta`: the supports that
    /// touch carry the weight, and the middle of the base (or the one touching corner) does not move vertically.
    pub vertical: Option<(f64, f64)>,
}

impl System {
    /// The pose at the beginning, at `time` (s), under the excitation of that time. A support that nothing touches stands at
    /// its free height.
    pub fn beginning(&self, initial: &Initial, time: f64, excitation: &Excitation) -> Pose {
        match self.block.foundation {
            Foundation::Viscoelastic => self.beginning_on_supports(initial, time, excitation),
            Foundation::Rigid => beginning_on_rigid_base(initial, time),
        }
    }

    fn beginning_on_supports(&self, initial: &Initial, time: f64, excitation: &Excitation) -> Pose {
        let Block { b, h, .. } = self.block;
        let (sin, cos) = libm::sincos(initial.theta);
        let free = self.block.static_deflection();
        let turn = [b * sin, -b * sin];
        let turn_dot = [b * cos * initial.theta_dot, -b * cos * initial.theta_dot];
        // Height and rate of the middle of the base.
        let (middle, middle_dot) = match initial.vertical {
            Some((v, v_dot)) => (v + h * sin * sin / (1.0 + cos), v_dot + h * sin * initial.theta_dot),
            None if turn[0].abs() <= free => (0.0, 0.0),
            // On the lower corner alone, which sinks by δ_s under the whole weight and does not move.
            None => (turn[0].abs() - free, turn_dot[0] * turn[0].signum()),
        };
        let (v, v_dot) = (middle - h * sin * sin / (1.0 + cos), middle_dot - h * sin * initial.theta_dot);
        let corners = [0, 1].map(|i| (middle + turn[i], middle_dot + turn_dot[i]));
        let contacts = Contacts::touching(corners.map(|(height, _)| height <= free), time);
        let velocities = Velocities { u_dot: h * cos * initial.theta_dot, v_dot, theta_dot: initial.theta_dot };
        let placement = Placement { corners, theta: initial.theta, u: h * sin, v, velocities };
        let pose = Pose { time, state: State::zeros(), contacts, footing: Footing::AT_START };
        // A corner that is drawn up faster than its support can follow leaves it at once.
        let mut change = Change::begin(self, &pose, excitation);
        change.settle(contacts.regime(), placement);
        change.pose
    }
}

fn beginning_on_rigid_base(initial: &Initial, time: f64) -> Pose {
    let lean = if initial.theta != 0.0 { initial.theta } else { initial.theta_dot };
    Pose {
        time,
        state: State::new(initial.theta, initial.theta_dot, 0.0, 0.0),
        // A block that leans to the left stands on L alone.
        contacts: Contacts::touching([lean <= 0.0, lean >= 0.0], time),
        footing: Footing::AT_START,
    }
}
