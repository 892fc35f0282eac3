//! Parameters → the planar unit's own ground motion, from files or arrays.

use crate::excitation::records::Ground;
use crate::unit::record_source::{RecordFile, RecordSource, from_one, of_arrays};
use crate::unit::values::Values;
use crate::unit::variables::{Fmi3Variable, Text, Variable};

impl Values {
    /// Returns the FMU's own records, from arrays or files.
    ///
    /// # Errors
    /// One line: both arrays and files, or the first fault of a file.
    pub fn ground(&self) -> Result<Ground, String> {
        let ground = self.unscaled_ground()?;
        Ok(ground.scaled(self[Variable::RecordScale]).shifted(self[Variable::RecordStart]))
    }

    /// Returns the records without scale and shift.
    pub(super) fn unscaled_ground(&self) -> Result<Ground, String> {
        let arrays = RecordSource {
            variables: "record.horizontal_samples or record.vertical_samples",
            gives: self.fmi3.has_record(),
        };
        let files = RecordSource { variables: "record.horizontal or record.vertical", gives: self.has_file() };
        from_one([arrays, files], || self.ground_of_arrays(), || self.ground_of_files())
    }

    /// Whether the FMU has a record of its own.
    pub(super) fn has_record(&self) -> bool {
        self.has_file() || self.fmi3.has_record()
    }

    /// Whether a parameter names a record file.
    pub(super) fn has_file(&self) -> bool {
        !(self[Text::RecordHorizontal].is_empty() && self[Text::RecordVertical].is_empty())
    }

    /// Whether [`Values::ground`] reads this variable.
    pub fn is_of_ground(variable: Variable) -> bool {
        variable == Variable::G || variable.name().starts_with("record.")
    }

    /// Returns the record in the arrays. An error is one line.
    fn ground_of_arrays(&self) -> Result<Ground, String> {
        let arrays = [Fmi3Variable::RecordHorizontalSamples, Fmi3Variable::RecordVerticalSamples];
        let [horizontal, vertical] = of_arrays(
            arrays.map(|samples| (samples.name(), self.fmi3.of(samples))),
            (Variable::RecordDt.name(), self[Variable::RecordDt]),
        )?;
        Ok(Ground { horizontal, vertical })
    }

    /// Reads the files that the parameters name. An error is one line and names settings by their variables.
    pub(super) fn ground_of_files(&self) -> Result<Ground, String> {
        let unit = |texts: &[Text]| texts.iter().copied().find(|&text| !self[text].is_empty());
        let record = |path: Text, unit: Text, channel: Variable| {
            let text = |text: Text| (text.variable().name(), self[text].as_str());
            let number = |variable: Variable| (variable.name(), self[variable]);
            let (channel, time_step) = (number(channel), number(Variable::RecordDt));
            RecordFile { path: text(path), unit: text(unit), channel, time_step, gravity: self[Variable::G] }.read()
        };
        let horizontal_unit = unit(&[Text::RecordHorizontalUnit]).unwrap_or(Text::RecordHorizontalUnit);
        let vertical_unit =
            unit(&[Text::RecordVerticalUnit, Text::RecordHorizontalUnit]).unwrap_or(Text::RecordVerticalUnit);
        Ok(Ground {
            horizontal: record(Text::RecordHorizontal, horizontal_unit, Variable::RecordHorizontalChannel)?,
            vertical: record(Text::RecordVertical, vertical_unit, Variable::RecordVerticalChannel)?,
        })
    }
}
