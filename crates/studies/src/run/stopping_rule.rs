//! A block after the ground has come to rest → the time at which its run is over.
//!
//! A run without a given duration ends once the ground has come to rest and the block has come down: it has overturned (or
//! separated, where that ends the run), or it is at rest, or it will come to rest. A block with |θ| < α will come to rest if its
//! energy is below the barrier `V(α)` against overturning. Without excitation the energy decreases, so that the next cycle of
//! motion is the greatest; after it, the outcome and the peaks are known. A free motion is followed until the block is at rest.

use std::f64::consts::TAU;

use rocking_block::block::Regime;
use rocking_block::block::{Block, Foundation};
use rocking_block::simulation::Simulation;

/// Fraction of the barrier that the energy must stay below.
///
/// The margin covers the energy that a lift-off adds until the next landing: 0.1 % at η = 40, 2 % at η = 10
/// (docs/lift_off.md).
const BELOW_THE_BARRIER: f64 = 0.95;

/// Longest time after the ground has come to rest, in 1/p, which blocks without energy loss reach.
///
/// Approaching the unstable equilibrium to 1e-10 α takes 24/p, and leaving it as long.
const MAX_TIME: u64 = 100;

/// The same for free motion of a block that loses energy: a slender one rocks for long.
const MAX_DECAY: u64 = 1000;

/// Fraction of the lift-off energy below which a block on supports is at rest: 1 % of the lift-off rotation.
const AT_REST: f64 = 1e-4;

/// Barrier against overturning per unit mass (m²/s²): the least potential energy at |θ| = α, relative to rest.
///
/// On the rigid base `g R0 (1 − cos α)`; on supports less by `g δ_s/2`, since the support that carries all the weight sinks by a
/// further δ_s. On supports so soft that both touch at |θ| = α, the energy of both springs and of the lowered weight.
pub fn overturning_barrier(block: &Block) -> f64 {
    let Block { gravity, r0, b, h, omega_v, .. } = *block;
    let (sin, cos) = (b / r0, h / r0);
    let rigid = gravity * (r0 - h);
    let sunk = block.static_deflection();
    match block.foundation {
        Foundation::Rigid => rigid,
        Foundation::Viscoelastic if b * sin >= sunk => rigid - 0.5 * gravity * sunk,
        Foundation::Viscoelastic => sin * sin * (0.5 * omega_v * omega_v * b * b - gravity * h / (1.0 + cos)),
    }
}

/// Longest rocking period (s) at an energy of `fraction` times the barrier, 0 ≤ fraction < 1.
///
/// On the rigid base `(4/p) arcosh(1/√(1 − fraction))` (Housner 1963, in terms of the energy); supports add the period of rocking
/// in full contact.
fn cycle(block: &Block, fraction: f64) -> f64 {
    let Block { b, h, i0, p, gravity, omega_v, .. } = *block;
    let rocking = 4.0 / p * libm::acosh(1.0 / (1.0 - fraction).sqrt());
    let stiffness = omega_v * omega_v * b * b - gravity * h;
    match block.foundation {
        Foundation::Viscoelastic if stiffness > 0.0 => rocking + TAU * ((i0 + h * h) / stiffness).sqrt(),
        Foundation::Viscoelastic | Foundation::Rigid => rocking,
    }
}

/// Checks a block every 1/p after the ground has come to rest, and decides when its run is over.
#[derive(Clone, Copy, Debug)]
pub struct StoppingRule {
    /// Time from which the ground is at rest (s).
    ground_at_rest: f64,
    /// Whether the run continues until the block is at rest.
    until_rest: bool,
    /// Number of checks so far.
    checks: u64,
    /// The first check at which the outcome and the peaks are known.
    earliest: Option<u64>,
    /// Whether the last check found the block at rest after that.
    is_over: bool,
}

impl StoppingRule {
    /// Starts the rule for a ground that comes to rest at this time (s).
    ///
    /// The run continues `until_rest`, or until its outcome is known.
    pub fn new(ground_at_rest: f64, until_rest: bool) -> StoppingRule {
        StoppingRule { ground_at_rest, until_rest, checks: 0, earliest: None, is_over: false }
    }

    fn time_of(&self, block: &Block, check: u64) -> f64 {
        self.ground_at_rest + check as f64 / block.p
    }

    /// Time of the next check (s), at which the run has to stop.
    pub fn next_check(&self, block: &Block) -> f64 {
        self.time_of(block, self.checks)
    }

    /// Time at which the run is over (s); the latest possible time while it is unknown.
    pub fn end(&self, block: &Block) -> f64 {
        let longest = if self.until_rest && loses_energy(block) { MAX_DECAY } else { MAX_TIME };
        let last = match self.earliest {
            Some(_) if self.is_over => self.checks - 1,
            Some(earliest) if !self.until_rest => earliest,
            _ => longest,
        };
        self.time_of(block, last.min(longest))
    }

    /// Checks the block, at the time of the next check.
    pub fn check(&mut self, simulation: &Simulation) {
        let block = simulation.block();
        if let (None, Some(fraction)) = (self.earliest, fraction_of_barrier(simulation)) {
            let further = (cycle(block, fraction) * block.p).ceil();
            self.earliest = Some(self.checks + further as u64);
        }
        let is_known = self.earliest.is_some_and(|earliest| self.checks >= earliest);
        self.is_over = self.until_rest && is_known && is_at_rest(simulation);
        self.checks += 1;
    }
}

/// Energy as a fraction of the barrier, for a block that will come to rest without further excitation.
///
/// Nothing for a block that may overturn.
pub fn fraction_of_barrier(simulation: &Simulation) -> Option<f64> {
    let block = simulation.block();
    let barrier = overturning_barrier(block);
    let fraction = simulation.energies().total / (block.mass * barrier);
    let inside = simulation.state()[0].abs() < block.alpha && barrier > 0.0;
    (inside && fraction < BELOW_THE_BARRIER).then_some(fraction.max(0.0))
}

/// Whether a block is at rest: on both corners, with too little energy to lift one without excitation.
pub fn is_at_rest(simulation: &Simulation) -> bool {
    let block = simulation.block();
    let quiet = match block.foundation {
        Foundation::Rigid => true,
        Foundation::Viscoelastic => {
            // A corner lifts at a deflection of δ_s from equilibrium: ½ K δ_s² = M g δ_s/4.
            let lifting = 0.25 * block.mass * block.gravity * block.static_deflection();
            simulation.energies().total <= AT_REST * lifting
        }
    };
    simulation.regime() == Regime::FullContact && quiet
}

/// Whether dashpots, or impacts on the rigid base, dissipate energy.
pub fn loses_energy(block: &Block) -> bool {
    match block.foundation {
        Foundation::Rigid => block.restitution() < 1.0,
        Foundation::Viscoelastic => block.damping > 0.0,
    }
}
