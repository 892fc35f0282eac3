//! A mode of motion and a tolerance → the errors that a step may make, and the longest step.

use crate::block::{Block, Body, Foundation, Regime, restraints};
use crate::numerics::control::LONGEST;
use crate::system::instant::State;
use crate::system::motion_mode::MotionMode;

/// Limits of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits<const N: usize = 4> {
    /// Reciprocals of the errors that a step may make in each component of the state.
    pub(super) weights: State<f64, N>,
    /// The reciprocal of the error that a step may make in each of the works.
    pub(super) work_weight: f64,
    /// The longest step (s).
    pub(super) longest: f64,
    /// The error of a short step over that of other steps (1).
    pub(super) short_fraction: f64,
}

/// Error of a short step over that of other steps, in motion and works.
///
/// Frequent stops, as under a record, add up the errors of more steps than the motion needs. A loose tolerance lifts this limit.
const SHORT_FRACTION: f64 = 0.1;

/// Tolerance from which on a short step may make the error of any other step.
const LOOSE: f64 = 1e-6;

impl<const N: usize> Limits<N> {
    /// Limits of a step.
    ///
    /// An error counts as an equivalent velocity: a displacement times the circular frequency of its motion, a vertical one
    /// divided by R0. The allowed error is the tolerance times the velocity of rocking, α p. An error of the vertical
    /// velocity also changes a reaction by at most some 5 tolerances times the weight, which is stricter on stiff supports. A step is at
    /// most a third of the shortest period, so that it has at most one extremum.
    #[inline(always)]
    pub(super) fn of(block: &Block, tolerance: f64, mode: impl MotionMode, pulse_frequency: f64) -> Limits<N> {
        let alpha = block.alpha;
        let Body { p, b, h, i0, r0, omega_v, xi_v, gravity, eccentricity, friction, .. } = block.body;
        const OF_WEIGHT: f64 = 10.0;
        // A block whose foot slides turns about its centre of mass, and friction adds to the moment.
        let arm = b + eccentricity.abs() + if mode.grips() { 0.0 } else { friction * h };
        let turning = if mode.grips() { arm * arm / (i0 + h * h) } else { arm * arm / i0 };
        let (rocking, vertical) = match (mode.foundation(), mode.regime()) {
            (Foundation::Rigid, _) | (_, Regime::Separated) => (p, p),
            (_, Regime::FullContact) => (p.max(omega_v * turning.sqrt()), omega_v),
            (_, Regime::TiltingLeft | Regime::TiltingRight) => (p, omega_v * (0.5 * (1.0 + turning)).sqrt()),
        };
        // The greatest rate at which damped motion dies away.
        let decay = match (mode.foundation(), mode.regime()) {
            (Foundation::Rigid, _) | (_, Regime::Separated) => 0.0,
            (_, Regime::FullContact) => 2.0 * xi_v * omega_v * turning.max(1.0),
            (_, Regime::TiltingLeft | Regime::TiltingRight) => xi_v * omega_v * (1.0 + turning),
        };
        let allowed = 1.0 / (tolerance * alpha * p);
        let most = match mode.foundation() {
            Foundation::Rigid => r0 * alpha * p,
            // The reaction of one support changes by ω_v ẇ/2 or ξ_v ω_v ẇ, whichever is more, per mass.
            Foundation::Viscoelastic => (r0 * alpha * p).min(OF_WEIGHT * gravity / (omega_v * (2.0 * xi_v).max(1.0))),
        };
        let upright = 1.0 / (tolerance * most);
        let across = 1.0 / (tolerance * r0 * alpha * p);
        // The energy of a block that rocks with the velocity of the other weights.
        let work_weight = allowed / ((i0 + r0 * r0) * alpha * p);
        let of_motion = [rocking * allowed, allowed, vertical * upright, upright, p * across, across];
        let weights = State::from(std::array::from_fn(|i| *of_motion.get(i).unwrap_or(&work_weight)));
        let restrained = if mode.integrates_u() { restraints::fastest(block) } else { 0.0 };
        let longest = LONGEST / rocking.max(vertical).max(decay).max(pulse_frequency).max(restrained);
        Limits { weights, work_weight, longest, short_fraction: if tolerance >= LOOSE { 1.0 } else { SHORT_FRACTION } }
    }
}

/// Returns the number of the block that makes its motion fastest, and the circular frequency or decay rate that comes of it.
pub(super) fn fastest_number(block: &Block) -> String {
    let Body { i0, b, h, omega_v, xi_v, foundation, .. } = block.body;
    let mut numbers = restraints::rates(block);
    if foundation == Foundation::Viscoelastic {
        let turning = 1.0 + (b * b + h * h) / i0;
        numbers.push(("the stiffness of the supports".into(), omega_v * turning.sqrt()));
        numbers.push(("the damping of the supports".into(), 2.0 * xi_v * omega_v * turning));
    }
    let fastest = numbers.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    fastest.map_or_else(|| "the excitation".into(), |(name, rate): (String, f64)| format!("{name}, {rate:.1e} rad/s"))
}
