//! Reading and setting the variables that exist only in FMI 3.0.

use crate::unit::fault::Fault;
use crate::unit::instance::{Interface, Unit};
use crate::unit::variables::Fmi3Variable;

impl Unit {
    /// Returns the time between two intermediate updates (s).
    pub fn interval(&self) -> f64 {
        self.values.fmi3.interval
    }

    /// Returns the number of samples in each array.
    pub fn sample_count(&self) -> usize {
        self.values.fmi3.of(Fmi3Variable::RecordHorizontalSamples).len()
    }

    /// Returns the number of values of a variable.
    pub fn size_of(&self, variable: Fmi3Variable) -> usize {
        self.values.fmi3.of(variable).len().max(1)
    }

    /// Passes the values of a real variable to `give`.
    ///
    /// # Errors
    /// Before initialization ends, values that make no block or record.
    pub fn read_fmi3_variable(&mut self, variable: Fmi3Variable, give: &mut dyn FnMut(f64)) -> Result<(), Fault> {
        match variable {
            Fmi3Variable::Time => give(self.time()),
            Fmi3Variable::Indicator(number) => give(self.indicator(number)?),
            Fmi3Variable::RecordSamples => give(self.sample_count() as f64),
            Fmi3Variable::RecordHorizontalSamples
            | Fmi3Variable::RecordVerticalSamples
            | Fmi3Variable::IntermediateInterval => {
                self.values.fmi3.of(variable).iter().copied().for_each(give);
            }
        }
        Ok(())
    }

    /// Returns an event indicator of Model Exchange. It is a constant in Co-Simulation, where the importer watches none.
    fn indicator(&mut self, number: usize) -> Result<f64, Fault> {
        match self.life.interface {
            Interface::CoSimulation => Ok(1.0),
            Interface::ModelExchange => Ok(self.indicators()?[number]),
        }
    }

    /// Sets all values of a real parameter, or none if one is refused.
    ///
    /// # Errors
    /// A variable that cannot be set, or not now; or a value outside its limits.
    pub fn set_fmi3_variable(&mut self, variable: Fmi3Variable, values: &[f64]) -> Result<(), Fault> {
        let metadata = variable.metadata();
        let name = metadata.name;
        if self.values.fmi3.of(variable).is_empty() {
            return Err(Fault::new(format!("{name} is set; expected a real parameter")));
        }
        if self.life.phase.is_initialized() {
            return Err(Fault::new(format!(
                "{name} is a fixed parameter; expected it to be set before initialization ends"
            )));
        }
        values.iter().try_for_each(|&value| metadata.admits(value)).map_err(Fault::new)?;
        self.values.fmi3.of_mut(variable).copy_from_slice(values);
        self.forget_ground();
        Ok(())
    }

    /// Sets the number of samples in each array, and all samples to zero.
    ///
    /// # Errors
    /// A number outside its limits.
    pub fn resize_samples(&mut self, count: u64) -> Result<(), Fault> {
        Fmi3Variable::RecordSamples.metadata().admits(count as f64).map_err(Fault::new)?;
        self.values.fmi3.resize(count as usize);
        self.forget_ground();
        Ok(())
    }
}
