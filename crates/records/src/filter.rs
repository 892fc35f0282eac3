//! A record → the same without its linear trend, filtered, or with another time step.

use std::f64::consts::PI;
use std::sync::Arc;

use super::processing::Processing;
use super::record::Record;

/// Order of the Butterworth filter in each direction.
const ORDER: usize = 4;

impl Processing {
    /// Returns the processed record.
    ///
    /// # Errors
    /// A corner at or above the Nyquist frequency, corners that do not increase, a time step that is not above zero, and one so long that
    /// frequencies of the record would be aliased: it needs a band-pass filter with its upper corner below the new Nyquist frequency.
    pub fn apply(&self, mut record: Record) -> Result<Record, String> {
        let Processing { baseline, band_pass, resample } = *self;
        let nyquist = |step: f64| 0.5 / step;
        if let Some([low, high]) = band_pass {
            let limit = nyquist(record.time_step);
            if !(low > 0.0 && low < high && high < limit) {
                return Err(format!(
                    "band-pass {low} to {high} Hz; expected 0 < lower corner < upper corner < {limit} Hz, the Nyquist frequency"
                ));
            }
        }
        if let Some(step) = resample {
            if !(step.is_finite() && step > 0.0) {
                return Err(format!("time step {step} s of the resampled record; expected a time > 0 s"));
            }
            let is_limited = band_pass.is_some_and(|[_, high]| high < nyquist(step));
            if step > record.time_step && !is_limited {
                let (old, limit) = (record.time_step, nyquist(step));
                return Err(format!(
                    "resampling from {old} to {step} s would alias; expected a band-pass with its upper corner below {limit} Hz"
                ));
            }
            let count = (record.duration() / step * (1.0 + f64::EPSILON)).floor() + 1.0;
            if !(2.0..=1e8).contains(&count) {
                return Err(format!("resampling every {step} s gives {count} samples; expected 2 to 1e8"));
            }
        }
        if baseline {
            subtract_line(Arc::make_mut(&mut record.acceleration));
        }
        if let Some(corners) = band_pass {
            filter(Arc::make_mut(&mut record.acceleration), record.time_step, corners);
        }
        if let Some(step) = resample {
            record = with_step(record, step);
        }
        record.processing = *self;
        Ok(record)
    }
}

/// Subtracts the least-squares line.
fn subtract_line(values: &mut [f64]) {
    let count = values.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = values.iter().sum::<f64>() / count;
    let moment: f64 = values.iter().enumerate().map(|(i, a)| (i as f64 - middle) * a).sum();
    // Σ (i − middle)² of n indices is n (n² − 1)/12.
    let slope = moment / (count * (count * count - 1.0) / 12.0);
    for (i, a) in values.iter_mut().enumerate() {
        *a -= mean + slope * (i as f64 - middle);
    }
}

/// Returns the record with another time step, from the same first sample.
fn with_step(record: Record, step: f64) -> Record {
    // The last sample may be missed by round-off.
    let count = (record.duration() / step * (1.0 + f64::EPSILON)).floor() as usize + 1;
    let end = record.start_time + record.duration();
    let at = |i: usize| record.at((record.start_time + i as f64 * step).min(end));
    Record { acceleration: (0..count).map(at).collect(), time_step: step, ..record }
}

/// A second-order section with numerator `gain (1 − z⁻²)` and denominator `1 + a[0] z⁻¹ + a[1] z⁻²`.
struct Section {
    gain: f64,
    a: [f64; 2],
}

impl Section {
    /// Filters values, from rest.
    fn run(&self, values: &mut [f64]) {
        let Section { gain, a: [a1, a2] } = *self;
        let mut state = [0.0; 2];
        for value in values {
            let input = gain * *value;
            let output = input + state[0];
            state = [state[1] - a1 * output, -input - a2 * output];
            *value = output;
        }
    }
}

/// Filters forwards and backwards, between zeros.
fn filter(values: &mut [f64], time_step: f64, corners: [f64; 2]) {
    let sections = band_pass(corners.map(|corner| corner * time_step));
    let zeros = (1.5 * ORDER as f64 / (corners[0] * time_step)).ceil() as usize;
    let mut padded = vec![0.0; values.len() + 2 * zeros];
    padded[zeros..zeros + values.len()].copy_from_slice(values);
    for _ in 0..2 {
        sections.iter().for_each(|section| section.run(&mut padded));
        padded.reverse();
    }
    values.copy_from_slice(&padded[zeros..zeros + values.len()]);
}

/// The sections of a Butterworth band-pass filter with these corners, as parts of the sampling frequency.
///
/// The poles of the analog low-pass filter are transformed to those of the band-pass, then by the bilinear transform with warped
/// corners (A. V. Oppenheim, R. W. Schafer, Discrete-time signal processing, chapter 7). Half of the zeros are at 1, half at −1.
fn band_pass(corners: [f64; 2]) -> Vec<Section> {
    // With `s = 2 (z − 1)/(z + 1)`.
    let [low, high] = corners.map(|corner| 2.0 * libm::tan(PI * corner));
    let (width, square) = (high - low, low * high);
    let mut sections = Vec::with_capacity(ORDER);
    // Of conjugate poles, that in the upper half plane.
    for k in 0..ORDER / 2 {
        let (sin, cos) = libm::sincos(PI * (2 * k + 1 + ORDER) as f64 / (2 * ORDER) as f64);
        let half = [0.5 * width * cos, 0.5 * width * sin];
        let root = square_root([half[0] * half[0] - half[1] * half[1] - square, 2.0 * half[0] * half[1]]);
        for sign in [-1.0, 1.0] {
            let [x, y] = [half[0] + sign * root[0], half[1] + sign * root[1]];
            // A pair of poles s and its conjugate: (2 − s)(2 − s̄) and z = (2 + s)/(2 − s).
            let norm = (2.0 - x) * (2.0 - x) + y * y;
            let [re, im] = [(4.0 - x * x - y * y) / norm, 4.0 * y / norm];
            sections.push(Section { gain: 2.0 * width / norm, a: [-2.0 * re, re * re + im * im] });
        }
    }
    sections
}

/// The square root, with a real part above or equal to zero, of a complex number.
fn square_root([x, y]: [f64; 2]) -> [f64; 2] {
    let size = libm::hypot(x, y);
    let re = (0.5 * (size + x).max(0.0)).sqrt();
    [re, (0.5 * (size - x).max(0.0)).sqrt().copysign(y)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 0.01;

    fn record(value: impl Fn(f64) -> f64) -> Record {
        let text: String = (0..6000).map(|i| format!("{:e}\n", value(f64::from(i) * STEP))).collect();
        let unit = Some(crate::Unit::MetrePerSecondSquared);
        let options = crate::ReadOptions { unit, time_step: Some(STEP), ..crate::ReadOptions::default() };
        crate::parse("made up", text.as_bytes(), &options).unwrap()
    }

    /// The amplitude is |H|², and the phase stays. It is `1/(1 + ((w² − w_1 w_2)/(w (w_2 − w_1)))⁸)` at the warped frequencies w.
    #[test]
    fn a_sine_in_the_middle_has_the_amplitude_of_the_closed_form() {
        let corners = [0.5, 8.0];
        let warped = |frequency: f64| (PI * frequency * STEP).tan();
        let [low, high] = corners.map(warped);
        for frequency in [0.3, 0.5, 1.0, 3.0, 8.0, 12.0] {
            let sine = |t: f64| (2.0 * PI * frequency * t).sin();
            let processing = Processing { band_pass: Some(corners), ..Processing::default() };
            let filtered = processing.apply(record(sine)).unwrap();
            let w = warped(frequency);
            let gain = 1.0 / (1.0 + ((w * w - low * high) / (w * (high - low))).powi(8));
            for i in 2800..3200 {
                let (found, exact) = (filtered.acceleration[i], gain * sine(i as f64 * STEP));
                assert!((found - exact).abs() < 1e-6, "{frequency} Hz: {found}, not {exact}");
            }
        }
    }

    #[test]
    fn a_line_is_removed_and_nothing_else() {
        // Even and odd about the middle: orthogonal to any line.
        let wave = |t: f64| (2.0 * PI * (t - 29.995) / 60.0 * 2.0).cos();
        let offset = record(|t| wave(t) + 0.3 - 0.02 * t);
        let processing = Processing { baseline: true, ..Processing::default() };
        let [found, alone] = [offset, record(wave)].map(|record| processing.apply(record).unwrap());
        assert_eq!(found.processing.to_string(), "baseline removed");
        for (i, (a, b)) in found.acceleration.iter().zip(alone.acceleration.iter()).enumerate() {
            assert!((a - b).abs() < 1e-13 && (b - wave(i as f64 * STEP)).abs() < 1e-12, "sample {i}: {a}, {b}");
        }
    }

    #[test]
    fn a_resampled_record_is_the_same_motion() {
        let original = record(|t| (3.0 * t).sin());
        for step in [0.005, 0.0025, 0.01, 0.003] {
            let processing = Processing { resample: Some(step), ..Processing::default() };
            let found = processing.apply(original.clone()).unwrap();
            assert_eq!((found.time_step, found.start_time), (step, original.start_time));
            assert!(found.duration() <= original.duration() && found.duration() > original.duration() - step);
            for i in 0..found.acceleration.len() {
                let time = found.sample_time(i);
                assert!((found.acceleration[i] - original.at(time)).abs() < 1e-12, "{step} s, sample {i}");
            }
        }
    }

    #[test]
    fn impossible_changes_are_refused() {
        let refused = |band_pass, resample| {
            Processing { baseline: false, band_pass, resample }.apply(record(f64::sin)).unwrap_err()
        };
        for corners in [[0.0, 5.0], [5.0, 2.0], [0.1, 50.0], [f64::NAN, 3.0]] {
            assert!(refused(Some(corners), None).contains("< 50 Hz, the Nyquist frequency"));
        }
        assert!(refused(None, Some(0.0)).contains("expected a time > 0 s"));
        assert!(
            refused(None, Some(0.02)).contains("would alias; expected a band-pass with its upper corner below 25 Hz")
        );
        assert!(refused(Some([0.1, 30.0]), Some(0.02)).contains("would alias"));
        assert!(refused(None, Some(1e-9)).contains("samples; expected 2 to 1e8"));
    }
}
