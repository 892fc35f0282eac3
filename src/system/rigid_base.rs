//! Housner's block: the equations of motion on the rigid base.

use crate::block::Block;
use crate::contact::Corner;
use crate::excitation::Forcing;
use crate::scalar::{Beside, Scalar};
use crate::system::dynamics::{Footing, Instant, Posture};

impl<P: Scalar, T: Beside<P>> Posture<'_, P, T> {
    /// Housner's block about the corner on which it stands; w = 0. A corner that slides bears what keeps it on the base:
    /// `v̈ = −s P θ̈ − Q θ̇²` with `θ̈ i0 = s P N/M + m`.
    #[inline(always)]
    pub(super) fn on_rigid_base(&self, corner: Corner, forcing: Forcing<T>) -> Instant<T> {
        let s = corner.sign();
        let (reach, height) = (self.reach(s), self.height(s));
        let Block { gravity, i0, r0, .. } = *self.block;
        let weight = forcing.z + gravity;
        let theta_ddot = match self.footing {
            Footing::Grips { .. } => {
                (reach * weight * s - height * forcing.x + forcing.moment) * T::from(P::from(1.0) / (i0 + r0 * r0))
            }
            Footing::Free { .. } => {
                let pressing = weight - height * self.theta_dot * self.theta_dot;
                (reach * pressing * s + forcing.moment) / (reach * reach + i0)
            }
        };
        let v_ddot = -(reach * theta_ddot * s) - height * self.theta_dot * self.theta_dot;
        let n = v_ddot + forcing.z + gravity;
        self.about(corner, theta_ddot, T::from(0.0), v_ddot, n, forcing)
    }

    /// On the rigid base without motion: the reactions that keep the block at rest. The corner whose reaction would
    /// have to pull lifts, which is `|a_gx| > (g + a_gz) tan α`.
    #[inline(always)]
    pub(super) fn at_rest(&self, forcing: Forcing<T>) -> Instant<T> {
        let Block { b, h, gravity, .. } = *self.block;
        let zero = T::from(0.0);
        let (u, u_dot, u_ddot, horizontal) = match self.footing {
            Footing::Grips { offset } => (offset, zero, zero, forcing.x),
            Footing::Free { u, u_dot } => (u, u_dot, -forcing.x, zero),
        };
        let weight = forcing.z + gravity;
        let half = weight * 0.5;
        let couple = (horizontal * h - forcing.moment) * (P::from(0.5) / b);
        // A corner bears what keeps the block from turning about the other one. Where rounding may decide whether that is above
        // zero, it is the moment of `on_rigid_base` to the last bit: a corner that cannot stay is never pressed back at once.
        let bears = |s: f64| {
            let moment = (weight * b * s - horizontal * h + forcing.moment) * s;
            let (n, exact) = (half - couple * s, moment * (P::from(0.5) / b));
            let n = T::select_less(n.value(), zero.value(), exact, n);
            T::select_less(moment.value(), zero.value(), exact, n)
        };
        Instant {
            theta: self.theta,
            theta_dot: self.theta_dot,
            theta_ddot: zero,
            w_dot: zero,
            w_ddot: zero,
            u,
            u_dot,
            u_ddot,
            v: zero,
            v_dot: zero,
            v_ddot: zero,
            corner: [zero; 2],
            corner_dot: [zero; 2],
            corner_ddot: [zero; 2],
            reaction: [bears(-1.0), bears(1.0)],
            horizontal,
        }
    }
}
