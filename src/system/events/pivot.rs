//! Housner's change of the pivot: on the rigid base the gap under a lifted corner closes at θ = 0.

use crate::block::{Contacts, Corner};
use crate::system::dynamics::State;
use crate::system::evaluation::Evaluation;
use crate::system::events::change::Change;

impl Change<'_> {
    /// The pivot changes to `corner`: `θ̇ → e θ̇` at θ = 0, or rest.
    pub(super) fn change_pivot(&mut self, corner: Corner, now: &Evaluation) {
        let block = &self.system.block;
        let theta_dot = block.restitution_of(corner).max(0.0) * now.state[1];
        self.counts.impacts += 1;
        self.pose.contacts = Contacts::FULL;
        if theta_dot.abs() < self.system.slowest * block.p {
            self.pose.state = State::zeros();
        } else {
            self.raise(corner.other());
            self.pose.state = State::from([0.0, theta_dot, 0.0, 0.0]);
            self.counts.liftoffs += 1;
        }
        self.settle_on_rigid_base();
    }
}
