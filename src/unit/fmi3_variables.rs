//! Values of the parameters that exist only in FMI 3.0: a record as arrays, and the interval of intermediate updates.

use serde::{Deserialize, Serialize};

use crate::unit::record_source;
use crate::unit::variables::Fmi3Variable;

/// Values of these parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fmi3Values {
    /// Horizontal and vertical ground accelerations (m/s²), equal in number; zeros if there is no record.
    samples: [Vec<f64>; 2],
    /// Time between two intermediate updates (s).
    pub interval: f64,
}

impl Default for Fmi3Values {
    fn default() -> Fmi3Values {
        let start = |variable: Fmi3Variable| variable.metadata().start.unwrap_or(0.0);
        let mut values =
            Fmi3Values { samples: [Vec::new(), Vec::new()], interval: start(Fmi3Variable::IntermediateInterval) };
        values.resize(start(Fmi3Variable::RecordSamples) as usize);
        values
    }
}

impl Fmi3Values {
    /// Whether each value is within its limits.
    pub fn are_valid(&self) -> bool {
        record_source::are_valid(&self.samples, Fmi3Variable::RecordSamples.metadata())
            && Fmi3Variable::IntermediateInterval.metadata().admits(self.interval).is_ok()
    }

    /// Whether the arrays hold a record.
    pub fn has_record(&self) -> bool {
        record_source::hold_record(&self.samples)
    }

    /// Sets the number of samples in each array, and all samples to zero.
    pub fn resize(&mut self, count: usize) {
        self.samples = [vec![0.0; count], vec![0.0; count]];
    }

    /// Returns the values of a real parameter, or an empty slice for any other variable.
    pub fn of(&self, variable: Fmi3Variable) -> &[f64] {
        match variable {
            Fmi3Variable::Time | Fmi3Variable::RecordSamples | Fmi3Variable::Indicator(_) => &[],
            Fmi3Variable::RecordHorizontalSamples => &self.samples[0],
            Fmi3Variable::RecordVerticalSamples => &self.samples[1],
            Fmi3Variable::IntermediateInterval => std::slice::from_ref(&self.interval),
        }
    }

    /// Returns the values of a real parameter for a change.
    pub fn of_mut(&mut self, variable: Fmi3Variable) -> &mut [f64] {
        match variable {
            Fmi3Variable::Time | Fmi3Variable::RecordSamples | Fmi3Variable::Indicator(_) => &mut [],
            Fmi3Variable::RecordHorizontalSamples => &mut self.samples[0],
            Fmi3Variable::RecordVerticalSamples => &mut self.samples[1],
            Fmi3Variable::IntermediateInterval => std::slice::from_mut(&mut self.interval),
        }
    }
}
