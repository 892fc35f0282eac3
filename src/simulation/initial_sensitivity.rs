//! Initial values and parameters, with derivatives in a direction → exact derivatives of all outputs at the beginning.

use crate::block::{Block, Foundation, Regime};
use crate::excitation::Excitation;
use crate::numerics::dual::Dual;
use crate::numerics::gradient::DirectionalDual;
use crate::simulation::Energies;
use crate::simulation::outputs::{Observation, observe};
use crate::simulation::peaks::Peaks;
use crate::system::System;
use crate::system::beginning::Initial;
use crate::system::dynamics::instant;
use crate::system::evaluation::{Evaluation, Motion};
use crate::system::events::ROUNDING;
use crate::system::forces::energy;
use crate::system::instant::{Footing, Instant, Pose};

/// A block before its first step. Its parameters, initial values and start time vary in a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The block.
    pub block: Block<DirectionalDual>,
    /// Where it is.
    pub initial: Initial<DirectionalDual>,
    /// Its excitation.
    pub excitation: Excitation<DirectionalDual>,
    /// The start time (s).
    pub time: DirectionalDual,
}

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

impl Start {
    /// Derivatives of the beginning in this direction. The block moves by the rules of `system`, or `is_frozen`.
    ///
    /// The regimes are those through which the block goes: where one of them begins or ends, the derivative is that of the
    /// side on which the block is.
    pub(super) fn derivatives(&self, &System { flies, .. }: &System, is_frozen: bool) -> InitialDerivatives {
        let Start { block, initial, excitation, time } = self;
        let system = System { block: *block, flies };
        let at = |pose: &Pose<DirectionalDual>| Motion::from_pose(block, pose, excitation).at(*time, pose.state);
        let pose = system.beginning(initial, *time, excitation);
        let mut begins = at(&pose);
        let mut goes_on = system.pose_after_jump(&pose, &begins).map_or(begins, |pose| at(&pose));
        if block.foundation == Foundation::Rigid && goes_on.regime == Regime::FullContact {
            lean(&mut goes_on, initial);
            begins = goes_on;
        }
        let support_heights = goes_on.support_heights.map(|top| top.re);
        let seen = observe(block, goes_on.regime, &goes_on.instant, support_heights, goes_on.forcing);
        let seen = seen.map(|x| Dual::new(x.re, x.eps[0]));
        let peaks = Peaks {
            pull: seen.restraints.map(|restraint| restraint.pull.abs().eps),
            plastic: seen.restraints.map(|restraint| restraint.plastic.abs().eps),
            elongation: std::array::from_fn(|i| {
                let elongation = seen.restraints[i].elongation;
                if !block.restraints.pushes(i) {
                    let shortening = -elongation;
                    let rises = if shortening.re.abs() <= ROUNDING * block.r0.re {
                        shortening.eps > 0.0
                    } else {
                        shortening.re > 0.0
                    };
                    return if rises { shortening.eps } else { 0.0 };
                }
                match goes_on.forcing.restraints.pull_of(i) {
                    None => 0.0,
                    // At rest it is zero to round-off, and grows to either side.
                    Some(_) if elongation.re.abs() <= ROUNDING * block.r0.re => elongation.eps.abs(),
                    Some(_) => elongation.abs().eps,
                }
            }),
            ..seen.channels().peak_sensitivity()
        };
        let seen = if is_frozen { seen.without_motion() } else { seen };
        let (kinetic, potential) = energy(block, begins.regime, &begins.forcing, &begins.instant);
        let [kinetic, potential] = [kinetic, potential].map(|energy| (energy * block.mass).eps[0]);
        let energies = Energies { total: kinetic + potential, kinetic, potential, ..Energies::default() };
        InitialDerivatives { observed: seen.map(|x| x.eps), energies, peaks }
    }
}

/// Leans a block at rest on the rigid base as it tilts or is thrown. It stands on that corner. Displacements and the rates of the centre of
/// mass change as there; accelerations and reactions would jump, and are those of rest.
fn lean(rest: &mut Evaluation<DirectionalDual>, &Initial { theta, theta_dot, .. }: &Initial<DirectionalDual>) {
    let lean = if theta.eps[0] != 0.0 { theta.eps[0] } else { theta_dot.eps[0] };
    if lean == 0.0 {
        return;
    }
    rest.regime = if lean < 0.0 { Regime::TiltingLeft } else { Regime::TiltingRight };
    let zero = DirectionalDual::from(0.0);
    let state = [theta, theta_dot, zero, zero];
    let x = instant(rest.body, rest.regime, state, Footing::AT_START.map(DirectionalDual::from), rest.forcing);
    let Instant { u, u_dot, v, v_dot, corner, .. } = x;
    rest.instant = Instant { u, u_dot, v, v_dot, corner, ..rest.instant };
}
