//! Contacts and tolerance → the errors that a step may make, and the longest step.

use crate::numerics::control::LONGEST;
use crate::space::body::SpaceBody;
use crate::space::forces::FootContact;
use crate::space::motion::{DISPLACEMENT, FEET_FROM, OMEGA, QUATERNION, VELOCITY, moving, slip_of};

/// Limits of a step.
#[derive(Clone, Debug)]
pub(super) struct SpaceLimits {
    /// Reciprocals of the errors that a step may make in each number of the state but the lengths of slips, which have no effect.
    pub(super) weights: Vec<f64>,
    /// The longest step of a block that does not turn (s).
    pub(super) longest: f64,
}

/// Returns the circular frequency of the body on the feet that touch and the rates of decay (1/s), each with the number behind it.
fn rates(body: &SpaceBody, contacts: &[FootContact]) -> [(&'static str, f64); 4] {
    let touching = body.feet.iter().zip(contacts).filter(|(_, contact)| contact.touches());
    let slides = contacts.contains(&FootContact::Slides);
    let sum: f64 = touching.map(|(foot, _)| foot.frequency_square).sum();
    // The force of a foot that slides is inclined, in the direction of friction.
    let inclination = if slides { (1.0 + body.friction * body.friction).sqrt() } else { 1.0 };
    let square = sum.min(body.fastest_square) * inclination;
    // The dashpots' bound is that of the springs with the greater damping for the greater stiffness.
    let of_dashpot = |damping: f64| damping / body.greater_stiffness() * square;
    let (horizontal, relaxation) = if body.is_frictionless() {
        (0.0, 0.0)
    } else {
        let relaxation = body.horizontal_stiffness / body.horizontal_damping;
        (of_dashpot(body.horizontal_damping), if slides { relaxation } else { 0.0 })
    };
    [
        ("the stiffness of the feet", square.sqrt()),
        ("the vertical damping of the feet", of_dashpot(body.damping)),
        ("the horizontal damping of the feet", horizontal),
        ("the horizontal stiffness of feet that slide over their damping", relaxation),
    ]
}

/// Returns the number of the body that makes its motion fastest, and the circular frequency or rate of decay that it causes.
pub(super) fn fastest_number(body: &SpaceBody, contacts: &[FootContact]) -> String {
    let [first, others @ ..] = rates(body, contacts);
    let (name, rate) = others.into_iter().fold(first, |a, b| if b.1 > a.1 { b } else { a });
    if rate > 0.0 { format!("{name}, {rate:.1e} rad/s") } else { "the excitation".into() }
}

/// The largest rotation in a step (rad).
const MAX_TURN: f64 = 1.0;

impl SpaceLimits {
    /// Returns limits of a state of a block with n feet, to be set.
    pub(super) fn new(feet: usize) -> SpaceLimits {
        SpaceLimits { weights: vec![0.0; slip_of(0, feet)], longest: 0.0 }
    }

    /// Sets the limits under these contacts.
    ///
    /// As in the plane, an error counts as an equivalent velocity: a displacement times the greatest circular frequency of the body on the
    /// feet that touch. The allowed error is the tolerance times the velocity of rocking, R0 α p, vertically at most that which changes the
    /// forces together by 10 tolerances times the weight.
    pub(super) fn set(&mut self, body: &SpaceBody, contacts: &[FootContact], tolerance: f64, pulse_frequency: f64) {
        const OF_WEIGHT: f64 = 10.0;
        let [(_, frequency), rates @ ..] = rates(body, contacts);
        let frequency = frequency.max(body.p);
        let fastest = rates.into_iter().map(|(_, rate)| rate).fold(frequency, f64::max);
        self.longest = LONGEST / fastest.max(pulse_frequency);

        let rocking = body.alpha * body.p;
        let (turning, across) = (1.0 / (tolerance * rocking), 1.0 / (tolerance * body.r0 * rocking));
        let on_supports = OF_WEIGHT * body.gravity / (body.omega_v * (2.0 * body.xi_v).max(1.0));
        let most = if contacts.iter().any(FootContact::touches) {
            (body.r0 * rocking).min(on_supports)
        } else {
            body.r0 * rocking
        };
        let upright = 1.0 / (tolerance * most);
        let work = turning / (2.0 * body.mass * body.r0 * body.r0 * rocking);
        let weights = &mut self.weights;
        weights[DISPLACEMENT..QUATERNION].copy_from_slice(&[
            frequency * across,
            frequency * across,
            frequency * upright,
        ]);
        weights[QUATERNION..VELOCITY].fill(2.0 * frequency * turning);
        weights[VELOCITY..OMEGA].copy_from_slice(&[across, across, upright]);
        weights[OMEGA..FEET_FROM].fill(turning);
        let moving = moving(body.count());
        weights[FEET_FROM..moving].fill(frequency * across);
        weights[moving..].fill(work);
    }

    /// Returns the longest step (s) of a block with an angular velocity (rad/s).
    pub(super) fn longest(&self, omega: f64) -> f64 {
        self.longest.min(MAX_TURN / omega)
    }
}
