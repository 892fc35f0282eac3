//! Grip without a limit of friction: a sliding foot grips once it would still be pressed on right after.
//!
//! Nothing holds the block horizontally in flight or on a support without load. A support that bears the block grips it as soon as it
//! would still be pressed on right after; until then the block slides on it without friction. So no support ever pulls, and no landing or
//! grip creates energy.

use crate::block::{Body, Corner, Foot, Foundation, Regime};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary, least};
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{PoseUpdate, ROUNDING, TransitionCounts};
use crate::system::events::placement::Placement;
use crate::system::impact::{self, Velocities};
use crate::system::instant::Instant;

/// Returns the distance of a sliding foot from being pressed on if it gripped (m/s²).
pub(super) fn slide<T: Elementary>(at: &Evaluation<T>) -> Dual<T>
where
    Dual<T>: CombinesWith<T>,
{
    distance(at.body, at.regime, &at.rates())
}

/// Returns the value of [`slide`] at an instant.
pub(super) fn distance<P: Elementary, T: CombinesWith<P>>(body: &Body<P>, regime: Regime, x: &Instant<T>) -> T {
    match (body.foundation, regime.pivot()) {
        // The foot may be pressed on for a moment only, when it turns back.
        (Foundation::Viscoelastic, _) => -pressure_if_gripped(body, regime, x),
        (Foundation::Rigid, Some(corner)) => impact::thrown_by_grip(body, corner, x) * body.p,
        // A rigid base throws neither of two corners up: they grip.
        (Foundation::Rigid, None) => -T::from(body.gravity),
    }
}

/// Returns the size of the terms of [`slide`] (m/s²). They include dashpot forces, which amplify the round-off of rates.
#[inline]
pub(super) fn size<T: Elementary>(body: &Body<T>) -> f64 {
    body.gravity.value().max((body.xi_v * body.omega_v * body.p * body.r0).value())
}

/// Returns the round-off of [`slide`] at zero (m/s²).
#[inline]
pub(super) fn rounding<T: Elementary>(body: &Body<T>) -> f64 {
    ROUNDING * size(body)
}

/// Returns the least force on a touching corner, per mass (m/s²), after a grip now. Positive if it presses the corner on its support.
///
/// It is the reaction right after the horizontal impulse, which turns the block, less a reserve for a corner that this throws up. A
/// support of stiffness K catches a mass M thrown up with v̇ if its force is above `√(K M) v̇`; with less, the corner would leave, land and
/// grip again and again.
pub fn pressure_if_gripped<P: Elementary, T: CombinesWith<P>>(body: &Body<P>, regime: Regime, x: &Instant<T>) -> T {
    let Body { i0, omega_v, xi_v, .. } = *body;
    let (sin, cos) = x.theta.sin_cos();
    let height = body.lever(regime.foot().unwrap_or(Foot::Middle), sin, cos).q;
    let theta_dot = (x.theta_dot * i0 + height * x.u_dot) / (height * height + i0);
    let pressed = |corner: Corner| {
        let i = corner.index();
        let change = body.lever(Foot::Corner(corner), sin, cos).x * (theta_dot - x.theta_dot);
        let rate = x.corner_dot[i] + change;
        let zero = T::Real::from(0.0);
        let thrown = T::select_less(zero, rate.value(), rate, T::from(0.0));
        x.reaction[i] - (change * xi_v + thrown * std::f64::consts::FRAC_1_SQRT_2) * omega_v
    };
    let touching = Corner::BOTH.into_iter().filter(|&corner| regime.touches(corner));
    touching.map(pressed).fold(T::from(f64::INFINITY), least)
}

impl<T: Elementary> PoseUpdate<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Lets the sliding foot grip.
    pub(super) fn grip_from(&mut self, mut placement: Placement<T>) -> TransitionCounts {
        let before = self.regime();
        match self.system.block.foundation {
            Foundation::Viscoelastic => self.grip(&mut placement) + self.resolve_regime(before, placement),
            Foundation::Rigid => self.grip_rigid_base(placement),
        }
    }

    /// Stops the foot on supports by a horizontal impulse.
    pub(super) fn grip(&mut self, placement: &mut Placement<T>) -> TransitionCounts {
        let block = &self.system.block;
        let velocities = impact::grip(block, self.regime(), placement.theta, placement.velocities);
        placement.set_velocities(block, velocities);
        self.grip_at(placement)
    }

    fn grip_rigid_base(&mut self, placement: Placement<T>) -> TransitionCounts {
        let zero = T::from(0.0);
        let (velocities, rates) = match self.regime().pivot() {
            Some(corner) => {
                let held =
                    impact::landing_with_grip(&self.system.block, corner, placement.theta, placement.velocities, zero);
                (held, Corner::BOTH.map(|landing| (landing == corner).then_some(zero)))
            }
            None => (Velocities { u_dot: zero, v_dot: zero, theta_dot: zero }, [Some(zero); 2]),
        };
        self.touch_down(placement, velocities, rates)
    }
}
