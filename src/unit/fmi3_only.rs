//! The parameters that exist only in FMI 3.0: a record as arrays, and the interval of intermediate updates.

use serde::{Deserialize, Serialize};

use crate::ground::Ground;
use crate::unit::fault::Fault;
use crate::unit::instance::{Interface, Unit};
use crate::unit::variables::{Fmi3Only, Variable};
use rocking_records::{Format, Record};

/// Values of these parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fmi3OnlyValues {
    /// Horizontal and vertical ground accelerations (m/s²), equal in number; zeros if there is no record.
    samples: [Vec<f64>; 2],
    /// Time between two intermediate updates (s).
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

    /// Returns the record in the arrays, with `time_step` (s) between two samples. An error is one line.
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

    fn of_mut(&mut self, fmi3_only: Fmi3Only) -> &mut [f64] {
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

impl Unit {
    /// Returns the time between two intermediate updates (s).
    pub fn interval(&self) -> f64 {
        self.values.fmi3_only.interval
    }

    /// Returns the number of samples in each array.
    pub fn sample_count(&self) -> usize {
        self.values.fmi3_only.samples[0].len()
    }

    /// Returns the number of values of a variable.
    pub fn size(&self, fmi3_only: Fmi3Only) -> usize {
        self.values.fmi3_only.of(fmi3_only).len().max(1)
    }

    /// Passes the values of a real variable to `give`.
    pub fn read_fmi3_only(&mut self, fmi3_only: Fmi3Only, give: &mut dyn FnMut(f64)) -> Result<(), Fault> {
        match fmi3_only {
            Fmi3Only::Time => give(self.time()),
            Fmi3Only::IndicatorL => give(self.indicator(0)?),
            Fmi3Only::IndicatorR => give(self.indicator(1)?),
            Fmi3Only::IndicatorQuarterTurn => give(self.indicator(2)?),
            Fmi3Only::IndicatorSlide => give(self.indicator(3)?),
            Fmi3Only::IndicatorSlipR => give(self.indicator(4)?),
            Fmi3Only::IndicatorSlipL => give(self.indicator(5)?),
            Fmi3Only::IndicatorTie1Taut => give(self.indicator(6)?),
            Fmi3Only::IndicatorTie1Strength => give(self.indicator(7)?),
            Fmi3Only::IndicatorTie2Taut => give(self.indicator(8)?),
            Fmi3Only::IndicatorTie2Strength => give(self.indicator(9)?),
            Fmi3Only::RecordSamples => give(self.sample_count() as f64),
            Fmi3Only::RecordHorizontalSamples | Fmi3Only::RecordVerticalSamples | Fmi3Only::IntermediateInterval => {
                self.values.fmi3_only.of(fmi3_only).iter().copied().for_each(give);
            }
        }
        Ok(())
    }

    /// Returns an event indicator of Model Exchange; a constant in Co-Simulation, where the importer watches none.
    fn indicator(&mut self, number: usize) -> Result<f64, Fault> {
        match self.interface() {
            Interface::CoSimulation => Ok(1.0),
            Interface::ModelExchange => Ok(self.indicators()?[number]),
        }
    }

    /// Sets all values of a real parameter, or none if one is refused.
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

    /// Sets the number of samples in each array, and all samples to zero.
    pub fn resize_samples(&mut self, count: u64) -> Result<(), Fault> {
        Fmi3Only::RecordSamples.admits(count as f64).map_err(Fault::new)?;
        self.values.fmi3_only.resize(count as usize);
        self.forget_ground();
        Ok(())
    }
}
