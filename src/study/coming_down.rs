//! A block after the ground has come to rest → the time from which nothing more can happen to it.
//!
//! A run without a given duration goes on until the ground has come to rest and the block has come down: it has overturned
//! (or separated, where that ends the run), or it has come to rest, or it is bound to. Bound to come to rest is a block
//! with |θ| < α whose energy is below the barrier `V(α)` that it would have to climb to overturn. Without excitation a
//! block loses energy, so that no later cycle of its motion is greater than the one that follows; after that cycle the
//! outcome and the peaks are known. Free motion, in which nothing but that decay happens, is followed until the block is at
//! rest.

use std::f64::consts::TAU;

use crate::block::{Block, Foundation};
use crate::contact::Regime;
use crate::simulation::Simulation;

/// The part of the barrier that the energy has to stay below. What is left to 1 makes up for the energy that a lift-off
/// adds before the next landing takes it back: 0.1 % of it at η = 40, 2 % at η = 10 (docs/lift_off.md).
const BELOW_THE_BARRIER: f64 = 0.95;

/// Longest time after the ground has come to rest, in 1/p: reached by blocks that lose no energy. To rise to within
/// 1e-10 α of the unstable equilibrium takes 24/p, to leave it as much.
const LONGEST: u64 = 100;

/// The same in free motion of a block that loses energy: a slender one rocks for long.
const LONGEST_DECAY: u64 = 1000;

/// The part of the energy that lifts a corner below which a block on supports is at rest: 1 % of the rotation at which one lifts.
const AT_REST: f64 = 1e-4;

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
    /// Whether the run goes on until the block is at rest.
    until_rest: bool,
    /// Looks that were taken.
    looks: u64,
    /// The look from which on the outcome and the peaks are known.
    earliest: Option<u64>,
    /// Whether the last look found the block at rest after that.
    is_over: bool,
}

impl ComingDown {
    /// For a run in which the ground comes to rest at this time (s), followed `until_rest` or until its outcome is known.
    pub fn new(ground_at_rest: f64, until_rest: bool) -> ComingDown {
        ComingDown { ground_at_rest, until_rest, looks: 0, earliest: None, is_over: false }
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
        let longest = if self.until_rest && loses_energy(block) { LONGEST_DECAY } else { LONGEST };
        let last = match self.earliest {
            Some(_) if self.is_over => self.looks - 1,
            Some(earliest) if !self.until_rest => earliest,
            _ => longest,
        };
        self.time_of(block, last.min(longest))
    }

    /// Looks at the block, at the time of the next look.
    pub fn look(&mut self, simulation: &Simulation) {
        let block = simulation.block();
        if let (None, Some(part)) = (self.earliest, part_of_barrier(simulation)) {
            let further = (cycle(block, part) * block.p).ceil();
            self.earliest = Some(self.looks + further as u64);
        }
        let is_known = self.earliest.is_some_and(|earliest| self.looks >= earliest);
        self.is_over = self.until_rest && is_known && is_at_rest(simulation);
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

/// Whether a block without further excitation is at rest: on both corners, and with too little energy to lift one again.
pub fn is_at_rest(simulation: &Simulation) -> bool {
    let block = simulation.block();
    let quiet = match block.foundation {
        Foundation::Rigid => true,
        Foundation::Viscoelastic => {
            // A corner lifts where its support's deflection from equilibrium is δ_s: ½ K δ_s² = M g δ_s/4.
            let lifting = 0.25 * block.mass * block.gravity * block.static_deflection();
            simulation.energies().total <= AT_REST * lifting
        }
    };
    simulation.regime() == Regime::FullContact && quiet
}

/// Whether the motion of a block decays: by its dashpots, or by impacts on the rigid base.
pub fn loses_energy(block: &Block) -> bool {
    match block.foundation {
        Foundation::Rigid => block.restitution() < 1.0,
        Foundation::Viscoelastic => block.damping > 0.0,
    }
}
