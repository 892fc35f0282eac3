//! A block at an instant → the quantities that users see.

use nalgebra::Vector3;

use crate::numerics::dual::Dual;
use crate::space::body::SpaceBody;
use crate::space::events::Poised;
use crate::space::forces::{FootContact, FootForces, support_height};
use crate::space::motion::{BodyMotion, Component, OMEGA, Turn, VELOCITY, constant, of_foot, three};

/// Tilt and twist of a rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attitude {
    /// Angle of the body's axis n = R e_z to the vertical (rad).
    pub tilt: f64,
    /// Its component towards +x (rad).
    pub tilt_x: f64,
    /// Its component towards +y (rad).
    pub tilt_y: f64,
    /// Direction of the tilt (rad), from +x towards +y.
    pub azimuth: f64,
    /// Twist about the vertical (rad).
    pub twist: f64,
}

impl Attitude {
    /// Returns tilt and twist of a rotation.
    pub fn of(turn: &Turn<f64>) -> Attitude {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| turn.rotate(&axis));
        let across = libm::hypot(z.x, z.y);
        let tilt = libm::atan2(across, z.z);
        let [tilt_x, tilt_y] = [z.x, z.y].map(|n| if across > 0.0 { tilt * n / across } else { 0.0 });
        Attitude { tilt, tilt_x, tilt_y, azimuth: libm::atan2(z.y, z.x), twist: libm::atan2(x.y - y.x, x.x + y.y) }
    }
}

impl Attitude {
    /// Returns the twist of a rotation (rad), with its rate.
    pub(super) fn twist_of(turn: &Turn<Dual>) -> Dual {
        let [x, y] = [Vector3::x(), Vector3::y()].map(|axis| turn.rotate(&constant(&axis)));
        let (sin, cos) = (x.y - y.x, x.x + y.y);
        let rate = (cos.re * sin.eps - sin.re * cos.eps) / (sin.re * sin.re + cos.re * cos.re);
        Dual::new(libm::atan2(sin.re, cos.re), rate)
    }
}

/// The middle of the base under the centre of mass (m), in body axes.
fn middle(body: &SpaceBody) -> Vector3<f64> {
    Vector3::new(0.0, 0.0, -body.center_height)
}

/// Returns the displacement of the base's middle over the ground (m).
pub(super) fn drift<T: Component>(body: &SpaceBody, motion: &BodyMotion<T>) -> [T; 2] {
    let drift = motion.displacement + motion.turn.change(&constant(&middle(body)));
    [drift.x, drift.y]
}

/// A foot at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FootObservation {
    /// Vertical force N (N).
    pub normal: f64,
    /// Horizontal force on the block (N).
    pub horizontal: [f64; 2],
    /// Height over the top of its support (m).
    pub uplift: f64,
    /// Length of its slip since the start (m).
    pub slip: f64,
    /// |F|/N of a foot that touches (1).
    pub friction_demand: f64,
    /// Whether it touches.
    pub touches: bool,
    /// Whether it slides.
    pub slides: bool,
}

/// The observed quantities.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpaceObservation {
    /// Time (s).
    pub time: f64,
    /// Tilt and twist.
    pub attitude: Attitude,
    /// Angular velocity (rad/s).
    pub omega: Vector3<f64>,
    /// Displacement u, w, v of the centre of mass (m).
    pub displacement: Vector3<f64>,
    /// Its velocity (m/s).
    pub velocity: Vector3<f64>,
    /// Its acceleration relative to the ground (m/s²).
    pub acceleration: Vector3<f64>,
    /// Angular acceleration (rad/s²).
    pub angular_acceleration: Vector3<f64>,
    /// Displacement of the middle of the base over the ground (m).
    pub drift: [f64; 2],
    /// Sum of the forces on the feet (N).
    pub force: Vector3<f64>,
    /// Moment of these forces about the place of the base's middle at rest (N.m).
    pub moment: Vector3<f64>,
    /// The feet.
    pub feet: Vec<FootObservation>,
}

impl SpaceObservation {
    /// Returns the quantities of a block.
    pub fn of(now: &Poised) -> SpaceObservation {
        let &Poised { body, time, state, rates, contacts } = now;
        let motion = BodyMotion::of(state);
        let BodyMotion { displacement, turn, velocity, omega } = motion;
        let base = middle(body);
        let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
        let mut feet = Vec::with_capacity(body.count());
        for (i, (foot, contact)) in body.feet.iter().zip(contacts).enumerate() {
            let at = motion.foot(&foot.place);
            let slip = state[of_foot(i) + 2];
            if let FootContact::Lifted(creep) = contact {
                let uplift = at.displacement.z - support_height(body, foot, creep, time).re;
                feet.push(FootObservation { uplift, slip, ..FootObservation::default() });
                continue;
            }
            let forces = FootForces::of(body, foot, *contact, &at, [state[of_foot(i)], state[of_foot(i) + 1]]);
            force += forces.force;
            moment += (displacement + at.arm - base).cross(&forces.force);
            feet.push(FootObservation {
                normal: forces.normal,
                horizontal: [forces.force.x, forces.force.y],
                uplift: 0.0,
                slip,
                friction_demand: forces.trial_size / forces.normal,
                touches: true,
                slides: *contact == FootContact::Slides,
            });
        }
        SpaceObservation {
            time,
            attitude: Attitude::of(&turn),
            omega,
            displacement,
            velocity,
            acceleration: three(rates, VELOCITY),
            angular_acceleration: three(rates, OMEGA),
            drift: drift(body, &motion),
            force,
            moment,
            feet,
        }
    }

    /// Returns the number of feet that touch.
    pub fn touching(&self) -> usize {
        self.feet.iter().filter(|foot| foot.touches).count()
    }

    /// Returns the number of feet that slide.
    pub fn sliding(&self) -> usize {
        self.feet.iter().filter(|foot| foot.slides).count()
    }
}
