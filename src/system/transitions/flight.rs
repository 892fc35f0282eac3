//! Free of the supports' grip: landing from flight, grip.
//!
//! In flight nothing holds the block horizontally, nor does a support that bears nothing. A support that bears the block
//! grips it as soon as it would still be pressed on right after; until then the block slides on it without friction. So no
//! support ever pulls, and no landing or grip makes energy.

use crate::contact::{Corner, Regime};
use crate::system::impact;
use crate::system::now::Now;
use crate::system::surfaces::Surface;
use crate::system::transitions::Change;
use crate::system::transitions::placement::Placement;

impl Change<'_> {
    /// What slides is held from here on: a horizontal impulse stops it.
    pub(super) fn grip(&mut self, placement: &mut Placement) {
        let block = &self.system.block;
        let velocities = impact::grip(block, self.regime(), placement.theta, placement.velocities);
        placement.strike(block, velocities);
        self.hold(placement);
    }

    /// The same, and the regime anew.
    pub(super) fn grip_and_settle(&mut self, mut placement: Placement) {
        let before = self.regime();
        self.grip(&mut placement);
        self.settle(before, placement);
    }

    /// The gap under `corner` closed in flight, or while the other corner slides.
    pub(super) fn land_freely(&mut self, corner: Corner, now: &Now) {
        let other = corner.other();
        let placement = Placement::of(&now.instant);
        if self.is_level(other, now) {
            let before = *self.contacts();
            let mut both = placement;
            let rates = Corner::BOTH.map(|corner| {
                let (rate, support) = (both.corners[corner.index()].1, self.support(corner).rate);
                self.put_down(corner, &mut both);
                self.rate_after_landing(corner, rate, support)
            });
            let (impulses, velocities) =
                impact::landing_on_both(&self.system.block, placement.theta, placement.velocities, rates);
            if impulses.iter().all(|&impulse| impulse >= 0.0) {
                self.tally.impacts += 2;
                both.velocities = velocities;
                both.corners = [(both.corners[0].0, rates[0]), (both.corners[1].0, rates[1])];
                self.hold(&both);
                return self.settle(Regime::FullContact, both);
            }
            self.pose.contacts = before;
            if impulses[corner.index()] < 0.0 {
                return self.land_alone(other, placement);
            }
        }
        self.land_alone(corner, placement);
    }

    /// Whether, in flight, the gap under this corner is closed to rounding and closing.
    pub(super) fn is_level(&self, corner: Corner, now: &Now) -> bool {
        let gap = Surface::Gap(corner).sample(now);
        let closed = gap.value <= Surface::Gap(corner).rounding(&self.system.block) && gap.rate < 0.0;
        now.regime == Regime::Separated && closed
    }

    fn land_alone(&mut self, corner: Corner, mut placement: Placement) {
        let block = &self.system.block;
        let (i, before, regime) = (corner.index(), placement.velocities, self.regime());
        let support = self.support(corner).rate;
        self.put_down(corner, &mut placement);
        let rate = placement.corners[i].1;
        self.tally.impacts += u32::from(rate < 0.0);
        let mut after = self.rate_after_landing(corner, rate, support);
        let flying = regime == Regime::Separated;
        if flying {
            let mut velocities = impact::landing_with_grip(block, corner, placement.theta, before, after);
            if rate >= 0.0 || velocities.v_dot < before.v_dot {
                // The support came up to the corner, or it would have to pull: the horizontal stop alone throws the corner
                // up faster than that.
                let thrown = impact::grip(block, Regime::on(corner), placement.theta, before);
                let rate = impact::corner_rate(block, corner, placement.theta, thrown.v_dot, thrown.theta_dot);
                after = self.or_rest(corner, rate, support);
                velocities = impact::landing_with_grip(block, corner, placement.theta, before, after);
            }
            placement.strike(block, velocities);
        } else {
            placement.strike(block, impact::landing_without_grip(block, corner, placement.theta, before, after));
        }
        placement.corners[i].1 = after;
        let mut before = regime;
        if flying {
            self.hold(&placement);
            before = self.regime();
        }
        self.settle(before, placement);
    }

    /// Vertical rate of a corner after its landing from flight (m/s), on a support that moves at `support` (m/s).
    fn rate_after_landing(&self, corner: Corner, rate: f64, support: f64) -> f64 {
        self.or_rest(corner, if rate < 0.0 { self.system.block.epsilon * rate } else { rate }, support)
    }
}
