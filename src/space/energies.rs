//! A state → its energy; and the balance of energy since the start.

use serde::Serialize;

use crate::space::body::SpaceBody;
use crate::space::forces::FootContact;
use crate::space::motion::{BodyMotion, Component, OMEGA, VELOCITY, dot, of_foot, three, works};

/// Energy that a block has (J).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StoredEnergy {
    /// Kinetic energy relative to the ground.
    pub kinetic: f64,
    /// Energy of the weight, zero at rest.
    pub weight: f64,
    /// Energy of the springs less that at rest.
    pub supports: f64,
}

impl StoredEnergy {
    /// Returns the sum.
    pub fn total(&self) -> f64 {
        self.kinetic + self.weight + self.supports
    }
}

/// Energies now, and their sums since the start (J).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SpaceEnergies {
    /// Energy now.
    pub stored: StoredEnergy,
    /// Work of the ground motion and the loads.
    pub input: f64,
    /// Energy taken by the dashpots, vertical and horizontal.
    pub dashpots: f64,
    /// Energy taken by friction.
    pub slip: f64,
    /// Energy of springs lost at lift-offs, less that of supports that had not recovered at landings.
    pub lift_off: f64,
    /// The balance: round-off and integration error.
    pub residual: f64,
}

/// Returns the energy of a state: kinetic, of the weight, of the springs.
pub(super) fn stored<T: Component>(body: &SpaceBody, state: &[T], contacts: &[FootContact]) -> [T; 3] {
    let motion = BodyMotion::of(state);
    let turning = motion.turn.rotate_back(&motion.omega);
    let kinetic = (dot(&motion.velocity, &motion.velocity) * body.mass
        + dot(&turning, &body.times_inertia(&body.inertia, &turning)))
        * 0.5;
    let mut supports = T::from(0.0);
    for (i, (foot, contact)) in body.feet.iter().zip(contacts).enumerate() {
        if foot.static_load > 0.0 {
            supports = supports - 0.5 * body.stiffness * foot.free_height * foot.free_height;
        }
        if contact.touches() {
            let depth = -motion.foot(&foot.place).displacement.z + foot.free_height;
            let [e_x, e_y] = [0, 1].map(|axis| state[of_foot(i) + axis]);
            let horizontal = (e_x * e_x + e_y * e_y) * body.horizontal_stiffness;
            supports += (depth * body.stiffness * depth + horizontal) * 0.5;
        }
    }
    [kinetic, motion.displacement.z * (body.mass * body.gravity), supports]
}

impl From<[f64; 3]> for StoredEnergy {
    fn from([kinetic, weight, supports]: [f64; 3]) -> StoredEnergy {
        StoredEnergy { kinetic, weight, supports }
    }
}

/// Returns the rates of all energies (W) from a state and its rates.
pub(super) fn energy_rates(body: &SpaceBody, state: &[f64], rates: &[f64], contacts: &[FootContact]) -> SpaceEnergies {
    let motion = BodyMotion::of(state);
    let [turning, accelerating] = [motion.omega, three(rates, OMEGA)].map(|v| motion.turn.rotate_back(&v));
    let velocity = three(rates, 0);
    let kinetic = body.mass * velocity.dot(&three(rates, VELOCITY)) + turning.dot(&(body.inertia * accelerating));
    let mut supports = 0.0;
    for (i, (foot, _)) in body.feet.iter().zip(contacts).enumerate().filter(|(_, (_, contact))| contact.touches()) {
        let at = motion.foot(&foot.place);
        let depth = foot.free_height - at.displacement.z;
        let stretches = [0, 1].map(|axis| state[of_foot(i) + axis] * rates[of_foot(i) + axis]);
        supports += body.horizontal_stiffness * (stretches[0] + stretches[1]) - body.stiffness * depth * at.velocity.z;
    }
    let stored = StoredEnergy { kinetic, weight: body.mass * body.gravity * velocity.z, supports };
    SpaceEnergies::changing(stored, works(rates, body.count()))
}

impl SpaceEnergies {
    /// Returns the change of all energies by that of the stored ones and of the works.
    pub(super) fn changing(stored: StoredEnergy, [input, dashpots, slip]: [f64; 3]) -> SpaceEnergies {
        let residual = stored.total() - input + dashpots + slip;
        SpaceEnergies { stored, input, dashpots, slip, lift_off: 0.0, residual }
    }
}
