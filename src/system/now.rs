//! Where the block is and what it stands on → its equations of motion at any time while that lasts, and all that follows
//! from them at one instant.

use serde::{Deserialize, Serialize};

use crate::block::Block;
use crate::contact::Contacts;
use crate::contact::{Corner, Regime};
use crate::dual::Dual64;
use crate::excitation::{Excitation, Forcing};
use crate::numerics::roots::Sample;
use crate::numerics::{Equations, Rate};
use crate::system::dynamics::{Footing, Instant, State, along, energy, instant_of};
use crate::system::held::{Held, along_held, instant_held};
use crate::system::law::{AnyLaw, Law};
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

impl Pose {
    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        let Pose { time, state, contacts, footing } = self;
        time.is_finite() && state.0.iter().all(|x| x.is_finite()) && contacts.is_finite() && footing.is_finite()
    }
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
    /// The corner that is held, if one is.
    pub held: Option<Held<f64>>,
}

/// The motion from a pose on, while the block stands on the same corners.
#[derive(Clone, Copy)]
pub struct Motion<'a, L = AnyLaw> {
    block: &'a Block,
    excitation: &'a Excitation,
    law: L,
    since: f64,
    footing: Footing<f64>,
    contacts: Contacts,
}

impl<'a> Motion<'a> {
    /// The motion of a block from a pose on.
    #[inline]
    pub fn from_pose(block: &'a Block, pose: &Pose, excitation: &'a Excitation) -> Motion<'a> {
        Motion::under(AnyLaw::of(block, pose), block, pose, excitation)
    }
}

impl<'a, L: Law> Motion<'a, L> {
    /// The same where the law of the pose is known already.
    #[inline(always)]
    pub fn under(law: L, block: &'a Block, pose: &Pose, excitation: &'a Excitation) -> Motion<'a, L> {
        let Pose { time, contacts, footing, .. } = *pose;
        Motion { block, excitation, law, since: time, footing, contacts }
    }

    /// The law of the motion.
    #[inline(always)]
    pub fn law(&self) -> L {
        self.law
    }

    /// All that follows from a state at a time.
    #[inline(always)]
    pub fn at(&self, time: f64, state: State) -> Now<'a> {
        if let Some(held) = self.held_at(time) {
            return self.at_held(time, state, held);
        }
        let (foundation, regime) = (self.law.foundation(), self.law.regime());
        let forcing = self.excitation.at(time);
        let footing = self.footing_at(time);
        instant_of(self.block, foundation, regime, state.0, footing, forcing, |instant| Now {
            block: self.block,
            excitation: self.excitation,
            time,
            regime,
            state,
            footing,
            forcing,
            instant,
            rate: self.rate_of(&instant, forcing),
            tops: self.tops(time),
            held: None,
        })
    }

    /// The corner that is held, with its support at a time.
    #[inline(always)]
    fn held_at(&self, time: f64) -> Option<Held<f64>> {
        self.law.held().map(|corner| Held::on(self.block, corner, self.contacts.top(corner, self.block, time)))
    }

    /// [`Motion::at`] where a corner is held: height and rate of the middle of the base follow from θ and θ̇.
    #[inline(never)]
    fn at_held(&self, time: f64, State { 0: [theta, theta_dot, ..] }: State, held: Held<f64>) -> Now<'a> {
        let (forcing, footing) = (self.excitation.at(time), self.footing_at(time));
        let instant = instant_held(self.block, [theta, theta_dot], held, footing, forcing);
        let [left, right] = instant.corner;
        Now {
            block: self.block,
            excitation: self.excitation,
            time,
            regime: self.law.regime(),
            state: State::from([theta, theta_dot, 0.5 * (left + right), instant.w_dot]),
            footing,
            forcing,
            instant,
            rate: self.rate_of(&instant, forcing),
            tops: self.tops(time),
            held: Some(held),
        }
    }

    /// Heights of the supports that nothing touches (m), and their rates (m/s); zeros for the others.
    #[inline(always)]
    pub fn tops(&self, time: f64) -> [Sample; 2] {
        Corner::each(|corner| match self.law.regime().touches(corner) {
            true => Sample::default(),
            false => self.contacts.top(corner, self.block, time),
        })
    }

    #[inline(always)]
    fn rate_of(&self, x: &Instant<f64>, forcing: Forcing<f64>) -> Rate {
        // Where nothing holds the block, `Footing::free_work` is the horizontal part of the work.
        let integrated = if self.law.grips() { forcing } else { Forcing { x: 0.0, ..forcing } };
        Rate {
            state: State::from([x.theta_dot, x.theta_ddot, x.w_dot, x.w_ddot]),
            quadratures: x.powers(self.block, self.law.regime(), integrated).into(),
        }
    }

    /// What holds the block at `time`. Where nothing does, `ü = −a_gx` is integrated in closed form.
    #[inline(always)]
    fn footing_at(&self, time: f64) -> Footing<f64> {
        match self.footing {
            Footing::Free { u, u_dot } if !self.law.grips() => {
                let (velocity, displacement) = self.excitation.horizontal_drift(self.since, time);
                Footing::Free { u: u + u_dot * (time - self.since) - displacement, u_dot: u_dot - velocity }
            }
            // What the law says is known to the compiler, where the footing itself may not be.
            Footing::Grips { offset } | Footing::Free { u: offset, .. } => Footing::Grips { offset },
        }
    }
}

impl<L: Law> Equations for Motion<'_, L> {
    #[inline(always)]
    fn rate(&self, time: f64, state: &State) -> Rate {
        if L::KNOWN { self.rate_inlined(time, state) } else { self.rate_called(time, state) }
    }
}

impl<L: Law> Motion<'_, L> {
    /// All laws in one function, which is too much for each stage of a step.
    #[inline(never)]
    fn rate_called(&self, time: f64, state: &State) -> Rate {
        self.rate_inlined(time, state)
    }

    #[inline(always)]
    fn rate_inlined(&self, time: f64, state: &State) -> Rate {
        if let Some(held) = self.held_at(time) {
            return self.at_held(time, *state, held).rate;
        }
        let (foundation, regime) = (self.law.foundation(), self.law.regime());
        let forcing = self.excitation.at(time);
        let footing = self.footing_at(time);
        instant_of(self.block, foundation, regime, state.0, footing, forcing, |x| self.rate_of(&x, forcing))
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
        if let Some(held) = &self.held {
            return along_held(self.block, held, self.footing, &self.instant, forcing);
        }
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
}
