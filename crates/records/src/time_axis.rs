//! Column of evenly spaced times → start time and time step.

use super::claims::StatedStep;
use super::error::RecordError;
use super::text::FileText;

/// Largest deviation from even spacing, as a fraction of the time step. It holds even if times are printed coarsely.
const LARGEST_SHIFT: f64 = 0.1;

/// Relative precision of times computed in single precision with a few operations.
const SINGLE_PRECISION: f64 = 4.0 * f32::EPSILON as f64;

/// Relative round-off error of the arithmetic below.
const ROUNDING: f64 = 1e-9;

/// Relative precision of times computed in double precision with a few operations.
const DOUBLE_PRECISION: f64 = 4.0 * f64::EPSILON;

/// Relative deviation from even spacing beyond which times were not computed in double precision, not even by sums.
const SUMS_IN_DOUBLE_PRECISION: f64 = 1e-11;

/// Times of a file, each with its line.
pub(super) struct TimeAxis {
    times: Vec<(usize, f64)>,
    /// Units of the last printed digit (s), below 1 s, each with the largest time that has it.
    units: Vec<(f64, f64)>,
}

impl TimeAxis {
    pub(super) fn new() -> TimeAxis {
        TimeAxis { times: Vec::new(), units: Vec::new() }
    }

    /// Adds a time (s) printed as a multiple of `unit` (s).
    pub(super) fn push(&mut self, line: usize, time: f64, unit: f64) {
        self.times.push((line, time));
        // Whole seconds such as a first 0 are exact.
        if unit >= 1.0 {
            return;
        }
        match self.units.iter_mut().find(|(known, _)| *known == unit) {
            Some((_, largest)) => *largest = largest.max(time.abs()),
            None => self.units.push((unit, time.abs())),
        }
    }

    /// Returns the resolution of the printed times (s).
    ///
    /// Shortest forms leave zeros out, so a time of few digits, such as a first 0.0, is no coarser than the others. Times are printed
    /// to the most decimals or, if those of large times are fewer, to the most significant digits of any of them.
    fn resolution(&self) -> f64 {
        let units = self.units.iter().map(|&(unit, _)| unit);
        let (finest, coarsest) = (units.clone().fold(1.0, f64::min), units.fold(0.0, f64::max));
        let digits = self.units.iter().map(|&(unit, largest)| decade(largest) + 1 - decade(unit)).max().unwrap_or(0);
        let largest = self.times.iter().map(|(_, time)| time.abs()).fold(0.0, f64::max);
        power_of_ten(decade(largest) + 1 - digits).max(finest).min(coarsest)
    }

    /// Returns start time (s) and time step. Times must be even to the precision in which they are printed.
    ///
    /// The mean step is rounded to the shortest decimal number that gives the same printed times, as far as they are even.
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
        let (resolution, largest) = (self.resolution(), start.abs().max(end.abs()));
        let printed = resolution.max(SINGLE_PRECISION * largest);
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
        // Times without the round-off of single precision allow no more than their digits and their own deviation.
        let deviation = self.farthest().map_or(0.0, |(_, found, expected, _)| (found - expected).abs());
        let own = resolution.min(tolerance).max(deviation).max(DOUBLE_PRECISION * largest);
        let shift = if deviation > resolution.max(SUMS_IN_DOUBLE_PRECISION * largest) { tolerance } else { own };
        let rounded = (0..17).filter_map(|digits| format!("{mean:.digits$e}").parse().ok());
        let value =
            rounded.into_iter().find(|step: &f64| (step - mean).abs() * intervals <= shift / 2.0).unwrap_or(mean);
        Ok((start, Some(StatedStep { line, value, tolerance: tolerance / intervals + ROUNDING * mean })))
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

/// Returns the exponent of the first significant digit of a number; 0 for 0.
fn decade(number: f64) -> i32 {
    // Exact for powers of ten, unlike a logarithm.
    format!("{number:e}").split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(f64::NAN)
}
