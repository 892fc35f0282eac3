//! Landing on a support while the other corner stands and grips, or with friction.

use crate::block::{Body, Corner, Foot, Foundation};
use crate::numerics::Scalar;
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary};
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{PoseUpdate, ROUNDING, TransitionCounts};
use crate::system::events::placement::Placement;
use crate::system::impact::{self, Velocities};
use crate::system::instant::Instant;

/// Returns the gap `v_I − y_I` between a lifted corner and its support (m). It follows from the heights and rates of the `supports`.
#[inline(always)]
pub fn gap<R: Scalar>(x: &Instant<R>, supports: [Dual<R>; 2], corner: Corner) -> Dual<R> {
    let i = corner.index();
    Dual::new(x.corner[i], x.corner_dot[i]) - supports[i]
}

/// Returns the size of the terms of a gap (m).
#[inline]
fn size<T: Elementary>(body: &Body<T>) -> f64 {
    match body.foundation {
        Foundation::Viscoelastic => body.static_deflection().value().max(body.b.value()),
        Foundation::Rigid => body.r0.value(),
    }
}

/// Returns the round-off of a gap at zero (m).
#[inline]
pub(super) fn rounding<T: Elementary>(body: &Body<T>) -> f64 {
    ROUNDING * size(body)
}

impl<T: Elementary> PoseUpdate<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Applies the impact map if the corner comes down, and holds the base's middle.
    pub(super) fn land(&mut self, corner: Corner, now: &Evaluation<T>) -> TransitionCounts {
        let (block, mut counts) = (&self.system.block, TransitionCounts::NONE);
        let (regime, mut placement) = (self.regime(), Placement::of(&now.instant));
        let before = placement.velocities;
        self.set_down(corner, &mut placement);
        let rate = placement.corners[corner.index()].1;
        if rate.value() < 0.0 {
            let (v_dot, theta_dot) = impact::landing(block, corner, placement.theta, before.v_dot, before.theta_dot);
            placement.set_velocities(block, Velocities { v_dot, theta_dot, ..before });
            // The map gives ε times the rate before only to round-off.
            placement.corners[corner.index()].1 = block.epsilon * rate;
            let loss = impact::landing_loss(block, corner, placement.theta, rate).value();
            counts += TransitionCounts::impacts(1) + TransitionCounts::constraint(loss);
        }
        placement.velocities.u_dot =
            impact::height_over(block, Foot::Middle, placement.theta) * placement.velocities.theta_dot;
        let gained = placement.velocities.kinetic(block) - before.kinetic(block);
        counts + TransitionCounts::constraint(gained.value()) + self.resolve_regime(regime, placement)
    }

    /// Lands `corner` with friction, also from flight. A horizontal impulse within its limit slows the foot of the regime after it.
    pub(super) fn land_with_friction(&mut self, corner: Corner, now: &Evaluation<T>) -> TransitionCounts {
        if self.is_level(corner.other(), now)
            && let Ok(counts) = self.land_on_both(now)
        {
            return counts;
        }
        let (block, mut counts) = (&self.system.block, TransitionCounts::NONE);
        let (regime, mut placement) = (self.regime(), Placement::of(&now.instant));
        let before = placement.velocities;
        let support = self.support(corner).eps;
        self.set_down(corner, &mut placement);
        let i = corner.index();
        let rate = placement.corners[i].1;
        if rate.value() < 0.0 {
            let foot = self.regime().foot().unwrap_or(Foot::Corner(corner));
            let after = self.rest_if_slow(block.epsilon * rate, support);
            let land = |rate: T| impact::landing_with_friction(block, corner, foot, placement.theta, before, rate);
            let (rate, velocities) = without_gain(block, before, after, land);
            placement.set_velocities(block, velocities);
            placement.corners[i].1 = rate;
            counts += TransitionCounts::impacts(1);
        }
        counts + self.resolve_regime(regime, placement)
    }

    /// Returns a corner's rate after a landing (m/s). It is that of its support if the corner would leave it hardly faster.
    ///
    /// A sequence of ever lower flights thus ends: each rises at least to ten times the round-off of a gap.
    pub(super) fn rest_if_slow(&self, rate: T, support_rate: T) -> T {
        let block = &self.system.block;
        let slowest = (20.0 * block.gravity.value() * rounding(block)).sqrt();
        let faster = rate.value() - support_rate.value();
        if faster > 0.0 && faster < slowest { support_rate } else { rate }
    }
}

/// Returns the rate after a landing (m/s or rad/s) and the velocities. The rate is reduced if the landing would create energy.
pub(super) fn without_gain<T: Elementary>(
    body: &Body<T>,
    before: Velocities<T>,
    rate: T,
    land: impl Fn(T) -> Velocities<T>,
) -> (T, Velocities<T>) {
    const HALVINGS: u32 = 60;
    let energy = before.kinetic(body);
    let all = land(rate);
    if all.kinetic(body).value() <= energy.value() || rate.value() == 0.0 {
        return (rate, all);
    }
    let surplus = |rate: T| land(rate).kinetic(body) - energy;
    let value = |rate: f64| land(T::from(rate)).kinetic(body).value();
    let (mut low, mut high) = (0.0, rate.value());
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if value(middle) <= energy.value() {
            low = middle;
        } else {
            high = middle;
        }
    }
    // A Newton step adds the derivatives. The central difference is exact, since the energy is quadratic in the rate.
    let slope = (value(1.001 * low) - value(0.999 * low)) / (0.002 * low);
    let left = surplus(T::from(low));
    let change = left - T::constant(left.value());
    let low = if slope.is_normal() { T::from(low) - change * (1.0 / slope) } else { T::from(low) };
    (low, land(low))
}
