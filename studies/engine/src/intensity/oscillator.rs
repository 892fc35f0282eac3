//! A record → the peaks of elastic oscillators: Sa(T), Sv(T), Housner's spectrum intensity.

use std::f64::consts::TAU;

use rocking_block::numerics::dual::Dual;
use rocking_block::numerics::roots::greatest;
use rocking_records::Record;

/// Damping ratio of all oscillators (1).
pub const DAMPING: f64 = 0.05;

/// The peak response of an oscillator to a record.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OscillatorPeaks {
    /// Greatest relative displacement max|u| (m).
    pub displacement: f64,
    /// Greatest relative velocity max|u̇| (m/s): the spectral velocity Sv, not the pseudo-velocity ω max|u|.
    pub velocity: f64,
}

/// Elastic pseudo-acceleration Sa(T) = ω² max|u| (m/s²) of an oscillator. It has 5 % damping and this period (s).
pub fn spectral_acceleration(record: &Record, period: f64) -> f64 {
    displacement(record, period) * (TAU / period) * (TAU / period)
}

/// Housner's spectrum intensity ∫ω max|u| dT (m) over the periods from 0.1 to 2.5 s. Pseudo-velocities are at 5 % damping (G. W. Housner,
/// Spectrum intensities of strong-motion earthquakes, Symposium on Earthquake and Blast Effects on Structures, EERI, 1952, 20–36), by the
/// trapezoidal rule in steps of 0.02 s.
pub fn spectrum_intensity(record: &Record) -> f64 {
    const STEPS: usize = 120;
    let velocity = |number: usize| {
        let period = 0.1 + 2.4 * number as f64 / STEPS as f64;
        displacement(record, period) * TAU / period
    };
    let inner: f64 = (1..STEPS).map(velocity).sum();
    (inner + 0.5 * (velocity(0) + velocity(STEPS))) * 2.4 / STEPS as f64
}

/// Greatest relative displacement max|u| (m).
fn displacement(record: &Record, period: f64) -> f64 {
    peaks::<false>(record, period).displacement
}

/// Peak response of an oscillator of 5 % damping and this period (s). It begins at rest, and ends one period after the record.
///
/// Each step is exact for an acceleration that is linear in time (N. C. Nigam, P. C. Jennings, Calculation of response
/// spectra from strong-motion earthquake records, Bull. Seism. Soc. Am. 59 (1969) 909–922). Peaks inside a step are found on the
/// same solution; a step of at most a 20th of the period has at most one of each sign.
pub fn oscillator_peaks(record: &Record, period: f64) -> OscillatorPeaks {
    peaks::<true>(record, period)
}

/// The [`oscillator_peaks`]; without `VELOCITY` the velocity stays zero, in half the computing time.
fn peaks<const VELOCITY: bool>(record: &Record, period: f64) -> OscillatorPeaks {
    const STEPS_A_PERIOD: f64 = 20.0;
    let omega = TAU / period;
    let substeps = (record.time_step / (period / STEPS_A_PERIOD)).ceil().max(1.0);
    let step = OscillatorStep::new(omega, DAMPING, record.time_step / substeps);
    let (mut state, mut peaks) = ([0.0; 2], OscillatorPeaks::default());
    let mut pass = |from: f64, to: f64| {
        let slope = (to - from) / record.time_step;
        for i in 0..substeps as u64 {
            let a = from + (to - from) * i as f64 / substeps;
            let before = state;
            state = step.advance(before, a, slope);
            let at =
                |t: f64| [OscillatorStep::new(omega, DAMPING, t).advance(before, a, slope), [a + slope * t, slope]];
            let ends = [[before, [a, slope]], [state, [a + slope * step.duration, slope]]];
            peaks.displacement =
                higher(peaks.displacement, ends, step.duration, |[[u, u_dot], _]| Dual::new(u, u_dot), at);
            if !VELOCITY {
                continue;
            }
            let rates =
                |[[u, u_dot], [a, _]]: Moment| Dual::new(u_dot, -a - omega * (2.0 * DAMPING * u_dot + omega * u));
            peaks.velocity = higher(peaks.velocity, ends, step.duration, rates, at);
        }
    };
    for pair in record.acceleration.windows(2) {
        pass(pair[0], pair[1]);
    }
    for _ in 0..(period / record.time_step).ceil() as u64 {
        pass(0.0, 0.0);
    }
    peaks
}

/// State of the oscillator, `[u, u̇]`, and of the ground, `[a, ȧ]`.
type Moment = [[f64; 2]; 2];

/// The greater of a previous peak and the peak within a step. `value_at` gives the value and its rate at a moment.
fn higher(
    peak: f64,
    [start, end]: [Moment; 2],
    duration: f64,
    value_at: impl Fn(Moment) -> Dual,
    at: impl Fn(f64) -> Moment,
) -> f64 {
    [1.0, -1.0].into_iter().fold(peak, |peak, sign| {
        let sample = |moment: Moment| value_at(moment) * sign;
        let (start, end) = (sample(start), sample(end));
        greatest(peak, start, end, duration, &mut |t| sample(at(t)))
    })
}

/// The step of `ü + 2 ζ ω u̇ + ω² u = −a(t)` with a linear a.
pub(crate) struct OscillatorStep {
    omega: f64,
    /// Damping ratio ζ, less than 1.
    damping: f64,
    omega_d: f64,
    duration: f64,
    /// `exp(−ζ ω h)` times cosine and sine of `ω_d h`.
    cos: f64,
    sin: f64,
}

impl OscillatorStep {
    pub(crate) fn new(omega: f64, damping: f64, duration: f64) -> OscillatorStep {
        let omega_d = omega * (1.0 - damping * damping).sqrt();
        let decay = libm::exp(-damping * omega * duration);
        let (sin, cos) = libm::sincos(omega_d * duration);
        OscillatorStep { omega, damping, omega_d, duration, cos: decay * cos, sin: decay * sin }
    }

    /// `[u, u̇]` at the end of the step. They follow from those at its start, the acceleration there and its rate.
    pub(crate) fn advance(&self, [u, u_dot]: [f64; 2], a: f64, slope: f64) -> [f64; 2] {
        let OscillatorStep { omega, damping, omega_d, duration, cos, sin } = *self;
        // The particular solution `c0 + c1 t`, plus the free vibration that meets the initial state.
        let c1 = -slope / (omega * omega);
        let c0 = (-a - 2.0 * damping * omega * c1) / (omega * omega);
        let free = u - c0;
        let free_sin = (u_dot - c1 + damping * omega * free) / omega_d;
        let free_end = free * cos + free_sin * sin;
        let rate_end = omega_d * (free_sin * cos - free * sin) - damping * omega * free_end;
        [free_end + c0 + c1 * duration, rate_end + c1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intensity::{near, pga, record_of};

    /// Under a constant acceleration the oscillator vibrates about −a/ω², first to `1 + exp(−ζπ/√(1−ζ²))` times that. Its
    /// velocity, `a/ω_d exp(−ζωt) sin ω_d t`, peaks where `tan ω_d t = √(1−ζ²)/ζ`.
    #[test]
    fn a_sudden_constant_acceleration_gives_the_closed_forms() {
        let root = (1.0 - DAMPING * DAMPING).sqrt();
        let exact = 2.0 * (1.0 + (-DAMPING * std::f64::consts::PI / root).exp());
        for (period, samples) in [(0.05, 1000), (0.3, 4000), (1.0, 11000), (2.5, 28000)] {
            // Long enough for the first transient to decay before the sudden end of the acceleration.
            let record = record_of(&vec![2.0; samples], 0.01);
            near(spectral_acceleration(&record, period), exact, 1e-13);
            let omega = TAU / period;
            let peak = 2.0 / omega * (-DAMPING / root * (root / DAMPING).atan()).exp();
            near(oscillator_peaks(&record, period).velocity, peak, 1e-13);
        }
    }

    /// The recurrence meets the closed form under `a = s t` with any step. From rest it is
    /// `u = s/ω³ [2ζ − ω t + exp(−ζωt) ((1 − 2ζ²)/√(1−ζ²) sin ω_d t − 2ζ cos ω_d t)]`.
    #[test]
    fn a_ramp_gives_the_closed_form_with_any_step() {
        let (omega, slope, root) = (TAU / 0.7, 3.0, (1.0 - DAMPING * DAMPING).sqrt());
        for h in [0.013, 0.1, 0.31] {
            let step = OscillatorStep::new(omega, DAMPING, h);
            let mut state = [0.0; 2];
            for i in 0..20 {
                state = step.advance(state, slope * f64::from(i) * h, slope);
                let t = f64::from(i + 1) * h;
                let (sin, cos) = (root * omega * t).sin_cos();
                let free = (1.0 - 2.0 * DAMPING * DAMPING) / root * sin - 2.0 * DAMPING * cos;
                let exact = slope / omega.powi(3) * (2.0 * DAMPING - omega * t + (-DAMPING * omega * t).exp() * free);
                near(state[0], exact, 1e-11);
            }
        }
    }

    /// A stiff oscillator follows the ground acceleration. A soft one stays in place, so that its relative velocity is that of the ground.
    /// Sa is proportional to the record.
    #[test]
    fn stiff_and_soft_limits_are_ground_values() {
        let samples: Vec<f64> = (0..400).map(|i| (0.05 * f64::from(i)).sin() * (0.011 * f64::from(i)).cos()).collect();
        let record = record_of(&samples, 0.01);
        near(spectral_acceleration(&record, 0.005), pga(&record), 1e-3);
        near(oscillator_peaks(&record, 900.0).velocity, crate::intensity::pgv(&record), 5e-3);
        let twice = record.clone().scaled(-2.0);
        near(spectral_acceleration(&twice, 0.8), 2.0 * spectral_acceleration(&record, 0.8), 1e-14);
    }
}
