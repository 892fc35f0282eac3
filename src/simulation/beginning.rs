//! Initial values → state and regime at the beginning.

use crate::block::Block;
use crate::excitation::Excitation;
use crate::impact::Velocities;
use crate::simulation::placement::Placement;
use crate::simulation::{Counts, Initial, Simulation};

impl Simulation {
    pub(super) fn place_on_supports(&mut self, initial: &Initial, excitation: &Excitation) {
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
        let touching = corners.map(|(height, _)| height <= free);
        // The supports of corners in the air are at their free height; a corner that is drawn up faster than its
        // support can follow leaves it at once, which is no lift-off to be counted.
        let velocities = Velocities { u_dot: h * cos * initial.theta_dot, v_dot, theta_dot: initial.theta_dot };
        let now = Placement { touching, corners, theta: initial.theta, u: h * sin, v, velocities };
        self.regime = now.regime();
        self.settle(now, excitation);
        self.counts = Counts::default();
        self.end_if_separated();
    }
}
