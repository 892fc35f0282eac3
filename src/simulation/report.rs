//! The block in motion → what a user sees of it.

use num_dual::Dual64;

use crate::dynamics::energy;
use crate::excitation::{Excitation, Forcing, Inputs, Pulse};
use crate::outputs::{Observation, View};
use crate::simulation::motion::Motion;
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
        let seen = self.with_view(inputs, |view, _| view.observe());
        if self.is_frozen() { seen.frozen() } else { seen }
    }

    /// The same with, in the dual parts, the exact rates of change along the motion while the inputs go on.
    pub fn observe_rates(&self, inputs: &Inputs) -> Observation<Dual64> {
        let seen = self.with_view(inputs, |view, rate| view.observe_rates(rate));
        if self.is_frozen() { seen.frozen() } else { seen }
    }

    /// The same with, in the dual parts, the exact derivatives with respect to the inputs in the direction whose
    /// components are the values of `direction`: at this instant, so with state and regime as they are.
    pub fn observe_direction(&self, inputs: &Inputs, direction: &Inputs) -> Observation<Dual64> {
        let direction = Excitation::from_time(0.0, direction, &Pulse::NONE, &self.block).at(direction.time);
        let seen = self.with_view(inputs, |view, _| view.observe_direction(direction));
        if self.is_frozen() { seen.frozen() } else { seen }
    }

    fn with_view<R>(&self, inputs: &Inputs, look: impl FnOnce(View, Forcing<f64>) -> R) -> R {
        let excitation = Excitation::from_time(self.time, inputs, &self.pulse, &self.block);
        let motion = Motion::of(self, &self.block);
        let mut point = motion.point(self.time, self.state, &excitation);
        let rate = excitation.rate_at(self.time);
        if let Some((_, ended)) = self.ending {
            // Under a block that is held the supports are, too.
            point.tops = motion.tops(ended);
        } else if let Some(released) = self.released(&point, &excitation) {
            let point = released.point_at(released.time, released.state, &excitation);
            return look(released.view(&point), rate);
        }
        look(self.view(&point), rate)
    }

    /// Energies and their sums now (J).
    pub fn energies(&self) -> Energies {
        let x = self.point_at(self.time, self.state, &Excitation::none()).instant;
        let (kinetic, potential) = energy(&self.block, self.regime, &x);
        let EnergySums { initial, input, dashpots, impacts, constraint } = self.sums;
        let [kinetic, potential, initial, input, dashpots, impacts, constraint] =
            [kinetic, potential, initial, input, dashpots, impacts, constraint].map(|part| part * self.block.mass);
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
        self.with_view(inputs, |view, _| {
            let block = &self.block;
            let x = view.along(Forcing::default());
            let (kinetic, potential) = energy(block, view.regime, &x);
            let forcing = view.forcing;
            let [input, dashpots] = view.instant.powers(block, view.regime, forcing);
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
