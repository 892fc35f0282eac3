//! Slip: the last corner bears nothing, but its gap would close again if it lifted.
//!
//! A support without load cannot hold it horizontally, so it slides without friction until it is pressed on again ([`super::grip`]).
//! [`super::lift_off`] and [`super::settle`] decide it when a reaction falls through zero.

use crate::numerics::scalar::Elementary;
use crate::system::events::change::PoseUpdate;
use crate::system::instant::{Footing, Instant};

impl<T: Elementary> PoseUpdate<'_, T> {
    /// Releases the block horizontally.
    pub(super) fn free_horizontally(&mut self, x: &Instant<T>) {
        self.pose.footing = Footing::Free { u: x.u, u_dot: x.u_dot };
    }
}
