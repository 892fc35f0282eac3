//! Lift-off: the vertical force of a foot falls through zero.
//!
//! Its horizontal force has come to zero with it, so that accelerations do not jump. The support begins to recover with the velocity of the foot.

use crate::block::Creep;
use crate::numerics::dual::Dual;
use crate::space::body::SpaceBody;
use crate::space::events::{FootChange, RoundOff, SpaceEventKind};
use crate::space::forces::{FootContact, FootForces};
use crate::space::motion::{BodyMotion, of_foot};

/// Returns N (N) and its round-off.
pub(super) fn sample(body: &SpaceBody, forces: &FootForces<Dual>, round_off: RoundOff) -> (Dual, f64) {
    (forces.normal, body.stiffness * round_off.height + body.damping * round_off.velocity)
}

/// Lifts a foot. The energy of its springs is lost.
pub(super) fn apply(body: &SpaceBody, time: f64, state: &[f64], foot: usize) -> FootChange {
    let height = BodyMotion::of(state).foot(&body.feet[foot].place).displacement.z;
    let depth = body.feet[foot].free_height - height;
    let [e_x, e_y] = [0, 1].map(|i| state[of_foot(foot) + i]);
    FootChange {
        contact: FootContact::Lifted(Creep { depth, since: time }),
        lost: 0.5 * (body.stiffness * depth * depth + body.horizontal_stiffness * (e_x * e_x + e_y * e_y)),
        events: [Some(SpaceEventKind::LiftOff(foot)), None],
    }
}
