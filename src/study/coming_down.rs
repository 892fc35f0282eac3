//! A block after the ground has come to rest → the time from which nothing more can happen to it.
//!
//! A run without a given duration goes on until the ground has come to rest and the block has come down: it has overturned
//! (or separated, where that ends the run), or it has come to rest, or it is bound to. Bound to come to rest is a block
//! with |θ| < α whose energy is below the barrier `V(α)` that it would have to climb to overturn. Without excitation a
//! block loses energy, so that no later cycle of its motion is greater than the one that follows; after that cycle the
//! outcome and the peaks are known.

use std::f64::consts::TAU;

use crate::block::{Block, Foundation};
use crate::simulation::Simulation;

/// The part of the barrier that the energy has to stay below. What is left to 1 makes up for the energy that a lift-off
/// adds before the next landing takes it back: 0.1 % of it at η = 40, 2 % at η = 10 (docs/lift_off.md).
const BELOW_THE_BARRIER: f64 = 0.95;

/// Longest time after the ground has come to rest, in 1/p: reached by blocks that lose no energy. To rise to within
/// 1e-10 α of the unstable equilibrium takes 24/p, to leave it as much.
const LONGEST: f64 = 100.0;

/// Height of the barrier against overturning, per unit mass (m²/s²): the least potential energy at |θ| = α, where that
/// at rest is zero.
///
/// On the rigid base `g R0 (1 − cos α)`; on supports less by `g δ_s/2`, since the one that carries the weight alone sinks by
/// δ_s. On supports so soft that both touch at |θ| = α, the energy of both springs and the sunken weight.
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

/// Longest period of a block that rocks with the energy `part` times the barrier, 0 ≤ part < 1 (s): that of rocking on
/// the rigid base, `(4/p) arcosh(1/√(1 − part))` (Housner 1963, in terms of the energy), and on supports that of rocking in
/// full contact on top.
fn cycle(block: &Block, part: f64) -> f64 {
    let Block { b, h, i0, p, gravity, omega_v, .. } = *block;
    let rocking = 4.0 / p * libm::acosh(1.0 / (1.0 - part).sqrt());
    let stiffness = omega_v * omega_v * b * b - gravity * h;
    match block.foundation {
        Foundation::Viscoelastic if stiffness > 0.0 => rocking + TAU * ((i0 + h * h) / stiffness).sqrt(),
        Foundation::Viscoelastic | Foundation::Rigid => rocking,
    }
}

/// Looks at a block every 1/p from when the ground has come to rest, and says when its run is over.
#[derive(Clone, Copy, Debug)]
pub struct ComingDown {
    /// Time from which the ground is at rest (s).
    ground_at_rest: f64,
    /// Looks that were taken.
    looks: u64,
    /// The look at which the run is over, once it is known.
    last: Option<u64>,
}

impl ComingDown {
    /// For a run in which the ground comes to rest at this time (s).
    pub fn new(ground_at_rest: f64) -> ComingDown {
        ComingDown { ground_at_rest, looks: 0, last: None }
    }

    fn time_of(&self, block: &Block, look: u64) -> f64 {
        self.ground_at_rest + look as f64 / block.p
    }

    /// Time of the next look (s), at which the run has to stop.
    pub fn next_look(&self, block: &Block) -> f64 {
        self.time_of(block, self.looks)
    }

    /// Time at which the run is over (s); as long as it is not known, the latest.
    pub fn end(&self, block: &Block) -> f64 {
        self.time_of(block, self.last.unwrap_or(LONGEST as u64))
    }

    /// Looks at the block, at the time of the next look.
    pub fn look(&mut self, simulation: &Simulation) {
        let block = simulation.block();
        if let (None, Some(part)) = (self.last, part_of_barrier(simulation)) {
            let further = (cycle(block, part) * block.p).ceil();
            self.last = Some((self.looks + further as u64).min(LONGEST as u64));
        }
        self.looks += 1;
    }
}

/// The part of the barrier that the energy of a block reaches which, without further excitation, is bound to come to rest;
/// nothing for a block that may overturn.
pub fn part_of_barrier(simulation: &Simulation) -> Option<f64> {
    let block = simulation.block();
    let barrier = overturning_barrier(block);
    let part = simulation.energies().total / (block.mass * barrier);
    let inside = simulation.state()[0].abs() < block.alpha && barrier > 0.0;
    (inside && part < BELOW_THE_BARRIER).then_some(part.max(0.0))
}
