//! The block in motion → its energies, and their sums since the start.

use serde::{Deserialize, Serialize};

use crate::excitation::{Excitation, Forcing, Inputs};
use crate::simulation::Simulation;
use crate::system::forces::{self, energy};

/// Energy sums since the start, per unit mass (m²/s²).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergySums {
    /// Total energy at the start.
    pub initial: f64,
    /// Work of the ground motion and the loads.
    pub input: f64,
    /// Energy taken by the dashpots of the supports.
    pub dashpots: f64,
    /// Energy taken by friction.
    pub friction: f64,
    /// Energy taken by the dashpots of the ties, and lost from the springs of those that broke.
    pub ties: f64,
    /// Energy lost at changes of regime; negative if some was gained.
    pub impacts: f64,
    /// Energy gained from changes of the horizontal constraint at lift-off; included in `impacts` with the opposite sign.
    pub constraint: f64,
}

impl EnergySums {
    /// Adds the works that [dissipative](forces::dissipated) forces have taken.
    pub(super) fn add(&mut self, [friction, ties]: [f64; forces::DISSIPATIVE]) {
        self.friction += friction;
        self.ties += ties;
    }
}

/// Energies at one time (J), and their sums since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Energies {
    /// Total energy, zero at rest.
    pub total: f64,
    /// Kinetic energy relative to the ground.
    pub kinetic: f64,
    /// Energy of the weight and of the springs under the touching corners.
    pub potential: f64,
    /// Work of the ground motion and the loads.
    pub input: f64,
    /// Energy taken by the dashpots of the supports.
    pub dashpots: f64,
    /// Energy taken by friction.
    pub friction: f64,
    /// Energy taken by the dashpots of the ties, and lost from the springs of those that broke.
    pub ties: f64,
    /// Energy lost at changes of regime; negative if some was gained.
    pub impacts: f64,
    /// Energy gained from changes of the horizontal constraint at lift-off; included in `impacts` with the opposite sign.
    pub constraint: f64,
    /// The balance: `total − initial − input + dashpots + friction + ties + impacts`, round-off and integration error.
    pub residual: f64,
}

impl Simulation {
    /// Energies and their sums now (J).
    pub fn energies(&self) -> Energies {
        let (block, excitation) = (self.block(), Excitation::none());
        let now = self.now(block, &excitation);
        let (kinetic, potential) = energy(block, now.regime, &now.forcing.ties, &now.instant);
        let EnergySums { initial, input, dashpots, friction, ties, impacts, constraint } = self.sums;
        let [kinetic, potential, initial, input, dashpots, friction, ties, impacts, constraint] =
            [kinetic, potential, initial, input, dashpots, friction, ties, impacts, constraint]
                .map(|part| part * block.mass);
        let total = kinetic + potential;
        Energies {
            total,
            kinetic,
            potential,
            input,
            dashpots,
            friction,
            ties,
            impacts,
            constraint,
            residual: total - initial - input + dashpots + friction + ties + impacts,
        }
    }

    /// Rates at which the energies and their sums change now (W).
    pub fn energy_rates(&self, inputs: &Inputs) -> Energies {
        if self.is_frozen() {
            return Energies::default();
        }
        self.shown(inputs, |now| {
            let block = now.block;
            let (kinetic, potential) =
                energy(block, now.regime, &now.forcing.ties, &now.with_rates(Forcing::default()));
            let [input, dashpots] = now.instant.powers(block, now.regime, now.forcing);
            let [friction, ties] = now.dissipated();
            let [kinetic, potential, input, dashpots, friction, ties] =
                [kinetic.eps, potential.eps, input, dashpots, friction, ties].map(|part| part * block.mass);
            let total = kinetic + potential;
            Energies {
                total,
                kinetic,
                potential,
                input,
                dashpots,
                friction,
                ties,
                residual: total - input + dashpots + friction + ties,
                ..Energies::default()
            }
        })
    }
}
