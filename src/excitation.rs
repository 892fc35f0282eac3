//! Inputs over a step and the built-in pulse → the forcing, per unit of the block's mass, at any time of a smooth piece.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use crate::block::ties::NO_TIES;
use crate::block::{Block, TieStates};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{Elementary, Real, Scalar};

/// A value that changes linearly in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ramp<T = f64> {
    /// Value at the reference time of the [`Inputs`].
    pub value: T,
    /// Its rate of change, per second.
    pub rate: T,
}

impl<T: Scalar> Ramp<T> {
    /// A constant.
    #[inline(always)]
    pub fn held(value: T) -> Ramp<T> {
        Ramp { value, rate: T::from(0.0) }
    }

    #[inline(always)]
    fn at(self, elapsed: T) -> T {
        self.value + self.rate * elapsed
    }

    /// The ramp seen from a reference time `elapsed` seconds later.
    pub fn moved(self, elapsed: T) -> Ramp<T> {
        Ramp { value: self.at(elapsed), rate: self.rate }
    }
}

impl<T: Elementary> Ramp<T> {
    fn minus(self, force: Ramp<T>, mass: T) -> Ramp<T> {
        // No force needs no divisions.
        if force.value.is_zero() && force.rate.is_zero() {
            return self;
        }
        Ramp { value: self.value - force.value / mass, rate: self.rate - force.rate / mass }
    }
}

/// The inputs from a reference time on, each linear in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Inputs<T = f64> {
    /// Reference time of the ramps (s).
    pub time: T,
    /// Horizontal ground acceleration (m/s²), positive to the right.
    pub a_gx: Ramp<T>,
    /// Vertical ground acceleration (m/s²), positive up.
    pub a_gz: Ramp<T>,
    /// Horizontal load on the centre of mass (N), positive to the right.
    pub f_x: Ramp<T>,
    /// Vertical load on the centre of mass (N), positive up.
    pub f_z: Ramp<T>,
    /// Moment on the block (N.m), positive clockwise.
    pub m_y: Ramp<T>,
}

impl Inputs {
    /// The sum of both, with the reference of `self`.
    pub fn plus(&self, others: &Inputs) -> Inputs {
        let sum = |a: Ramp, b: Ramp| Ramp { value: a.value + b.value, rate: a.rate + b.rate };
        self.with(&others.moved_to(self.time), sum)
    }

    /// The same inputs with their reference at another time.
    pub fn moved_to(&self, time: f64) -> Inputs {
        let elapsed = time - self.time;
        Inputs { time, ..self.with(self, |ramp, _| ramp.moved(elapsed)) }
    }

    /// The values at the reference time, held constant.
    pub fn held(&self) -> Inputs {
        self.with(self, |ramp, _| Ramp::held(ramp.value))
    }

    /// The line from these values to the values of `end`, each at its reference time.
    pub fn line_to(&self, end: &Inputs) -> Inputs {
        let duration = end.time - self.time;
        self.with(end, |a, b| Ramp { value: a.value, rate: (b.value - a.value) / duration })
    }

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        let Inputs { time, a_gx, a_gz, f_x, f_z, m_y } = self;
        time.is_finite()
            && [a_gx, a_gz, f_x, f_z, m_y].iter().all(|ramp| ramp.value.is_finite() && ramp.rate.is_finite())
    }

    /// Combines each input with that of `others`, and keeps the reference time.
    fn with(&self, others: &Inputs, combine: impl Fn(Ramp, Ramp) -> Ramp) -> Inputs {
        Inputs {
            time: self.time,
            a_gx: combine(self.a_gx, others.a_gx),
            a_gz: combine(self.a_gz, others.a_gz),
            f_x: combine(self.f_x, others.f_x),
            f_z: combine(self.f_z, others.f_z),
            m_y: combine(self.m_y, others.m_y),
        }
    }
}

/// Shape of the pulse that is added to the horizontal ground acceleration; cycloidal pulses of the paper's Table I.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(i32)]
pub enum PulseShape {
    /// No pulse.
    None = 1,
    /// Type A: one sine in acceleration, `a_p = ω_p v_p/2`.
    OneSine = 2,
    /// Type B: one cosine in acceleration, `a_p = ω_p v_p`.
    OneCosine = 3,
    /// Type C1: `v_g = v_p [sin(ω_p t + φ) − sin φ]`, which brings the ground back after one and a half half-cycles.
    C1 = 4,
    /// Type C2: the same with one more cycle.
    C2 = 5,
}

/// A ground pulse; outside its duration it is zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pulse<T = f64> {
    /// Its shape.
    pub shape: PulseShape,
    /// Amplitude a_p of the acceleration (m/s²).
    pub amplitude: T,
    /// Period T_p (s).
    pub period: T,
    /// Time at which it begins (s).
    pub start: T,
}

impl Pulse {
    /// No pulse at all.
    pub const NONE: Pulse = Pulse { shape: PulseShape::None, amplitude: 0.0, period: 1.0, start: 0.0 };

    /// Duration (s): T_p, or (n + ½ − φ/π) T_p for type Cn.
    pub fn duration(&self) -> f64 {
        let cycles = match self.shape {
            PulseShape::None => 0.0,
            PulseShape::OneSine | PulseShape::OneCosine => 1.0,
            PulseShape::C1 => 1.5 - C1_PHASE / PI,
            PulseShape::C2 => 2.5 - C2_PHASE / PI,
        };
        cycles * self.period
    }

    /// Time at which it ends (s).
    pub fn end(&self) -> f64 {
        self.start + self.duration()
    }

    /// Whether it acts from `time` on: the beginning counts as inside, the end as outside.
    pub fn acts_at(&self, time: f64) -> bool {
        self.shape != PulseShape::None && self.start <= time && time < self.end()
    }

    /// The first beginning or end later than `time` (s).
    pub fn next_kink(&self, time: f64) -> Option<f64> {
        match self.shape {
            PulseShape::None => None,
            PulseShape::OneSine | PulseShape::OneCosine | PulseShape::C1 | PulseShape::C2 => {
                [self.start, self.end()].into_iter().find(|&kink| kink > time)
            }
        }
    }

    /// Its acceleration at `time` (m/s²).
    pub fn acceleration(&self, time: f64) -> f64 {
        if self.acts_at(time) { self.wave().at(time) } else { 0.0 }
    }
}

impl<T: Elementary> Pulse<T> {
    fn wave(&self) -> Wave<T> {
        let phase = match self.shape {
            PulseShape::None | PulseShape::OneSine => 0.0,
            PulseShape::OneCosine => 0.5 * PI,
            PulseShape::C1 => 0.5 * PI + C1_PHASE,
            PulseShape::C2 => 0.5 * PI + C2_PHASE,
        };
        Wave { amplitude: self.amplitude, omega: T::from(TAU) / self.period, phase, start: self.start }
    }
}

/// φ of a type-C1 pulse (rad), 0.0697π: the first positive root of `((2n+1)π − 2φ) tan φ = 2`, which is the paper's
/// condition `cos[(2n+1)π − φ] + [(2n+1)π − 2φ] sin φ − cos φ = 0` divided by cos φ, for n = 1.
const C1_PHASE: f64 = 0.21897952247562566;

/// The same of a type-C2 pulse (rad), 0.0410π: n = 2.
const C2_PHASE: f64 = 0.12872979703677595;

/// `amplitude · sin(ω (t − start) + phase)`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wave<T = f64> {
    amplitude: T,
    omega: T,
    phase: f64,
    start: T,
}

impl<T: Scalar> Wave<T> {
    #[inline]
    fn at(&self, time: T) -> T {
        self.amplitude * (self.omega * (time - self.start) + self.phase).sin()
    }

    #[inline]
    fn rate_at(&self, time: T) -> T {
        self.amplitude * self.omega * (self.omega * (time - self.start) + self.phase).cos()
    }
}

/// The forcing at one instant, per unit of the block's mass: ground accelerations less the loads' share.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Forcing<T> {
    /// `a_gx − F_x/M` (m/s²).
    pub x: T,
    /// `a_gz − F_z/M` (m/s²).
    pub z: T,
    /// `M_y/M` (m²/s²).
    pub moment: T,
    /// The ties that pull at this instant: they are loads that follow from where the block is.
    pub ties: TieStates,
}

impl<R: Real> Forcing<R> {
    /// This forcing as dual numbers with `derivative` in their dual parts.
    #[inline(always)]
    pub fn with_derivative(self, derivative: Forcing<R>) -> Forcing<Dual<R>> {
        Forcing {
            x: Dual::new(self.x, derivative.x),
            z: Dual::new(self.z, derivative.z),
            moment: Dual::new(self.moment, derivative.moment),
            ties: self.ties,
        }
    }
}

/// The excitation over a piece of time in which it is smooth: no pulse begins or ends inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excitation<T = f64> {
    time: T,
    x: Ramp<T>,
    z: Ramp<T>,
    moment: Ramp<T>,
    wave: Option<Wave<T>>,
}

impl<T: Elementary> Excitation<T> {
    /// The excitation of a block of this mass (kg), with a pulse if there is one that acts.
    pub fn new(inputs: &Inputs<T>, pulse: Option<&Pulse<T>>, mass: T) -> Excitation<T> {
        Excitation {
            time: inputs.time,
            x: inputs.a_gx.minus(inputs.f_x, mass),
            z: inputs.a_gz.minus(inputs.f_z, mass),
            moment: Ramp::held(T::from(0.0)).minus(inputs.m_y, -mass),
            wave: pulse.map(Pulse::wave),
        }
    }
}

impl<T: Scalar> Excitation<T> {
    /// Ground accelerations alone, horizontal and vertical, from a reference time (s) on.
    #[inline(always)]
    pub fn of_ground(time: T, [x, z]: [Ramp<T>; 2]) -> Excitation<T> {
        Excitation { time, x, z, moment: Ramp::held(T::from(0.0)), wave: None }
    }

    /// The forcing at `time` (s), without ties.
    #[inline(always)]
    pub fn at(&self, time: T) -> Forcing<T> {
        let elapsed = time - self.time;
        let pulse = match &self.wave {
            Some(wave) => wave.at(time),
            None => T::from(0.0),
        };
        Forcing { x: self.x.at(elapsed) + pulse, z: self.z.at(elapsed), moment: self.moment.at(elapsed), ties: NO_TIES }
    }

    /// The rate at which the forcing changes at `time` (s), per second.
    #[inline(always)]
    pub fn rate_at(&self, time: T) -> Forcing<T> {
        let pulse = match &self.wave {
            Some(wave) => wave.rate_at(time),
            None => T::from(0.0),
        };
        Forcing { x: self.x.rate + pulse, z: self.z.rate, moment: self.moment.rate, ties: NO_TIES }
    }
}

impl Excitation {
    /// The excitation of `block` from `time` to the pulse's next kink.
    pub fn from_time(time: f64, inputs: &Inputs, pulse: &Pulse, block: &Block) -> Excitation {
        Excitation::new(inputs, pulse.acts_at(time).then_some(pulse), block.mass)
    }

    /// Nothing drives the block.
    pub fn none() -> Excitation {
        Excitation { time: 0.0, x: Ramp::default(), z: Ramp::default(), moment: Ramp::default(), wave: None }
    }

    /// Integrals of the horizontal forcing between two times: `(∫ x dt, ∫∫ x dt dt)` in m/s and m.
    pub fn horizontal_drift(&self, from: f64, to: f64) -> (f64, f64) {
        let duration = to - from;
        let start = self.x.at(from - self.time);
        let (mut velocity, mut way) = (
            duration * (start + 0.5 * self.x.rate * duration),
            duration * duration * (0.5 * start + self.x.rate * duration / 6.0),
        );
        if let Some(Wave { amplitude, omega, phase, start }) = self.wave {
            let (sin_from, cos_from) = libm::sincos(omega * (from - start) + phase);
            let (sin_to, cos_to) = libm::sincos(omega * (to - start) + phase);
            velocity += amplitude / omega * (cos_from - cos_to);
            way += amplitude / omega * (cos_from * duration - (sin_to - sin_from) / omega);
        }
        (velocity, way)
    }

    /// The reference time and the ground accelerations from there on, horizontal and vertical, where nothing else acts.
    pub fn ground_alone(&self) -> Option<(f64, [Ramp; 2])> {
        (self.wave.is_none() && self.moment == Ramp::default()).then_some((self.time, [self.x, self.z]))
    }

    /// Whether nothing of it changes.
    pub fn is_constant(&self) -> bool {
        self.wave.is_none() && [self.x, self.z, self.moment].iter().all(|ramp| ramp.rate == 0.0)
    }

    /// Circular frequency of the pulse that acts (rad/s), zero if none does.
    pub fn frequency(&self) -> f64 {
        self.wave.map_or(0.0, |wave| wave.omega)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The paper gives 0.0697π and 0.0410π.
    #[test]
    fn phases_of_c_pulses_are_roots_of_the_papers_condition() {
        for (n, phase, printed) in [(1.0, C1_PHASE, 0.0697), (2.0, C2_PHASE, 0.0410)] {
            assert!((phase / PI - printed).abs() < 5e-5, "n = {n}: {phase} rad");
            // A contraction by more than 10 a turn: from any start 20 turns reach the root to rounding.
            let root = (0..20).fold(0.0, |phase, _| libm::atan(2.0 / ((2.0 * n + 1.0) * PI - 2.0 * phase)));
            assert_eq!(phase, root, "n = {n}");
        }
    }
}
