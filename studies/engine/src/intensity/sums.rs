//! A record → its peaks, Arias intensity, CAV and significant duration.

use std::f64::consts::PI;

use rocking_block::numerics::roots::sign_change;
use rocking_records::Record;

/// Peak ground acceleration (m/s²): greatest |a|.
pub fn pga(record: &Record) -> f64 {
    record.peak().acceleration.abs()
}

/// Peak ground velocity (m/s): greatest |∫a dt| from rest at the first sample.
///
/// The velocity has an extremum where the acceleration changes sign between two samples.
pub fn pgv(record: &Record) -> f64 {
    let (mut velocity, mut peak) = (0.0, 0.0_f64);
    for [a, b] in steps(record) {
        if a * b < 0.0 {
            peak = peak.max((velocity + 0.5 * a * record.time_step * a / (a - b)).abs());
        }
        velocity += 0.5 * (a + b) * record.time_step;
        peak = peak.max(velocity.abs());
    }
    peak
}

/// Peak ground displacement (m): greatest |∬a dt dt| from rest at the first sample.
///
/// For a record without base line correction this is its drift.
pub fn pgd(record: &Record) -> f64 {
    let h = record.time_step;
    let (mut displacement, mut velocity, mut peak) = (0.0, 0.0, 0.0_f64);
    for [a, b] in steps(record) {
        let slope = (b - a) / h;
        let at = |t: f64| displacement + t * (velocity + t * (0.5 * a + t * slope / 6.0));
        for t in zeros(0.5 * slope, a, velocity).into_iter().filter(|t| (0.0..=h).contains(t)) {
            peak = peak.max(at(t).abs());
        }
        displacement = at(h);
        velocity += 0.5 * (a + b) * h;
        peak = peak.max(displacement.abs());
    }
    peak
}

/// Arias intensity π/(2g) ∫a² dt (m/s), g in m/s² (A. Arias, A measure of earthquake intensity, in R. J. Hansen (ed.),
/// Seismic design for nuclear power plants, MIT Press, 1970, 438–483). The usual trapezoidal rule over
/// samples gives π/(2g) Σ dt (aᵢ₊₁ − aᵢ)²/6 more.
pub fn arias(record: &Record, gravity: f64) -> f64 {
    0.5 * PI / gravity * steps(record).map(|step| square(step, record.time_step)).sum::<f64>()
}

/// Cumulative absolute velocity ∫|a| dt (m/s), over the whole record and without a threshold. Source: EPRI, A criterion for determining
/// exceedance of the operating basis earthquake, NP-5930, 1988. The trapezoidal rule over samples gives more where the acceleration changes
/// its sign between two of them.
pub fn cumulative_absolute_velocity(record: &Record) -> f64 {
    let area = |[a, b]: [f64; 2]| match a * b < 0.0 {
        true => (a * a + b * b) / (a - b).abs(),
        false => (a + b).abs(),
    };
    0.5 * record.time_step * steps(record).map(area).sum::<f64>()
}

/// Significant duration D5–95 (s): the time in which ∫a² dt grows from 5 % to 95 %. The fractions are of its final value (M. D. Trifunac,
/// A. G. Brady, A study on the duration of strong earthquake ground motion, Bull. Seism. Soc. Am. 65 (1975) 581–626), with times between
/// samples. `None` for a record of zeros.
pub fn significant_duration(record: &Record) -> Option<f64> {
    let h = record.time_step;
    let total: f64 = steps(record).map(|step| square(step, h)).sum();
    let time_of = |fraction: f64| {
        let mut sum = 0.0;
        for (number, [a, b]) in steps(record).enumerate() {
            let next = sum + square([a, b], h);
            if next >= fraction * total {
                let missing = |t: f64| fraction * total - sum - square([a, a + (b - a) * t / h], t);
                return Some(
                    number as f64 * h + sign_change(0.0, h, fraction * total - sum, fraction * total - next, missing),
                );
            }
            sum = next;
        }
        None
    };
    if total > 0.0 { Some(time_of(0.95)? - time_of(0.05)?) } else { None }
}

/// The accelerations at both ends of each step.
fn steps(record: &Record) -> impl Iterator<Item = [f64; 2]> {
    record.acceleration.windows(2).map(|pair| [pair[0], pair[1]])
}

/// ∫a² dt over a time in which a varies linearly between two values.
fn square([a, b]: [f64; 2], time: f64) -> f64 {
    time * (a * a + a * b + b * b) / 3.0
}

/// The real zeros of `c2 t² + c1 t + c0`, to round-off. Missing zeros are not finite.
fn zeros(c2: f64, c1: f64, c0: f64) -> [f64; 2] {
    let root = (c1 * c1 - 4.0 * c2 * c0).sqrt();
    let sum = -0.5 * (c1 + root.copysign(c1));
    [sum / c2, c0 / sum]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intensity::{near, record_of};

    /// The velocity peaks at a zero of the acceleration between samples. The acceleration is +1 m/s² for 1 s, then in 0.5 s −1 m/s²: v
    /// peaks at 1.125 m/s, and 2.5 s at −1 m/s² then lead to −1.5 m/s.
    #[test]
    fn velocity_peaks_between_samples_too() {
        let mut samples = vec![1.0; 3];
        samples.extend([-1.0; 3]);
        near(pgv(&record_of(&samples, 0.5)), 1.125, 1e-15);
        samples.extend([-1.0; 3]);
        near(pgv(&record_of(&samples, 0.5)), 1.5, 1e-15);
        near(pga(&record_of(&[0.5, -2.0, 1.0], 0.5)), 2.0, 0.0);
    }

    /// The displacement peaks at a zero of the velocity between samples. The acceleration is +1 m/s² for 1 s, then in 1 s −2 m/s² for 1 s:
    /// the displacement has samples of 0.5, 1.5 and 1 m; the velocity, 0.5 m/s at 2 s, is zero a quarter of a second later.
    #[test]
    fn displacement_peaks_between_samples_too() {
        near(pgd(&record_of(&[1.0, 1.0, -2.0, -2.0], 1.0)), 1.5625, 1e-15);
        near(pgd(&record_of(&[-1.0, -1.0, 2.0], 1.0)), 1.5, 1e-15);
        near(pgd(&record_of(&[2.0; 4], 1.0)), 9.0, 1e-15);
        // v = 1 + t − 4t² in the second step is zero at (1 + √17)/8, where d = 0.5 + t + t²/2 − 4t³/3.
        let t = 0.125 * (1.0 + 17.0_f64.sqrt());
        near(pgd(&record_of(&[1.0, 1.0, -7.0], 1.0)), 0.5 + t * (1.0 + t * (0.5 - t * 4.0 / 3.0)), 1e-14);
    }

    /// Whole half-waves of `a = A sin ωt` have I_A = πA²T/(4g) and CAV = 2AT/π. 100 samples per half-wave are accurate to 1e-3.
    #[test]
    fn a_sine_gives_the_closed_forms() {
        let samples: Vec<f64> = (0..=1000).map(|i| 3.0 * (PI * f64::from(i) / 100.0).sin()).collect();
        let record = record_of(&samples, 0.004);
        near(arias(&record, 9.81), PI * 9.0 * 4.0 / (4.0 * 9.81), 4e-4);
        near(cumulative_absolute_velocity(&record), 2.0 * 3.0 * 4.0 / PI, 1e-4);
    }

    /// ∫a² grows linearly under a constant acceleration, and as t³ under `a = t` over T. The latter gives T (0.95^⅓ − 0.05^⅓). From −1 to 1
    /// in one step, |a| is a triangle on each side.
    #[test]
    fn linear_accelerations_are_exact() {
        near(significant_duration(&record_of(&[2.0, 2.0], 3.0)).unwrap(), 2.7, 1e-14);
        near(
            significant_duration(&record_of(&[0.0, 5.0], 3.0)).unwrap(),
            3.0 * (0.95_f64.cbrt() - 0.05_f64.cbrt()),
            1e-14,
        );
        near(cumulative_absolute_velocity(&record_of(&[-1.0, 1.0], 2.0)), 1.0, 1e-15);
        near(cumulative_absolute_velocity(&record_of(&[-1.0, 3.0], 2.0)), 2.5, 1e-15);
        near(arias(&record_of(&[0.0, 3.0], 2.0), 9.81), PI / (2.0 * 9.81) * 6.0, 1e-15);
    }
}
