//! Initial values and parameters as dual numbers → exact derivatives of all outputs at the beginning.

use crate::block::Foundation;
use crate::block::contact::Regime;
use crate::excitation::Inputs;
use crate::numerics::dual::Dual64;
use crate::simulation::outputs::{Observation, observe};
use crate::simulation::peaks::{Peaks, channels};
use crate::simulation::{Energies, Initial, Simulation};
use crate::system::dynamics::instant;
use crate::system::forces::energy;
use crate::system::initial_sensitivity::{InitialSensitivity, Start};
use crate::system::instant::{Footing, Instant};

/// Derivatives of all outputs at the beginning in a direction of parameters and initial values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialDerivatives {
    /// Motion, reactions and corners.
    pub observed: Observation<f64>,
    /// Energies; their sums since the start are zero.
    pub energies: Energies,
    /// Greatest values, which are those of the beginning.
    pub peaks: Peaks,
}

impl Simulation {
    /// Derivatives of the beginning in the direction of the dual parts of `start`; its values, `initial` and `inputs` are those from
    /// which this block has begun.
    ///
    /// The regimes are those through which the block goes: where one of them begins or ends, the derivative is that of the
    /// side on which the block is.
    pub fn initial_sensitivity(&self, initial: &Initial, inputs: &Inputs, start: &Start<Dual64>) -> InitialDerivatives {
        let excitation = self.excitation(inputs);
        let InitialSensitivity { mut begins, mut goes_on, support_heights } =
            self.system.initial_sensitivity(initial, self.pose.time, &excitation, start);
        if self.block().foundation == Foundation::Rigid && goes_on.0 == Regime::FullContact {
            goes_on = leaning(goes_on, start);
            begins = goes_on;
        }
        let seen = observe(&start.block, goes_on.0, &goes_on.1, support_heights, start.forcing);
        let peaks = Peaks { tension: seen.tension.map(|tension| tension.eps), ..channels(&seen).peak_sensitivity() };
        let seen = if self.is_frozen() { seen.without_motion() } else { seen };
        let (kinetic, potential) = energy(&start.block, begins.0, &start.forcing.ties, &begins.1);
        let [kinetic, potential] = [kinetic, potential].map(|part| (part * start.block.mass).eps);
        let energies = Energies { total: kinetic + potential, kinetic, potential, ..Energies::default() };
        InitialDerivatives { observed: seen.map(|x| x.eps), energies, peaks }
    }
}

/// The upright block at rest on the rigid base, moved in a direction: it leans to the side to which it is tilted or thrown, on that
/// corner. Displacements and rates change as there; accelerations and reactions would jump, and are those of rest.
fn leaning((regime, rest): (Regime, Instant<Dual64>), start: &Start<Dual64>) -> (Regime, Instant<Dual64>) {
    let Initial { theta, theta_dot, .. } = start.initial;
    let lean = if theta.eps != 0.0 { theta.eps } else { theta_dot.eps };
    if lean == 0.0 {
        return (regime, rest);
    }
    let leaning = if lean < 0.0 { Regime::TiltingLeft } else { Regime::TiltingRight };
    let zero = Dual64::from(0.0);
    let x = instant(
        &start.block,
        leaning,
        [theta, theta_dot, zero, zero],
        Footing::AT_START.map(Dual64::from),
        start.forcing,
    );
    let Instant { u, u_dot, v, v_dot, corner, corner_dot, .. } = x;
    (leaning, Instant { u, u_dot, v, v_dot, corner, corner_dot, ..rest })
}
