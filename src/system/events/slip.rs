//! Slip: the last corner bears nothing, but its gap would close again if it were let go. A support that bears nothing cannot hold
//! it horizontally, so it slides without friction until it is pressed on again ([`super::grip`]).
//!
//! Nothing is watched for it: it is one way in which [`super::lift_off`] and [`super::settle`] take a reaction that falls.

use crate::numerics::scalar::Elementary;
use crate::system::events::change::Change;
use crate::system::instant::{Footing, Instant};

impl<T: Elementary> Change<'_, T> {
    /// Releases the block horizontally.
    pub(super) fn release(&mut self, x: &Instant<T>) {
        self.pose.footing = Footing::Free { u: x.u, u_dot: x.u_dot };
    }
}
