//! A corner that is held on its support: the motion along the boundary between full contact and the other corner alone.

use crate::block::Block;
use crate::contact::Corner;
use crate::dual::{Dual, Dual64};
use crate::excitation::Forcing;
use crate::numerics::roots::Sample;
use crate::scalar::{Beside, Scalar};
use crate::system::dynamics::{Footing, Instant, Posture};

/// A corner that is held: it goes with its support, and bears nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held<T> {
    /// The corner.
    pub corner: Corner,
    /// Height of its support above its place under the block at rest (m), its rate (m/s) and its acceleration (m/s²).
    pub top: [T; 3],
}

impl Held<f64> {
    /// The support at this height, which creeps at this rate: `C ÿ = −K ẏ`.
    pub fn on(block: &Block, corner: Corner, Sample { value, rate }: Sample) -> Held<f64> {
        let creeps = if rate == 0.0 { 0.0 } else { -(block.creep_rate() * rate) };
        Held { corner, top: [value, rate, creeps] }
    }

    /// The same with its rates of change in the dual parts.
    fn along(&self, block: &Block) -> Held<Dual64> {
        let [value, rate, acceleration] = self.top;
        let jerk = if acceleration == 0.0 { 0.0 } else { -(block.creep_rate() * acceleration) };
        let top = [Dual::new(value, rate), Dual::new(rate, acceleration), Dual::new(acceleration, jerk)];
        Held { corner: self.corner, top }
    }
}

/// The equations of motion where one of both corners is held; θ and θ̇ alone are the state.
pub fn instant_held<P: Scalar, T: Beside<P>>(
    block: &Block<P>,
    [theta, theta_dot]: [T; 2],
    held: Held<T>,
    footing: Footing<T>,
    forcing: Forcing<T>,
) -> Instant<T> {
    let zero = T::from(0.0);
    Posture::new(block, [theta, theta_dot, zero, zero], footing).held(held, forcing)
}

/// The same at an instant `x` with, in the dual parts, the rates of change of [`crate::system::dynamics::along`].
pub fn along_held(
    block: &Block,
    held: &Held<f64>,
    footing: Footing<f64>,
    x: &Instant<f64>,
    forcing: Forcing<Dual64>,
) -> Instant<Dual64> {
    let state = [Dual::new(x.theta, x.theta_dot), Dual::new(x.theta_dot, x.theta_ddot)];
    instant_held(block, state, held.along(block), footing.map(Dual64::from), forcing)
}

impl<P: Scalar, T: Beside<P>> Posture<'_, P, T> {
    /// Both corners touch, and one of them is held on its support, which moves by itself. So the other one's reaction says how
    /// the centre of mass moves, and both together how the block turns; what holds it horizontally is the middle of the base.
    pub(super) fn held(
        mut self,
        Held { corner, top: [top, top_dot, top_ddot] }: Held<T>,
        forcing: Forcing<T>,
    ) -> Instant<T> {
        let Posture { block, theta, theta_dot, sin, cos, .. } = self;
        let Block { b, h, gravity, .. } = *block;
        let s = corner.sign();
        let theta_dot2 = theta_dot * theta_dot;
        (self.w, self.w_dot) = (top - sin * (b * s), top_dot - cos * theta_dot * (b * s));
        let other = corner.other().index();
        let [height, rate, _] = self.corners([self.w, self.w_dot, T::from(0.0)], T::from(0.0)).map(|pair| pair[other]);
        let n = self.support(height, rate);
        let v_ddot = n - gravity - forcing.z;
        let theta_ddot = (top_ddot - v_ddot - self.height(s) * theta_dot2) / (self.reach(s) * s);
        let w_ddot = v_ddot + sin * theta_ddot * h + cos * theta_dot2 * h;
        let (arm, centripetal) = (cos * h, sin * theta_dot2 * h);
        let along = self.horizontal(sin * h, arm * theta_dot, arm * theta_ddot - centripetal, forcing);
        let [mut heights, mut rates, mut accelerations] = self.corners([self.w, self.w_dot, w_ddot], theta_ddot);
        let mut reaction = [n; 2];
        let i = corner.index();
        // To the last bit, by which events are decided.
        (heights[i], rates[i], accelerations[i], reaction[i]) = (top, top_dot, top_ddot, T::from(0.0));
        Instant {
            theta,
            theta_dot,
            theta_ddot,
            w_dot: self.w_dot,
            w_ddot,
            u: along.u,
            u_dot: along.u_dot,
            u_ddot: along.u_ddot,
            v: self.w - self.versine() * h,
            v_dot: self.w_dot - sin * theta_dot * h,
            v_ddot,
            corner: heights,
            corner_dot: rates,
            corner_ddot: accelerations,
            reaction,
            horizontal: along.reaction,
        }
    }
}
