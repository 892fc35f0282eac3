//! A state → its energy; and the balance of energy since the start.

use serde::Serialize;

use crate::space::body::SpaceBody;
use crate::space::forces::FootContact;
use crate::space::motion::{BodyMotion, OMEGA, VELOCITY, WORKS, of_foot, three};

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

/// Returns the energy of a state.
pub(super) fn stored(body: &SpaceBody, state: &[f64], contacts: &[FootContact]) -> StoredEnergy {
    let motion = BodyMotion::of(state);
    let turning = motion.turn.rotate_back(&motion.omega);
    let kinetic = 0.5 * (body.mass * motion.velocity.norm_squared() + turning.dot(&(body.inertia * turning)));
    let mut supports = 0.0;
    for (i, (foot, contact)) in body.feet.iter().zip(contacts).enumerate() {
        if foot.static_load > 0.0 {
            supports -= 0.5 * body.stiffness * foot.free_height * foot.free_height;
        }
        if contact.touches() {
            let depth = foot.free_height - motion.foot(&foot.place).displacement.z;
            let [e_x, e_y] = [0, 1].map(|axis| state[of_foot(i) + axis]);
            supports += 0.5 * (body.stiffness * depth * depth + body.horizontal_stiffness * (e_x * e_x + e_y * e_y));
        }
    }
    StoredEnergy { kinetic, weight: body.mass * body.gravity * motion.displacement.z, supports }
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
    let [input, dashpots, slip] = [0, 1, 2].map(|i| rates[WORKS + i]);
    SpaceEnergies { stored, input, dashpots, slip, lift_off: 0.0, residual: stored.total() - input + dashpots + slip }
}
