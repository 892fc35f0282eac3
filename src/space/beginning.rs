//! Tilt, twist and velocities at the beginning → the state and the contacts there.

use nalgebra::{Quaternion, Vector3};
use serde::{Deserialize, Serialize};

use crate::block::Creep;
use crate::space::body::SpaceBody;
use crate::space::forces::{FootContact, FootForces};
use crate::space::motion::{BodyMotion, DISPLACEMENT, OMEGA, QUATERNION, Turn, VELOCITY, dimension, normalize};

/// The beginning of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpaceInitial {
    /// Components of the tilt towards +x and +y (rad).
    pub tilt: [f64; 2],
    /// Twist about the vertical (rad), before the tilt.
    pub twist: f64,
    /// Angular velocity (rad/s).
    pub omega: [f64; 3],
    /// Height above rest (m) and vertical velocity (m/s) of the centre of mass; settled on the supports if not given.
    pub vertical: Option<[f64; 2]>,
}

/// Returns the quaternion of a twist followed by a tilt about a horizontal axis.
fn quaternion(tilt: [f64; 2], twist: f64) -> Quaternion<f64> {
    let [x, y] = tilt;
    let angle = libm::hypot(x, y);
    let (sin, cos) = libm::sincos(0.5 * angle);
    // sin(θ/2)/θ
    let factor = if angle > 0.0 { sin / angle } else { 0.5 };
    let (sin_twist, cos_twist) = libm::sincos(0.5 * twist);
    Quaternion::new(cos, -y * factor, x * factor, 0.0) * Quaternion::new(cos_twist, 0.0, 0.0, sin_twist)
}

impl SpaceInitial {
    /// Returns the state and the contacts at `time` (s).
    pub fn state(&self, body: &SpaceBody, time: f64) -> (Vec<f64>, Vec<FootContact>) {
        let mut state = vec![0.0; dimension(body.count())];
        let q = quaternion(self.tilt, self.twist);
        state[QUATERNION..VELOCITY].copy_from_slice(&[q.w, q.i, q.j, q.k]);
        normalize(&mut state);
        state[OMEGA..OMEGA + 3].copy_from_slice(&self.omega);
        match self.vertical {
            Some([height, rate]) => {
                state[DISPLACEMENT + 2] = height;
                state[VELOCITY + 2] = rate;
            }
            None => settle(body, &mut state),
        }
        let motion = BodyMotion::of(&state);
        let contacts = body.feet.iter().map(|foot| {
            let at = motion.foot(&foot.place);
            let height = at.displacement.z;
            let forces = FootForces::of(body, foot, FootContact::Sticks, &at, [0.0; 2]);
            if height < foot.free_height && forces.normal > 0.0 {
                forces.contact(body)
            } else {
                FootContact::Lifted(Creep { depth: foot.free_height - height.min(foot.free_height), since: time })
            }
        });
        let contacts = contacts.collect();
        (state, contacts)
    }
}

/// Places a turned block where the springs of the feet that touch carry its weight, and lets the middle of these feet stand still.
fn settle(body: &SpaceBody, state: &mut [f64]) {
    let turn = Turn::of(state);
    let omega = Vector3::from_row_slice(&state[OMEGA..OMEGA + 3]);
    // The height of the body at which each foot begins to touch.
    let mut heights: Vec<(f64, usize)> =
        body.feet.iter().enumerate().map(|(i, foot)| (foot.free_height - turn.change(&foot.place).z, i)).collect();
    heights.sort_by(|a, b| b.0.total_cmp(&a.0));
    let needed = body.mass * body.gravity / body.stiffness;
    let (mut sum, mut touching, mut height) = (0.0, 0, f64::NEG_INFINITY);
    for (i, &(touches_at, _)) in heights.iter().enumerate() {
        if touches_at <= height {
            break;
        }
        sum += touches_at;
        touching = i + 1;
        height = (sum - needed) / touching as f64;
    }
    let feet = || heights[..touching].iter().map(|&(_, i)| &body.feet[i].place);
    let mean = feet().map(|place| turn.change(place)).sum::<Vector3<f64>>() / touching as f64;
    let arm = feet().map(|place| turn.rotate(place)).sum::<Vector3<f64>>() / touching as f64;
    state[DISPLACEMENT..QUATERNION].copy_from_slice(&[-mean.x, -mean.y, height]);
    state[VELOCITY..OMEGA].copy_from_slice(arm.cross(&omega).as_slice());
}
