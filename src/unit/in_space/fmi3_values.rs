//! Values of the parameters that only FMI 3.0 has: feet and records as arrays, and the interval of intermediate updates.

use serde::{Deserialize, Serialize};

use crate::unit::in_space::variables::{Fmi3Variable, fmi3_metadata};
use crate::unit::record_source;

/// Values of these parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpaceFmi3Values {
    /// Places of feet along x and y, and gaps (m), equal in number.
    pub(super) feet: [Vec<f64>; 3],
    /// Ground accelerations along x, y and z (m/s²), equal in number; zeros if there is no record.
    samples: [Vec<f64>; 3],
    /// Time between two intermediate updates (s).
    pub interval: f64,
}

impl Default for SpaceFmi3Values {
    fn default() -> SpaceFmi3Values {
        let start = |variable| fmi3_metadata(variable).start.unwrap_or(0.0);
        let zeros = |count| std::array::from_fn(|_| vec![0.0; start(count) as usize]);
        SpaceFmi3Values {
            feet: zeros(Fmi3Variable::FootCount),
            samples: zeros(Fmi3Variable::RecordSamples),
            interval: start(Fmi3Variable::IntermediateInterval),
        }
    }
}

impl SpaceFmi3Values {
    /// Whether each value is within its limits.
    pub fn are_valid(&self) -> bool {
        let [x, y, gap] = &self.feet;
        let admitted = |variable, values: &[f64]| values.iter().all(|&v| fmi3_metadata(variable).admits(v).is_ok());
        x.len() == y.len()
            && x.len() == gap.len()
            && admitted(Fmi3Variable::FootCount, &[x.len() as f64])
            && admitted(Fmi3Variable::FootX, x)
            && admitted(Fmi3Variable::FootY, y)
            && admitted(Fmi3Variable::FootGap, gap)
            && record_source::are_valid(&self.samples, fmi3_metadata(Fmi3Variable::RecordSamples))
            && admitted(Fmi3Variable::IntermediateInterval, &[self.interval])
    }

    /// Whether the arrays hold a record.
    pub fn has_record(&self) -> bool {
        record_source::hold_record(&self.samples)
    }

    /// Returns the number of feet in the arrays.
    pub fn foot_count(&self) -> usize {
        self.feet[0].len()
    }

    /// Returns the number of elements of an array, the size of arrays, or 1.
    pub fn size_of(&self, variable: Fmi3Variable) -> usize {
        match variable {
            Fmi3Variable::FootCount
            | Fmi3Variable::FootX
            | Fmi3Variable::FootY
            | Fmi3Variable::FootGap
            | Fmi3Variable::N
            | Fmi3Variable::Uplift
            | Fmi3Variable::Slip
            | Fmi3Variable::StretchX
            | Fmi3Variable::StretchY
            | Fmi3Variable::StretchXRate
            | Fmi3Variable::StretchYRate
            | Fmi3Variable::SlipRate => self.foot_count(),
            Fmi3Variable::RecordSamples
            | Fmi3Variable::RecordXSamples
            | Fmi3Variable::RecordYSamples
            | Fmi3Variable::RecordZSamples => self.samples[0].len(),
            // The instance knows which feet an indicator has.
            Fmi3Variable::Time | Fmi3Variable::IntermediateInterval | Fmi3Variable::Indicator(_) => 1,
        }
    }

    /// Sets the size of arrays, with zeros: all feet at the centre of mass, or no record.
    pub fn resize(&mut self, size: Fmi3Variable, count: usize) {
        *if size == Fmi3Variable::RecordSamples { &mut self.samples } else { &mut self.feet } =
            std::array::from_fn(|_| vec![0.0; count]);
    }

    /// Returns the values of a parameter for a change.
    pub fn of_mut(&mut self, variable: Fmi3Variable) -> Option<&mut [f64]> {
        let [x, y, gap] = &mut self.feet;
        let [a_x, a_y, a_z] = &mut self.samples;
        match variable {
            Fmi3Variable::FootX => Some(x),
            Fmi3Variable::FootY => Some(y),
            Fmi3Variable::FootGap => Some(gap),
            Fmi3Variable::RecordXSamples => Some(a_x),
            Fmi3Variable::RecordYSamples => Some(a_y),
            Fmi3Variable::RecordZSamples => Some(a_z),
            Fmi3Variable::IntermediateInterval => Some(std::slice::from_mut(&mut self.interval)),
            Fmi3Variable::Time
            | Fmi3Variable::FootCount
            | Fmi3Variable::RecordSamples
            | Fmi3Variable::N
            | Fmi3Variable::Uplift
            | Fmi3Variable::Slip
            | Fmi3Variable::StretchX
            | Fmi3Variable::StretchY
            | Fmi3Variable::StretchXRate
            | Fmi3Variable::StretchYRate
            | Fmi3Variable::SlipRate
            | Fmi3Variable::Indicator(_) => None,
        }
    }

    /// Returns the values of a parameter; none of another variable.
    pub fn of(&self, variable: Fmi3Variable) -> &[f64] {
        let [x, y, gap] = &self.feet;
        let [a_x, a_y, a_z] = &self.samples;
        match variable {
            Fmi3Variable::FootX => x,
            Fmi3Variable::FootY => y,
            Fmi3Variable::FootGap => gap,
            Fmi3Variable::RecordXSamples => a_x,
            Fmi3Variable::RecordYSamples => a_y,
            Fmi3Variable::RecordZSamples => a_z,
            Fmi3Variable::IntermediateInterval => std::slice::from_ref(&self.interval),
            Fmi3Variable::Time
            | Fmi3Variable::FootCount
            | Fmi3Variable::RecordSamples
            | Fmi3Variable::N
            | Fmi3Variable::Uplift
            | Fmi3Variable::Slip
            | Fmi3Variable::StretchX
            | Fmi3Variable::StretchY
            | Fmi3Variable::StretchXRate
            | Fmi3Variable::StretchYRate
            | Fmi3Variable::SlipRate
            | Fmi3Variable::Indicator(_) => &[],
        }
    }
}
