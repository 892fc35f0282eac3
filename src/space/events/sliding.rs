//! Slides and sticks: the trial force |F| of a foot exceeds μ N, or no longer does. Forces are continuous: it is a kink.

use crate::numerics::dual::Dual;
use crate::space::events::{FootChange, Poised, SpaceEventKind};
use crate::space::forces::{FootContact, FootForces};
use crate::space::motion::of_foot;

/// Returns μ N − |F| (N) and its round-off.
pub(super) fn room(at: &Poised, foot: usize, forces: &FootForces<Dual>) -> (Dual, f64) {
    let &Poised { body, round_off, .. } = at;
    let [x, y] = forces.trial;
    let size = if forces.trial_size.re > 0.0 {
        forces.trial_size
    } else {
        // From zero it grows in any direction.
        Dual::new(0.0, (x.eps * x.eps + y.eps * y.eps).sqrt())
    };
    let stretch = at.state[of_foot(foot)].abs() + at.state[of_foot(foot) + 1].abs();
    let of_normal = body.stiffness * round_off.height + body.damping * round_off.velocity;
    let of_trial = body.horizontal_stiffness * stretch * f64::EPSILON + body.horizontal_damping * round_off.velocity;
    (forces.normal * body.friction - size, body.friction * of_normal + of_trial)
}

/// Lets a foot slide.
pub(super) fn slides(foot: usize) -> FootChange {
    FootChange { contact: FootContact::Slides, lost: 0.0, events: [Some(SpaceEventKind::Slides(foot)), None] }
}

/// Lets a foot stick.
pub(super) fn sticks(foot: usize) -> FootChange {
    FootChange { contact: FootContact::Sticks, lost: 0.0, events: [Some(SpaceEventKind::Sticks(foot)), None] }
}
