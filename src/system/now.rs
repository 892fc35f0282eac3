//! Where the block is and what it stands on → its equations of motion at any time while that lasts, and all that follows
//! from them at one instant.

use num_dual::Dual64;
use serde::{Deserialize, Serialize};

use crate::block::Block;
use crate::contact::Contacts;
use crate::contact::{Corner, Regime};
use crate::excitation::{Excitation, Forcing};
use crate::numerics::Rate;
use crate::numerics::roots::Sample;
use crate::system::dynamics::{Footing, Instant, State, along, energy, instant, instant_of};
use crate::system::surfaces::Surface;

/// Where the block is and what it stands on: all that its motion follows from, besides the excitation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Time (s).
    pub time: f64,
    /// `[θ, θ̇, w, ẇ]`; what w is depends on the regime, see [`super::dynamics`].
    pub state: State,
    /// What the corners do.
    pub contacts: Contacts,
    /// What holds the block horizontally.
    pub footing: Footing<f64>,
}

/// The block at an instant: its pose, what drives it, and what the equations of motion say.
#[derive(Clone, Copy, Debug)]
pub struct Now<'a> {
    /// The block.
    pub block: &'a Block,
    /// What drives it.
    pub excitation: &'a Excitation,
    /// Time (s).
    pub time: f64,
    /// Which corners touch.
    pub regime: Regime,
    /// `[θ, θ̇, w, ẇ]`.
    pub state: State,
    /// What holds the block horizontally.
    pub footing: Footing<f64>,
    /// What drives the block at this time.
    pub forcing: Forcing<f64>,
    /// The equations of motion.
    pub instant: Instant<f64>,
    /// Rate of the state, and the powers.
    pub rate: Rate,
    /// Heights of the supports that nothing touches (m), and their rates (m/s); zeros for the others.
    pub tops: [Sample; 2],
}

/// The motion from a pose on, while the block stands on the same corners.
pub struct Motion<'a> {
    block: &'a Block,
    excitation: &'a Excitation,
    regime: Regime,
    since: f64,
    footing: Footing<f64>,
    contacts: Contacts,
}

impl<'a> Motion<'a> {
    /// The motion of a block from a pose on.
    #[inline]
    pub fn from_pose(block: &'a Block, pose: &Pose, excitation: &'a Excitation) -> Motion<'a> {
        let Pose { time, contacts, footing, .. } = *pose;
        Motion { block, excitation, regime: contacts.regime(), since: time, footing, contacts }
    }

    /// All that follows from a state at a time.
    #[inline]
    pub fn at(&self, time: f64, state: State) -> Now<'a> {
        let forcing = self.excitation.at(time);
        let footing = self.footing_at(time);
        let instant = instant(self.block, self.regime, state.into(), footing, forcing);
        Now {
            block: self.block,
            excitation: self.excitation,
            time,
            regime: self.regime,
            state,
            footing,
            forcing,
            instant,
            rate: self.rate_of(&instant, forcing),
            tops: self.tops(time),
        }
    }

    /// Heights of the supports that nothing touches (m), and their rates (m/s); zeros for the others.
    pub fn tops(&self, time: f64) -> [Sample; 2] {
        Corner::BOTH.map(|corner| self.contacts.top(corner, self.block, time))
    }

    /// The right-hand side alone.
    pub fn rate(&self, time: f64, state: &State) -> Rate {
        let forcing = self.excitation.at(time);
        let footing = self.footing_at(time);
        instant_of(self.block, self.regime, (*state).into(), footing, forcing, |x| self.rate_of(&x, forcing))
    }

    #[inline(always)]
    fn rate_of(&self, x: &Instant<f64>, forcing: Forcing<f64>) -> Rate {
        Rate {
            state: State::new(x.theta_dot, x.theta_ddot, x.w_dot, x.w_ddot),
            quadratures: x.powers(self.block, self.regime, forcing).into(),
        }
    }

    /// What holds the block at `time`. Where nothing does, `ü = −a_gx` is integrated in closed form.
    #[inline]
    fn footing_at(&self, time: f64) -> Footing<f64> {
        match self.footing {
            grips @ Footing::Grips { .. } => grips,
            Footing::Free { u, u_dot } => {
                let (velocity, displacement) = self.excitation.horizontal_drift(self.since, time);
                Footing::Free { u: u + u_dot * (time - self.since) - displacement, u_dot: u_dot - velocity }
            }
        }
    }
}

impl Now<'_> {
    /// Rate at which the forcing changes.
    pub fn forcing_rate(&self) -> Forcing<f64> {
        self.excitation.rate_at(self.time)
    }

    /// The equations of motion with, in the dual parts, their rates of change along the motion while the forcing changes at
    /// this rate.
    pub fn along(&self, forcing_rate: Forcing<f64>) -> Instant<Dual64> {
        let forcing = self.forcing.with_derivative(forcing_rate);
        along(self.block, self.regime, &self.state, self.footing, &self.instant, forcing)
    }

    /// Kinetic and potential energy per unit mass, together (m²/s²).
    pub fn energy(&self) -> f64 {
        let (kinetic, potential) = energy(self.block, self.regime, &self.instant);
        kinetic + potential
    }

    /// Whether the block stands on both corners and what moves it, and how it moves, is below what rounding leaves of the
    /// reactions: it is at rest.
    pub fn rests(&self) -> bool {
        let Instant { theta_dot, theta_ddot, w_dot, w_ddot, .. } = self.instant;
        let Block { r0, omega_v, .. } = *self.block;
        let rounding = Surface::Reaction(Corner::Left).rounding(self.block);
        let below = |rotation: f64, vertical: f64| r0 * rotation.abs() + vertical.abs() <= rounding;
        self.regime == Regime::FullContact
            && self.footing.grips()
            && below(theta_ddot, w_ddot)
            && below(omega_v * theta_dot, omega_v * w_dot)
    }

    /// Whether a corner that was held bears weight again.
    pub fn bears(&self, corner: Corner) -> bool {
        self.instant.reaction[corner.index()] > Surface::Reaction(corner).rounding(self.block)
    }
}
