//! A folder of records → the ground motions of Table I, where pulses replace missing records.

use std::path::{Path, PathBuf};

use rocking_block::block::Common;
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_records::{ReadOptions, Record, RecordError, Unit};
use rocking_studies::spec::words::Words;

/// A row of Table I, and the files of its records.
pub struct TableRow {
    /// Short name, for tables.
    pub name: &'static str,
    /// Station and component.
    pub station: &'static str,
    /// Peak ground acceleration of the paper's record (g).
    pub pga: f64,
    /// Shape of the pulse.
    pub shape: PulseShape,
    /// Amplitude a_p of the pulse (m/s²).
    pub amplitude: f64,
    /// Period T_p of the pulse (s).
    pub period: f64,
    /// File of the horizontal record.
    pub horizontal: &'static str,
    /// File of the vertical record.
    pub vertical: &'static str,
    /// Time step (s) of files without header, in g.
    pub headerless_step: Option<f64>,
}

/// Table I.
pub const TABLE: [TableRow; 4] = [
    TableRow {
        name: "pacoima",
        station: "Pacoima Dam 164",
        pga: 1.23,
        shape: PulseShape::C1,
        amplitude: 4.11,
        period: 1.30,
        horizontal: "PCD164.AT2",
        vertical: "PCD-UP.AT2",
        headerless_step: None,
    },
    TableRow {
        name: "erzincan",
        station: "Erzincan NS",
        pga: 0.52,
        shape: PulseShape::C1,
        amplitude: 2.44,
        period: 1.80,
        horizontal: "ERZ-NS_unrotated.AT2",
        vertical: "ERZ-UP.AT2",
        headerless_step: None,
    },
    TableRow {
        name: "sylmar",
        station: "Sylmar Converter 052",
        pga: 0.73,
        shape: PulseShape::C2,
        amplitude: 1.64,
        period: 2.30,
        horizontal: "SCS052.AT2",
        vertical: "SCSUP.AT2",
        headerless_step: Some(0.005),
    },
    TableRow {
        name: "rinaldi",
        station: "Rinaldi 228",
        pga: 0.84,
        shape: PulseShape::OneSine,
        amplitude: 6.87,
        period: 0.80,
        horizontal: "NGA_no_1063_RRS228.AT2",
        vertical: "RRS-UP.AT2",
        headerless_step: None,
    },
];

/// Subfolders of the records, searched in this order.
const FOLDERS: [&str; 3] = ["", "paper", "paper_derived"];

/// A ground motion of Table I.
#[derive(Clone, Debug)]
pub struct GroundMotion {
    /// Short name.
    pub name: &'static str,
    /// Description: station with the peak of its record, or with the pulse that replaces it.
    pub label: String,
    /// Peak ground acceleration of the paper's record (g).
    pub pga: f64,
    /// Record, with its vertical component if available.
    pub ground: Ground,
    /// Pulse that replaces a missing record.
    pub pulse: Pulse,
}

impl GroundMotion {
    /// Returns true if the motion is a record.
    pub fn is_record(&self) -> bool {
        self.ground.horizontal.is_some()
    }

    /// Returns the motion without its vertical component.
    pub fn horizontal_only(&self) -> GroundMotion {
        GroundMotion { ground: Ground { vertical: None, ..self.ground.clone() }, ..self.clone() }
    }

    /// Describes horizontal and vertical motion.
    pub fn description(&self) -> String {
        format!("{}; {}", self.label, self.vertical_label())
    }

    /// Describes the vertical motion.
    fn vertical_label(&self) -> String {
        match &self.ground.vertical {
            Some(record) => format!("vertical record, {}", peak(record)),
            None => "no vertical record at hand".into(),
        }
    }
}

/// Error of the records of Table I.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// The folder does not exist.
    #[error("{0}: no such folder; expected one with the records of Table I (docs/unit/figures.md)")]
    Folder(String),
    /// A file is invalid.
    #[error(transparent)]
    Record(#[from] RecordError),
}

/// Returns the ground motions of Table I, with the available records of a folder.
///
/// # Errors
/// A folder that is missing or has none of the records, or a record that cannot be read.
pub fn read(folder: Option<&Path>) -> Result<Vec<GroundMotion>, SourceError> {
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        return Err(SourceError::Folder(folder.display().to_string()));
    }
    TABLE.iter().map(|row| source(row, folder)).collect()
}

/// Returns the files of a folder that [`read`] uses.
pub fn files(folder: Option<&Path>) -> Vec<PathBuf> {
    let names = TABLE.iter().flat_map(|row| [row.horizontal, row.vertical]);
    folder.map_or(Vec::new(), |folder| names.filter_map(|name| find(folder, name)).collect())
}

fn source(row: &TableRow, folder: Option<&Path>) -> Result<GroundMotion, SourceError> {
    let load = |name: &str| -> Result<Option<Record>, RecordError> {
        let Some(path) = folder.and_then(|folder| find(folder, name)) else { return Ok(None) };
        let options = ReadOptions {
            unit: row.headerless_step.map(|_| Unit::G),
            time_step: row.headerless_step,
            gravity: Common::default().gravity,
            ..ReadOptions::default()
        };
        rocking_records::read(&path, &options).map(Some)
    };
    let &TableRow { name, station, pga, shape, amplitude, period, .. } = row;
    Ok(match load(row.horizontal)? {
        Some(record) => GroundMotion {
            name,
            label: format!("{station}, {}", peak(&record)),
            pga,
            ground: Ground { horizontal: Some(record), vertical: load(row.vertical)? },
            pulse: Pulse::NONE,
        },
        None => GroundMotion {
            name,
            label: format!(
                "{station}: no record at hand, its {} pulse instead, a_p = {amplitude} m/s², T_p = {period} s",
                shape.word()
            ),
            pga,
            ground: Ground::default(),
            pulse: Pulse { shape, amplitude, period, start: 0.0, ..Pulse::NONE },
        },
    })
}

fn find(folder: &Path, name: &str) -> Option<PathBuf> {
    FOLDERS.iter().map(|inner| folder.join(inner).join(name)).find(|path| path.is_file())
}

fn peak(record: &Record) -> String {
    format!("{:.2} g", record.peak().acceleration.abs() / Common::default().gravity)
}
