//! Reading and setting the variables that exist only in FMI 3.0.

use crate::unit::fault::Fault;
use crate::unit::instance::{Interface, Unit};
use crate::unit::variables::Fmi3Only;

impl Unit {
    /// Returns the time between two intermediate updates (s).
    pub fn interval(&self) -> f64 {
        self.values.fmi3_only.interval
    }

    /// Returns the number of samples in each array.
    pub fn sample_count(&self) -> usize {
        self.values.fmi3_only.of(Fmi3Only::RecordHorizontalSamples).len()
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
