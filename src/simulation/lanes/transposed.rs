//! A run on supports → the numbers that its steps in lanes read.

use crate::block::{Body, Contact, Corner, Creep};
use crate::excitation::Ramp;
use crate::numerics::wide::Four;
use crate::simulation::Simulation;
use crate::simulation::lanes::Stance;
use crate::simulation::limits::Limits;
use crate::simulation::state::RunState;
use crate::system::events::EventFunction;
use crate::system::instant::Footing;

/// The numbers of a run that steps on supports read.
///
/// In groups of four: a transposition of the same group of several runs gives four vectors.
#[derive(Clone, Copy, Debug, Default)]
pub struct TransposedInputs {
    /// The body, and the displacement of its foot. Mass (kg), gravity (m/s²), R0 and b (m); h (m), ω_v (rad/s), ξ_v (1), I0 (m²);
    /// eccentricity (m), fractions of the weight on both corners (1), displacement (m).
    pub body: [Four; 3],
    /// Limits of a step, and p. Weight of the works, fraction of the error of a short step in this regime (1), round-off of the zero of a
    /// gap (m), p (rad/s).
    pub limits: Four,
    /// The support of the lifted corner. Depth (m), beginning (s) and rate (1/s) of its creep, its free height (m). Zeros stand for a creep
    /// that has ended.
    pub lifted: Four,
    /// Works of the excitation and the dashpots (m²/s²), peak of the friction demand (1). The fourth number is unused.
    pub sums: Four,
    /// Peaks of θ (rad), N, H (N) and uplift (m).
    pub peaks: Four,
    /// The ground accelerations. Their reference time (s), the horizontal one (m/s²), its rate (m/s³), and the vertical one (m/s²).
    pub ground: Four,
    /// The rate of the vertical ground acceleration (m/s³).
    pub vertical_rate: f64,
    /// Beginning, end, size and greatest size (s) of the step that comes next.
    pub step: Four,
}

impl TransposedInputs {
    /// Reads the numbers that only events and steps of single runs change.
    pub fn read(&mut self, simulation: &Simulation, limits: &[Limits; 3]) {
        let RunState { pose, sums, peaks, .. } = &simulation.run;
        let block = simulation.block();
        let Body { mass, gravity, r0, b, h, p, omega_v, xi_v, i0, eccentricity, weight_fraction, .. } = block.body;
        let (Footing::Grips { offset } | Footing::Free { u: offset, .. } | Footing::Slides { u: offset, .. }) =
            pose.footing;
        let [left, right] = weight_fraction;
        self.body = [[mass, gravity, r0, b], [h, omega_v, xi_v, i0], [eccentricity, left, right, offset]];
        let Limits { work_weight, short_fraction, .. } =
            limits[Stance::of(pose.contacts.regime()).map_or(0, Stance::index)];
        self.limits = [work_weight, short_fraction, EventFunction::Gap(Corner::Left).rounding(block), p];
        // The support under a corner that touches is not read.
        let corner = if pose.contacts.touches(Corner::Left) { Corner::Right } else { Corner::Left };
        let (rate, free_height) = (block.creep_rate, block.free_height(corner));
        self.lifted = match pose.contacts.of(corner) {
            Contact::Lifted(Creep { depth, since }) if depth != 0.0 && rate.is_finite() => {
                [depth, since, rate, free_height]
            }
            // A recovered support.
            _ => [0.0, 0.0, 0.0, free_height],
        };
        self.sums = [sums.input, sums.dashpots, peaks.friction_demand, 0.0];
        self.peaks = [peaks.theta, peaks.reaction, peaks.horizontal, peaks.uplift];
    }

    #[inline(always)]
    pub fn set_ground(&mut self, time: f64, [x, z]: [Ramp; 2]) {
        (self.ground, self.vertical_rate) = ([time, x.value, x.rate, z.value], z.rate);
    }
}
