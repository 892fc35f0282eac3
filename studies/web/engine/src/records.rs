//! Dropped files and their settings → records.

use rocking_records::{Choice, Processing, ReadOptions, Record, Setting};
use rocking_studies::input::ground_files::RecordOption;
use rocking_studies::spec::limits;
use rocking_studies::spec::records::FileSpec;

use crate::fields::{FieldError, Fields};

/// The embedded record: U.S. Geological Survey, public domain.
pub const EMBEDDED: (&str, &[u8]) =
    ("np01002p_4225a_a.smc", include_bytes!("../../../../examples/records/np01002p_4225a_a.smc"));

/// Path of the embedded record in the repository, for command lines.
pub const EMBEDDED_PATH: &str = "examples/records/np01002p_4225a_a.smc";

/// A file that the user dropped.
#[derive(Clone, Debug)]
pub struct DroppedFile {
    /// Its name, without a folder.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// Direction of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Horizontal, in space along x.
    Horizontal,
    /// Horizontal, in space along y.
    SecondHorizontal,
    /// Vertical.
    Vertical,
}

/// The dropped files, in the order of [`Direction::ALL`].
pub type Files<'f> = [Option<&'f DroppedFile>; Direction::ALL.len()];

/// Settings of a file that the command line can name, with their values.
pub type Settings = Vec<(String, String)>;

impl Direction {
    /// All directions.
    pub const ALL: [Direction; 3] = [Direction::Horizontal, Direction::SecondHorizontal, Direction::Vertical];

    /// Name of the field of the file.
    pub fn field(self) -> &'static str {
        match self {
            Direction::Horizontal => "record",
            Direction::SecondHorizontal => "record_y",
            Direction::Vertical => "vertical",
        }
    }

    /// Name of the field of a setting, that of study files.
    fn setting_field(self, setting: Setting) -> String {
        RecordOption { setting, vertical: self == Direction::Vertical }.key()
    }
}

/// The settings of a direction, as read from the fields.
fn options(fields: &mut Fields, direction: Direction, gravity: f64) -> ReadOptions {
    let field = |setting| direction.setting_field(setting);
    let settings = ReadOptions {
        format: fields.parsed(&field(Setting::Format)),
        unit: fields.parsed(&field(Setting::Unit)),
        time_step: fields.limited(&field(Setting::TimeStep), &limits::properties::<FileSpec>()["dt"]),
        gravity,
        layout: None,
        skip: None,
        npts: None,
        value_scale: None,
        time_column: fields.parsed::<Choice>(&field(Setting::TimeColumn)),
        acceleration_column: fields.parsed::<Choice>(&field(Setting::AccelerationColumn)),
        channel: fields.parsed(&field(Setting::Channel)),
        processing: Processing::default(),
    };
    // As in the program, settings of the horizontal file apply to the vertical one too unless it has its own.
    match direction {
        Direction::Vertical if fields.text("excitation") == "file" => {
            settings.or(&options(fields, Direction::Horizontal, gravity))
        }
        Direction::Horizontal | Direction::SecondHorizontal | Direction::Vertical => settings,
    }
}

/// The settings of a direction that have a value, by the names of their fields.
pub fn settings(fields: &Fields, direction: Direction) -> Settings {
    let all = [
        Setting::Unit,
        Setting::TimeStep,
        Setting::Format,
        Setting::Channel,
        Setting::AccelerationColumn,
        Setting::TimeColumn,
    ];
    all.into_iter()
        .map(|setting| direction.setting_field(setting))
        .map(|field| (field.clone(), fields.text(&field).to_string()))
        .filter(|(_, text)| !text.is_empty())
        .collect()
}

/// Reads a dropped file, with a warning if its content is doubtful. An error appears beside the setting that resolves it, or beside the
/// file.
fn read(fields: &mut Fields, direction: Direction, files: Files, gravity: f64) -> Option<(Record, Option<String>)> {
    let Some(DroppedFile { name, bytes }) = files[direction as usize] else {
        let expected = fields.text(&format!("{}_name", direction.field()));
        let expected = if expected.is_empty() { "an accelerogram" } else { expected };
        fields.refuse(FieldError::new(direction.field(), format!("no file yet; expected {expected}")));
        return None;
    };
    let options = options(fields, direction, gravity);
    if fields.has_errors() {
        return None;
    }
    match rocking_records::parse_with_doubt(name, bytes, &options) {
        Ok((record, doubt)) => Some((record, doubt.map(|why| format!("{name}: {why}")))),
        Err(error) => {
            let mut field = direction.field().to_string();
            let message = error.naming(|setting| {
                field = direction.setting_field(setting);
                format!("the {setting}")
            });
            fields.refuse(FieldError::new(field, message));
            None
        }
    }
}

/// Whether the fields choose a file of the second horizontal component.
pub fn has_second(fields: &mut Fields) -> bool {
    let may_have = fields.text("body") == "space" && fields.text("excitation") == "file";
    may_have && fields.one_of(Direction::SecondHorizontal.field(), &["none", "file"]) == "file"
}

/// Reads the ground motion that the fields choose, unscaled, along x, y and z, and warns of doubtful files.
///
/// A block in a plane has none along y. That of a block in space is a file beside that along x, with the same settings.
pub fn components(fields: &mut Fields, files: Files, gravity: f64) -> ([Option<Record>; 3], Vec<String>) {
    let horizontal = match fields.text("excitation") {
        "embedded" => {
            let (name, bytes) = EMBEDDED;
            let options = ReadOptions { gravity, ..ReadOptions::default() };
            rocking_records::parse(name, bytes, &options)
                .map_err(|error| fields.refuse(FieldError::new("record", error.to_string())))
                .ok()
                .map(|record| (record, None))
        }
        "file" => read(fields, Direction::Horizontal, files, gravity),
        _ => return Default::default(),
    };
    let second = match has_second(fields) {
        true => read(fields, Direction::SecondHorizontal, files, gravity),
        false => None,
    };
    let vertical = match fields.text("vertical") {
        "file" => read(fields, Direction::Vertical, files, gravity),
        _ => None,
    };
    let read = [horizontal, second, vertical].map(Option::unzip);
    let doubts = read.iter().filter_map(|(_, doubt)| doubt.clone().flatten()).collect();
    (read.map(|(record, _)| record), doubts)
}
