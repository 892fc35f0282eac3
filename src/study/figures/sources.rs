//! A folder of records → the ground motions of the paper's Table I, each a record or, where it is missing, its pulse.

use std::path::{Path, PathBuf};

use crate::block::Common;
use crate::excitation::{Pulse, PulseShape};
use crate::records::ground::Ground;
use crate::records::{self, ReadOptions, Record, RecordError, Unit};

/// A row of Table I, and the files that hold its records.
pub struct Row {
    /// Short name, which is used in tables.
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
    /// Time step (s) of files in g that have no header.
    pub bare: Option<f64>,
}

/// Table I.
pub const TABLE: [Row; 4] = [
    Row {
        name: "pacoima",
        station: "Pacoima Dam 164",
        pga: 1.23,
        shape: PulseShape::C1,
        amplitude: 4.11,
        period: 1.30,
        horizontal: "PCD164.AT2",
        vertical: "PCD-UP.AT2",
        bare: None,
    },
    Row {
        name: "erzincan",
        station: "Erzincan NS",
        pga: 0.52,
        shape: PulseShape::C1,
        amplitude: 2.44,
        period: 1.80,
        horizontal: "ERZ-NS_unrotated.AT2",
        vertical: "ERZ-UP.AT2",
        bare: None,
    },
    Row {
        name: "sylmar",
        station: "Sylmar Converter 052",
        pga: 0.73,
        shape: PulseShape::C2,
        amplitude: 1.64,
        period: 2.30,
        horizontal: "SCS052.AT2",
        vertical: "SCSUP.AT2",
        bare: Some(0.005),
    },
    Row {
        name: "rinaldi",
        station: "Rinaldi 228",
        pga: 0.84,
        shape: PulseShape::OneSine,
        amplitude: 6.87,
        period: 0.80,
        horizontal: "NGA_no_1063_RRS228.AT2",
        vertical: "RRS-UP.AT2",
        bare: None,
    },
];

/// Folders, inside the one that is named, in which a file is looked for.
const FOLDERS: [&str; 3] = ["", "paper", "paper_derived"];

/// A ground motion of Table I.
#[derive(Clone, Debug)]
pub struct Source {
    /// Short name.
    pub name: &'static str,
    /// What it is: a record with its peak, or the pulse that stands for it.
    pub label: String,
    /// Peak ground acceleration of the paper's record (g).
    pub pga: f64,
    /// The record, with its vertical part if that is at hand.
    pub ground: Ground,
    /// The pulse, where there is no record.
    pub pulse: Pulse,
}

impl Source {
    /// Whether there is a record.
    pub fn is_record(&self) -> bool {
        self.ground.horizontal.is_some()
    }

    /// The same without vertical motion.
    pub fn horizontal_only(&self) -> Source {
        Source { ground: Ground { vertical: None, ..self.ground.clone() }, ..self.clone() }
    }

    /// The label with what is to be said of the vertical motion.
    pub fn with_vertical(&self) -> String {
        format!("{}; {}", self.label, self.vertical_label())
    }

    /// What is to be said of the vertical motion: its record with its peak, or that there is none.
    pub fn vertical_label(&self) -> String {
        match &self.ground.vertical {
            Some(record) => format!("vertical record, {}", peak(record)),
            None => "no vertical record at hand".into(),
        }
    }
}

/// A file of records that is there and cannot be read, or a folder that is not there.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// No such folder.
    #[error("{0}: found no such folder; expected one with the records of Table I, see docs/figures.md")]
    Folder(String),
    /// The file is bad.
    #[error(transparent)]
    Record(#[from] RecordError),
}

/// The ground motions of Table I, from the records of a folder as far as they are there.
pub fn read(folder: Option<&Path>) -> Result<Vec<Source>, SourceError> {
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        return Err(SourceError::Folder(folder.display().to_string()));
    }
    TABLE.iter().map(|row| source(row, folder)).collect()
}

/// The files of a folder that [`read`] reads.
pub fn files(folder: Option<&Path>) -> Vec<PathBuf> {
    let names = TABLE.iter().flat_map(|row| [row.horizontal, row.vertical]);
    folder.map_or(Vec::new(), |folder| names.filter_map(|name| find(folder, name)).collect())
}

fn source(row: &Row, folder: Option<&Path>) -> Result<Source, SourceError> {
    let load = |name: &str| -> Result<Option<Record>, RecordError> {
        let Some(path) = folder.and_then(|folder| find(folder, name)) else { return Ok(None) };
        let options = ReadOptions {
            unit: row.bare.map(|_| Unit::G),
            time_step: row.bare,
            gravity: Common::default().gravity,
            ..ReadOptions::default()
        };
        records::read(&path, &options).map(Some)
    };
    let &Row { name, station, pga, shape, amplitude, period, .. } = row;
    Ok(match load(row.horizontal)? {
        Some(record) => Source {
            name,
            label: format!("{station}, {}", peak(&record)),
            pga,
            ground: Ground { horizontal: Some(record), vertical: load(row.vertical)? },
            pulse: Pulse::NONE,
        },
        None => Source {
            name,
            label: format!(
                "{station}: no record at hand, its {} pulse instead, a_p = {amplitude} m/s², T_p = {period} s",
                match shape {
                    PulseShape::OneSine => "type A",
                    PulseShape::OneCosine => "type B",
                    PulseShape::C1 => "type C1",
                    PulseShape::C2 => "type C2",
                    PulseShape::None => "missing",
                }
            ),
            pga,
            ground: Ground::default(),
            pulse: Pulse { shape, amplitude, period, start: 0.0 },
        },
    })
}

fn find(folder: &Path, name: &str) -> Option<PathBuf> {
    FOLDERS.iter().map(|inner| folder.join(inner).join(name)).find(|path| path.is_file())
}

fn peak(record: &Record) -> String {
    format!("{:.2} g", record.peak().acceleration.abs() / Common::default().gravity)
}
