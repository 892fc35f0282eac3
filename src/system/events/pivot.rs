//! Housner's change of the pivot: on the rigid base the gap under a lifted corner closes at θ = 0.

use crate::block::{Contacts, Corner};
use crate::system::evaluation::Evaluation;
use crate::system::events::change::Change;
use crate::system::events::landing::without_gain;
use crate::system::events::placement::Placement;
use crate::system::impact::Velocities;
use crate::system::instant::State;

impl Change<'_> {
    /// The pivot changes to `corner`: `θ̇ → e θ̇` at θ = 0, or rest.
    pub(super) fn change_pivot(&mut self, corner: Corner, now: &Evaluation) {
        let block = &self.system.block;
        let theta_dot = block.restitution_of(corner).max(0.0) * now.state[1];
        self.counts.impacts += 1;
        self.pose.contacts = Contacts::FULL;
        if block.friction > 0.0 {
            self.change_pivot_with_friction(corner, theta_dot, now);
        } else if theta_dot.abs() < self.system.slowest * block.p {
            self.pose.state = State::zeros();
        } else {
            self.raise(corner.other());
            self.pose.state = State::from([0.0, theta_dot, 0.0, 0.0]);
            self.counts.liftoffs += 1;
        }
        self.settle_on_rigid_base();
    }

    /// The same with friction: e determines the vertical rates after the impact and with them the vertical impulse, and a horizontal
    /// impulse within its limit slows the new pivot. A block that slides may gain energy by this; e is then reduced.
    fn change_pivot_with_friction(&mut self, corner: Corner, theta_dot: f64, now: &Evaluation) {
        let block = &self.system.block;
        let mut placement = Placement { theta: 0.0, v: 0.0, ..Placement::of(&now.instant) };
        let before = placement.velocities;
        let ends = theta_dot.abs() < self.system.slowest * block.p;
        let strike = |theta_dot: f64| {
            let v_dot = -block.offset(corner) * theta_dot;
            let most = block.friction * (v_dot - before.v_dot).max(0.0);
            let u_dot = before.u_dot + (block.h * theta_dot - before.u_dot).clamp(-most, most);
            Velocities { u_dot, v_dot, theta_dot }
        };
        let (_, velocities) = without_gain(block, before, if ends { 0.0 } else { theta_dot }, strike);
        placement.strike(block, velocities);
        for corner in Corner::BOTH {
            placement.corners[corner.index()].0 = 0.0;
        }
        placement.corners[corner.index()].1 = 0.0;
        if !ends {
            self.raise(corner.other());
            self.counts.liftoffs += 1;
        }
        self.stand(&mut placement);
    }
}
