//! The block in motion → its energies, and their sums since the start.

use serde::{Deserialize, Serialize};

use crate::block::restraints;
use crate::system::evaluation::Evaluation;
use crate::system::events::EventKind;
use crate::system::forces;

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
    /// Energies taken by the restraints.
    pub restraints: restraints::RestraintEnergies,
    /// Energy lost at changes of regime; negative if some was gained.
    pub impacts: f64,
    /// Energy gained by changes of the horizontal constraint. `impacts` includes it with the opposite sign.
    pub constraint: f64,
}

impl EnergySums {
    /// The works that an outside solver integrates: of the excitation, dashpots, friction and restraints. The last three are energies that
    /// they take.
    pub(super) fn works(&self) -> [f64; WORKS] {
        forces::joined([self.input, self.dashpots, self.friction], self.restraints.into_array())
    }

    /// Replaces these works.
    pub(super) fn with_works(self, [input, dashpots, friction, restraints @ ..]: [f64; WORKS]) -> EnergySums {
        EnergySums {
            input,
            dashpots,
            friction,
            restraints: restraints::RestraintEnergies::from_array(restraints),
            ..self
        }
    }

    /// Includes the energy that was lost in an event.
    pub(super) fn lose(&mut self, event: Option<EventKind>, energy: f64) {
        match event {
            Some(EventKind::Restraint(event)) => self.restraints.lose(event, energy),
            Some(
                EventKind::LiftOff(_)
                | EventKind::Landing(_)
                | EventKind::Slip
                | EventKind::Grip
                | EventKind::Overturning,
            )
            | None => self.impacts += energy,
        }
    }

    /// Whether all sums are finite.
    pub(super) fn is_finite(&self) -> bool {
        let EnergySums { initial, impacts, constraint, .. } = *self;
        [initial, impacts, constraint].into_iter().chain(self.works()).all(f64::is_finite)
    }

    /// Adds the works that [dissipative](forces::dissipated) forces have taken.
    pub(super) fn add(&mut self, [friction, restraints @ ..]: [f64; forces::DISSIPATIVE]) {
        self.friction += friction;
        self.restraints.add(restraints::RestraintEnergies::from_array(restraints));
    }
}

/// The number of [`EnergySums::works`].
pub(super) const WORKS: usize = 2 + forces::DISSIPATIVE;

/// Energies at one time (J), and their sums since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Energies {
    /// Total energy, zero at rest.
    pub total: f64,
    /// Kinetic energy relative to the ground.
    pub kinetic: f64,
    /// Potential energy of weight, supports and restraints.
    pub potential: f64,
    /// Work of the ground motion and the loads.
    pub input: f64,
    /// Energy taken by the dashpots of the supports.
    pub dashpots: f64,
    /// Energy taken by friction.
    pub friction: f64,
    /// Energies taken by the restraints.
    #[serde(flatten)]
    pub restraints: restraints::RestraintEnergies,
    /// Energy lost at changes of regime; negative if some was gained.
    pub impacts: f64,
    /// Energy gained by changes of the horizontal constraint. `impacts` includes it with the opposite sign.
    pub constraint: f64,
    /// The balance: `total − initial − input + dashpots + friction + restraints + impacts`, round-off and integration error.
    pub residual: f64,
}

impl Energies {
    /// The changes of the energies while none is lost in events.
    pub(super) fn changing(
        kinetic: f64,
        potential: f64,
        [input, dashpots, friction, restraints @ ..]: [f64; WORKS],
    ) -> Energies {
        let total = kinetic + potential;
        let restraints = restraints::RestraintEnergies::from_array(restraints);
        let residual = restraints.added_to(total - input + dashpots + friction);
        Energies { total, kinetic, potential, input, dashpots, friction, restraints, residual, ..Energies::default() }
    }
}

/// The rates of [`EnergySums::works`] now (W).
pub(super) fn powers(now: &Evaluation) -> [f64; WORKS] {
    let powers = now.instant.powers(now.body, now.regime, now.forcing);
    forces::joined::<_, 2, { forces::DISSIPATIVE }, WORKS>(powers, now.dissipated()).map(|power| power * now.body.mass)
}

impl EnergySums {
    /// The energies (J) of a block of this mass (kg). Its kinetic and potential energy are per unit mass (m²/s²).
    pub(super) fn energies(&self, (kinetic, potential): (f64, f64), mass: f64) -> Energies {
        let &EnergySums { initial, input, dashpots, friction, restraints, impacts, constraint } = self;
        let [kinetic, potential, initial, input, dashpots, friction, impacts, constraint] =
            [kinetic, potential, initial, input, dashpots, friction, impacts, constraint].map(|energy| energy * mass);
        let restraints = restraints.map(|energy| energy * mass);
        let total = kinetic + potential;
        Energies {
            total,
            kinetic,
            potential,
            input,
            dashpots,
            friction,
            restraints,
            impacts,
            constraint,
            residual: restraints.added_to(total - initial - input + dashpots + friction) + impacts,
        }
    }
}
