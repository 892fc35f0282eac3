//! Initial values and parameters as dual numbers → exact derivatives of all that is put out at the beginning.

use crate::dual::Dual64;
use crate::excitation::Inputs;
use crate::simulation::outputs::{Observation, observe};
use crate::simulation::peaks::{Peaks, channels};
use crate::simulation::{Energies, Initial, Simulation};
use crate::system::dynamics::energy;
use crate::system::transitions::{Along, Start};

/// How what is put out at the beginning changes in a direction of what the block begins from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtBeginning {
    /// Motion, reactions and corners.
    pub seen: Observation<f64>,
    /// Energies. What has become of them since the start is nothing.
    pub energies: Energies,
    /// Greatest values, which are those of the beginning.
    pub peaks: Peaks,
}

impl Simulation {
    /// How the beginning changes in the direction of the dual parts of `start`, whose values and `initial` and `inputs` are what
    /// this block has begun from.
    ///
    /// The regimes are those through which the block goes: where one of them begins or ends, the derivative is that of the
    /// side on which the block is.
    pub fn beginning_along(&self, initial: &Initial, inputs: &Inputs, start: &Start<Dual64>) -> AtBeginning {
        let excitation = self.excitation(inputs);
        let Along { begins, goes_on, tops } = self.system.beginning_along(initial, self.pose.time, &excitation, start);
        let seen = observe(&start.block, goes_on.0, &goes_on.1, tops, start.forcing);
        let peaks = channels(&seen).peaks_along();
        let seen = if self.is_frozen() { seen.without_motion() } else { seen };
        let (kinetic, potential) = energy(&start.block, begins.0, &begins.1);
        let [kinetic, potential] = [kinetic, potential].map(|part| (part * start.block.mass).eps);
        let energies = Energies { total: kinetic + potential, kinetic, potential, ..Energies::default() };
        AtBeginning { seen: seen.map(|x| x.eps), energies, peaks }
    }
}
