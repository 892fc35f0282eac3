//! Column of evenly spaced times → start time and time step.

use super::error::RecordError;
use super::raw::StatedStep;
use super::text::FileText;

/// Largest deviation from even spacing, as a fraction of the time step. It holds even if times are printed coarsely.
const LARGEST_SHIFT: f64 = 0.1;

/// Relative precision of times computed in single precision with a few operations.
const SINGLE_PRECISION: f64 = 4.0 * f32::EPSILON as f64;

/// Relative round-off error of the arithmetic below.
const ROUNDING: f64 = 1e-9;

/// Times of a file, each with its line.
pub(super) struct TimeAxis {
    times: Vec<(usize, f64)>,
    /// Largest unit of the last printed digit of all times (s).
    quantum: f64,
}

impl TimeAxis {
    pub(super) fn new() -> TimeAxis {
        TimeAxis { times: Vec::new(), quantum: 0.0 }
    }

    /// Adds a time (s) printed as a multiple of `quantum` (s).
    pub(super) fn push(&mut self, line: usize, time: f64, quantum: f64) {
        self.times.push((line, time));
        // Whole seconds such as a first 0 are exact.
        if quantum < 1.0 {
            self.quantum = self.quantum.max(quantum);
        }
    }

    /// Returns start time (s) and time step. Times must be even to the precision in which they are printed.
    ///
    /// The mean step is rounded to the shortest decimal number that gives the same printed times.
    pub(super) fn even_spacing(&self, source: &FileText<'_>) -> Result<(f64, Option<StatedStep>), RecordError> {
        let (Some(&(line, start)), Some(&(_, end))) = (self.times.first(), self.times.get(1..).and_then(<[_]>::last))
        else {
            return Ok((0.0, None));
        };
        for pair in self.times.windows(2) {
            if let [(_, before), (line, after)] = pair
                && after <= before
            {
                return Err(source.header_error(*line, &format!("time {after} s"), format!("a time after {before} s")));
            }
        }
        let intervals = (self.times.len() - 1) as f64;
        let mean = (end - start) / intervals;
        let printed = self.quantum.max(SINGLE_PRECISION * start.abs().max(end.abs()));
        let tolerance = printed.min(LARGEST_SHIFT * mean).max(ROUNDING * mean);
        let first_uneven = |step: f64| {
            let expected =
                self.times.iter().enumerate().map(|(index, &(line, t))| (line, t, start + index as f64 * step));
            // A step that overflowed gives NaN for the first time.
            expected.into_iter().find(|(_, found, expected)| expected.is_nan() || (found - expected).abs() > tolerance)
        };
        if let Some(uneven) = first_uneven(mean) {
            // The first step finds the change of spacing; the mean step already includes it.
            let first = self.times.get(1).map_or(mean, |&(_, second)| second - start);
            let (time_step, uneven) = first_uneven(first).map_or((mean, uneven), |uneven| (first, uneven));
            let (file, (line, found, expected)) = (source.name.clone(), uneven);
            return Err(RecordError::UnevenTime { file, line, found, expected, time_step });
        }
        let tolerance = tolerance / intervals + ROUNDING * mean;
        let rounded = (0..9).filter_map(|digits| format!("{mean:.digits$e}").parse().ok());
        let value = rounded.into_iter().find(|step: &f64| (step - mean).abs() < tolerance / 2.0).unwrap_or(mean);
        Ok((start, Some(StatedStep { line, value, tolerance })))
    }

    /// Returns the time farthest from even spacing: line, found and expected value, and mean step (s).
    ///
    /// Where rounding hides the first steps, it shows best that the spacing is uneven.
    pub(super) fn farthest(&self) -> Option<(usize, f64, f64, f64)> {
        let (&(_, start), &(_, end)) = (self.times.first()?, self.times.last()?);
        let mean = (end - start) / (self.times.len() - 1) as f64;
        let spaced =
            self.times.iter().enumerate().map(|(index, &(line, t))| (line, t, start + index as f64 * mean, mean));
        spaced.max_by(|(_, a, at, _), (_, b, bt, _)| (a - at).abs().total_cmp(&(b - bt).abs()))
    }
}
