//! A ground acceleration that is linear between evenly spaced samples.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::format::Format;
use super::processing::Processing;
use super::unit::Unit;

/// A ground acceleration that is linear between evenly spaced samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Earthquake, station and component as far as the header names them. Otherwise the name of the file.
    pub title: String,
    /// Format of the file.
    pub format: Format,
    /// Unit of the values in the file.
    pub unit: Unit,
    /// Time of the first sample (s).
    pub start_time: f64,
    /// Time between two samples (s), above zero.
    pub time_step: f64,
    /// Ground accelerations [m/s²], at least two, finite, with the sign of the file. All runs under a record share them.
    pub acceleration: Arc<[f64]>,
    /// Changes since the file.
    pub processing: Processing,
}

/// The sample of largest magnitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Acceleration with its sign [m/s²]; the peak ground acceleration is its magnitude.
    pub acceleration: f64,
    /// Time (s) on the axis of the record.
    pub time: f64,
}

impl Record {
    /// Returns the time from the first to the last sample (s).
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.acceleration.len().saturating_sub(1) as f64 * self.time_step
    }

    /// Returns the first sample of largest magnitude.
    #[must_use]
    pub fn peak(&self) -> Peak {
        let mut peak = Peak { acceleration: 0.0, time: self.start_time };
        for (index, &acceleration) in self.acceleration.iter().enumerate() {
            if acceleration.abs() > peak.acceleration.abs() {
                peak = Peak { acceleration, time: self.start_time + index as f64 * self.time_step };
            }
        }
        peak
    }

    /// Returns the ground acceleration at time `t` (s) on the axis of the record [m/s²].
    ///
    /// It is linear between samples, and zero before the first and after the last one.
    #[must_use]
    pub fn at(&self, t: f64) -> f64 {
        let end = self.start_time + self.duration();
        if !(self.start_time..=end).contains(&t) {
            return 0.0;
        }
        let position = (t - self.start_time) / self.time_step;
        let index = position as usize;
        match self.acceleration.get(index..) {
            Some([left, right, ..]) => left + (position - index as f64) * (right - left),
            // The last sample, or just beyond it by round-off.
            _ => self.acceleration.last().copied().unwrap_or(0.0),
        }
    }

    /// Returns whether all fields are in their ranges. Records from files are; those from saved states may not be.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let Record { start_time, time_step, acceleration, .. } = self;
        acceleration.len() >= 2
            && *time_step > 0.0
            && [start_time, time_step].into_iter().chain(acceleration.iter()).all(|x| x.is_finite())
    }

    /// Multiplies all accelerations by `factor` (1).
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Record {
        Arc::make_mut(&mut self.acceleration).iter_mut().for_each(|a| *a *= factor);
        self
    }

    /// Returns the time of a sample (s).
    #[inline]
    pub fn sample_time(&self, i: usize) -> f64 {
        self.start_time + i as f64 * self.time_step
    }

    /// Returns the sample at or before `time`, or none before the first. After the last, it is the last or the number of samples.
    pub fn sample_at(&self, time: f64) -> Option<usize> {
        self.sample_near(time, self.guess(time))
    }

    /// Estimates the sample at or before `time`.
    ///
    /// The division may be off by one either way, and a time far beyond a short record saturates.
    pub fn guess(&self, time: f64) -> usize {
        ((time - self.start_time) / self.time_step) as usize
    }

    /// Returns the same as [`Record::sample_at`], searching from a guess.
    #[inline]
    pub fn sample_near(&self, time: f64, guess: usize) -> Option<usize> {
        if time < self.start_time {
            return None;
        }
        let end = self.acceleration.len();
        let mut i = guess.min(end);
        // Usually it is the guess or, for a caller that goes from sample to sample, the next one. The loops below are compiled for long
        // searches, and begin slowly.
        let holds = |i: usize| i <= end && self.sample_time(i) <= time && time < self.sample_time(i + 1);
        if holds(i) {
            return Some(i);
        }
        if holds(i + 1) {
            return Some(i + 1);
        }
        while i > 0 && self.sample_time(i) > time {
            i -= 1;
        }
        while i < end && self.sample_time(i + 1) <= time {
            i += 1;
        }
        Some(i)
    }
}
