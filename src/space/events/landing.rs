//! Landing: the gap between a lifted foot and its support, which recovers, falls through zero.
//!
//! The foot lands on its dashpot: N = C (ẏ − v̇) > 0. Its horizontal spring begins without a stretch.

use crate::numerics::dual::Dual;
use crate::space::body::SpaceBody;
use crate::space::events::{FootChange, Poised, SpaceEventKind};
use crate::space::forces::{FootContact, FootForces, support_height};
use crate::space::motion::BodyMotion;

/// Returns the gap (m) and its round-off.
#[inline]
pub(super) fn sample(at: &Poised, foot: usize) -> (Dual, f64) {
    let height = at.motion.foot(&at.body.feet[foot].place).displacement.z;
    let top = match &at.contacts[foot] {
        FootContact::Lifted(creep) => support_height(at.body, &at.body.feet[foot], creep, at.time),
        FootContact::Sticks | FootContact::Slides => height,
    };
    (height - top, at.round_off.height)
}

/// Lets a foot touch. One that its support would pull at once is not taken in: its gap opens.
pub(super) fn apply(body: &SpaceBody, state: &[f64], foot: usize) -> Option<FootChange> {
    let place = &body.feet[foot];
    let motion = BodyMotion::of(state).foot(&place.place);
    let forces = FootForces::of(body, place, FootContact::Sticks, &motion, [0.0; 2]);
    if forces.normal <= 0.0 {
        return None;
    }
    let contact = forces.contact(body);
    let depth = place.free_height - motion.displacement.z;
    let slides = (contact == FootContact::Slides && !body.is_frictionless()).then_some(SpaceEventKind::Slides(foot));
    Some(FootChange {
        contact,
        lost: -0.5 * body.stiffness * depth * depth,
        events: [Some(SpaceEventKind::Landing(foot)), slides],
    })
}
