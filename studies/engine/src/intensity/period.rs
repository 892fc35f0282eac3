//! A record → its mean period.

use rustfft::algorithm::Radix4;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftDirection};

use rocking_records::Record;

/// Frequency band of the mean period (Hz).
const BAND: std::ops::RangeInclusive<f64> = 0.25..=20.0;
/// Greatest spacing of the frequencies (Hz).
const RESOLUTION: f64 = 0.05;

/// Mean period T_m = Σ C²/f / Σ C² (s) of a record. C are the Fourier amplitudes of the samples. The frequencies f are those from 0.25 to
/// 20 Hz, at most 0.05 Hz apart (E. M. Rathje, N. A. Abrahamson, J. D. Bray, J. Geotech. Geoenviron. Eng. 124 (1998) 150–159; E. M. Rathje,
/// F. Faraj, S. Russell, J. D. Bray, Earthquake Spectra 20 (2004) 119–144). `None` for a record without amplitudes in the band.
///
/// Zeros are appended until the number of samples is a power of two and the frequency spacing is small enough.
pub fn mean_period(record: &Record) -> Option<f64> {
    let shortest = (1.0 / (RESOLUTION * record.time_step)).ceil() as usize;
    let count = record.acceleration.len().max(shortest).next_power_of_two();
    let mut values: Vec<Complex<f64>> = record.acceleration.iter().map(|&a| Complex::new(a, 0.0)).collect();
    values.resize(count, Complex::default());
    // A fixed algorithm without vector instructions keeps the order of the sums the same on every machine.
    Radix4::new(count, FftDirection::Forward).process(&mut values);
    let spacing = 1.0 / (count as f64 * record.time_step);
    let (mut weighted, mut power) = (0.0, 0.0);
    for (number, value) in values.iter().enumerate().take(count / 2 + 1) {
        let frequency = number as f64 * spacing;
        if BAND.contains(&frequency) {
            weighted += value.norm_sqr() / frequency;
            power += value.norm_sqr();
        }
    }
    (power > 0.0).then(|| weighted / power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intensity::{near, record_of};
    use std::f64::consts::TAU;

    /// A sine has its own period, two of equal amplitude the mean of theirs. Frequencies outside the band are ignored.
    #[test]
    fn sines_have_their_periods() {
        let of = |frequencies: &[f64]| {
            let a = |i: i32| frequencies.iter().map(|f| (TAU * f * 0.01 * f64::from(i)).sin()).sum::<f64>();
            mean_period(&record_of(&(0..32768).map(a).collect::<Vec<_>>(), 0.01)).unwrap()
        };
        // Whole numbers of waves in 32768 samples have no spectral leakage.
        let whole = |waves: f64| waves / (32768.0 * 0.01);
        near(of(&[whole(650.0)]), 1.0 / whole(650.0), 1e-12);
        near(of(&[whole(300.0), whole(1200.0)]), 0.5 / whole(300.0) + 0.5 / whole(1200.0), 1e-12);
        near(of(&[whole(650.0), whole(9000.0), whole(30.0)]), 1.0 / whole(650.0), 1e-12);
        near(of(&[2.0]), 0.5, 1e-3);
    }
}
