//! Landing on a support while the other corner stands and grips: the gap under a lifted corner closes.

use crate::block::{Block, Corner, Foot, Foundation};
use crate::numerics::Real;
use crate::numerics::roots::Sample;
use crate::system::dynamics::Instant;
use crate::system::evaluation::Evaluation;
use crate::system::events::change::Change;
use crate::system::events::placement::Placement;
use crate::system::impact::{self, Velocities};

/// The gap `v_I − y_I` between a lifted corner and its support (m), whose heights and rates are `supports`.
#[inline(always)]
pub fn gap<R: Real>(x: &Instant<R>, supports: [Sample<R>; 2], corner: Corner) -> Sample<R> {
    let i = corner.index();
    Sample { value: x.corner[i] - supports[i].value, rate: x.corner_dot[i] - supports[i].rate }
}

/// Size of the terms of a gap (m).
#[inline]
pub(super) fn size(block: &Block) -> f64 {
    match block.foundation {
        Foundation::Viscoelastic => block.static_deflection().max(block.b),
        Foundation::Rigid => block.r0,
    }
}

impl Change<'_> {
    /// Applies the impact map, if the corner comes down, and holds the middle of the base.
    pub(super) fn land(&mut self, corner: Corner, now: &Evaluation) {
        let block = &self.system.block;
        let (regime, mut placement) = (self.regime(), Placement::of(&now.instant));
        let before = placement.velocities;
        self.put_down(corner, &mut placement);
        let rate = placement.corners[corner.index()].1;
        if rate < 0.0 {
            let (v_dot, theta_dot) = impact::landing(block, corner, placement.theta, before.v_dot, before.theta_dot);
            placement.strike(block, Velocities { v_dot, theta_dot, ..before });
            // Exactly ε times the rate before, which the map gives only to rounding.
            placement.corners[corner.index()].1 = block.epsilon * rate;
            self.counts.impacts += 1;
            self.counts.constraint += impact::landing_loss(block, corner, placement.theta, rate);
        }
        placement.velocities.u_dot =
            impact::height_over(block, Foot::Middle, placement.theta) * placement.velocities.theta_dot;
        self.counts.constraint += placement.velocities.kinetic(block) - before.kinetic(block);
        self.settle(regime, placement);
    }
}
