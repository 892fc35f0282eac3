//! Shape, amplitude and period of a pulse → its acceleration, the integrals of it, and its kinks.

use std::f64::consts::{PI, SQRT_2, TAU};

use serde::{Deserialize, Serialize};

use crate::numerics::scalar::{CombinesWith, Elementary, Scalar};
#[cfg(feature = "lanes")]
use crate::numerics::wide::{Simd, Wide};

/// Shape of the pulse that is added to the horizontal ground acceleration.
///
/// Types A, B and Cn are the cycloidal pulses of Palmeri & Makris (2008), Table I. `t` counts from the start, `τ` from the middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(i32)]
pub enum PulseShape {
    /// No pulse.
    None = 1,
    /// Type A: one sine in acceleration, `a_p = ω_p v_p/2`.
    OneSine = 2,
    /// Type B: one cosine in acceleration, `a_p = ω_p v_p`.
    OneCosine = 3,
    /// Type C1: `v_g = v_p [sin(ω_p t + φ) − sin φ]`. It brings the ground back after one and a half half-cycles.
    C1 = 4,
    /// Type C2: the same with one more cycle.
    C2 = 5,
    /// Half a sine, `a_p sin ω_p t`, T_p/2 long (G. W. Housner, The behavior of inverted pendulum structures during earthquakes, BSSA 53
    /// (1963) 403–417).
    HalfSine = 6,
    /// Constant `a_p`, T_p long (Housner, 1963).
    Rectangular = 7,
    /// Symmetric Ricker wavelet, `a_p (1 − x²) exp(−x²/2)` with `x = √2 π τ/T_p`.
    ///
    /// It is 3 T_p long (M. F. Vassiliou, N. Makris, Estimating time scales and length scales in pulselike earthquake acceleration records
    /// with wavelet analysis, BSSA 101 (2011) 596–618).
    SymmetricRicker = 8,
    /// Antisymmetric Ricker wavelet, `a_p/β (y² − 3) y exp(−y²/2)` with `y = 2π τ/(√3 T_p)`.
    ///
    /// It is 4 T_p long (Vassiliou & Makris, 2011).
    AntisymmetricRicker = 9,
    /// Velocity `A/2 [1 + cos(ω_p τ/γ)] cos(ω_p τ + ν)` with `a_p = ω_p A`.
    ///
    /// It is γ T_p long (G. P. Mavroeidis, A. S. Papageorgiou, A mathematical representation of near-fault ground motions, BSSA 93 (2003)
    /// 1099–1131).
    Gabor = 10,
}

impl PulseShape {
    /// All shapes, in the order of their numbers.
    pub const ALL: [PulseShape; 10] = [
        PulseShape::None,
        PulseShape::OneSine,
        PulseShape::OneCosine,
        PulseShape::C1,
        PulseShape::C2,
        PulseShape::HalfSine,
        PulseShape::Rectangular,
        PulseShape::SymmetricRicker,
        PulseShape::AntisymmetricRicker,
        PulseShape::Gabor,
    ];
}

/// A ground pulse; outside its duration it is zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pulse<T = f64> {
    /// Its shape.
    pub shape: PulseShape,
    /// Amplitude a_p of the acceleration (m/s²): its peak, or `ω_p A` of [`PulseShape::Gabor`].
    pub amplitude: T,
    /// Period T_p (s).
    pub period: T,
    /// Time at which it begins (s).
    pub start: T,
    /// Phase ν of the velocity in the middle of [`PulseShape::Gabor`] (rad).
    pub phase: T,
    /// Duration of [`PulseShape::Gabor`] in periods, γ ≥ 1.
    pub cycles: T,
}

impl Pulse {
    /// No pulse; its phase and cycles are the defaults of all pulses.
    pub const NONE: Pulse =
        Pulse { shape: PulseShape::None, amplitude: 0.0, period: 1.0, start: 0.0, phase: 0.0, cycles: 2.0 };

    /// Whether it has no shape or no amplitude. Derivatives with respect to the amplitude need it nevertheless.
    pub fn is_none(&self) -> bool {
        self.shape == PulseShape::None || self.amplitude == 0.0
    }

    /// Returns the time at which it ends (s).
    pub fn end(&self) -> f64 {
        self.start + self.duration()
    }

    /// Whether it acts right after `time` (s): at its beginning, but not at its end.
    #[inline]
    pub fn acts_at(&self, time: f64) -> bool {
        self.shape != PulseShape::None && self.start <= time && time < self.end()
    }

    /// Returns the first beginning or end later than `time` (s).
    #[inline]
    pub fn next_kink(&self, time: f64) -> Option<f64> {
        match self.shape {
            PulseShape::None => None,
            PulseShape::OneSine
            | PulseShape::OneCosine
            | PulseShape::C1
            | PulseShape::C2
            | PulseShape::HalfSine
            | PulseShape::Rectangular
            | PulseShape::SymmetricRicker
            | PulseShape::AntisymmetricRicker
            | PulseShape::Gabor => [self.start, self.end()].into_iter().find(|&kink| kink > time),
        }
    }

    /// Returns its acceleration at `time` (m/s²).
    pub fn acceleration(&self, time: f64) -> f64 {
        if self.acts_at(time) { self.wave().map_or(self.amplitude, |wave| wave.at(time)) } else { 0.0 }
    }

    /// Returns its velocity at `time` (m/s), zero before it begins.
    pub fn velocity(&self, time: f64) -> f64 {
        let time = time.min(self.end());
        match (self.shape, self.wave()) {
            (PulseShape::None, _) => 0.0,
            _ if time < self.start => 0.0,
            (_, Some(wave)) => wave.drift(self.start, time).0,
            (_, None) => self.amplitude * (time - self.start),
        }
    }
}

impl<T: Elementary> Pulse<T> {
    /// Returns its duration (s) from the period T_p. Type Cn has n + ½ − φ/π periods.
    ///
    /// Ricker wavelets end where their acceleration is below 1e-8 a_p.
    pub fn duration(&self) -> T {
        let cycles = match self.shape {
            PulseShape::None => 0.0,
            PulseShape::OneSine | PulseShape::OneCosine | PulseShape::Rectangular => 1.0,
            PulseShape::C1 => 1.5 - C1_PHASE / PI,
            PulseShape::C2 => 2.5 - C2_PHASE / PI,
            PulseShape::HalfSine => 0.5,
            PulseShape::SymmetricRicker => 3.0,
            PulseShape::AntisymmetricRicker => 4.0,
            PulseShape::Gabor => return self.period * self.cycles,
        };
        self.period * cycles
    }

    /// Whether its acceleration is zero at its beginning and at its end.
    pub fn ends_at_zero(&self) -> bool {
        match self.shape {
            PulseShape::OneSine | PulseShape::HalfSine | PulseShape::Gabor => true,
            PulseShape::None
            | PulseShape::OneCosine
            | PulseShape::C1
            | PulseShape::C2
            | PulseShape::Rectangular
            | PulseShape::SymmetricRicker
            | PulseShape::AntisymmetricRicker => false,
        }
    }

    /// Returns a pulse of this shape with `of` each number.
    pub fn map<U>(&self, of: impl Fn(T) -> U) -> Pulse<U> {
        Pulse {
            shape: self.shape,
            amplitude: of(self.amplitude),
            period: of(self.period),
            start: of(self.start),
            phase: of(self.phase),
            cycles: of(self.cycles),
        }
    }

    /// Returns the acceleration (m/s²) of a pulse that is constant while it acts.
    pub(crate) fn constant(&self) -> Option<T> {
        (self.shape == PulseShape::Rectangular).then_some(self.amplitude)
    }

    /// Returns the acceleration of any other pulse while it acts.
    pub(crate) fn wave(&self) -> Option<Wave<T>> {
        let omega = T::from(TAU) / self.period;
        let middle = || self.start + self.duration() * 0.5;
        let sine = |phase| Wave {
            form: Form::Sine,
            amplitude: self.amplitude,
            omega,
            phase,
            origin: self.start,
            cycles: self.cycles,
        };
        let ricker = |form, amplitude, omega| Wave { form, amplitude, omega, origin: middle(), ..sine(T::from(0.0)) };
        Some(match self.shape {
            PulseShape::None | PulseShape::Rectangular => return None,
            PulseShape::OneSine | PulseShape::HalfSine => sine(T::from(0.0)),
            PulseShape::OneCosine => sine(T::from(0.5 * PI)),
            PulseShape::C1 => sine(T::from(0.5 * PI + C1_PHASE)),
            PulseShape::C2 => sine(T::from(0.5 * PI + C2_PHASE)),
            PulseShape::SymmetricRicker => ricker(Form::SymmetricRicker, self.amplitude, omega * (1.0 / SQRT_2)),
            PulseShape::AntisymmetricRicker => {
                // β, the peak of (y³ − 3y) exp(−y²/2), is at y² = 3 − √6.
                let at = 3.0 - 6.0_f64.sqrt();
                let beta = (6.0 * at).sqrt() * libm::exp(-0.5 * at);
                ricker(Form::AntisymmetricRicker, self.amplitude * (1.0 / beta), omega * (1.0 / 3.0_f64.sqrt()))
            }
            PulseShape::Gabor => Wave { form: Form::Gabor, origin: middle(), ..sine(self.phase) },
        })
    }
}

/// φ of a type-C1 pulse (rad), 0.0697π. It is the first positive root of `((2n+1)π − 2φ) tan φ = 2`, which is the paper's condition
/// `cos[(2n+1)π − φ] + [(2n+1)π − 2φ] sin φ − cos φ = 0` divided by cos φ, for n = 1.
const C1_PHASE: f64 = 0.21897952247562566;

/// φ of a type-C2 pulse (rad), 0.0410π: n = 2.
const C2_PHASE: f64 = 0.12872979703677595;

/// `1/((k + 1) (k + 2))`.
static FACTORS: [f64; 17] = factors();

const fn factors() -> [f64; 17] {
    let (mut factors, mut k) = ([0.0; 17], 0);
    while k < factors.len() {
        factors[k] = 1.0 / ((k + 1) * (k + 2)) as f64;
        k += 1;
    }
    factors
}

/// Formula of a [`Wave`] with amplitude `a`; `x` is `ω (t − origin)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `a sin(x + phase)`.
    Sine,
    /// `a (1 − x²) exp(−x²/2)`, the second derivative of `−a/ω² exp(−x²/2)`.
    SymmetricRicker,
    /// `a (x³ − 3x) exp(−x²/2)`, the second derivative of `a/ω² x exp(−x²/2)`.
    AntisymmetricRicker,
    /// The derivative of `a/(2ω) [1 + cos(x/cycles)] cos(x + phase)`.
    Gabor,
}

/// A smooth acceleration, valid while its pulse acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave<T = f64> {
    /// Its formula.
    pub form: Form,
    /// Its amplitude (m/s²).
    pub amplitude: T,
    /// Its circular frequency (rad/s).
    pub omega: T,
    /// Its phase (rad).
    pub phase: T,
    /// The time from which its phase is counted (s).
    pub origin: T,
    /// The cycles of [`Form::Gabor`].
    pub cycles: T,
}

impl<T: Scalar> Wave<T> {
    #[inline]
    pub(super) fn at<N: CombinesWith<T>>(&self, time: N) -> N {
        self.acceleration(time)
    }

    #[inline]
    pub(super) fn rate_at(&self, time: T) -> T {
        self.rate(time)
    }

    /// Returns the acceleration at `time` (m/s²), inlined with all functions that it calls.
    #[inline(always)]
    pub fn acceleration<N: CombinesWith<T>>(&self, time: N) -> N {
        let x = (time - self.origin) * self.omega;
        match self.form {
            Form::Sine => (x + self.phase).sin() * self.amplitude,
            Form::SymmetricRicker => (-(x * x) + 1.0) * self.amplitude * gaussian(x),
            Form::AntisymmetricRicker => x * self.amplitude * (x * x - 3.0) * gaussian(x),
            Form::Gabor => {
                let cycles = N::from(self.cycles);
                let ((sin_slow, cos_slow), (sin, cos)) = ((x / cycles).sin_cos(), (x + self.phase).sin_cos());
                -((sin_slow * cos / cycles + sin * (cos_slow + 1.0)) * (self.amplitude * 0.5))
            }
        }
    }

    /// Returns the rate of the acceleration at `time` (m/s³), inlined likewise.
    #[inline(always)]
    pub fn rate(&self, time: T) -> T {
        let x = self.omega * (time - self.origin);
        let rate = self.amplitude * self.omega;
        match self.form {
            Form::Sine => rate * (x + self.phase).cos(),
            Form::SymmetricRicker => rate * x * (x * x - 3.0) * gaussian(x),
            Form::AntisymmetricRicker => {
                let square = x * x;
                rate * (square * (-square + 6.0) - 3.0) * gaussian(x)
            }
            Form::Gabor => {
                let ((sin_slow, cos_slow), (sin, cos)) = ((x / self.cycles).sin_cos(), (x + self.phase).sin_cos());
                let of_cos = cos_slow / (self.cycles * self.cycles) + cos_slow + 1.0;
                -(rate * 0.5 * (cos * of_cos - sin_slow * sin / self.cycles * 2.0))
            }
        }
    }

    /// Whether it is a sine.
    pub(super) fn is_sine(&self) -> bool {
        self.form == Form::Sine
    }

    /// Adds the power series of a sine in the time elapsed since `time` (s).
    #[inline(always)]
    pub(super) fn add_series<const TERMS: usize, N: CombinesWith<T>>(&self, time: N, series: &mut [N; TERMS]) {
        const { assert!(TERMS <= FACTORS.len()) };
        let Wave { amplitude, omega, phase, origin, .. } = *self;
        let (sin, cos) = ((time - origin) * omega + phase).sin_cos();
        let (mut now, mut next) = (sin * amplitude, cos * (amplitude * omega));
        let square = -omega * omega;
        for k in 0..TERMS {
            series[k] = series[k] + now;
            (now, next) = (next, now * square * FACTORS[k]);
        }
    }
}

#[cfg(feature = "lanes")]
impl<V: Simd> Wave<Wide<V>> {
    /// Returns the waves of several lanes, all of one form. A lane without a wave gets an amplitude of zero.
    #[inline(always)]
    pub fn in_lanes<'a>(form: Form, of: impl Fn(usize) -> Option<&'a Wave>) -> Wave<Wide<V>> {
        let each = |number: fn(&Wave) -> f64| Wide::each(|lane| of(lane).map_or(1.0, number));
        Wave {
            form,
            amplitude: Wide::each(|lane| of(lane).map_or(0.0, |wave| wave.amplitude)),
            omega: each(|wave| wave.omega),
            phase: each(|wave| wave.phase),
            origin: each(|wave| wave.origin),
            cycles: each(|wave| wave.cycles),
        }
    }
}

/// `exp(−x²/2)`.
#[inline(always)]
fn gaussian<T: Scalar>(x: T) -> T {
    (x * x * -0.5).exp()
}

impl<T: Elementary> Wave<T> {
    /// Returns `(∫ a dt, ∫∫ a dt dt)` of this acceleration, in m/s and m. They are velocity and displacement of a body that was at rest.
    pub(super) fn drift(&self, from: T, to: T) -> (T, T) {
        let Wave { form, amplitude, omega, phase, origin, cycles } = *self;
        let duration = to - from;
        let [x_from, x_to] = [from, to].map(|time| omega * (time - origin));
        match form {
            Form::Sine => {
                let (sin_from, cos_from) = (x_from + phase).sin_cos();
                let (sin_to, cos_to) = (x_to + phase).sin_cos();
                let velocity = amplitude / omega * (cos_from - cos_to);
                (velocity, amplitude / omega * (cos_from * duration - (sin_to - sin_from) / omega))
            }
            Form::SymmetricRicker => {
                let [(v_from, d_from), (v_to, d_to)] = [x_from, x_to].map(|x| (x * gaussian(x), -gaussian(x)));
                let velocity = amplitude / omega;
                (velocity * (v_to - v_from), velocity * ((d_to - d_from) / omega - v_from * duration))
            }
            Form::AntisymmetricRicker => {
                let [(v_from, d_from), (v_to, d_to)] =
                    [x_from, x_to].map(|x| ((-(x * x) + 1.0) * gaussian(x), x * gaussian(x)));
                let velocity = amplitude / omega;
                (velocity * (v_to - v_from), velocity * ((d_to - d_from) / omega - v_from * duration))
            }
            Form::Gabor => {
                let [v_from, v_to] = [x_from, x_to].map(|x| ((x / cycles).cos() + 1.0) * 0.5 * (x + phase).cos());
                // The velocity is a sum of three cosines; the frequency of the last is zero for one cycle.
                let part = |weight: f64, ratio: T| {
                    let half = ratio * 0.5 * omega * duration;
                    let mean = if half.value() == 0.0 { T::from(1.0) } else { half.sin() / half };
                    mean * weight * (ratio * 0.5 * (x_from + x_to) + phase).cos()
                };
                let (one, inverse) = (T::from(1.0), T::from(1.0) / cycles);
                let mean = part(0.5, one) + part(0.25, one + inverse) + part(0.25, one - inverse);
                let velocity = amplitude / omega;
                (velocity * (v_to - v_from), velocity * (mean - v_from) * duration)
            }
        }
    }
}

impl Wave {
    /// Returns its greatest circular frequency (rad/s). For Ricker wavelets it is about 2 ω_p, above which little of their spectrum lies.
    pub fn frequency(&self) -> f64 {
        match self.form {
            Form::Sine => self.omega,
            Form::SymmetricRicker | Form::AntisymmetricRicker => 3.0 * self.omega,
            Form::Gabor => self.omega * (1.0 + 1.0 / self.cycles),
        }
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
            // A contraction by more than 10 a turn: from any start 20 turns reach the root to round-off.
            let root = (0..20).fold(0.0, |phase, _| libm::atan(2.0 / ((2.0 * n + 1.0) * PI - 2.0 * phase)));
            assert_eq!(phase, root, "n = {n}");
        }
    }
}
