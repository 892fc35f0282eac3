//! The motion of a foot and its contact → the force on it, the rate of its stretch, and that of its slip.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::block::Creep;
use crate::numerics::dual::Dual;
use crate::space::body::{SpaceBody, SpaceFoot};
use crate::space::motion::{Component, FootMotion};

/// The contact of a foot, by its trial force: it slides where `|F_i| > μ N_i`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum FootContact {
    /// It touches and sticks.
    Sticks,
    /// It touches and slides.
    Slides,
    /// It is lifted, and its support recovers.
    Lifted(Creep),
}

impl FootContact {
    /// Whether the foot touches.
    #[inline]
    pub fn touches(&self) -> bool {
        match self {
            FootContact::Sticks | FootContact::Slides => true,
            FootContact::Lifted(_) => false,
        }
    }
}

/// The forces of a foot that touches: `N_i = K (f_i − v_i) − C v̇_i` and, from the trial force `F_i = K_h e_i + C_h u̇_i`, `H_i = −F_i`
/// where it sticks and `H_i = −μ N_i F_i/|F_i|` where it slides.
///
/// A frictionless foot slides with its own velocity: its spring has no stretch.
#[derive(Clone, Copy, Debug)]
pub struct FootForces<T> {
    /// N (N), vertical.
    pub normal: T,
    /// The trial force F (N), horizontal.
    pub trial: [T; 2],
    /// |F| (N).
    pub trial_size: T,
    /// The force on the body (N).
    pub force: Vector3<T>,
    /// Rate of the stretch of its horizontal spring (m/s).
    pub stretch_rate: [T; 2],
    /// |w| (m/s), the slip velocity.
    pub slip_rate: T,
}

impl<T: Component> FootForces<T> {
    /// Returns the forces of a foot with this stretch (m) of its horizontal spring.
    #[inline(always)]
    pub fn of(
        body: &SpaceBody,
        foot: &SpaceFoot,
        contact: FootContact,
        motion: &FootMotion<T>,
        stretch: [T; 2],
    ) -> Self {
        let FootMotion { displacement, velocity, .. } = motion;
        let normal = -((displacement.z - foot.free_height) * body.stiffness + velocity.z * body.damping);
        let [e_x, e_y] = stretch;
        let trial = [
            e_x * body.horizontal_stiffness + velocity.x * body.horizontal_damping,
            e_y * body.horizontal_stiffness + velocity.y * body.horizontal_damping,
        ];
        let trial_size = size(trial);
        let sticking = FootForces {
            normal,
            trial,
            trial_size,
            force: Vector3::new(-trial[0], -trial[1], normal),
            stretch_rate: [velocity.x, velocity.y],
            slip_rate: T::from(0.0),
        };
        match contact {
            FootContact::Sticks | FootContact::Lifted(_) => sticking,
            FootContact::Slides => sticking.sliding(body),
        }
    }

    /// Returns these forces for a foot that slides.
    #[inline(always)]
    fn sliding(self, body: &SpaceBody) -> Self {
        let zero = T::from(0.0);
        if body.is_frictionless() {
            return FootForces {
                force: Vector3::new(zero, zero, self.normal),
                stretch_rate: [zero; 2],
                slip_rate: size(self.stretch_rate),
                ..self
            };
        }
        let limit = self.normal * body.friction;
        // A foot without a trial force has no direction of slip.
        let along =
            |component: T| T::select_less(zero.value(), self.trial_size.value(), component / self.trial_size, zero);
        let direction = self.trial.map(along);
        let slip_rate = (self.trial_size - limit) * (1.0 / body.horizontal_damping);
        let [u_x, u_y] = self.stretch_rate;
        FootForces {
            force: Vector3::new(-(limit * direction[0]), -(limit * direction[1]), self.normal),
            stretch_rate: [u_x - direction[0] * slip_rate, u_y - direction[1] * slip_rate],
            slip_rate,
            ..self
        }
    }
}

impl FootForces<f64> {
    /// Returns the contact of a foot that touches with these forces.
    pub fn contact(&self, body: &SpaceBody) -> FootContact {
        if body.is_frictionless() || self.trial_size > body.friction * self.normal {
            FootContact::Slides
        } else {
            FootContact::Sticks
        }
    }
}

/// Returns the length of a horizontal vector. That of zero has no derivative.
#[inline(always)]
fn size<T: Component>([x, y]: [T; 2]) -> T {
    let square = x * x + y * y;
    T::select_less(square.value(), f64::MIN_POSITIVE.into(), T::from(0.0), square.sqrt())
}

/// Returns the height of a lifted support's top above its foot's place at rest (m), and its rate (m/s).
pub fn support_height(body: &SpaceBody, foot: &SpaceFoot, creep: &Creep, time: f64) -> Dual {
    match creep.sunk(body.creep_rate(), time) {
        Some(sunk) => Dual::new(foot.free_height - sunk, body.creep_rate() * sunk),
        None => Dual::new(foot.free_height, 0.0),
    }
}
