//! Lift-off: the reaction of a touching corner falls through zero.
//!
//! The corner lifts if its gap would open. Otherwise it is held, or slips if it is the last one.

use crate::block::{Body, Contact, Corner, Creep, Foundation, Regime};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary, Scalar};
use crate::system::dynamics::instant;
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{PoseUpdate, ROUNDING, Release, TransitionCounts};
use crate::system::events::friction;
use crate::system::events::placement::Placement;
use crate::system::forces::support;
use crate::system::instant::{Footing, Instant};

/// Returns the reaction N_I/M of a touching corner (m/s²).
#[inline(always)]
pub(super) fn reaction<T: Elementary>(foundation: Foundation, at: &Evaluation<T>, corner: Corner) -> Dual<T>
where
    Dual<T>: CombinesWith<T>,
{
    match foundation {
        Foundation::Viscoelastic => on_support(at.body, &at.instant, corner),
        // The reaction follows from the accelerations, so that its rate needs all equations.
        Foundation::Rigid => {
            let i = corner.index();
            Dual::new(at.instant.reaction[i], at.rates().reaction[i].eps)
        }
    }
}

/// Returns the round-off of a reaction at zero (m/s²).
#[inline]
pub(super) fn rounding<T: Elementary>(body: &Body<T>) -> f64 {
    ROUNDING * body.gravity.value()
}

/// Returns the reaction N_I/M of a support (m/s²).
#[inline(always)]
pub fn on_support<R: Scalar>(body: &Body<R>, x: &Instant<R>, corner: Corner) -> Dual<R>
where
    Dual<R>: CombinesWith<R>,
{
    let i = corner.index();
    Dual::new(x.reaction[i], support::reaction_rate(body, x.corner_dot[i], x.corner_ddot[i]))
}

/// Returns the opening acceleration (m/s²) of the gap of a touching corner that leaves now. Only this corner leaves its support.
///
/// It is `v̈_I − ÿ_I` with `ẏ_I = v̇_I = corner_dot`, so `ÿ_I = −(K/C) v̇_I`. Without damping the top of the support stands still, and the
/// gap opens with the rate v̇_I, which makes this acceleration infinite.
///
/// The horizontal constraint changes with the regime: in full contact it holds the middle of the base, on one corner that corner. `v̈_I`
/// therefore jumps a little at lift-off. If full contact lifts the corner and the other regime presses it back, neither regime is
/// consistent, and the motion follows the boundary with `N_I ≈ 0`: the corner is held in full contact until one of the two regimes lets it
/// go. A last corner slides in that case, since a support without load cannot hold it.
pub fn gap_opening<T: Elementary>(at: &Evaluation<T>, corner: Corner, corner_dot: T) -> T {
    // Without damping K/C is infinite: the sign of a nonzero rate decides, otherwise the acceleration.
    let creep = if corner_dot.is_zero() { T::from(0.0) } else { at.body.creep_rate * corner_dot };
    acceleration_if_let_go(at, corner) + creep
}

/// Returns the vertical acceleration (m/s²) of a touching corner if only this corner left now.
fn acceleration_if_let_go<T: Elementary>(at: &Evaluation<T>, corner: Corner) -> T {
    let &Evaluation { body, instant: ref x, .. } = at;
    let other = corner.other();
    let after = if at.regime.touches(other) {
        let state = [x.theta, x.theta_dot, x.corner[other.index()], x.corner_dot[other.index()]];
        let regime = Regime::on(other);
        instant(body, regime, state, friction::footing_on(at, regime), at.forcing)
    } else {
        let flight = Footing::Free { u: x.u, u_dot: x.u_dot };
        instant(body, Regime::Separated, [x.theta, x.theta_dot, x.v, x.v_dot], flight, at.forcing)
    };
    after.corner_ddot[corner.index()]
}

impl<T: Elementary> PoseUpdate<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Handles a reaction of `corner` that fell through zero. If it `was_held`, the corner would no longer be pressed on.
    pub(super) fn lift_off(
        &mut self,
        corner: Corner,
        was_held: bool,
        now: &Evaluation<T>,
    ) -> (Release, TransitionCounts) {
        match self.system.block.foundation {
            Foundation::Viscoelastic => self.unload_support(corner, was_held, now),
            Foundation::Rigid => self.unload_rigid_base(corner, now),
        }
    }

    fn unload_support(&mut self, corner: Corner, was_held: bool, now: &Evaluation<T>) -> (Release, TransitionCounts) {
        let x = &now.instant;
        let opens = self.gap_would_open(corner, x.corner_dot[corner.index()], now);
        match self.regime() {
            Regime::FullContact => {
                let other_is_held = self.pose.contacts.held() == Some(corner.other());
                self.pose.contacts.let_bear();
                if !opens && other_is_held {
                    return self.lose_support(x);
                }
                if !opens && !was_held {
                    return (Release::Held, self.hold_corner(corner, x.corner[corner.index()]));
                }
            }
            Regime::TiltingLeft | Regime::TiltingRight | Regime::Separated
                if !opens && self.system.block.friction.value() == 0.0 =>
            {
                self.free_horizontally(x);
                return (Release::Slides, TransitionCounts::NONE);
            }
            Regime::TiltingLeft | Regime::TiltingRight | Regime::Separated => {}
        }
        let (before, placement) = (self.regime(), Placement::of(x));
        (Release::Lifts, self.lift_off_support(corner, &placement) + self.resolve_regime(before, placement))
    }

    /// Whether the gap under `corner`, which no longer bears anything, would open.
    ///
    /// It always does for a foot without horizontal force, and for the last corner in the paper's analysis, which ends there.
    pub(super) fn gap_would_open(&self, corner: Corner, corner_dot: T, now: &Evaluation<T>) -> bool {
        let last = !now.regime.touches(corner.other());
        let is_free = matches!(self.pose.footing, Footing::Free { .. });
        is_free || (last && !self.system.flies) || gap_opening(now, corner, corner_dot).value() >= 0.0
    }

    /// Lifts `corner` off its support, which creeps back from now on.
    pub(super) fn lift_off_support(&mut self, corner: Corner, placement: &Placement<T>) -> TransitionCounts {
        self.pose.contacts.set(corner, Contact::Lifted(self.creep_from(corner, placement.corners[corner.index()].0)));
        TransitionCounts::LIFTOFF
    }

    /// Lets `corner` leave the rigid base, and the other one rather than be pulled.
    pub(super) fn unload_rigid_base(&mut self, corner: Corner, now: &Evaluation<T>) -> (Release, TransitionCounts) {
        let (first, of_first) = self.unload_rigid_corner(corner, now);
        let (last, of_others) = self.resolve_regime_on_rigid_base();
        let release = match last {
            Some(Release::Lifts) => Release::Lifts,
            Some(Release::Slides | Release::Held) | None => first,
        };
        (release, of_first + of_others)
    }

    /// Lifts `corner` off the rigid base, or lets it slide. It slides if it is the last one and would be pressed on without a horizontal
    /// hold.
    ///
    /// The paper's analysis ends when the last corner bears nothing.
    pub(super) fn unload_rigid_corner(&mut self, corner: Corner, now: &Evaluation<T>) -> (Release, TransitionCounts) {
        let x = &now.instant;
        let last = !now.regime.touches(corner.other());
        let holds = self.pose.footing.grips() && self.system.block.friction.value() == 0.0;
        if last && self.system.flies && holds && acceleration_if_let_go(now, corner).value() < 0.0 {
            self.free_horizontally(x);
            return (Release::Slides, TransitionCounts::NONE);
        }
        self.mark_lifted(corner);
        self.continue_from(&Placement::of(x));
        (Release::Lifts, TransitionCounts::LIFTOFF)
    }

    /// Marks `corner` as lifted off the rigid base.
    pub(super) fn mark_lifted(&mut self, corner: Corner) {
        self.pose.contacts.set(corner, Contact::Lifted(Creep::default()));
    }
}
