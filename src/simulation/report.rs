//! The block in motion → what a user sees of it.

use num_dual::Dual64;

use crate::dynamics::energy;
use crate::excitation::{Excitation, Forcing, Inputs, Pulse};
use crate::now::{Motion, Now};
use crate::outputs::Observation;
use crate::simulation::{Ending, Energies, EnergySums, OnOverturning, OnSeparation, Simulation};

impl Simulation {
    /// Whether the run ended and is held there: nothing moves and no support bears any more.
    pub fn is_frozen(&self) -> bool {
        match self.ending {
            None => false,
            Some((Ending::Separated | Ending::Toppled, _)) => self.settings.on_separation == OnSeparation::Hold,
            Some((Ending::Overturned, _)) => self.settings.on_overturning == OnOverturning::Hold,
        }
    }

    /// What a user sees now, under these inputs, as the block goes on from here: on the rigid base a corner that would have
    /// to be pulled has lifted. The next step counts its event.
    pub fn observe(&self, inputs: &Inputs) -> Observation<f64> {
        let seen = self.shown(inputs, |now| now.observe());
        if self.is_frozen() { seen.frozen() } else { seen }
    }

    /// The same with, in the dual parts, the exact rates of change along the motion while the inputs go on.
    pub fn observe_rates(&self, inputs: &Inputs) -> Observation<Dual64> {
        let seen = self.shown(inputs, |now| now.observe_rates());
        if self.is_frozen() { seen.frozen() } else { seen }
    }

    /// The same with, in the dual parts, the exact derivatives with respect to the inputs in the direction whose
    /// components are the values of `direction`: at this instant, so with state and regime as they are.
    pub fn observe_direction(&self, inputs: &Inputs, direction: &Inputs) -> Observation<Dual64> {
        let direction = Excitation::from_time(0.0, direction, &Pulse::NONE, self.block()).at(direction.time);
        let seen = self.shown(inputs, |now| now.observe_direction(direction));
        if self.is_frozen() { seen.frozen() } else { seen }
    }

    /// Looks at the block as it goes on from here under these inputs.
    fn shown<R>(&self, inputs: &Inputs, look: impl FnOnce(&Now) -> R) -> R {
        let (Simulation { system, pose, .. }, block) = (self, self.block());
        let excitation = Excitation::from_time(pose.time, inputs, &self.pulse, block);
        let mut now = self.now(block, &excitation);
        if let Some((_, ended)) = self.ending {
            // Under a block that is held the supports are, too.
            now.tops = Motion::from_pose(block, pose, &excitation).tops(ended);
        } else if let Some(released) = system.released(pose, &now) {
            now = Motion::from_pose(block, &released, &excitation).at(released.time, released.state);
        }
        look(&now)
    }

    /// Energies and their sums now (J).
    pub fn energies(&self) -> Energies {
        let (block, excitation) = (self.block(), Excitation::none());
        let now = self.now(block, &excitation);
        let (kinetic, potential) = energy(block, now.regime, &now.instant);
        let EnergySums { initial, input, dashpots, impacts, constraint } = self.sums;
        let [kinetic, potential, initial, input, dashpots, impacts, constraint] =
            [kinetic, potential, initial, input, dashpots, impacts, constraint].map(|part| part * block.mass);
        let total = kinetic + potential;
        Energies {
            total,
            kinetic,
            potential,
            input,
            dashpots,
            impacts,
            constraint,
            residual: total - initial - input + dashpots + impacts,
        }
    }

    /// Rates at which the energies and their sums change now (W).
    pub fn energy_rates(&self, inputs: &Inputs) -> Energies {
        if self.is_frozen() {
            return Energies::default();
        }
        self.shown(inputs, |now| {
            let block = now.block;
            let (kinetic, potential) = energy(block, now.regime, &now.along(Forcing::default()));
            let [input, dashpots] = now.instant.powers(block, now.regime, now.forcing);
            let [kinetic, potential, input, dashpots] =
                [kinetic.eps, potential.eps, input, dashpots].map(|part| part * block.mass);
            let total = kinetic + potential;
            Energies {
                total,
                kinetic,
                potential,
                input,
                dashpots,
                residual: total - input + dashpots,
                ..Energies::default()
            }
        })
    }
}
