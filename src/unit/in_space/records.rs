//! Parameters → the ground motion of the unit in space, from files or arrays.

use rocking_records::Record;

use crate::space::SpaceGround;
use crate::unit::in_space::values::SpaceValues;
use crate::unit::in_space::variables::{Fmi3Variable, Text, Variable, fmi3_metadata};
use crate::unit::record_source::{RecordFile, RecordSource, from_one, of_arrays};

impl SpaceValues {
    /// Returns the FMU's own records, from arrays or files.
    ///
    /// # Errors
    /// One line: both arrays and files, or the first fault of a file, a second component without the first, or components that differ in
    /// time step or length.
    pub fn ground(&self) -> Result<SpaceGround, String> {
        let arrays = RecordSource {
            variables: "record.x_samples, record.y_samples or record.z_samples",
            gives: self.fmi3.has_record(),
        };
        let files = RecordSource { variables: "record.x, record.y or record.z", gives: self.has_file() };
        let records = from_one([arrays, files], || self.records_of_arrays(), || self.records_of_files())?;
        let ground = SpaceGround { records, azimuth: self[Variable::RecordAzimuth] };
        let ground = ground.checked().map_err(|error| match error.starts_with("record.") {
            true if error.contains(" time step of ") => format!("{error}; resample the components to one step"),
            true => format!("{error}; cut the components to the samples that all have"),
            false => error,
        })?;
        Ok(ground.scaled_and_shifted(self[Variable::RecordScale], self[Variable::RecordStart]))
    }

    /// Whether a parameter names a record file.
    pub(super) fn has_file(&self) -> bool {
        [Text::RecordX, Text::RecordY, Text::RecordZ].iter().any(|&path| !self[path].is_empty())
    }

    fn records_of_arrays(&self) -> Result<[Option<Record>; 3], String> {
        let arrays = [Fmi3Variable::RecordXSamples, Fmi3Variable::RecordYSamples, Fmi3Variable::RecordZSamples];
        of_arrays(
            arrays.map(|samples| (fmi3_metadata(samples).name, self.fmi3.of(samples))),
            (Variable::RecordDt.name(), self[Variable::RecordDt]),
        )
    }

    fn records_of_files(&self) -> Result<[Option<Record>; 3], String> {
        if self[Text::RecordX].is_empty() && !self[Text::RecordY].is_empty() {
            return Err(
                "record.x is empty and record.y is not; expected both horizontal components, or record.x alone".into(),
            );
        }
        let record = |path: Text, unit: Text, channel: Variable| {
            // The unit of the first component is that of all without one of their own.
            let unit = if self[unit].is_empty() { Text::RecordXUnit } else { unit };
            let text = |text: Text| (text.variable().name(), self[text].as_str());
            let number = |variable: Variable| (variable.name(), self[variable]);
            let (channel, time_step) = (number(channel), number(Variable::RecordDt));
            RecordFile { path: text(path), unit: text(unit), channel, time_step, gravity: self[Variable::G] }.read()
        };
        Ok([
            record(Text::RecordX, Text::RecordXUnit, Variable::RecordXChannel)?,
            record(Text::RecordY, Text::RecordYUnit, Variable::RecordYChannel)?,
            record(Text::RecordZ, Text::RecordZUnit, Variable::RecordZChannel)?,
        ])
    }

    /// Whether [`SpaceValues::ground`] reads this variable.
    pub fn is_of_ground(variable: Variable) -> bool {
        variable == Variable::G || variable.name().starts_with("record.")
    }
}
