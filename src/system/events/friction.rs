//! Coulomb's limit `|H| ≤ μ N`: a gripping foot slides when it is reached, and a sliding foot grips when it stops.

use crate::block::{Body, Corner, Foot, Foundation, Regime, StandingSlide};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary, Scalar};
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{PoseUpdate, ROUNDING, TransitionCounts};
use crate::system::events::event::EventKind;
use crate::system::events::grip;
use crate::system::events::placement::Placement;
use crate::system::impact;
use crate::system::instant::{Footing, Instant};

/// Returns the distance of a gripping foot from sliding (m/s²).
///
/// It is `μ N ± H` per mass, with + for a `push` from L.
#[inline(never)]
pub(super) fn margin<T: Elementary>(at: &Evaluation<T>, push: Corner) -> Dual<T>
where
    Dual<T>: CombinesWith<T>,
{
    distance(at.body, &at.rates(), push)
}

/// Returns the [`margin`] at an instant.
pub(super) fn distance<P: Scalar, T: CombinesWith<P>>(body: &Body<P>, x: &Instant<T>, push: Corner) -> T {
    let normal = x.reaction[0] + x.reaction[1];
    normal * body.friction + x.horizontal * push.sign()
}

/// Returns the footing that a block would have in another regime now. Where it slides, the velocity of the new foot decides.
pub(super) fn footing_on<T: Elementary>(at: &Evaluation<T>, regime: Regime) -> Footing<T> {
    let Footing::Slides { u, u_dot, direction } = at.footing else { return at.footing };
    if let (Some(held), Some(_)) = (&at.held, regime.pivot()) {
        return match held.standing {
            StandingSlide::Follows => at.footing,
            StandingSlide::Opposes => Footing::Slides { u, u_dot, direction: -direction },
        };
    }
    let height = impact::height_over(at.body, regime.foot().unwrap_or(Foot::Middle), at.instant.theta);
    let speed = (at.instant.u_dot - height * at.instant.theta_dot).value();
    let direction = if speed.abs() > speed_rounding(at.body) { speed.signum() } else { direction };
    Footing::Slides { u, u_dot, direction }
}

/// Returns the speed of a sliding foot (m/s).
#[inline(never)]
pub(super) fn speed<T: Elementary>(at: &Evaluation<T>) -> Dual<T> {
    let Footing::Slides { direction, .. } = at.footing else { return Dual::default() };
    let rate = at.foot_acceleration();
    Dual::new(at.instant.slip_rate * direction, rate * direction)
}

/// Returns the round-off of [`margin`] at zero (m/s²). On the rigid base no dashpot amplifies the round-off of rates.
#[inline(never)]
pub(super) fn margin_rounding<T: Elementary>(body: &Body<T>) -> f64 {
    const ULPS: f64 = 16.0;
    match body.foundation {
        Foundation::Viscoelastic => ROUNDING * grip::size(body) * (1.0 + body.friction.value()),
        Foundation::Rigid => ULPS * f64::EPSILON * body.gravity.value() * (1.0 + body.friction.value()),
    }
}

/// Returns the round-off of [`speed`] at zero (m/s).
#[inline]
pub(super) fn speed_rounding<T: Elementary>(body: &Body<T>) -> f64 {
    ROUNDING * (body.p * body.r0).value()
}

impl<T: Elementary> PoseUpdate<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Decides whether the foot grips or slides, and to which side. It grips if it is at rest and `|H| ≤ μ N` holds it.
    ///
    /// Does nothing without a limit of friction.
    pub(super) fn apply_friction(&mut self, placement: &mut Placement<T>) -> TransitionCounts {
        let block = &self.system.block;
        if block.friction.value() == 0.0 || self.regime() == Regime::Separated {
            return TransitionCounts::NONE;
        }
        let foot = self.regime().foot().unwrap_or(Foot::Middle);
        let height = impact::height_over(block, foot, placement.theta);
        let velocities = &mut placement.velocities;
        let speed = velocities.u_dot - height * velocities.theta_dot;
        if speed.value().abs() > speed_rounding(block) {
            self.slide(placement, speed.value().signum());
            return TransitionCounts::NONE;
        }
        velocities.u_dot = height * velocities.theta_dot;
        let counts = self.grip_here(placement) + TransitionCounts::EVALUATION;
        let now = self.now();
        let rounding = margin_rounding(block);
        for push in Corner::BOTH {
            let margin = margin(&now, push);
            let (margin, rate) = (margin.re.value(), margin.eps.value());
            if margin < -rounding || (margin <= rounding && rate < 0.0) {
                // H pushes the block to a side, and the foot slides to the other one.
                self.slide(placement, push.sign());
                break;
            }
        }
        counts
    }

    /// Applies friction to the present motion.
    pub(super) fn apply_friction_here(&mut self) -> TransitionCounts {
        if self.system.block.friction.value() == 0.0 {
            return TransitionCounts::NONE;
        }
        let now = self.now();
        TransitionCounts::EVALUATION + self.apply_friction(&mut Placement::of(&now.instant))
    }

    /// Lets a gripping foot slide, or a sliding foot grip or turn back. A gripping foot is pushed from a side; a sliding one has stopped.
    pub(super) fn slide_or_grip(
        &mut self,
        pushed_from: Option<Corner>,
        now: &Evaluation<T>,
    ) -> (EventKind, TransitionCounts) {
        self.pose.contacts.let_bear();
        let mut counts = TransitionCounts::NONE;
        let mut placement = Placement::of(&now.instant);
        match pushed_from {
            Some(push) => self.slide(&placement, push.sign()),
            None => {
                let foot = now.regime.foot().unwrap_or(Foot::Middle);
                let height = impact::height_over(now.body, foot, placement.theta);
                placement.velocities.u_dot = height * placement.velocities.theta_dot;
                counts += self.apply_friction(&mut placement);
            }
        }
        if now.body.foundation == Foundation::Rigid {
            counts += self.resolve_regime_under_friction().1;
        }
        (if self.pose.footing.grips() { EventKind::Grip } else { EventKind::Slip }, counts)
    }

    /// Lets the block stand on its present contacts. Its foot grips as far as friction allows.
    pub(super) fn stand(&mut self, placement: &mut Placement<T>) -> TransitionCounts {
        if self.system.block.friction.value() > 0.0 {
            self.place(placement);
            self.apply_friction(placement)
        } else {
            self.grip_at(placement)
        }
    }

    /// Keeps the horizontal position of a gripping block where it has an effect. It does with restraints, friction or an eccentric centre
    /// of mass.
    pub(super) fn place_foot(&mut self, placement: &Placement<T>) -> TransitionCounts {
        if self.system.block.tracks_foot() && self.pose.footing.grips() && self.regime() != Regime::Separated {
            self.grip_here(placement)
        } else {
            TransitionCounts::NONE
        }
    }

    /// Takes horizontal position and velocity of a gripping foot at the beginning.
    pub(in crate::system) fn grip_at_start(&self, placement: &mut Placement<T>) {
        if self.system.block.tracks_foot() && self.regime() != Regime::Separated {
            let now = self.now();
            (placement.u, placement.velocities.u_dot) = (now.instant.u, now.instant.u_dot);
        }
    }

    fn slide(&mut self, placement: &Placement<T>, direction: f64) {
        self.pose.footing = Footing::Slides { u: placement.u, u_dot: placement.velocities.u_dot, direction };
    }
}
