//! A held corner: full contact would lift it, and standing on the other corner alone would press it back.
//!
//! It lifts once it would no longer be pressed back, and bears again once full contact would no longer lift it. Where the middle of the base
//! and the other corner slide to opposite sides, it lifts once the latter stops.

use crate::block::{Contact, Corner, Foot, Lever, Regime, StandingSlide};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary};
use crate::system::dynamics::instant;
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{PoseUpdate, Release, TransitionCounts};
use crate::system::events::friction;
use crate::system::events::lift_off::gap_opening;
use crate::system::events::placement::Placement;
use crate::system::instant::{Footing, Held, Instant};

/// Returns the acceleration (m/s²) that would press a released corner on.
///
/// Its rate is unknown and set to zero, so that only a sign change between samples is found, which suffices for a monotone function.
pub(super) fn pressed_on<T: Elementary>(at: &Evaluation<T>, corner: Corner) -> Dual<T> {
    Dual::new(-gap_opening(at, corner, at.instant.corner_dot[corner.index()]), T::from(0.0))
}

/// Returns the acceleration (m/s²) with which full contact would lift a held corner. Its rate is set to zero.
pub(super) fn unloading<T: Elementary>(at: &Evaluation<T>, corner: Corner) -> Dual<T> {
    let i = corner.index();
    let x = instant(at.body, Regime::FullContact, at.state.0, at.footing, at.forcing);
    Dual::new(x.corner_ddot[i] - at.instant.corner_ddot[i], T::from(0.0))
}

/// Returns the speed of the standing corner while the other one is held (m/s). It is positive in its present direction.
pub(super) fn standing_slide<T: Elementary>(at: &Evaluation<T>) -> Dual<T> {
    let (Some(held), Footing::Slides { direction, .. }) = (&at.held, at.footing) else { return Dual::default() };
    let (x, (sin, cos)) = (&at.instant, at.instant.theta.sin_cos());
    let Lever { x: across, q } = at.body.lever(Foot::Corner(held.corner.other()), sin, cos);
    let direction = match held.standing {
        StandingSlide::Follows => direction,
        StandingSlide::Opposes => -direction,
    };
    let acceleration = x.u_ddot - q * x.theta_ddot + across * x.theta_dot * x.theta_dot;
    Dual::new((x.u_dot - q * x.theta_dot) * direction, acceleration * direction)
}

impl<T: Elementary> PoseUpdate<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Holds `corner` on its support at this height (m).
    pub(super) fn hold_corner(&mut self, corner: Corner, height: T) -> TransitionCounts {
        let creep = self.creep_from(corner, height);
        self.pose.contacts.set(corner, Contact::Held(creep, StandingSlide::Follows));
        let Footing::Slides { .. } = self.pose.footing else { return TransitionCounts::NONE };
        if standing_slide(&self.now()).re.value() < -friction::speed_rounding(&self.system.block) {
            self.pose.contacts.set(corner, Contact::Held(creep, StandingSlide::Opposes));
        }
        TransitionCounts::EVALUATION
    }

    /// Lifts the held corner, since the standing one stopped and no longer presses it back. The standing one grips, or slides on.
    pub(super) fn stop_standing_corner(&mut self, held: &Held<T>, now: &Evaluation<T>) -> TransitionCounts {
        let placement = Placement::of(&now.instant).with_pivot_constraint(now.body, held.corner.other());
        self.lift_off_support(held.corner, &placement) + self.resolve_regime(Regime::FullContact, placement)
    }

    /// Handles two corners without load, so that nothing holds the block horizontally. The paper's analysis ends here.
    pub(super) fn lose_support(&mut self, x: &Instant<T>) -> (Release, TransitionCounts) {
        let (placement, mut counts) = (Placement::of(x), TransitionCounts::NONE);
        if self.system.flies && self.system.block.friction.value() == 0.0 {
            self.free_horizontally(x);
        } else {
            for corner in Corner::BOTH {
                counts += self.lift_off_support(corner, &placement);
            }
        }
        counts += self.resolve_regime(Regime::FullContact, placement);
        (if self.regime() == Regime::FullContact { Release::Slides } else { Release::Lifts }, counts)
    }
}
