//! A state, the contacts of the feet and the excitation → the rates of the state, in one pass over the feet.
//!
//! ```text
//! M V̇ = Σ (H_i, N_i) − M g e_z − M a_g + F,     J ω̇ = −ω × J ω + Σ r_i × (H_i, N_i) + M_load,     q̇ = ½ (0, ω) q
//! ```

use nalgebra::Vector3;

use crate::numerics::dual::Dual;
use crate::numerics::scalar::CombinesWith;
use crate::numerics::stepper::SliceEquations;
use crate::space::body::SpaceBody;
use crate::space::excitation::{SpaceExcitation, SpaceForcing};
use crate::space::forces::{FootContact, FootForces};
use crate::space::motion::{
    BodyMotion, Component, DISPLACEMENT, FEET_FROM, OMEGA, PER_FOOT, QUATERNION, VELOCITY, WORKS, dot, moving, three,
};

/// The equations of motion under given contacts.
#[derive(Clone, Copy, Debug)]
pub struct SpaceEquations<'a> {
    /// The block.
    pub body: &'a SpaceBody,
    /// The contacts of its feet.
    pub contacts: &'a [FootContact],
    /// The excitation.
    pub excitation: &'a SpaceExcitation,
}

/// Writes three numbers of the state.
#[inline(always)]
fn put<T: Component>(state: &mut [T], from: usize, v: Vector3<T>) {
    (state[from], state[from + 1], state[from + 2]) = (v.x, v.y, v.z);
}

impl SpaceEquations<'_> {
    /// Writes the rates of a state at a time (s). Both have the numbers of a state of this block.
    pub fn rates<T: Component + CombinesWith<f64>>(&self, time: T, state: &[T], rates: &mut [T]) {
        self.rates_under(&self.excitation.at(time), state, rates);
    }

    /// Writes the rates of a state under this forcing.
    #[inline(always)]
    pub fn rates_under<T: Component>(&self, forcing: &SpaceForcing<T>, state: &[T], rates: &mut [T]) {
        let body = self.body;
        let (state, stretches) = state.split_first_chunk::<FEET_FROM>().expect("the numbers of the body");
        let (moving, sums) = rates.split_at_mut(moving(body.count()));
        let (of_body, of_feet) = moving.split_first_chunk_mut::<FEET_FROM>().expect("the numbers of the body");
        let (works, slips) = sums.split_first_chunk_mut::<WORKS>().expect("the works");
        let motion = BodyMotion::of(state);
        let BodyMotion { turn, velocity, omega, .. } = motion;
        let zero = T::from(0.0);
        let (mut force, mut moment) = (Vector3::repeat(zero), forcing.moment);
        let (mut dashpots, mut slip) = (zero, zero);
        let feet = body.feet.iter().zip(self.contacts).zip(slips);
        let stretches = stretches.as_chunks::<PER_FOOT>().0.iter().zip(of_feet.as_chunks_mut::<PER_FOOT>().0);
        for (((foot, &contact), slip_rate), (&stretch, stretch_rate)) in feet.zip(stretches) {
            if !contact.touches() {
                (*stretch_rate, *slip_rate) = ([zero; PER_FOOT], zero);
                continue;
            }
            let at = motion.foot(&foot.place);
            let forces = FootForces::of(body, foot, contact, &at, stretch);
            force += forces.force;
            moment += at.arm.cross(&forces.force);
            let [x, y] = forces.stretch_rate;
            dashpots += at.velocity.z * at.velocity.z * body.damping + (x * x + y * y) * body.horizontal_damping;
            slip += forces.normal * forces.slip_rate * body.friction;
            (*stretch_rate, *slip_rate) = (forces.stretch_rate, forces.slip_rate);
        }
        let acceleration = force * T::from(1.0 / body.mass) - forcing.acceleration;
        let acceleration = Vector3::new(acceleration.x, acceleration.y, acceleration.z - body.gravity);
        // In body axes the inertia is constant.
        let turning = turn.rotate_back(&omega);
        let gyroscopic = turning.cross(&body.times_inertia(&body.inertia, &turning));
        let turned = body.times_inertia(&body.inverse_inertia, &(turn.rotate_back(&moment) - gyroscopic));
        put(of_body, DISPLACEMENT, velocity);
        let (real, imaginary) = (state[QUATERNION], three(state, QUATERNION + 1));
        of_body[QUATERNION] = dot(&omega, &imaginary) * -0.5;
        put(of_body, QUATERNION + 1, (omega * real + omega.cross(&imaginary)) * T::from(0.5));
        put(of_body, VELOCITY, acceleration);
        put(of_body, OMEGA, turn.rotate(&turned));
        let input = dot(&forcing.moment, &omega) - dot(&forcing.acceleration, &velocity) * body.mass;
        *works = [input, dashpots, slip];
    }
}

impl SliceEquations for SpaceEquations<'_> {
    #[inline(never)]
    fn write_rates(&self, time: f64, state: &[f64], rates: &mut [f64]) {
        self.rates(time, state, rates);
    }
}

/// Writes a state with its rates in the dual parts.
pub fn with_rates(state: &[f64], rates: &[f64], duals: &mut [Dual]) {
    for ((dual, &re), &eps) in duals.iter_mut().zip(state).zip(rates) {
        *dual = Dual::new(re, eps);
    }
}
