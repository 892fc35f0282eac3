//! Initial values → the pose at the beginning.

use serde::{Deserialize, Serialize};

use crate::block::{Block, Body, Foot, Foundation, Kinematics, Regime, restraints};
use crate::block::{Contacts, Corner};
use crate::excitation::Excitation;
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary};
use crate::system::System;
use crate::system::events::change::{PoseUpdate, ROUNDING};
use crate::system::events::placement::Placement;
use crate::system::impact::Velocities;
use crate::system::instant::{Footing, Pose, State};

/// Initial values of the block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Initial<T = f64> {
    /// Rotation θ (rad), positive to the right, |θ| < π/2.
    pub theta: T,
    /// θ̇ (rad/s).
    pub theta_dot: T,
    /// `(v, v̇)` of the centre of mass (m, m/s). `None` stands for the vertical equilibrium at `theta`, in which the supports that touch
    /// carry the weight, and the middle of the base (or the one touching corner) does not move vertically.
    pub vertical: Option<(T, T)>,
}

impl<T: Elementary> System<T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Returns the pose at the beginning, at `time` (s), under the excitation of that time. A support that nothing touches is at its free
    /// height.
    pub fn beginning(&self, initial: &Initial<T>, time: T, excitation: &Excitation<T>) -> Pose<T> {
        match self.block.foundation {
            Foundation::Viscoelastic => self.beginning_on_supports(initial, time, excitation),
            Foundation::Rigid => self.switched(beginning_on_rigid_base(initial, time), excitation),
        }
    }

    fn beginning_on_supports(&self, initial: &Initial<T>, time: T, excitation: &Excitation<T>) -> Pose<T> {
        let mut placement = Placement::on_supports(&self.block, initial);
        let touching = Corner::each(|corner| {
            placement.corners[corner.index()].0.value() <= self.block.free_height(corner).value()
        });
        let contacts = Contacts::touching(touching, time);
        let footing = Footing::Grips { offset: T::from(0.0) };
        let state = placement.state(contacts.regime()).into();
        let pose = self.switched(Pose::unrestrained(time, state, contacts, footing), excitation);
        // A corner that is drawn up faster than its support can follow leaves it at once.
        let mut change = PoseUpdate::begin(self, &pose, excitation);
        change.grip_at_start(&mut placement);
        let _ = change.resolve_regime(contacts.regime(), placement);
        debug_assert!(!change.path.overflows(), "{:?}", change.path);
        change.pose
    }
}

impl<T: Elementary> Placement<T> {
    /// Returns the placement of a block on supports at the beginning.
    fn on_supports(block: &Block<T>, initial: &Initial<T>) -> Placement<T> {
        let h = block.h;
        let Initial { theta, theta_dot, vertical } = *initial;
        let (sin, cos) = theta.sin_cos();
        let free = Corner::each(|corner| block.free_height(corner));
        let turn = Corner::each(|corner| block.half_base(corner) * sin);
        let turn_dot = Corner::each(|corner| block.half_base(corner) * cos * theta_dot);
        // Descent of the centre of mass relative to the middle of the base.
        let e = block.eccentricity;
        let (sunk, sunk_dot) = (h * sin * sin / (cos + 1.0) + e * sin, h * sin * theta_dot + e * cos * theta_dot);
        let upper = if turn[0].value() > 0.0 { 0 } else { 1 };
        // Height and rate of the middle of the base.
        let (middle, middle_dot) = match vertical {
            Some((v, v_dot)) => (v + sunk, v_dot + sunk_dot),
            None if turn[upper].value() <= free[upper].value() => (T::from(0.0), T::from(0.0)),
            // The lower corner bears the whole weight and does not move.
            None => (turn[upper] - free[upper], turn_dot[upper]),
        };
        let middle = match vertical {
            None if !block.restraints.is_empty() => balanced(block, [sin, cos], middle),
            _ => middle,
        };
        let (v, v_dot) = (middle - sunk, middle_dot - sunk_dot);
        let velocities = Velocities { u_dot: h * cos * theta_dot - e * sin * theta_dot, v_dot, theta_dot };
        let corners = [0, 1].map(|i| (middle + turn[i], middle_dot + turn_dot[i]));
        Placement { corners, theta, u: h * sin - e * sin * sin / (cos + 1.0), v, velocities }
    }
}

fn beginning_on_rigid_base<T: Elementary>(initial: &Initial<T>, time: T) -> Pose<T> {
    let zero = T::from(0.0);
    let lean = if initial.theta.value() != 0.0 { initial.theta } else { initial.theta_dot }.value();
    let state = State::from([initial.theta, initial.theta_dot, zero, zero]);
    // A block that leans to the left stands on L alone.
    let contacts = Contacts::touching([lean <= 0.0, lean >= 0.0], time);
    Pose::unrestrained(time, state, contacts, Footing::Grips { offset: zero })
}

/// Returns the height of the middle of the base (m) at vertical equilibrium. The supports bear the weight and the vertical pull of
/// restraints.
///
/// The search begins at `middle`, where they bear the weight alone. The rotation, with this sine and cosine, is fixed.
fn balanced<T: Elementary>(block: &Block<T>, [sin, cos]: [T; 2], middle: T) -> T {
    const DOUBLINGS: u32 = 60;
    const HALVINGS: u32 = 200;
    let surplus = |middle: T| surplus(block, [sin, cos], middle);
    let value = |middle: f64| surplus(T::from(middle)).value();
    let (start, mut reach) = (middle.value(), block.static_deflection().value());
    let (mut low, mut high) = (start, start);
    for _ in 0..DOUBLINGS {
        let [sinks, rises] = [value(low) < 0.0, value(high) > 0.0];
        if !sinks && !rises {
            break;
        }
        (low, high) = (if sinks { low - reach } else { low }, if rises { high + reach } else { high });
        reach *= 2.0;
    }
    for _ in 0..HALVINGS {
        let half = 0.5 * (low + high);
        if value(half) > 0.0 {
            low = half;
        } else {
            high = half;
        }
    }
    // A Newton step adds the derivatives.
    T::from(high) - surplus(T::from(high)) * (1.0 / slope(block, [sin, cos], high))
}

/// Returns the derivative of [`surplus`] with respect to the height (N/m).
fn slope<T: Elementary>(block: &Block<T>, [sin, cos]: [T; 2], middle: f64) -> f64 {
    let (kinematics, pushes) = kinematics_at(block, [sin, cos], T::from(middle));
    let supports: f64 = pushes.iter().filter(|push| push.value() > 0.0).map(|_| block.stiffness.value()).sum();
    -(supports + restraints::static_stiffness(block, &kinematics, ROUNDING))
}

/// Returns the force of the supports less weight and pull of restraints (N). The middle of the base is at this height (m).
fn surplus<T: Elementary>(block: &Block<T>, turn: [T; 2], middle: T) -> T {
    let (kinematics, pushes) = kinematics_at(block, turn, middle);
    let zero = T::from(0.0);
    let mut sum = -(block.mass * block.gravity);
    for push in pushes {
        sum = sum + T::select_less(0.0, push.value(), push * block.stiffness, zero);
    }
    restraints::less_static_pull(block, &kinematics, sum, ROUNDING)
}

/// Returns the kinematics of a block at rest, and the compression of its supports (m). The middle of its base is at this height (m).
fn kinematics_at<T: Elementary>(body: &Body<T>, [sin, cos]: [T; 2], middle: T) -> (Kinematics<T>, [T; 2]) {
    let zero = T::from(0.0);
    let pushes = Corner::each(|corner| body.free_height(corner) - middle - body.half_base(corner) * sin);
    let touching = pushes.map(|push| push.value() > 0.0);
    let foot = Regime::of_touching(touching).foot().unwrap_or(Foot::Middle);
    let (versine, offset) = (sin * sin / (cos + 1.0), body.offset_from(foot));
    let center = [sin * body.h - versine * offset, middle - versine * body.h - sin * body.eccentricity];
    (Kinematics { sin_cos: [sin, cos], theta_dot: zero, center, velocity: [zero; 2] }, pushes)
}
