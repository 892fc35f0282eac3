//! The parameters that only FMI 3.0 has: a record as arrays, and how often the importer looks into a step.

use serde::{Deserialize, Serialize};

use crate::model::fault::Fault;
use crate::model::unit::{Interface, Unit};
use crate::model::values::Values;
use crate::model::variables::{Own, Variable};
use crate::records::ground::Ground;
use crate::records::{self, Format, Record};

/// Their values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OwnValues {
    /// Horizontal and vertical ground accelerations (m/s²), as many of each; zeros for none.
    samples: [Vec<f64>; 2],
    /// Time between two looks of the importer into a step (s).
    interval: f64,
}

impl Default for OwnValues {
    fn default() -> OwnValues {
        let start = |own: Own| own.start().unwrap_or(0.0);
        let mut values = OwnValues { samples: [Vec::new(), Vec::new()], interval: start(Own::IntermediateInterval) };
        values.resize(start(Own::RecordSamples) as usize);
        values
    }
}

impl OwnValues {
    /// Whether these are values of this FMU, each within its limits.
    pub fn are_valid(&self) -> bool {
        let [horizontal, vertical] = &self.samples;
        horizontal.len() == vertical.len()
            && Own::RecordSamples.admits(horizontal.len() as f64).is_ok()
            && Own::IntermediateInterval.admits(self.interval).is_ok()
            && horizontal.iter().chain(vertical).all(|a| a.is_finite())
    }

    /// Whether the arrays hold a record.
    pub fn has_record(&self) -> bool {
        self.samples.iter().flatten().any(|&a| a != 0.0)
    }

    /// The record that the arrays hold, with `time_step` (s) between two samples; the error is one line.
    pub fn ground(&self, time_step: f64) -> Result<Ground, String> {
        let [horizontal, vertical] = [Own::RecordHorizontalSamples, Own::RecordVerticalSamples].map(|own| {
            let acceleration = self.of(own);
            acceleration.iter().any(|&a| a != 0.0).then(|| Record {
                title: own.name().to_string(),
                format: Format::Columns,
                unit: records::Unit::MetrePerSecondSquared,
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

    /// The values of a real parameter; none of what is none.
    fn of(&self, own: Own) -> &[f64] {
        match own {
            Own::Time
            | Own::RecordSamples
            | Own::IndicatorL
            | Own::IndicatorR
            | Own::IndicatorQuarterTurn
            | Own::IndicatorSlide => &[],
            Own::RecordHorizontalSamples => &self.samples[0],
            Own::RecordVerticalSamples => &self.samples[1],
            Own::IntermediateInterval => std::slice::from_ref(&self.interval),
        }
    }

    fn of_mut(&mut self, own: Own) -> &mut [f64] {
        match own {
            Own::Time
            | Own::RecordSamples
            | Own::IndicatorL
            | Own::IndicatorR
            | Own::IndicatorQuarterTurn
            | Own::IndicatorSlide => &mut [],
            Own::RecordHorizontalSamples => &mut self.samples[0],
            Own::RecordVerticalSamples => &mut self.samples[1],
            Own::IntermediateInterval => std::slice::from_mut(&mut self.interval),
        }
    }
}

impl Values {
    /// The records that act inside, from arrays or files; the error is one line.
    pub fn ground(&self) -> Result<Ground, String> {
        let ground = self.unscaled_ground()?;
        Ok(ground.scaled(self[Variable::RecordScale]).shifted(self[Variable::RecordStart]))
    }

    /// The same as they are given, neither scaled nor shifted.
    pub(super) fn unscaled_ground(&self) -> Result<Ground, String> {
        match (self.own.has_record(), self.has_file()) {
            (false, _) => self.ground_of_files(),
            (true, false) => self.own.ground(self[Variable::RecordDt]),
            (true, true) => Err("record.horizontal_samples or record.vertical_samples holds a record, and \
                                 record.horizontal or record.vertical names one; expected one of both"
                .into()),
        }
    }
}

impl Unit {
    /// Time between two looks of the importer into a step (s).
    pub fn interval(&self) -> f64 {
        self.values.own.interval
    }

    /// Number of samples in each of the arrays.
    pub fn sample_count(&self) -> usize {
        self.values.own.samples[0].len()
    }

    /// How many values a variable has.
    pub fn size(&self, own: Own) -> usize {
        self.values.own.of(own).len().max(1)
    }

    /// Hands the values of a real variable over to `give`.
    pub fn read_own(&mut self, own: Own, give: &mut dyn FnMut(f64)) -> Result<(), Fault> {
        match own {
            Own::Time => give(self.time()),
            Own::IndicatorL => give(self.indicator(0)?),
            Own::IndicatorR => give(self.indicator(1)?),
            Own::IndicatorQuarterTurn => give(self.indicator(2)?),
            Own::IndicatorSlide => give(self.indicator(3)?),
            Own::RecordSamples => give(self.sample_count() as f64),
            Own::RecordHorizontalSamples | Own::RecordVerticalSamples | Own::IntermediateInterval => {
                self.values.own.of(own).iter().copied().for_each(give);
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
    pub fn set_own(&mut self, own: Own, values: &[f64]) -> Result<(), Fault> {
        let name = own.name();
        if self.values.own.of(own).is_empty() {
            return Err(Fault::new(format!("{name} is no real parameter, which alone can be set here")));
        }
        if self.phase().is_initialized() {
            return Err(Fault::new(format!("{name} is a fixed parameter; it can be set until initialization ends")));
        }
        values.iter().try_for_each(|&value| own.admits(value)).map_err(Fault::new)?;
        self.values.own.of_mut(own).copy_from_slice(values);
        self.forget_ground();
        Ok(())
    }

    /// Sets the number of samples in each of the arrays, which are zeros then.
    pub fn resize_samples(&mut self, count: u64) -> Result<(), Fault> {
        Own::RecordSamples.admits(count as f64).map_err(Fault::new)?;
        self.values.own.resize(count as usize);
        self.forget_ground();
        Ok(())
    }
}
