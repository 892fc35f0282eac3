//! Records, inputs over a step and the built-in pulse → the forcing at any time of a smooth piece.
//!
//! Forcing is per unit of the block's mass.

mod pulse;
pub mod records;

use std::ops::Mul;

use serde::{Deserialize, Serialize};

use crate::block::Body;
use crate::block::restraints::States;
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary, Scalar};
#[cfg(feature = "lanes")]
use crate::numerics::wide::{Simd, Wide};
pub use pulse::{Form, Pulse, PulseShape, Wave};

/// A value that changes linearly in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ramp<T = f64> {
    /// Value at the reference time of the [`Inputs`].
    pub value: T,
    /// Its rate of change, per second.
    pub rate: T,
}

impl<T: Scalar> Ramp<T> {
    /// Returns a constant.
    #[inline(always)]
    pub fn held(value: T) -> Ramp<T> {
        Ramp { value, rate: T::from(0.0) }
    }

    /// Returns the value `elapsed` (s) after the reference time.
    #[inline(always)]
    pub fn at<N: CombinesWith<T>>(self, elapsed: N) -> N {
        elapsed * self.rate + self.value
    }

    /// Returns the ramp with a reference time `elapsed` (s) later.
    pub fn moved(self, elapsed: T) -> Ramp<T> {
        Ramp { value: self.at(elapsed), rate: self.rate }
    }
}

impl<T: Elementary> Ramp<T> {
    /// Returns the acceleration less that of a force on a mass (kg).
    #[inline(always)]
    pub(crate) fn minus(self, force: Ramp<T>, mass: T) -> Ramp<T> {
        // The usual case without loads needs no divisions.
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
    /// Returns the sum of both, with the reference time of `self`.
    pub fn plus(&self, others: &Inputs) -> Inputs {
        let sum = |a: Ramp, b: Ramp| Ramp { value: a.value + b.value, rate: a.rate + b.rate };
        self.with(&others.moved_to(self.time), sum)
    }

    /// Returns the inputs with another reference time.
    #[inline]
    pub fn moved_to(&self, time: f64) -> Inputs {
        let mut moved = *self;
        moved.move_to(time);
        moved
    }

    /// Gives the inputs another reference time.
    #[inline]
    pub fn move_to(&mut self, time: f64) {
        if time != self.time {
            let elapsed = time - self.time;
            for ramp in self.ramps() {
                *ramp = ramp.moved(elapsed);
            }
            self.time = time;
        }
    }

    /// Holds the inputs constant at their values at the reference time.
    #[inline]
    pub fn hold(&mut self) {
        for ramp in self.ramps() {
            *ramp = Ramp::held(ramp.value);
        }
    }

    #[inline(always)]
    fn ramps(&mut self) -> [&mut Ramp; 5] {
        let Inputs { time: _, a_gx, a_gz, f_x, f_z, m_y } = self;
        [a_gx, a_gz, f_x, f_z, m_y]
    }

    /// Returns the line from these values to those of `end`, each at its reference time.
    pub fn line_to(&self, end: &Inputs) -> Inputs {
        let duration = end.time - self.time;
        self.with(end, |a, b| Ramp { value: a.value, rate: (b.value - a.value) / duration })
    }

    /// Whether there are no loads.
    #[cfg(feature = "lanes")]
    #[inline]
    pub fn is_ground_motion(&self) -> bool {
        let Inputs { f_x, f_z, m_y, .. } = self;
        // One test of all bits but the signs replaces six comparisons.
        let bits = |load: &Ramp| load.value.to_bits() | load.rate.to_bits();
        (bits(f_x) | bits(f_z) | bits(m_y)) << 1 == 0
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

/// The forcing at one instant: ground accelerations less the loads', per unit of mass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Forcing<T> {
    /// `a_gx − F_x/M` (m/s²).
    pub x: T,
    /// `a_gz − F_z/M` (m/s²).
    pub z: T,
    /// `M_y/M` (m²/s²).
    pub moment: T,
    /// The states of the restraints. Those that act are loads that depend on the motion.
    pub restraints: States<T>,
}

impl<R: Scalar> Forcing<R> {
    /// Returns the forcing with `derivative` in the dual parts.
    #[inline(always)]
    pub fn with_derivative(self, derivative: Forcing<R>) -> Forcing<Dual<R>> {
        Forcing {
            x: Dual::new(self.x, derivative.x),
            z: Dual::new(self.z, derivative.z),
            moment: Dual::new(self.moment, derivative.moment),
            restraints: self.restraints.map(|number| Dual::new(number, R::default())),
        }
    }
}

/// The forcing after an instant as power series of the elapsed time (s), without restraints.
#[derive(Clone, Copy, Debug)]
pub struct ForcingSeries<const N: usize, T = f64> {
    /// Coefficients of `a_gx − F_x/M` (m/s²).
    pub x: [T; N],
    /// Number of coefficients of x that may differ from zero.
    pub terms: usize,
    /// Coefficients of `a_gz − F_z/M` (m/s²), which is linear.
    pub z: [T; 2],
    /// Coefficients of `M_y/M` (m²/s²), which is linear.
    pub moment: [T; 2],
}

impl<const N: usize, T: Scalar> ForcingSeries<N, T> {
    /// Rescales the powers to a unit of time `factor` times as long.
    #[inline(always)]
    pub fn scale<S: Copy + Mul<Output = S>>(&mut self, factor: S)
    where
        T: Mul<S, Output = T>,
    {
        let mut power = factor;
        for k in 1..self.terms {
            self.x[k] = self.x[k] * power;
            power = power * factor;
        }
        self.z[1] = self.z[1] * factor;
        self.moment[1] = self.moment[1] * factor;
    }
}

/// The excitation over a smooth piece of time, in which no pulse begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excitation<T = f64> {
    time: T,
    x: Ramp<T>,
    z: Ramp<T>,
    moment: Ramp<T>,
    wave: Option<Wave<T>>,
}

impl<T: Elementary> Excitation<T> {
    /// Returns the excitation of a block of this mass (kg), with any acting pulse.
    #[inline]
    pub fn new(inputs: &Inputs<T>, pulse: Option<&Pulse<T>>, mass: T) -> Excitation<T> {
        let mut x = inputs.a_gx.minus(inputs.f_x, mass);
        let (constant, wave) = pulse.map_or((None, None), |pulse| (pulse.constant(), pulse.wave()));
        if let Some(constant) = constant {
            x.value = x.value + constant;
        }
        Excitation {
            time: inputs.time,
            x,
            z: inputs.a_gz.minus(inputs.f_z, mass),
            moment: Ramp::held(T::from(0.0)).minus(inputs.m_y, -mass),
            wave,
        }
    }
}

impl<T: Elementary> Excitation<T> {
    /// Returns the integrals of the horizontal forcing between two times. They are `(∫ x dt, ∫∫ x dt dt)` in m/s and m.
    pub fn horizontal_drift(&self, from: T, to: T) -> (T, T) {
        let duration = to - from;
        let start = self.x.at(from - self.time);
        let (mut velocity, mut displacement) = (
            duration * (start + self.x.rate * 0.5 * duration),
            duration * duration * (start * 0.5 + self.x.rate * duration / T::from(6.0)),
        );
        if let Some(wave) = &self.wave {
            let drift = wave.drift(from, to);
            (velocity, displacement) = (velocity + drift.0, displacement + drift.1);
        }
        (velocity, displacement)
    }
}

impl<T: Scalar> Excitation<T> {
    /// Returns horizontal and vertical ground accelerations alone, from a reference time (s) on.
    #[inline(always)]
    pub fn of_ground(time: T, [x, z]: [Ramp<T>; 2]) -> Excitation<T> {
        Excitation { time, x, z, moment: Ramp::held(T::from(0.0)), wave: None }
    }

    /// Adds the rate of a pulse's acceleration (m/s³) to the excitation, for [`Excitation::rate_at`].
    #[inline(always)]
    pub fn with_rate(mut self, of_pulse: T) -> Excitation<T> {
        self.x.rate = self.x.rate + of_pulse;
        self
    }

    /// Whether the excitation is linear in time.
    #[inline]
    pub fn is_linear(&self) -> bool {
        self.wave.is_none()
    }

    /// Returns the forcing at `time` (s), without restraints.
    #[inline(always)]
    pub fn at<N: CombinesWith<T>>(&self, time: N) -> Forcing<N> {
        let pulse = match &self.wave {
            Some(wave) => wave.at(time),
            None => N::from(0.0),
        };
        self.at_with(pulse, time)
    }

    /// Returns the forcing at `time` (s) with a known acceleration of the pulse (m/s²).
    #[inline(always)]
    pub fn at_with<N: CombinesWith<T>>(&self, pulse: N, time: N) -> Forcing<N> {
        let elapsed = time - self.time;
        Forcing {
            x: self.x.at(elapsed) + pulse,
            z: self.z.at(elapsed),
            moment: self.moment.at(elapsed),
            restraints: States::NONE,
        }
    }

    /// Returns the rate of the forcing at `time` (s), per second.
    #[inline(always)]
    pub fn rate_at(&self, time: T) -> Forcing<T> {
        let pulse = match &self.wave {
            Some(wave) => wave.rate_at(time),
            None => T::from(0.0),
        };
        Forcing { x: self.x.rate + pulse, z: self.z.rate, moment: self.moment.rate, restraints: States::NONE }
    }

    /// Returns the forcing after `time` (s) as power series; needs [`Excitation::has_series`].
    #[inline(always)]
    pub fn series<const TERMS: usize, N: CombinesWith<T>>(&self, time: N) -> ForcingSeries<TERMS, N> {
        let elapsed = time - self.time;
        let linear = |ramp: Ramp<T>| [ramp.at(elapsed), ramp.rate.into()];
        let mut series =
            ForcingSeries { x: [N::from(0.0); TERMS], terms: 2, z: linear(self.z), moment: linear(self.moment) };
        [series.x[0], series.x[1]] = linear(self.x);
        if let Some(wave) = &self.wave {
            wave.add_series(time, &mut series.x);
            series.terms = TERMS;
        }
        series
    }

    /// Whether the power series has a simple form, as for a sine or no wave.
    #[inline]
    pub fn has_series(&self) -> bool {
        self.wave.is_none_or(|wave| wave.is_sine())
    }
}

#[cfg(feature = "lanes")]
impl<V: Simd> Excitation<Wide<V>> {
    /// Returns the excitations of several lanes, whose waves, if any, are sines.
    #[inline(always)]
    pub fn in_lanes<'a>(has_waves: bool, of: impl Fn(usize) -> &'a Excitation) -> Excitation<Wide<V>> {
        let ramp = |ramp: fn(&Excitation) -> &Ramp| Ramp {
            value: Wide::each(|lane| ramp(of(lane)).value),
            rate: Wide::each(|lane| ramp(of(lane)).rate),
        };
        Excitation {
            time: Wide::each(|lane| of(lane).time),
            x: ramp(|excitation| &excitation.x),
            z: ramp(|excitation| &excitation.z),
            moment: ramp(|excitation| &excitation.moment),
            wave: has_waves.then(|| Wave::in_lanes(Form::Sine, |lane| of(lane).wave.as_ref())),
        }
    }
}

impl Excitation {
    /// Returns the excitation of `block` from `time` (s) to the pulse's next kink.
    #[inline]
    pub fn from_time(time: f64, inputs: &Inputs, pulse: &Pulse, body: &Body) -> Excitation {
        Excitation::new(inputs, pulse.acts_at(time).then_some(pulse), body.mass)
    }

    /// Copies another excitation number by number. A block copy would stall until the processor has stored all of them.
    #[cfg(feature = "lanes")]
    #[inline(always)]
    pub fn adopt(&mut self, other: &Excitation) {
        self.time = other.time;
        (self.x.value, self.x.rate) = (other.x.value, other.x.rate);
        (self.z.value, self.z.rate) = (other.z.value, other.z.rate);
        (self.moment.value, self.moment.rate) = (other.moment.value, other.moment.rate);
        if self.wave.is_some() || other.wave.is_some() {
            self.wave = other.wave;
        }
    }

    /// Returns zero excitation.
    pub fn none() -> Excitation {
        Excitation { time: 0.0, x: Ramp::default(), z: Ramp::default(), moment: Ramp::default(), wave: None }
    }

    /// Returns reference time (s), linear accelerations and pulse, or `None` if a moment acts. The accelerations are the horizontal and the
    /// vertical one.
    #[inline]
    pub fn without_moment(&self) -> Option<(f64, [Ramp; 2], Option<Wave>)> {
        (self.moment == Ramp::default()).then_some((self.time, [self.x, self.z], self.wave))
    }

    /// Whether the excitation is constant.
    #[inline]
    pub fn is_constant(&self) -> bool {
        self.wave.is_none() && [self.x, self.z, self.moment].iter().all(|ramp| ramp.rate == 0.0)
    }

    /// Returns the greatest circular frequency of the acting pulse (rad/s), or zero.
    #[inline]
    pub fn frequency(&self) -> f64 {
        self.wave.map_or(0.0, |wave| wave.frequency())
    }
}
