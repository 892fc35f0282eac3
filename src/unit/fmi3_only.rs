//! Values of the parameters that exist only in FMI 3.0: a record as arrays, and the interval of intermediate updates.

use serde::{Deserialize, Serialize};

use crate::unit::variables::Fmi3Only;

/// Values of these parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fmi3OnlyValues {
    /// Horizontal and vertical ground accelerations (m/s²), equal in number; zeros if there is no record.
    samples: [Vec<f64>; 2],
    /// Time between two intermediate updates (s).
    pub interval: f64,
}

impl Default for Fmi3OnlyValues {
    fn default() -> Fmi3OnlyValues {
        let start = |fmi3_only: Fmi3Only| fmi3_only.start().unwrap_or(0.0);
        let mut values =
            Fmi3OnlyValues { samples: [Vec::new(), Vec::new()], interval: start(Fmi3Only::IntermediateInterval) };
        values.resize(start(Fmi3Only::RecordSamples) as usize);
        values
    }
}

impl Fmi3OnlyValues {
    /// Whether each value is within its limits.
    pub fn are_valid(&self) -> bool {
        let [horizontal, vertical] = &self.samples;
        horizontal.len() == vertical.len()
            && Fmi3Only::RecordSamples.admits(horizontal.len() as f64).is_ok()
            && Fmi3Only::IntermediateInterval.admits(self.interval).is_ok()
            && horizontal.iter().chain(vertical).all(|a| a.is_finite())
    }

    /// Whether the arrays hold a record.
    pub fn has_record(&self) -> bool {
        self.samples.iter().flatten().any(|&a| a != 0.0)
    }

    /// Sets the number of samples in each array, and all samples to zero.
    pub fn resize(&mut self, count: usize) {
        self.samples = [vec![0.0; count], vec![0.0; count]];
    }

    /// Returns the values of a real parameter, or an empty slice for any other variable.
    pub fn of(&self, fmi3_only: Fmi3Only) -> &[f64] {
        match fmi3_only {
            Fmi3Only::Time
            | Fmi3Only::RecordSamples
            | Fmi3Only::IndicatorL
            | Fmi3Only::IndicatorR
            | Fmi3Only::IndicatorQuarterTurn
            | Fmi3Only::IndicatorSlide
            | Fmi3Only::IndicatorSlipR
            | Fmi3Only::IndicatorSlipL
            | Fmi3Only::IndicatorTie1Taut
            | Fmi3Only::IndicatorTie1Strength
            | Fmi3Only::IndicatorTie2Taut
            | Fmi3Only::IndicatorTie2Strength => &[],
            Fmi3Only::RecordHorizontalSamples => &self.samples[0],
            Fmi3Only::RecordVerticalSamples => &self.samples[1],
            Fmi3Only::IntermediateInterval => std::slice::from_ref(&self.interval),
        }
    }

    /// The same, to be set.
    pub fn of_mut(&mut self, fmi3_only: Fmi3Only) -> &mut [f64] {
        match fmi3_only {
            Fmi3Only::Time
            | Fmi3Only::RecordSamples
            | Fmi3Only::IndicatorL
            | Fmi3Only::IndicatorR
            | Fmi3Only::IndicatorQuarterTurn
            | Fmi3Only::IndicatorSlide
            | Fmi3Only::IndicatorSlipR
            | Fmi3Only::IndicatorSlipL
            | Fmi3Only::IndicatorTie1Taut
            | Fmi3Only::IndicatorTie1Strength
            | Fmi3Only::IndicatorTie2Taut
            | Fmi3Only::IndicatorTie2Strength => &mut [],
            Fmi3Only::RecordHorizontalSamples => &mut self.samples[0],
            Fmi3Only::RecordVerticalSamples => &mut self.samples[1],
            Fmi3Only::IntermediateInterval => std::slice::from_mut(&mut self.interval),
        }
    }
}
