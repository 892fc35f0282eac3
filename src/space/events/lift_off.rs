//! Lift-off: the vertical force of a foot falls through zero.
//!
//! Its horizontal force has come to zero with it, so that accelerations do not jump. The support begins to recover with the velocity of the foot.

use crate::block::Creep;
use crate::numerics::dual::Dual;
use crate::space::body::SpaceBody;
use crate::space::events::{FootChange, Poised, RoundOff, SpaceEventKind, SpaceSample};
use crate::space::forces::{FootContact, FootForces};
use crate::space::motion::{BodyMotion, of_foot};

/// Returns N (N).
pub(super) fn sample(body: &SpaceBody, forces: &FootForces<Dual>, round_off: RoundOff) -> SpaceSample {
    SpaceSample {
        value: forces.normal,
        rounding: body.stiffness * round_off.height + body.damping * round_off.velocity,
    }
}

/// Lifts a foot. The energy of its springs is lost.
pub(super) fn apply(at: &Poised, foot: usize) -> FootChange {
    let body = at.body;
    let height = BodyMotion::of(at.state).foot(&body.feet[foot].place).displacement.z;
    let depth = body.feet[foot].free_height - height;
    let [e_x, e_y] = [0, 1].map(|i| at.state[of_foot(foot) + i]);
    FootChange {
        contact: FootContact::Lifted(Creep { depth, since: at.time }),
        lost: 0.5 * (body.stiffness * depth * depth + body.horizontal_stiffness * (e_x * e_x + e_y * e_y)),
        events: [Some(SpaceEventKind::LiftOff(foot)), None],
    }
}
