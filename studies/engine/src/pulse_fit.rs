//! A record → the pulse that fits its velocity best.
//!
//! The ground velocity v is the integral of the acceleration from rest at the first sample. A pulse with velocity v_p explains the fraction
//! `R² = 1 − ∫(v − v_p)² dt/∫v² dt` of its energy. The fit maximizes R² over amplitude, period, start, and for [`PulseShape::Gabor`] phase and
//! cycles: the extended wavelet transform of M. F. Vassiliou, N. Makris, Estimating time scales and length scales in pulselike earthquake
//! acceleration records with wavelet analysis, BSSA 101 (2011) 596–618, applied to the velocity, in which G. P. Mavroeidis, A. S. Papageorgiou
//! (BSSA 93 (2003) 1099–1131) and J. W. Baker (BSSA 97 (2007) 1486–1501) find pulses.
//!
//! For given period, start and cycles the best amplitude, and with it the phase, solve a linear problem. The rest is a search over
//! a grid, whose best points a compass search then refines (T. G. Kolda, R. M. Lewis, V. Torczon, Optimization by direct search, SIAM
//! Review 45 (2003) 385–482).

use std::f64::consts::{FRAC_PI_2, TAU};

use rocking_block::excitation::{Pulse, PulseShape};
use rocking_records::Record;

/// Shapes that a fit can have: those after which the ground stands still.
pub const SHAPES: [PulseShape; 7] = [
    PulseShape::OneSine,
    PulseShape::OneCosine,
    PulseShape::C1,
    PulseShape::C2,
    PulseShape::SymmetricRicker,
    PulseShape::AntisymmetricRicker,
    PulseShape::Gabor,
];

/// Shortest period of a fit (s), also at least [`MIN_STEPS`] time steps.
const MIN_PERIOD: f64 = 0.1;
const MIN_STEPS: f64 = 10.0;
/// Ratio of two periods of the grid.
const RATIO: f64 = 1.06;
/// Cycles of a Gabor pulse on the grid, and the most of a fit.
const CYCLES: [f64; 7] = [1.0, 1.3, 1.7, 2.2, 3.0, 4.0, 6.0];
/// Steps per period of the grid.
const STEPS_PER_PERIOD: f64 = 24.0;
/// Points of the grid that are refined.
const CANDIDATES: usize = 12;
/// Size, relative to the period, at which the refinement ends.
const RESOLUTION: f64 = 1e-7;

/// A pulse fitted to a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PulseFit {
    /// The pulse, on the time axis of the record.
    pub pulse: Pulse,
    /// Share R² of the energy ∫v² dt of the record's velocity (1).
    pub r_squared: f64,
}

/// Velocities at evenly spaced times.
struct Velocities {
    start: f64,
    step: f64,
    values: Vec<f64>,
    energy: f64,
}

/// Fits a pulse of this shape, all of it within the record.
///
/// `None` for a record of zeros or one shorter than a few pulses of the least period, nor for a shape that is not in [`SHAPES`].
pub fn fit(record: &Record, shape: PulseShape) -> Option<PulseFit> {
    if !SHAPES.contains(&shape) {
        return None;
    }
    let velocities = Velocities::of(record);
    let duration = record.duration();
    let cycles: &[f64] = if shape == PulseShape::Gabor { &CYCLES } else { &CYCLES[..1] };
    let least = MIN_PERIOD.max(MIN_STEPS * record.time_step);
    let mut candidates: Vec<PulseFit> = Vec::new();
    for &cycles in cycles {
        let unit = Pulse { shape, cycles, ..Pulse::NONE };
        let mut period = least;
        while period * unit.duration() <= duration {
            let coarse = velocities.resampled(period / STEPS_PER_PERIOD);
            candidates.extend(coarse.best(Pulse { period, ..unit }));
            period *= RATIO;
        }
    }
    candidates.sort_by(|a, b| b.r_squared.total_cmp(&a.r_squared));
    let refined = candidates.iter().take(CANDIDATES).map(|fit| velocities.refined(fit.pulse, least));
    refined.max_by(|a, b| a.r_squared.total_cmp(&b.r_squared)).filter(|fit| fit.r_squared > 0.0)
}

impl Velocities {
    fn of(record: &Record) -> Velocities {
        let mut velocity = 0.0;
        let steps = record.acceleration.windows(2).map(|pair| {
            velocity += 0.5 * (pair[0] + pair[1]) * record.time_step;
            velocity
        });
        Velocities::new(record.start_time, record.time_step, std::iter::once(0.0).chain(steps).collect())
    }

    fn new(start: f64, step: f64, values: Vec<f64>) -> Velocities {
        let energy = values.iter().map(|v| v * v).sum();
        Velocities { start, step, values, energy }
    }

    /// The velocities at a longer step, linear between samples. A step that is not longer leaves them unchanged.
    fn resampled(&self, step: f64) -> Velocities {
        if step <= self.step {
            return Velocities::new(self.start, self.step, self.values.clone());
        }
        let count = (self.values.len() - 1) as f64 * self.step / step;
        let at = |i: usize| {
            let position = i as f64 * step / self.step;
            let before = position as usize;
            let [left, right] = [before, before + 1].map(|i| self.values.get(i).copied().unwrap_or(0.0));
            left + (position - before as f64) * (right - left)
        };
        Velocities::new(self.start, step, (0..=count as usize).map(at).collect())
    }

    /// The start with the greatest R² of a pulse of this period and these cycles. The pulse begins at a sample.
    fn best(&self, pulse: Pulse) -> Option<PulseFit> {
        let count = (pulse.duration() / self.step) as usize + 1;
        let templates = templates(&pulse, (0..count).map(|i| i as f64 * self.step));
        let starts = self.values.windows(count).enumerate().map(|(i, window)| (solve(window, &templates).0, i));
        let (gain, i) = starts.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let pulse = Pulse { start: self.start + i as f64 * self.step, ..pulse };
        Some(PulseFit { pulse, r_squared: gain / self.energy })
    }

    /// Fits amplitude and phase of a pulse.
    fn fitted(&self, pulse: Pulse) -> PulseFit {
        let first = ((pulse.start - self.start) / self.step).ceil().max(0.0) as usize;
        let last = first + (pulse.duration() / self.step) as usize + 1;
        let window = &self.values[first.min(self.values.len())..last.min(self.values.len())];
        let time = |i: usize| self.start + (first + i) as f64 * self.step - pulse.start;
        let (gain, [cos, sin]) = solve(window, &templates(&pulse, (0..window.len()).map(time)));
        let (amplitude, phase) = match pulse.shape {
            PulseShape::Gabor => (libm::hypot(cos, sin), libm::atan2(-sin, cos)),
            _ => (cos, 0.0),
        };
        PulseFit { pulse: Pulse { amplitude, phase, ..pulse }, r_squared: gain / self.energy }
    }

    /// Improves a pulse by moves along its period, start and cycles. Steps are halved once none helps.
    fn refined(&self, pulse: Pulse, least: f64) -> PulseFit {
        let end = self.start + (self.values.len() - 1) as f64 * self.step;
        let mut best = self.fitted(pulse);
        let mut size = 0.05;
        while size > RESOLUTION {
            let pulse = best.pulse;
            let Pulse { shape, period, start, cycles, .. } = pulse;
            let moves = [-size, size].into_iter().flat_map(|size| {
                let longer = Pulse { period: period * (1.0 + size), ..pulse };
                let wider = cycles * (1.0 + size);
                [
                    Pulse { start: start + size * period, ..pulse },
                    Pulse { start: start - 0.5 * (longer.duration() - pulse.duration()), ..longer },
                    Pulse { cycles: wider, start: start - 0.5 * (wider - cycles) * period, ..pulse },
                ]
            });
            let inside = |moved: &Pulse| {
                moved.period >= least
                    && (1.0..=CYCLES[CYCLES.len() - 1]).contains(&moved.cycles)
                    && (shape == PulseShape::Gabor || moved.cycles == cycles)
                    && moved.start >= self.start
                    && moved.end() <= end
            };
            let moved = moves.filter(inside).map(|moved| self.fitted(moved));
            match moved.max_by(|a, b| a.r_squared.total_cmp(&b.r_squared)) {
                Some(fit) if fit.r_squared > best.r_squared => best = fit,
                _ => size *= 0.5,
            }
        }
        best
    }
}

/// Velocities per unit of amplitude at times after the start. They are those of the pulse, and of a Gabor pulse with phase π/2 after its
/// own.
fn templates(pulse: &Pulse, times: impl Iterator<Item = f64>) -> Vec<[f64; 2]> {
    let [cos, sin] = [0.0, -FRAC_PI_2].map(|phase| Pulse { amplitude: 1.0, phase, start: 0.0, ..*pulse });
    times.map(|t| [cos.velocity(t), if pulse.shape == PulseShape::Gabor { sin.velocity(t) } else { 0.0 }]).collect()
}

/// The least squares of a window by both templates. They are the energy that these explain, and their amplitudes.
fn solve(window: &[f64], templates: &[[f64; 2]]) -> (f64, [f64; 2]) {
    let (mut right, mut gram) = ([0.0; 2], [0.0; 3]);
    for (v, [a, b]) in window.iter().zip(templates) {
        right = [right[0] + v * a, right[1] + v * b];
        gram = [gram[0] + a * a, gram[1] + a * b, gram[2] + b * b];
    }
    let [aa, ab, bb] = gram;
    let determinant = aa * bb - ab * ab;
    let amplitudes = match determinant > 1e-12 * aa * bb {
        true => [(bb * right[0] - ab * right[1]) / determinant, (aa * right[1] - ab * right[0]) / determinant],
        false if aa > 0.0 => [right[0] / aa, 0.0],
        false => [0.0; 2],
    };
    (right[0] * amplitudes[0] + right[1] * amplitudes[1], amplitudes)
}

/// Record and pulse at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitSample {
    /// Time (s).
    pub time: f64,
    /// Acceleration of the record and of the pulse (m/s²).
    pub acceleration: [f64; 2],
    /// Velocity of the record and of the pulse (m/s).
    pub velocity: [f64; 2],
}

impl PulseFit {
    /// Frequency ω_p (rad/s) of the pulse.
    pub fn omega(&self) -> f64 {
        TAU / self.pulse.period
    }

    /// Record and pulse at each sample of the record.
    pub fn samples(&self, record: &Record) -> Vec<FitSample> {
        let Velocities { values, .. } = Velocities::of(record);
        let sample = |(i, (a, v)): (usize, (&f64, f64))| {
            let time = record.sample_time(i);
            let acceleration = [*a, self.pulse.acceleration(time)];
            FitSample { time, acceleration, velocity: [v, self.pulse.velocity(time)] }
        };
        record.acceleration.iter().zip(values).enumerate().map(sample).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intensity::{near, record_of};

    const STEP: f64 = 0.002;

    fn record(pulse: &Pulse, noise: impl Fn(f64) -> f64) -> Record {
        let at = |i: u32| f64::from(i) * STEP;
        let samples: Vec<f64> = (0..5000).map(|i| pulse.acceleration(at(i)) + noise(at(i))).collect();
        record_of(&samples, STEP)
    }

    fn planted(shape: PulseShape) -> Pulse {
        Pulse { shape, amplitude: 4.0, period: 1.37, start: 2.3, phase: 0.9, cycles: 1.6 }
    }

    /// Of a record that is a pulse, the fit has all parameters, and explains all.
    #[test]
    fn pulses_are_recovered() {
        for shape in SHAPES {
            let pulse = planted(shape);
            let PulseFit { pulse: found, r_squared } = fit(&record(&pulse, |_| 0.0), shape).unwrap();
            // A record rises over a step where a pulse begins with a jump, and keeps that velocity after it.
            assert!(r_squared > 0.999, "{shape:?}: R² = {r_squared}");
            near(found.amplitude, pulse.amplitude, 5e-3);
            near(found.period, pulse.period, 2e-3);
            assert!((found.start - pulse.start).abs() < 0.02, "{shape:?}: {found:?}");
            if shape == PulseShape::Gabor {
                near(found.cycles, pulse.cycles, 5e-3);
                assert!((found.phase - pulse.phase).abs() < 5e-3, "{found:?}");
            }
        }
    }

    /// Accelerations of higher frequency and twice the amplitude hide a pulse, but not its velocity.
    #[test]
    fn pulses_are_recovered_from_noise() {
        for shape in SHAPES {
            let pulse = planted(shape);
            // Cosines, so that the mean velocity is zero, with signs that avoid peaks.
            let sign = |i: u32| if (i * (i + 1) / 2).is_multiple_of(2) { 1.2 } else { -1.2 };
            let noise = |t: f64| (4..30).map(|i| sign(i) * (6.1 * f64::from(i) * t).cos()).sum();
            let noisy = record(&pulse, noise);
            assert!(noisy.peak().acceleration.abs() > 2.0 * pulse.amplitude);
            let PulseFit { pulse: found, r_squared } = fit(&noisy, shape).unwrap();
            assert!((0.5..0.99).contains(&r_squared), "{shape:?}: R² = {r_squared}");
            near(found.amplitude, pulse.amplitude, 0.1);
            near(found.period, pulse.period, 0.05);
            assert!((found.start - pulse.start).abs() < 0.2, "{shape:?}: {found:?}");
        }
    }

    /// R² is that of the velocities, sample by sample. Any small change of the pulse lowers it.
    #[test]
    fn the_share_is_that_of_the_residual_and_greatest() {
        let noisy = record(&planted(PulseShape::C2), |t| 2.0 * (9.0 * t).cos() * (0.7 * t).cos());
        let mut velocity = 0.0;
        let velocities: Vec<f64> = std::iter::once(0.0)
            .chain(noisy.acceleration.windows(2).map(|pair| {
                velocity += 0.5 * STEP * (pair[0] + pair[1]);
                velocity
            }))
            .collect();
        let fraction = |pulse: &Pulse| {
            let residual = |(i, v): (usize, &f64)| (v - pulse.velocity(i as f64 * STEP)).powi(2);
            let left: f64 = velocities.iter().enumerate().map(residual).sum();
            1.0 - left / velocities.iter().map(|v| v * v).sum::<f64>()
        };
        for shape in SHAPES {
            let PulseFit { pulse, r_squared } = fit(&noisy, shape).unwrap();
            // Ricker wavelets leave a velocity of some 1e-9 of their peak.
            near(fraction(&pulse), r_squared, 1e-7);
            let Pulse { amplitude, period, start, phase, cycles, .. } = pulse;
            for sign in [-1.0, 1.0] {
                for other in [
                    Pulse { amplitude: amplitude * (1.0 + 0.01 * sign), ..pulse },
                    Pulse { period: period * (1.0 + 0.01 * sign), ..pulse },
                    Pulse { start: start + 0.01 * sign * period, ..pulse },
                    Pulse { phase: phase + 0.01 * sign, ..pulse },
                    Pulse { cycles: cycles * (1.0 + 0.01 * sign), ..pulse },
                ] {
                    let is_changed = shape == PulseShape::Gabor || (other.phase, other.cycles) == (phase, cycles);
                    assert!(!is_changed || fraction(&other) < r_squared, "{shape:?}: {other:?}");
                }
            }
        }
    }

    #[test]
    fn records_without_motion_or_too_short_have_no_pulse() {
        for samples in [vec![0.0; 500], vec![1.0, -1.0, 0.5]] {
            assert_eq!(fit(&record_of(&samples, STEP), PulseShape::Gabor), None);
        }
        let pulse = planted(PulseShape::HalfSine);
        assert_eq!(fit(&record(&pulse, |_| 0.0), PulseShape::HalfSine), None);
    }
}
