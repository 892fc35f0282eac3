//! Free of the supports' grip: slip, landing from flight, grip.
//!
//! In flight nothing holds the block horizontally, nor does a support that bears nothing. A support that bears the block
//! grips it as soon as it would still be pressed on right after; until then the block slides on it without friction. So no
//! support ever pulls, and no landing or grip makes energy.

use crate::dynamics::{Footing, Instant};
use crate::events::Surface;
use crate::excitation::Excitation;
use crate::impact;
use crate::regime::{Corner, Regime};
use crate::simulation::motion::Point;
use crate::simulation::placement::Placement;
use crate::simulation::{OnSeparation, Simulation};

impl Simulation {
    pub(super) fn flies(&self) -> bool {
        self.settings.on_separation == OnSeparation::Fly
    }

    /// Nothing holds the block horizontally from here on.
    pub(super) fn release(&mut self, x: &Instant<f64>) {
        self.footing = Footing::Free { u: x.u, u_dot: x.u_dot };
    }

    /// What touches is held from here on where it is, with velocities that agree with that.
    pub(super) fn hold(&mut self, now: &Placement, excitation: &Excitation) {
        (self.regime, self.state, self.footing) = (now.regime(), now.state(), Footing::AT_START);
        let offset = now.u - self.point(excitation).instant.u;
        self.footing = Footing::Grips { offset };
    }

    /// What slides is held from here on: a horizontal impulse stops it.
    pub(super) fn grip(&mut self, now: &mut Placement, excitation: &Excitation) {
        let velocities = impact::grip(&self.block, now.regime(), now.theta, now.velocities);
        now.strike(&self.block, velocities);
        self.hold(now, excitation);
    }

    /// The gap under `corner` closed in flight, or while the other corner slides.
    pub(super) fn land_freely(&mut self, corner: Corner, at: &Point, excitation: &Excitation) {
        let other = corner.other();
        let now = Placement::of(&at.instant, self.regime);
        let gap = Surface::Gap(other).sample(&self.moment(at, excitation));
        let level = gap.value <= Surface::Gap(other).rounding(&self.block) && gap.rate < 0.0;
        if self.regime == Regime::Separated && level {
            let mut both = now;
            Corner::BOTH.into_iter().for_each(|corner| self.put_down(corner, &mut both));
            let rates = Corner::BOTH.map(|corner| self.rate_after_landing(corner, both.corners[corner.index()].1));
            let (impulses, velocities) = impact::landing_on_both(&self.block, now.theta, now.velocities, rates);
            if impulses.iter().all(|&impulse| impulse >= 0.0) {
                self.counts.impacts += 2;
                both.velocities = velocities;
                both.corners = [(both.corners[0].0, rates[0]), (both.corners[1].0, rates[1])];
                self.hold(&both, excitation);
                return self.settle(both, excitation);
            }
            if impulses[corner.index()] < 0.0 {
                return self.land_alone(other, now, excitation);
            }
        }
        self.land_alone(corner, now, excitation);
    }

    fn land_alone(&mut self, corner: Corner, mut now: Placement, excitation: &Excitation) {
        let block = self.block;
        let (i, before, flying) = (corner.index(), now.velocities, self.regime == Regime::Separated);
        self.put_down(corner, &mut now);
        let rate = now.corners[i].1;
        self.counts.impacts += u32::from(rate < 0.0);
        let mut after = self.rate_after_landing(corner, rate);
        if flying {
            let mut velocities = impact::landing_with_grip(&block, corner, now.theta, before, after);
            if rate >= 0.0 || velocities.v_dot < before.v_dot {
                // The support came up to the corner, or it would have to pull: the horizontal stop alone throws the corner
                // up faster than that.
                let thrown = impact::grip(&block, Regime::on(corner), now.theta, before);
                let rate = impact::corner_rate(&block, corner, now.theta, thrown.v_dot, thrown.theta_dot);
                after = self.or_rest(corner, rate);
                velocities = impact::landing_with_grip(&block, corner, now.theta, before, after);
            }
            now.strike(&block, velocities);
        } else {
            now.strike(&block, impact::landing_without_grip(&block, corner, now.theta, before, after));
        }
        now.corners[i].1 = after;
        if flying {
            self.hold(&now, excitation);
        }
        self.settle(now, excitation);
    }

    /// Vertical rate of a corner after its landing from flight (m/s).
    fn rate_after_landing(&self, corner: Corner, rate: f64) -> f64 {
        self.or_rest(corner, if rate < 0.0 { self.block.epsilon * rate } else { rate })
    }

    /// A corner's rate after a landing (m/s), or that of its support if the two are near. So a sequence of ever lower
    /// flights ends: none is begun that would not rise ten times as high as what rounding leaves of a gap.
    pub(super) fn or_rest(&self, corner: Corner, rate: f64) -> f64 {
        let support = self.creep[corner.index()].top(&self.block, self.time).rate;
        let slowest = (20.0 * self.block.gravity * Surface::Gap(corner).rounding(&self.block)).sqrt();
        if (rate - support).abs() < slowest { support } else { rate }
    }
}
