//! A block at an instant → the quantities that users see.

use nalgebra::Vector3;

use crate::numerics::dual::Dual;
use crate::numerics::scalar::{Elementary, greatest};
use crate::space::body::SpaceBody;
use crate::space::forces::{FootContact, FootForces, support_height};
use crate::space::motion::{
    BodyMotion, Component, OMEGA, QUATERNION, Turn, VELOCITY, constant, of_foot, slip_of, three, works,
};

/// Tilt and twist of a rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attitude<T = f64> {
    /// Angle of the body's axis n = R e_z to the vertical (rad).
    pub tilt: T,
    /// Its component towards +x (rad).
    pub tilt_x: T,
    /// Its component towards +y (rad).
    pub tilt_y: T,
    /// Direction of the tilt (rad), from +x towards +y.
    pub azimuth: T,
    /// Twist about the vertical (rad).
    pub twist: T,
}

impl<T: Component + Elementary> Attitude<T> {
    /// Returns tilt and twist of a rotation.
    pub fn of(turn: &Turn<T>) -> Attitude<T> {
        let z = turn.axis();
        let across = z.x.hypot(z.y);
        let tilt = across.atan2(z.z);
        // An upright axis leaves along its rate.
        let [tilt_x, tilt_y] = [z.x, z.y].map(|n| if across.value() > 0.0 { tilt * n / across } else { n + 0.0 });
        Attitude { tilt, tilt_x, tilt_y, azimuth: z.y.atan2(z.x), twist: Attitude::twist_of(turn) }
    }

    /// Returns the twist of a rotation (rad).
    pub(super) fn twist_of(turn: &Turn<T>) -> T {
        let [sine, cosine] = turn.twist();
        sine.atan2(cosine)
    }
}

/// The middle of the base under the centre of mass (m), in body axes.
fn middle(body: &SpaceBody) -> Vector3<f64> {
    Vector3::new(0.0, 0.0, -body.center_height)
}

/// Returns the displacement of the base's middle over the ground (m).
pub(super) fn drift<T: Component>(body: &SpaceBody, motion: &BodyMotion<T>) -> [T; 2] {
    let drift = motion.displacement + motion.turn.change(&middle(body));
    [drift.x, drift.y]
}

/// A foot at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FootObservation<T = f64> {
    /// Vertical force N (N).
    pub normal: T,
    /// Horizontal force on the block (N).
    pub horizontal: [T; 2],
    /// Height over the top of its support (m).
    pub uplift: T,
    /// Stretch of its horizontal spring (m).
    pub stretch: [T; 2],
    /// Rate of this stretch (m/s).
    pub stretch_rate: [T; 2],
    /// Length of its slip since the start (m).
    pub slip: T,
    /// Rate of this length (m/s).
    pub slip_rate: T,
    /// |F|/N of a foot that touches (1).
    pub friction_demand: T,
    /// Whether it touches.
    pub touches: bool,
    /// Whether it slides.
    pub slides: bool,
}

/// The observed quantities.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceObservation<T = f64> {
    /// Time (s).
    pub time: T,
    /// Tilt and twist.
    pub attitude: Attitude<T>,
    /// The quaternion of the rotation, its real part first.
    pub quaternion: [T; 4],
    /// Its rate (1/s).
    pub quaternion_rate: [T; 4],
    /// Angular velocity (rad/s).
    pub omega: Vector3<T>,
    /// Displacement u, w, v of the centre of mass (m).
    pub displacement: Vector3<T>,
    /// Its velocity (m/s).
    pub velocity: Vector3<T>,
    /// Its acceleration relative to the ground (m/s²).
    pub acceleration: Vector3<T>,
    /// Angular acceleration (rad/s²).
    pub angular_acceleration: Vector3<T>,
    /// Displacement of the middle of the base over the ground (m).
    pub drift: [T; 2],
    /// Sum of the forces on the feet (N).
    pub force: Vector3<T>,
    /// Moment of these forces about the place of the base's middle at rest (N.m).
    pub moment: Vector3<T>,
    /// Powers (W) of ground motion and loads, and of what the dashpots and slip take.
    pub powers: [T; 3],
    /// The feet.
    pub feet: Vec<FootObservation<T>>,
}

impl SpaceObservation {
    /// Returns the tilt over the critical one in the direction of the lean (1): 1 where the centre of mass stands over an edge of the base.
    pub fn tilt_over_critical(&self, body: &SpaceBody) -> f64 {
        body.tilt_over_critical(&Turn::of_quaternion(self.quaternion.map(Dual::from)).lean()).re
    }
}

impl<T: Component + Elementary> SpaceObservation<T> {
    /// Returns the quantities of a block at a time (s), from its state and the rates of that.
    pub fn of(body: &SpaceBody, contacts: &[FootContact], time: T, state: &[T], rates: &[T]) -> SpaceObservation<T> {
        let motion = BodyMotion::of(state);
        let BodyMotion { displacement, turn, velocity, omega } = motion;
        let base = constant(&middle(body));
        let zero = T::from(0.0);
        let (mut force, mut moment) = (Vector3::repeat(zero), Vector3::repeat(zero));
        let mut feet = Vec::with_capacity(body.count());
        for (i, (foot, contact)) in body.feet.iter().zip(contacts).enumerate() {
            let at = motion.foot(&foot.place);
            let [stretch, stretch_rate] = [state, rates].map(|numbers| [numbers[of_foot(i)], numbers[of_foot(i) + 1]]);
            let [slip, slip_rate] = [state, rates].map(|numbers| numbers[slip_of(i, body.count())]);
            let of_state = FootObservation { stretch, stretch_rate, slip, slip_rate, ..FootObservation::default() };
            if let FootContact::Lifted(creep) = contact {
                let top = support_height(body, foot, creep, time.value());
                let uplift = at.displacement.z - ((time - time.value()) * top.eps + top.re);
                feet.push(FootObservation { uplift, ..of_state });
                continue;
            }
            let forces = FootForces::of(body, foot, *contact, &at, stretch);
            // The size of a force grows from zero in any direction.
            let trial_size = if forces.trial_size.value() > 0.0 {
                forces.trial_size
            } else {
                forces.trial[0].hypot(forces.trial[1])
            };
            force += forces.force;
            moment += (displacement + at.arm - base).cross(&forces.force);
            feet.push(FootObservation {
                normal: forces.normal,
                horizontal: [forces.force.x, forces.force.y],
                uplift: zero,
                friction_demand: trial_size / forces.normal,
                touches: true,
                slides: *contact == FootContact::Slides,
                ..of_state
            });
        }
        SpaceObservation {
            time,
            attitude: Attitude::of(&turn),
            quaternion: std::array::from_fn(|i| state[QUATERNION + i]),
            quaternion_rate: std::array::from_fn(|i| rates[QUATERNION + i]),
            omega,
            displacement,
            velocity,
            acceleration: three(rates, VELOCITY),
            angular_acceleration: three(rates, OMEGA),
            drift: drift(body, &motion),
            force,
            moment,
            powers: works(rates, body.count()),
            feet,
        }
    }

    /// Returns an observation with `f` applied to all numbers.
    pub fn map<U: Component>(&self, f: impl Fn(T) -> U) -> SpaceObservation<U> {
        let Attitude { tilt, tilt_x, tilt_y, azimuth, twist } = self.attitude;
        let [tilt, tilt_x, tilt_y, azimuth, twist] = [tilt, tilt_x, tilt_y, azimuth, twist].map(&f);
        let foot = |foot: &FootObservation<T>| FootObservation {
            normal: f(foot.normal),
            horizontal: foot.horizontal.map(&f),
            uplift: f(foot.uplift),
            stretch: foot.stretch.map(&f),
            stretch_rate: foot.stretch_rate.map(&f),
            slip: f(foot.slip),
            slip_rate: f(foot.slip_rate),
            friction_demand: f(foot.friction_demand),
            touches: foot.touches,
            slides: foot.slides,
        };
        SpaceObservation {
            time: f(self.time),
            attitude: Attitude { tilt, tilt_x, tilt_y, azimuth, twist },
            quaternion: self.quaternion.map(&f),
            quaternion_rate: self.quaternion_rate.map(&f),
            omega: self.omega.map(&f),
            displacement: self.displacement.map(&f),
            velocity: self.velocity.map(&f),
            acceleration: self.acceleration.map(&f),
            angular_acceleration: self.angular_acceleration.map(&f),
            drift: self.drift.map(&f),
            force: self.force.map(&f),
            moment: self.moment.map(&f),
            powers: self.powers.map(&f),
            feet: self.feet.iter().map(foot).collect(),
        }
    }

    /// Returns the greatest |F|/N of all feet (1), 0 if none touches.
    pub fn friction_demand(&self) -> T {
        let demands = self.feet.iter().map(|foot| foot.friction_demand);
        demands.fold(T::from(0.0), greatest)
    }

    /// Returns what is left of a block that is held: it has a place, and neither motion nor forces.
    #[must_use]
    pub fn held(self) -> SpaceObservation<T> {
        let still = T::from(0.0);
        let zero = Vector3::repeat(still);
        let foot = |foot: FootObservation<T>| FootObservation {
            stretch: foot.stretch,
            slip: foot.slip,
            uplift: foot.uplift,
            ..FootObservation::default()
        };
        SpaceObservation {
            quaternion_rate: [still; 4],
            omega: zero,
            velocity: zero,
            acceleration: zero,
            angular_acceleration: zero,
            force: zero,
            moment: zero,
            powers: [still; 3],
            feet: self.feet.into_iter().map(foot).collect(),
            ..self
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
