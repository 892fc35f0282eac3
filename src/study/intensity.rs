//! A record → what tells how strong it is: PGA, PGV, Sa(T).

use std::f64::consts::TAU;

use crate::records::Record;

/// Damping ratio of the oscillator of Sa (1).
pub const DAMPING: f64 = 0.05;

/// Peak ground acceleration (m/s²): greatest |a|.
pub fn pga(record: &Record) -> f64 {
    record.peak().acceleration.abs()
}

/// Peak ground velocity (m/s): greatest |∫a dt| from rest at the first sample, by the trapezoidal rule, which is exact for
/// an acceleration that is linear between samples; where it changes its sign between two, the velocity has its extreme
/// there. No base line is taken away.
pub fn pgv(record: &Record) -> f64 {
    let dt = record.time_step;
    let (mut velocity, mut peak) = (0.0, 0.0_f64);
    for (a, b) in record.acceleration.iter().zip(record.acceleration.iter().skip(1)) {
        if a * b < 0.0 {
            peak = peak.max((velocity + 0.5 * a * dt * a / (a - b)).abs());
        }
        velocity += 0.5 * (a + b) * dt;
        peak = peak.max(velocity.abs());
    }
    peak
}

/// Elastic pseudo-acceleration Sa(T) = ω² max|u| (m/s²) of an oscillator of 5 % damping and this period (s), at rest when
/// the record begins, followed until one period after its end.
///
/// Each step is exact for an acceleration that is linear in time (N. C. Nigam, P. C. Jennings, Calculation of response
/// spectra from strong-motion earthquake records, Bull. Seism. Soc. Am. 59 (1969) 909–922). Steps are at most a 200th
/// of the period, so that the greatest of the values at their ends is at most 1.3e-4 below the peak between them.
pub fn spectral_acceleration(record: &Record, period: f64) -> f64 {
    const STEPS_A_PERIOD: f64 = 200.0;
    let parts = (record.time_step / (period / STEPS_A_PERIOD)).ceil().max(1.0);
    let step = Step::new(TAU / period, record.time_step / parts);
    let (mut state, mut peak) = ([0.0; 2], 0.0_f64);
    let mut pass = |from: f64, to: f64| {
        let slope = (to - from) / parts;
        for i in 0..parts as u64 {
            state = step.take(state, from + i as f64 * slope, slope);
            peak = peak.max(state[0].abs());
        }
    };
    for (a, b) in record.acceleration.iter().zip(record.acceleration.iter().skip(1)) {
        pass(*a, *b);
    }
    for _ in 0..(period / record.time_step).ceil() as u64 {
        pass(0.0, 0.0);
    }
    peak * step.omega * step.omega
}

/// `ü + 2 ζ ω u̇ + ω² u = −a(t)` over a step in which a is linear.
struct Step {
    omega: f64,
    omega_d: f64,
    duration: f64,
    /// `exp(−ζ ω h)` times cosine and sine of `ω_d h`.
    cos: f64,
    sin: f64,
}

impl Step {
    fn new(omega: f64, duration: f64) -> Step {
        let omega_d = omega * (1.0 - DAMPING * DAMPING).sqrt();
        let decay = libm::exp(-DAMPING * omega * duration);
        let (sin, cos) = libm::sincos(omega_d * duration);
        Step { omega, omega_d, duration, cos: decay * cos, sin: decay * sin }
    }

    /// `[u, u̇]` at the end from those at the beginning, the acceleration there and its change over the step.
    fn take(&self, [u, u_dot]: [f64; 2], a: f64, change: f64) -> [f64; 2] {
        let Step { omega, omega_d, duration, cos, sin } = *self;
        // The solution that is linear in time, `c0 + c1 t`, and the free motion that makes up for the rest.
        let c1 = -change / duration / (omega * omega);
        let c0 = (-a - 2.0 * DAMPING * omega * c1) / (omega * omega);
        let free = u - c0;
        let free_sin = (u_dot - c1 + DAMPING * omega * free) / omega_d;
        let free_end = free * cos + free_sin * sin;
        let rate_end = omega_d * (free_sin * cos - free * sin) - DAMPING * omega * free_end;
        [free_end + c0 + c1 * duration, rate_end + c1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::{ReadOptions, Unit, parse};

    fn record(acceleration: &[f64], dt: f64) -> Record {
        let text: String = acceleration.iter().map(|a| format!("{a:e}\n")).collect();
        let unit = Some(Unit::MetrePerSecondSquared);
        parse("made-up", text.as_bytes(), &ReadOptions { unit, time_step: Some(dt), ..ReadOptions::default() }).unwrap()
    }

    #[track_caller]
    fn near(value: f64, exact: f64, tolerance: f64) {
        assert!((value / exact - 1.0).abs() <= tolerance, "{value}, exactly {exact}");
    }

    /// +1 for 1 s, then in 0.5 s through zero to −1, which stays for 2.5 s: v = 1 m/s, a quarter of a triangle more at
    /// the zero, and −1.5 m/s at the end.
    #[test]
    fn velocity_peaks_between_samples_too() {
        let mut samples = vec![1.0; 3];
        samples.extend([-1.0; 3]);
        near(pgv(&record(&samples, 0.5)), 1.125, 1e-15);
        samples.extend([-1.0; 3]);
        near(pgv(&record(&samples, 0.5)), 1.5, 1e-15);
        near(pga(&record(&[0.5, -2.0, 1.0], 0.5)), 2.0, 0.0);
    }

    /// Under a constant acceleration the oscillator swings about −a/ω², first to `1 + exp(−ζπ/√(1−ζ²))` times that.
    #[test]
    fn a_sudden_constant_acceleration_gives_the_closed_form() {
        let exact = 2.0 * (1.0 + (-DAMPING * std::f64::consts::PI / (1.0 - DAMPING * DAMPING).sqrt()).exp());
        for period in [0.05, 0.3, 1.0, 2.5] {
            near(spectral_acceleration(&record(&[2.0; 1001], 0.01), period), exact, 1.3e-4);
        }
    }

    /// Under `a = s t` from rest, `u = s/ω³ [2ζ − ω t + exp(−ζωt) ((1 − 2ζ²)/√(1−ζ²) sin ω_d t − 2ζ cos ω_d t)]`; the
    /// recurrence meets it at all times, whatever its step.
    #[test]
    fn a_ramp_gives_the_closed_form_with_any_step() {
        let (omega, slope, root) = (TAU / 0.7, 3.0, (1.0 - DAMPING * DAMPING).sqrt());
        for h in [0.013, 0.1, 0.31] {
            let step = Step::new(omega, h);
            let mut state = [0.0; 2];
            for i in 0..20 {
                state = step.take(state, slope * f64::from(i) * h, slope * h);
                let t = f64::from(i + 1) * h;
                let (sin, cos) = (root * omega * t).sin_cos();
                let free = (1.0 - 2.0 * DAMPING * DAMPING) / root * sin - 2.0 * DAMPING * cos;
                let exact = slope / omega.powi(3) * (2.0 * DAMPING - omega * t + (-DAMPING * omega * t).exp() * free);
                near(state[0], exact, 1e-11);
            }
        }
    }

    /// A stiff oscillator feels the ground's own acceleration, and Sa is proportional to the record.
    #[test]
    fn a_stiff_oscillator_gives_the_peak_acceleration() {
        let samples: Vec<f64> = (0..400).map(|i| (0.05 * f64::from(i)).sin() * (0.011 * f64::from(i)).cos()).collect();
        let record = record(&samples, 0.01);
        near(spectral_acceleration(&record, 0.005), pga(&record), 1e-3);
        let twice = record.clone().scaled(-2.0);
        near(spectral_acceleration(&twice, 0.8), 2.0 * spectral_acceleration(&record, 0.8), 1e-14);
    }
}
