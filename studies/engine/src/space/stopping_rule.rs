//! A block in space after the ground has come to rest → the end of its run.
//!
//! As in the plane, a run without a given duration ends once the block has overturned, is at rest, or can no longer overturn: its energy is
//! below the least barrier. Dashpots and friction only take energy, so that the next cycle is the greatest; after it, and once the feet have
//! nearly ceased to slip, the peaks are known. A free motion is followed until the block is at rest.

use std::f64::consts::TAU;

use rocking_block::space::{SpaceBody, SpaceInputs, SpaceRun};

/// Fraction of the barrier that the energy must stay below. The margin covers the energy that supports give back at landings.
const BELOW_THE_BARRIER: f64 = 0.95;

/// Longest time after the ground has come to rest, in 1/p: until the outcome is known, and until a block in free motion is at rest.
const MAX_TIMES: [u64; 2] = [200, 1000];

/// Kinetic energy of a block at rest over the energy that lifts a foot, and accelerations over g: 1 % of the rotation of lift-off.
const AT_REST: [f64; 2] = [1e-4, 1e-2];

/// Slip between two checks (R0) below which the feet have nearly ceased to slip.
const SLIP: f64 = 1e-4;

/// Returns the barrier against overturning (J), over the nearest edge with all the weight on one foot: a lower bound.
///
/// At the balance over m feet the energy is `M g (R − h) − M g (δ_m − δ)/2`, with the deflections `δ_m = M g/(m K)` there and δ at rest. `None` on
/// supports so soft that feet on the other side may still touch there.
fn barrier(body: &SpaceBody) -> Option<f64> {
    let (edge, h) = (body.edge_distance, body.center_height);
    let radius = libm::hypot(edge, h);
    let weight = body.mass * body.gravity;
    let (sunk, at_rest) = (weight / body.stiffness, body.gravity / (body.omega_v * body.omega_v));
    let barrier = weight * (radius - h) - 0.5 * weight * (sunk - at_rest);
    (barrier > 0.0 && edge * edge / radius >= sunk).then_some(barrier)
}

/// Energy over the barrier, for a block that will not overturn without further excitation.
fn fraction_of_barrier(run: &SpaceRun) -> Option<f64> {
    let body = run.body();
    let barrier = barrier(body)?;
    let tilt = run.observe(&still(run)).attitude.tilt;
    let fraction = run.energies().stored.total() / barrier;
    (tilt < body.edge_angle && fraction < BELOW_THE_BARRIER).then_some(fraction.max(0.0))
}

/// Whether a block stands for good without further excitation.
pub fn stands(run: &SpaceRun) -> bool {
    is_at_rest(run) || fraction_of_barrier(run).is_some()
}

/// Whether a block is at rest: it stands on all feet without gaps, none of them slides, and it has no velocity or acceleration.
pub fn is_at_rest(run: &SpaceRun) -> bool {
    let body = run.body();
    let seen = run.observe(&still(run));
    let stands = body.feet.iter().zip(&seen.feet).all(|(foot, seen)| foot.static_load == 0.0 || seen.touches);
    let lifting = 0.25 * body.mass * body.gravity * body.gravity / (body.omega_v * body.omega_v);
    let [kinetic, acceleration] = AT_REST;
    stands
        && seen.sliding() == 0
        && run.energies().stored.kinetic <= kinetic * lifting
        && seen.acceleration.norm() <= acceleration * body.gravity
}

/// No motion of the ground.
fn still(run: &SpaceRun) -> SpaceInputs {
    SpaceInputs { time: run.time(), ..SpaceInputs::default() }
}

/// Returns a bound of the rocking period (s) at a fraction of the barrier: Housner's over the slowest edge or corner, and that on all feet.
fn cycle(body: &SpaceBody, fraction: f64) -> f64 {
    let (edge, h, gravity) = (body.edge_distance, body.center_height, body.gravity);
    // No moment of inertia exceeds the sum of the others.
    let gyration = 0.5 * (0..3).map(|i| body.inertia[(i, i)]).sum::<f64>() / body.mass;
    let slowest =
        [libm::hypot(edge, h), body.reach].map(|radius| (gravity * radius / (gyration + radius * radius)).sqrt());
    let rocking = 4.0 / slowest[0].min(slowest[1]) * libm::acosh(1.0 / (1.0 - fraction).sqrt());
    // The sum of the squares of the feet's distances from any axis is at least half of that of a circle within the base.
    let stiffness = 0.5 * body.omega_v * body.omega_v * edge * edge - gravity * h;
    if stiffness > 0.0 { rocking + TAU * ((gyration + h * h) / stiffness).sqrt() } else { rocking }
}

/// Checks a block every 1/p after the ground's rest, until its run is over.
#[derive(Clone, Copy, Debug)]
pub struct SpaceStoppingRule {
    ground_at_rest: f64,
    p: f64,
    /// Whether the run continues until the block is at rest.
    until_rest: bool,
    /// Number of checks so far.
    checks: u64,
    /// The first check at which the outcome and the peaks are known.
    earliest: Option<u64>,
    /// The greatest slip of a foot at the last check (m).
    slip: f64,
    /// Time of the last check (s), if the run is over then.
    over: Option<f64>,
}

impl SpaceStoppingRule {
    /// Starts the rule for a ground that comes to rest at this time (s).
    pub fn new(body: &SpaceBody, ground_at_rest: f64, until_rest: bool) -> SpaceStoppingRule {
        SpaceStoppingRule { ground_at_rest, p: body.p, until_rest, checks: 0, earliest: None, slip: 0.0, over: None }
    }

    /// Time of the next check (s), at which the run has to stop.
    pub fn next_check(&self) -> f64 {
        self.ground_at_rest + self.checks as f64 / self.p
    }

    /// Time at which the run is over (s), the latest possible one while unknown.
    pub fn end(&self) -> f64 {
        let longest = MAX_TIMES[usize::from(self.until_rest)];
        self.over.unwrap_or(self.ground_at_rest + longest as f64 / self.p)
    }

    /// Checks the block, at the time of the next check.
    pub fn check(&mut self, run: &SpaceRun) {
        let slip = run.peaks().slip;
        let slips = slip - self.slip > SLIP * run.body().r0;
        self.slip = slip;
        let rests = is_at_rest(run);
        if let (true, Some(fraction)) = (self.earliest.is_none() || slips, fraction_of_barrier(run)) {
            let further = (cycle(run.body(), fraction) * self.p).ceil() as u64;
            self.earliest = Some(self.checks + further.max(1));
        }
        let is_known = self.earliest.is_some_and(|earliest| self.checks >= earliest);
        if rests || is_known && !self.until_rest {
            self.over = Some(run.time());
        }
        self.checks += 1;
    }
}
