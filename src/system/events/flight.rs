//! Landing from flight, or while the other corner slides.
//!
//! A corner that lands from flight grips, or slides if friction is limited; otherwise it lands without a horizontal impulse.

use crate::block::{Contact, Corner, Foot, Regime};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary, greatest};
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{PoseUpdate, TransitionCounts};
use crate::system::events::landing::{self, without_gain};
use crate::system::events::placement::Placement;
use crate::system::impact::{self, Velocities};

impl<T: Elementary> PoseUpdate<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Lands `corner` on its support from flight, or while the other corner slides.
    pub(super) fn land_freely(&mut self, corner: Corner, now: &Evaluation<T>) -> TransitionCounts {
        let (other, placement) = (corner.other(), Placement::of(&now.instant));
        if self.is_level(other, now) {
            match self.land_on_both(now) {
                Ok(counts) => return counts,
                Err(impulses) if impulses[corner.index()].value() < 0.0 => return self.land_alone(other, placement),
                Err(_) => {}
            }
        }
        self.land_alone(corner, placement)
    }

    /// Lands both corners at once from flight, or returns impulses with a pull.
    pub(super) fn land_on_both(&mut self, now: &Evaluation<T>) -> Result<TransitionCounts, [T; 2]> {
        let (mut landed, mut both) = (*self, Placement::of(&now.instant));
        let rates = Corner::BOTH.map(|corner| {
            let (rate, support) = (both.corners[corner.index()].1, self.support(corner).eps);
            landed.set_down(corner, &mut both);
            self.rate_after_landing(rate, support)
        });
        let (impulses, velocities) = impact::landing_on_both(&self.system.block, both.theta, both.velocities, rates);
        if impulses.iter().any(|impulse| impulse.value() < 0.0) {
            return Err(impulses);
        }
        both.velocities = velocities;
        both.corners = [(both.corners[0].0, rates[0]), (both.corners[1].0, rates[1])];
        *self = landed;
        Ok(TransitionCounts::impacts(2) + self.stand(&mut both) + self.resolve_regime(Regime::FullContact, both))
    }

    /// Whether, in flight, the gap under this corner is closed to round-off and closing.
    pub(super) fn is_level(&self, corner: Corner, now: &Evaluation<T>) -> bool {
        let gap = landing::gap(&now.instant, now.support_heights, corner);
        let closed = gap.re.value() <= landing::rounding(&self.system.block) && gap.eps.value() < 0.0;
        now.regime == Regime::Separated && closed
    }

    fn land_alone(&mut self, corner: Corner, mut placement: Placement<T>) -> TransitionCounts {
        let block = &self.system.block;
        let (i, before, regime) = (corner.index(), placement.velocities, self.regime());
        let support = self.support(corner).eps;
        self.set_down(corner, &mut placement);
        let rate = placement.corners[i].1;
        let mut counts = TransitionCounts::impacts(u32::from(rate.value() < 0.0));
        let mut after = self.rate_after_landing(rate, support);
        let flying = regime == Regime::Separated;
        if flying {
            let mut velocities = impact::landing_with_grip(block, corner, placement.theta, before, after);
            if rate.value() >= 0.0 || velocities.v_dot.value() < before.v_dot.value() {
                // The support rose to the corner, or its impulse would have to pull, since the horizontal stop alone throws the corner up
                // faster.
                let thrown = impact::grip(block, Regime::on(corner), placement.theta, before);
                let rate = impact::corner_rate(block, corner, placement.theta, thrown.v_dot, thrown.theta_dot);
                after = self.rest_if_slow(rate, support);
                velocities = impact::landing_with_grip(block, corner, placement.theta, before, after);
            }
            placement.set_velocities(block, velocities);
        } else {
            placement
                .set_velocities(block, impact::landing_without_grip(block, corner, placement.theta, before, after));
        }
        placement.corners[i].1 = after;
        let mut before = regime;
        if flying {
            counts += self.grip_at(&placement);
            before = self.regime();
        }
        counts + self.resolve_regime(before, placement)
    }

    /// Returns the vertical rate of a corner after its landing from flight (m/s). Its support moves at `support` (m/s).
    fn rate_after_landing(&self, rate: T, support: T) -> T {
        self.rest_if_slow(if rate.value() < 0.0 { self.system.block.epsilon * rate } else { rate }, support)
    }

    /// Lands `corner` on the rigid base from flight, or while the other one slides.
    pub(super) fn land_on_rigid_base(&mut self, corner: Corner, now: &Evaluation<T>) -> TransitionCounts {
        let other = corner.other();
        let placement = Placement::of(&now.instant);
        if !self.is_level(other, now) {
            return self.land_on_corner(corner, placement);
        }
        let block = &self.system.block;
        let rates = Corner::BOTH.map(|corner| self.rebound(placement.corners[corner.index()].1));
        let (impulses, velocities) = impact::landing_on_both(block, placement.theta, placement.velocities, rates);
        if impulses[corner.index()].value() < 0.0 {
            self.land_on_corner(other, placement)
        } else if impulses[other.index()].value() < 0.0
            || velocities.kinetic(block).value() > placement.velocities.kinetic(block).value()
        {
            self.land_on_corner(corner, placement)
        } else {
            TransitionCounts::impacts(2) + self.touch_down(placement, velocities, rates.map(Some))
        }
    }

    /// Lands `corner` alone: it stops horizontally, or slides with friction, and rebounds with ε times its vertical rate.
    ///
    /// The rebound is at most what the energy allows, and at least the rate with which the horizontal stop alone throws the corner up.
    fn land_on_corner(&mut self, corner: Corner, placement: Placement<T>) -> TransitionCounts {
        let block = &self.system.block;
        let before = placement.velocities;
        let zero = T::from(0.0);
        let land = |rate: T| {
            if block.friction.value() > 0.0 {
                let foot = Foot::Corner(corner);
                impact::landing_with_friction(block, corner, foot, placement.theta, before, rate)
            } else {
                impact::landing_with_grip(block, corner, placement.theta, before, rate)
            }
        };
        let mut rate = self.rebound(placement.corners[corner.index()].1);
        // The energy after the landing is quadratic in the rate.
        let [energy, held, rebound] = [before, land(zero), land(rate)].map(|velocities| velocities.kinetic(block));
        if block.friction.value() > 0.0 {
            rate = self.rest_if_slow(without_gain(block, before, rate, land).0, zero);
        } else if rebound.value() > energy.value() {
            // A rebound whose energy is round-off becomes zero.
            let gains = rebound.value() > held.value() && energy.value() > held.value();
            rate = if gains { rate * ((energy - held) / (rebound - held)).sqrt() } else { zero };
            rate = self.rest_if_slow(rate, zero);
        }
        if block.friction.value() == 0.0 && land(rate).v_dot.value() < before.v_dot.value() {
            let thrown = impact::grip(block, Regime::on(corner), placement.theta, before);
            let thrown = impact::corner_rate(block, corner, placement.theta, thrown.v_dot, thrown.theta_dot);
            rate = self.rest_if_slow(thrown, zero);
        }
        let mut counts = TransitionCounts::impacts(1);
        if self.pose.contacts.touches(corner.other()) {
            // The other corner, which slid, lifts.
            counts += TransitionCounts::LIFTOFF;
        }
        let mut rates = [None; 2];
        rates[corner.index()] = Some(rate);
        counts + self.touch_down(placement, land(rate), rates)
    }

    /// Returns the vertical rate of a corner after landing on the rigid base (m/s).
    fn rebound(&self, rate: T) -> T {
        let zero = T::from(0.0);
        self.rest_if_slow(greatest(-self.system.block.epsilon * rate, zero), zero)
    }

    /// Completes a landing on the rigid base. Corners with a rate have landed; those with a rate of zero stand.
    pub(super) fn touch_down(
        &mut self,
        mut placement: Placement<T>,
        velocities: Velocities<T>,
        rates: [Option<T>; 2],
    ) -> TransitionCounts {
        let mut counts = TransitionCounts::NONE;
        placement.set_velocities(&self.system.block, velocities);
        for (corner, rate) in Corner::BOTH.into_iter().zip(rates) {
            let stands = rate.is_some_and(|rate| rate.value() == 0.0);
            if stands {
                self.pose.contacts.set(corner, Contact::Bearing);
            } else {
                self.mark_lifted(corner);
            }
            if let Some(rate) = rate {
                placement.corners[corner.index()] = (T::from(0.0), rate);
                counts += if stands { TransitionCounts::NONE } else { TransitionCounts::LIFTOFF };
            }
        }
        match self.regime() {
            Regime::Separated => self.continue_from(&placement),
            Regime::FullContact => {
                placement.theta = T::from(0.0);
                counts += self.stand(&mut placement);
            }
            Regime::TiltingLeft | Regime::TiltingRight => counts += self.stand(&mut placement),
        }
        counts + self.resolve_regime_on_rigid_base().1
    }
}
