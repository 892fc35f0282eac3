//! A regime from a time on → its equations of motion at any point, and steps along it.

use crate::block::Block;
use crate::dynamics::{Footing, Instant, State, instant, instant_of};
use crate::events::Creep;
use crate::excitation::{Excitation, Forcing};
use crate::integrator::{Rate, ShortStep, Step};
use crate::regime::{Corner, Regime};
use crate::roots::Sample;
use crate::simulation::Simulation;

/// State and all that follows from it at one time.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub(super) time: f64,
    pub(super) state: State,
    pub(super) footing: Footing<f64>,
    pub(super) rate: Rate,
    pub(super) instant: Instant<f64>,
    pub(super) forcing: Forcing<f64>,
    /// Heights of the supports that nothing touches.
    pub(super) tops: [Sample; 2],
}

/// A regime from a time on.
pub(super) struct Motion<'a> {
    block: &'a Block,
    regime: Regime,
    since: f64,
    footing: Footing<f64>,
    creep: [Creep; 2],
}

impl Motion<'_> {
    /// The motion of a simulation from its present time on, while the regime lasts.
    #[inline]
    pub(super) fn of<'a>(simulation: &Simulation, block: &'a Block) -> Motion<'a> {
        let Simulation { regime, time, footing, creep, .. } = *simulation;
        Motion { block, regime, since: time, footing, creep }
    }

    #[inline]
    pub(super) fn point(&self, time: f64, state: State, excitation: &Excitation) -> Point {
        let forcing = excitation.at(time);
        let footing = self.footing_at(time, excitation);
        let instant = instant(self.block, self.regime, state.into(), footing, forcing);
        let rate = self.rate_of(&instant, forcing);
        Point { time, state, footing, rate, instant, forcing, tops: self.tops(time) }
    }

    /// Heights of the supports that nothing touches.
    pub(super) fn tops(&self, time: f64) -> [Sample; 2] {
        Corner::BOTH.map(|corner| match self.regime.touches(corner) {
            true => Sample::default(),
            false => self.creep[corner.index()].top(self.block, time),
        })
    }

    /// An attempted step of `size` from a point.
    #[inline]
    pub(super) fn step(&self, here: &Point, size: f64, excitation: &Excitation) -> Step {
        Step::attempt(here.time, size, here.state, here.rate, |t, x| self.rate(t, x, excitation))
    }

    /// The same of order 5.
    #[inline]
    pub(super) fn short_step(&self, here: &Point, size: f64, excitation: &Excitation) -> ShortStep {
        ShortStep::attempt(here.time, size, here.state, here.rate, |t, x| self.rate(t, x, excitation))
    }

    /// The right-hand side alone.
    pub(super) fn rate(&self, time: f64, state: &State, excitation: &Excitation) -> Rate {
        let forcing = excitation.at(time);
        let footing = self.footing_at(time, excitation);
        instant_of(self.block, self.regime, (*state).into(), footing, forcing, |x| self.rate_of(&x, forcing))
    }

    #[inline(always)]
    fn rate_of(&self, x: &Instant<f64>, forcing: Forcing<f64>) -> Rate {
        Rate {
            state: State::new(x.theta_dot, x.theta_ddot, x.w_dot, x.w_ddot),
            powers: x.powers(self.block, self.regime, forcing).into(),
        }
    }

    /// What holds the block at `time`. Where nothing does, `ü = −a_gx` is integrated in closed form.
    #[inline]
    fn footing_at(&self, time: f64, excitation: &Excitation) -> Footing<f64> {
        match self.footing {
            grips @ Footing::Grips { .. } => grips,
            Footing::Free { u, u_dot } => {
                let (velocity, way) = excitation.horizontal_drift(self.since, time);
                Footing::Free { u: u + u_dot * (time - self.since) - way, u_dot: u_dot - velocity }
            }
        }
    }
}
