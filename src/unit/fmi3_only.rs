//! The parameters that only FMI 3.0 has: a record as arrays, and how often the importer looks into a step.

use serde::{Deserialize, Serialize};

use crate::ground::Ground;
use crate::unit::fault::Fault;
use crate::unit::instance::{Interface, Unit};
use crate::unit::variables::{Fmi3Only, Variable};
use rocking_records::{Format, Record};

/// Their values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fmi3OnlyValues {
    /// Horizontal and vertical ground accelerations (m/s²), as many of each; zeros for none.
    samples: [Vec<f64>; 2],
    /// Time between two looks of the importer into a step (s).
    interval: f64,
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
    /// Whether these are values of this FMU, each within its limits.
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

    /// The record that the arrays hold, with `time_step` (s) between two samples; the error is one line.
    pub fn ground(&self, time_step: f64) -> Result<Ground, String> {
        let [horizontal, vertical] =
            [Fmi3Only::RecordHorizontalSamples, Fmi3Only::RecordVerticalSamples].map(|fmi3_only| {
                let acceleration = self.of(fmi3_only);
                acceleration.iter().any(|&a| a != 0.0).then(|| Record {
                    title: fmi3_only.name().to_string(),
                    format: Format::Columns,
                    unit: rocking_records::Unit::MetrePerSecondSquared,
                    start_time: 0.0,
                    time_step,
                    acceleration: acceleration.to_vec(),
                })
            });
        if time_step > 0.0 {
            return Ok(Ground { horizontal, vertical });
        }
        Err(format!(
            "{} = {time_step} s with samples; expected the time between two of them",
            Variable::RecordDt.name()
        ))
    }

    fn resize(&mut self, count: usize) {
        self.samples = [vec![0.0; count], vec![0.0; count]];
    }

    /// Returns the values of a real parameter, or an empty slice for any other variable.
    fn of(&self, fmi3_only: Fmi3Only) -> &[f64] {
        match fmi3_only {
            Fmi3Only::Time
            | Fmi3Only::RecordSamples
            | Fmi3Only::IndicatorL
            | Fmi3Only::IndicatorR
            | Fmi3Only::IndicatorQuarterTurn
            | Fmi3Only::IndicatorSlide => &[],
            Fmi3Only::RecordHorizontalSamples => &self.samples[0],
            Fmi3Only::RecordVerticalSamples => &self.samples[1],
            Fmi3Only::IntermediateInterval => std::slice::from_ref(&self.interval),
        }
    }

    fn of_mut(&mut self, fmi3_only: Fmi3Only) -> &mut [f64] {
        match fmi3_only {
            Fmi3Only::Time
            | Fmi3Only::RecordSamples
            | Fmi3Only::IndicatorL
            | Fmi3Only::IndicatorR
            | Fmi3Only::IndicatorQuarterTurn
            | Fmi3Only::IndicatorSlide => &mut [],
            Fmi3Only::RecordHorizontalSamples => &mut self.samples[0],
            Fmi3Only::RecordVerticalSamples => &mut self.samples[1],
            Fmi3Only::IntermediateInterval => std::slice::from_mut(&mut self.interval),
        }
    }
}

impl Unit {
    /// Time between two looks of the importer into a step (s).
    pub fn interval(&self) -> f64 {
        self.values.fmi3_only.interval
    }

    /// Number of samples in each of the arrays.
    pub fn sample_count(&self) -> usize {
        self.values.fmi3_only.samples[0].len()
    }

    /// How many values a variable has.
    pub fn size(&self, fmi3_only: Fmi3Only) -> usize {
        self.values.fmi3_only.of(fmi3_only).len().max(1)
    }

    /// Hands the values of a real variable over to `give`.
    pub fn read_fmi3_only(&mut self, fmi3_only: Fmi3Only, give: &mut dyn FnMut(f64)) -> Result<(), Fault> {
        match fmi3_only {
            Fmi3Only::Time => give(self.time()),
            Fmi3Only::IndicatorL => give(self.indicator(0)?),
            Fmi3Only::IndicatorR => give(self.indicator(1)?),
            Fmi3Only::IndicatorQuarterTurn => give(self.indicator(2)?),
            Fmi3Only::IndicatorSlide => give(self.indicator(3)?),
            Fmi3Only::RecordSamples => give(self.sample_count() as f64),
            Fmi3Only::RecordHorizontalSamples | Fmi3Only::RecordVerticalSamples | Fmi3Only::IntermediateInterval => {
                self.values.fmi3_only.of(fmi3_only).iter().copied().for_each(give);
            }
        }
        Ok(())
    }

    /// An event indicator of Model Exchange; in Co-Simulation the importer has nothing to watch.
    fn indicator(&mut self, place: usize) -> Result<f64, Fault> {
        match self.interface() {
            Interface::CoSimulation => Ok(1.0),
            Interface::ModelExchange => Ok(self.indicators()?[place]),
        }
    }

    /// Sets a real parameter, all of its values or none.
    pub fn set_fmi3_only(&mut self, fmi3_only: Fmi3Only, values: &[f64]) -> Result<(), Fault> {
        let name = fmi3_only.name();
        if self.values.fmi3_only.of(fmi3_only).is_empty() {
            return Err(Fault::new(format!("{name} is no real parameter, which alone can be set here")));
        }
        if self.phase().is_initialized() {
            return Err(Fault::new(format!("{name} is a fixed parameter; it can be set until initialization ends")));
        }
        values.iter().try_for_each(|&value| fmi3_only.admits(value)).map_err(Fault::new)?;
        self.values.fmi3_only.of_mut(fmi3_only).copy_from_slice(values);
        self.forget_ground();
        Ok(())
    }

    /// Sets the number of samples in each of the arrays, which are zeros then.
    pub fn resize_samples(&mut self, count: u64) -> Result<(), Fault> {
        Fmi3Only::RecordSamples.admits(count as f64).map_err(Fault::new)?;
        self.values.fmi3_only.resize(count as usize);
        self.forget_ground();
        Ok(())
    }
}
