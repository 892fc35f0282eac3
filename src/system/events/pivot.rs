//! Housner's change of the pivot: on the rigid base the gap under a lifted corner closes at θ = 0.

use crate::block::{Contacts, Corner};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary, greatest, least};
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{PoseUpdate, TransitionCounts};
use crate::system::events::landing::without_gain;
use crate::system::events::placement::Placement;
use crate::system::impact::Velocities;
use crate::system::instant::State;

/// Slowest rocking on the rigid base that continues after an impact, over p. The infinitely many impacts before rest, which take a finite
/// time, are not distinguished below this rate.
const SLOWEST: f64 = 1e-9;

impl<T: Elementary> PoseUpdate<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Changes the pivot to `corner`: `θ̇ → e θ̇` at θ = 0, or rest.
    pub(super) fn change_pivot(&mut self, corner: Corner, now: &Evaluation<T>) -> TransitionCounts {
        let block = &self.system.block;
        let theta_dot = greatest(block.restitution_of(corner), T::from(0.0)) * now.state[1];
        let zero = T::from(0.0);
        let mut counts = TransitionCounts::impacts(1);
        self.pose.contacts = Contacts::FULL;
        if block.friction.value() > 0.0 {
            counts += self.change_pivot_with_friction(corner, theta_dot, now);
        } else if theta_dot.value().abs() < SLOWEST * block.p.value() {
            self.pose.state = State::zeros();
        } else {
            self.mark_lifted(corner.other());
            self.pose.state = State::from([zero, theta_dot, zero, zero]);
            counts += TransitionCounts::LIFTOFF;
        }
        counts + self.resolve_regime_on_rigid_base().1
    }

    /// Changes the pivot with friction.
    ///
    /// e determines the vertical rates after the impact and thus the vertical impulse; a horizontal impulse within its limit slows the new
    /// pivot. e is reduced if a sliding block would gain energy. The last impact of a block that grips stands for all further ones, and stops
    /// the foot.
    fn change_pivot_with_friction(&mut self, corner: Corner, theta_dot: T, now: &Evaluation<T>) -> TransitionCounts {
        let block = &self.system.block;
        let zero = T::from(0.0);
        let mut placement = Placement { theta: zero, v: zero, ..Placement::of(&now.instant) };
        let before = placement.velocities;
        let ends = theta_dot.value().abs() < SLOWEST * block.p.value();
        let stops = ends && now.footing.grips();
        let land = |theta_dot: T| {
            let v_dot = -block.offset(corner) * theta_dot;
            let most =
                if stops { T::from(f64::INFINITY) } else { block.friction * greatest(v_dot - before.v_dot, zero) };
            let u_dot = before.u_dot + least(greatest(block.h * theta_dot - before.u_dot, -most), most);
            Velocities { u_dot, v_dot, theta_dot }
        };
        let (_, velocities) = without_gain(block, before, if ends { zero } else { theta_dot }, land);
        placement.set_velocities(block, velocities);
        for corner in Corner::BOTH {
            placement.corners[corner.index()].0 = zero;
        }
        placement.corners[corner.index()].1 = zero;
        if ends {
            return self.stand(&mut placement);
        }
        self.mark_lifted(corner.other());
        TransitionCounts::LIFTOFF + self.stand(&mut placement)
    }
}
