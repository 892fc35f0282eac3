//! The block stepped from outside: its continuous states, their derivatives, event indicators, and what an event makes
//! of it.
//!
//! The equations, surfaces and transitions are those of [`Simulation::advance`]; who steps has only to find where an
//! indicator falls through zero. In flight and while what touches slides, the horizontal motion is integrated, too, so that
//! inputs may be any functions of time.

use serde::{Deserialize, Serialize};

use crate::block::{Block, Foundation};
use crate::dual::Dual64;
use crate::excitation::{Excitation, Inputs, Pulse};
use crate::numerics::roots::Sample;
use crate::simulation::outputs::{Observation, observe};
use crate::simulation::peaks::Channels;
use crate::simulation::{Energies, Simulation, SimulationError};
use crate::system::dynamics::{Footing, State, energy, height_of_what_stands, instant};
use crate::system::law::{AnyLaw, Law};
use crate::system::now::{Motion, Now};
use crate::system::surfaces::{Event, Surface};

/// How many continuous states there are.
pub const STATES: usize = 8;

/// θ (rad), θ̇ (rad/s), v (m), v̇ (m/s), u (m), u̇ (m/s), work of the excitation and energy that the dashpots took (J).
///
/// While what touches grips, u and u̇ follow from the others, and so do v and v̇ on the rigid base: there these states
/// are integrated along and not read.
pub type States = [f64; STATES];

/// How many event indicators there are: of the corners L and R, of the quarter turn, and of what slides.
pub const INDICATORS: usize = 4;

/// How far below the rigid base a corner is when its landing is found, as a part of R0: far less than the last of the
/// impacts, with 1e-9 p, rises.
const SMALLEST_GAP: f64 = 1e-20;

/// The indicator of what can end nothing at present.
const IDLE: f64 = 1.0;

/// What the present piece of a motion that is stepped from outside has beside the block's pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Piece {
    /// Time from which the excitation is seen (s): at its end it is still that of the piece.
    since: f64,
    /// How far each indicator is above its surface. A motion that begins on a surface, or by the importer's tolerance beyond
    /// it on its way back, has not fallen through it.
    offsets: [f64; INDICATORS],
}

impl Piece {
    /// All numbers finite.
    pub(super) fn is_finite(&self) -> bool {
        self.since.is_finite() && self.offsets.iter().all(|offset| offset.is_finite())
    }
}

impl Simulation {
    /// From here on the block is stepped from outside.
    pub fn begin_exchange(&mut self) {
        self.piece = Some(Piece { since: self.pose.time, offsets: [IDLE; INDICATORS] });
    }

    /// Time from which the present smooth piece of the excitation is seen (s).
    pub fn piece_time(&self) -> f64 {
        self.piece.map_or(self.pose.time, |piece| piece.since)
    }

    /// The excitation of the present smooth piece.
    pub(super) fn excitation(&self, inputs: &Inputs) -> Excitation {
        Excitation::from_time(self.piece_time(), inputs, &self.pulse, self.block())
    }

    /// The continuous states.
    pub fn states(&self, inputs: &Inputs) -> States {
        let (block, excitation) = (self.block(), self.excitation(inputs));
        let x = self.now(block, &excitation).instant;
        let works = [self.sums.input, self.sums.dashpots].map(|work| work * block.mass);
        [x.theta, x.theta_dot, x.v, x.v_dot, x.u, x.u_dot, works[0], works[1]]
    }

    /// Puts the block where these states say, at `time` (s), on the same contacts.
    pub fn set_states(&mut self, time: f64, states: &States) {
        let [theta, theta_dot, v, v_dot, u, u_dot, input, dashpots] = *states;
        let (block, regime) = (*self.block(), self.regime());
        if time != self.pose.time {
            self.events_in_this_instant = 0;
        }
        self.pose.time = time;
        let [w, w_dot] = height_of_what_stands(&block, regime, [theta, theta_dot, v, v_dot]);
        self.pose.state = State::from([theta, theta_dot, w, w_dot]);
        if let Footing::Free { .. } = self.pose.footing {
            self.pose.footing = Footing::Free { u, u_dot };
        }
        (self.sums.input, self.sums.dashpots) = (input / block.mass, dashpots / block.mass);
    }

    /// The derivatives of the states, per second; zeros once the run has ended.
    pub fn derivatives(&self, inputs: &Inputs) -> States {
        if self.ending.is_some() {
            return [0.0; STATES];
        }
        let (block, excitation) = (self.block(), self.excitation(inputs));
        let now = self.now(block, &excitation);
        let x = &now.instant;
        let powers = x.powers(block, now.regime, now.forcing).map(|power| power * block.mass);
        [x.theta_dot, x.theta_ddot, x.v_dot, x.v_ddot, x.u_dot, x.u_ddot, powers[0], powers[1]]
    }

    /// Sizes that the states typically have, for error control: nothing of them is zero.
    pub fn nominals(&self) -> States {
        let Block { alpha, p, r0, mass, gravity, omega_v, foundation, .. } = *self.block();
        let (vertical, rate) = match foundation {
            Foundation::Viscoelastic => (self.block().static_deflection(), omega_v),
            Foundation::Rigid => (r0 * alpha * alpha, p),
        };
        let barrier = mass * gravity * r0 * alpha * alpha;
        [alpha, alpha * p, vertical, vertical * rate, r0 * alpha, r0 * alpha * p, barrier, barrier]
    }

    /// The event indicators: an event is due where one falls below zero. A surface on which the motion begins, to rounding, is
    /// above zero.
    pub fn indicators(&self, inputs: &Inputs) -> [f64; INDICATORS] {
        if self.ending.is_some() {
            return [IDLE; INDICATORS];
        }
        let (block, excitation) = (self.block(), self.excitation(inputs));
        let now = self.now(block, &excitation);
        let mut indicators = self.piece.map_or([IDLE; INDICATORS], |piece| piece.offsets);
        for (indicator, surface) in indicators.iter_mut().zip(self.all_surfaces()) {
            *indicator = surface.map_or(IDLE, |surface| surface.sample(&now).value + *indicator);
        }
        indicators
    }

    fn all_surfaces(&self) -> [Option<Surface>; INDICATORS] {
        AnyLaw::of(self.block(), &self.pose).surfaces()
    }

    /// What becomes of the block where it is: a new smooth piece of the excitation begins, and what has fallen through a
    /// surface passes into the motion after it. Events are reported to `observer`.
    pub fn pass_events(&mut self, inputs: &Inputs, observer: &mut dyn FnMut(&Event)) -> Result<(), SimulationError> {
        let block = self.system.block;
        let excitation = self.excitation(inputs);
        let mut now = self.now(&block, &excitation);
        // At the beginning no offset is known, and the motion may begin beyond a surface.
        let mut offsets = match self.piece {
            Some(Piece { offsets, .. }) if offsets != [IDLE; INDICATORS] => offsets,
            _ => self.offsets(&now),
        };
        while self.ending.is_none() {
            let surfaces = self.all_surfaces().into_iter().zip(offsets);
            let fallen = surfaces.filter_map(|(surface, offset)| {
                let below = surface?.sample(&now).value + offset;
                (below <= 0.0).then_some((surface?, below))
            });
            let Some((surface, _)) = fallen.min_by(|a, b| a.1.total_cmp(&b.1)) else { break };
            now = self.apply(surface, &now, observer)?;
            offsets = self.offsets(&now);
        }
        self.piece = Some(Piece { since: self.pose.time, offsets: self.offsets(&now) });
        self.let_bear(&now);
        self.peaks.include(&now.channels());
        Ok(())
    }

    /// A step was done from outside: takes its peaks in, from inside the step as far as the rates at its ends tell. `last`
    /// are time and channels at the step's beginning; gives those at its end.
    pub fn complete_step(&mut self, inputs: &Inputs, last: Option<(f64, Channels)>) -> (f64, Channels) {
        let (block, excitation) = (*self.block(), self.excitation(inputs));
        let now = self.now(&block, &excitation);
        self.peaks.include(&now.channels());
        // The rates of others depend on those of the inputs, which are not known.
        let end = now.cheap_channels();
        let time = self.pose.time;
        if let Some((before, start)) = last.filter(|(before, _)| *before < time) {
            let duration = time - before;
            self.peaks.include_step(&start, &end, duration, |elapsed| start.hermite(&end, duration, elapsed));
        }
        self.let_bear(&now);
        (time, end)
    }

    /// The first kink of the pulse after the present time (s).
    pub fn next_kink(&self) -> Option<f64> {
        self.pulse.next_kink(self.pose.time)
    }

    /// What a user sees, the energies, and the derivatives of the states, each with its exact derivative in the direction
    /// whose components are `states` and the values of `inputs`.
    pub fn directional(&self, at: &Inputs, states: &States, inputs: &Inputs) -> (Observation<Dual64>, Energies) {
        let (block, excitation) = (self.block(), self.excitation(at));
        let direction = Excitation::from_time(0.0, inputs, &Pulse::NONE, block).at(inputs.time);
        let now = self.now(block, &excitation);
        let x = &now.instant;
        let dual = |value: f64, i: usize| Dual64::new(value, states[i]);
        let motion = [dual(x.theta, 0), dual(x.theta_dot, 1), dual(x.v, 2), dual(x.v_dot, 3)];
        let [w, w_dot] = height_of_what_stands(block, now.regime, motion);
        let footing = match now.footing {
            grips @ Footing::Grips { .. } => grips.map(Dual64::from),
            Footing::Free { u, u_dot } => Footing::Free { u: dual(u, 4), u_dot: dual(u_dot, 5) },
        };
        let forcing = now.forcing.with_derivative(direction);
        let x = instant(block, now.regime, [motion[0], motion[1], w, w_dot], footing, forcing);
        let tops = Motion::from_pose(block, &self.pose, &excitation).tops(self.pose.time);
        let seen = observe(block, now.regime, &x, tops.map(|top| Dual64::from(top.value)), forcing);
        let (kinetic, potential) = energy(block, now.regime, &x);
        let [kinetic, potential] = [kinetic, potential].map(|part| part.eps * block.mass);
        let (total, input, dashpots) = (kinetic + potential, states[6], states[7]);
        let residual = total - input + dashpots;
        let energies = Energies { total, kinetic, potential, input, dashpots, residual, ..Energies::default() };
        if self.ending.is_some() { (seen.frozen(), energies) } else { (seen, energies) }
    }

    /// How far each indicator is above its surface for a motion that begins at `now`: by what rounding leaves of a zero, or,
    /// where a gap is closed by more and opens, by so much that it opens above zero.
    fn offsets(&self, now: &Now) -> [f64; INDICATORS] {
        self.all_surfaces().map(|surface| {
            let Some(surface) = surface else { return IDLE };
            // A rate that a landing makes zero is so to rounding.
            let opens = |rate: f64| rate >= -surface.rounding(now.block) * now.block.p;
            let rounding = match (surface, now.block.foundation) {
                // Its gaps are zero at θ = 0 without rounding, and rocking that dies out has ever smaller ones.
                (Surface::Gap(_), Foundation::Rigid) if now.footing.grips() => SMALLEST_GAP * now.block.r0,
                _ => 2.0 * surface.rounding(now.block),
            };
            match (surface, surface.sample(now)) {
                // No more than that: bounces would sink in by twice as much each time.
                (Surface::Gap(_), Sample { value, rate }) if value < 0.0 && opens(rate) => rounding - value,
                _ => rounding,
            }
        })
    }
}

impl Channels {
    /// The cubics through values and rates at both ends of a step.
    fn hermite(&self, end: &Channels, duration: f64, elapsed: f64) -> Channels {
        let s = elapsed / duration;
        let between = |a: Sample, b: Sample| {
            let (change, slope) = (b.value - a.value, [a.rate * duration, b.rate * duration]);
            let (square, cube) = (3.0 * change - 2.0 * slope[0] - slope[1], slope[0] + slope[1] - 2.0 * change);
            Sample {
                value: a.value + s * (slope[0] + s * (square + s * cube)),
                rate: (slope[0] + s * (2.0 * square + s * 3.0 * cube)) / duration,
            }
        };
        let both = |a: [Sample; 2], b: [Sample; 2]| [between(a[0], b[0]), between(a[1], b[1])];
        Channels {
            theta: between(self.theta, end.theta),
            reaction: both(self.reaction, end.reaction),
            horizontal: between(self.horizontal, end.horizontal),
            uplift: both(self.uplift, end.uplift),
            friction_demand: between(self.friction_demand, end.friction_demand),
        }
    }
}
