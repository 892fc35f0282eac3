//! `[[records]]` of a study file → ground motions.

use std::ops::Range;
use std::path::Path;

use toml::de::DeValue;

use crate::input::ground_files::{RecordOption, RecordOptions};
use crate::input::study_file::{Section, StudyFileError, StudyText};
use crate::intensity::Measure;
use crate::sweep::ground_motion::GroundMotion;
use rocking_block::ground::Ground;
use rocking_records::{Column, Processing, ReadOptions, Record, Setting};

/// The keys of `[[records]]`.
pub(crate) const KEYS: [&str; 17] = [
    "horizontal",
    "vertical",
    "unit",
    "dt",
    "format",
    "channel",
    "acceleration_column",
    "time_column",
    "baseline",
    "band_pass",
    "resample",
    "vertical_unit",
    "vertical_dt",
    "vertical_format",
    "vertical_channel",
    "vertical_acceleration_column",
    "vertical_time_column",
];

/// Reads the ground motions and computes these measures; without `[[records]]` the only motion has no record.
///
/// Paths and patterns are relative to `folder`; `gravity` (m/s²) is called only if there are records.
pub(super) fn read(
    root: &Section,
    source: StudyText,
    folder: &Path,
    measures: &[Measure],
    gravity: impl FnOnce() -> Result<f64, StudyFileError>,
) -> Result<Vec<GroundMotion>, StudyFileError> {
    let Some(value) = root.get("records") else {
        return Ok(vec![GroundMotion::new(Default::default(), Ground::default(), &[], f64::NAN)]);
    };
    let list = value.get_ref().as_array().filter(|list| !list.is_empty());
    let list = list.ok_or_else(|| root.wrong("records", value, "[[records]], a table for each ground motion"))?;
    let gravity = gravity()?;
    let mut motions = Vec::new();
    for value in list {
        let table = value.get_ref().as_table().ok_or_else(|| root.wrong("records", value, "tables"))?;
        let section = Section::new(source, "[[records]]", value.span(), table, &KEYS)?;
        let found = in_table(&section, value.span(), source, folder, gravity)?;
        motions.extend(found.into_iter().map(|(names, ground)| GroundMotion::new(names, ground, measures, gravity)));
    }
    Ok(motions)
}

/// Reads the ground motions of one table, at these bytes of the text, with the names of their files.
pub(crate) fn in_table(
    section: &Section,
    range: Range<usize>,
    source: StudyText,
    folder: &Path,
    gravity: f64,
) -> Result<Vec<([String; 2], Ground)>, StudyFileError> {
    let options = options(section, gravity)?;
    let found = grounds(section, source, folder, &options)?;
    let grounds: Vec<Ground> = found.iter().map(|(_, ground)| ground.clone()).collect();
    if let Some((option, needed)) = options.unread(&grounds) {
        let key = option.key();
        let place = section.get(&key).map_or(range, |value| value.span());
        return Err(source.wrong(&place, format!("{key} has no effect without {needed}")));
    }
    Ok(found)
}

/// Reads the ground motions of one table with the names of their files: one, or one per match of a pattern.
fn grounds(
    section: &Section,
    source: StudyText,
    folder: &Path,
    options: &RecordOptions,
) -> Result<Vec<([String; 2], Ground)>, StudyFileError> {
    let wrong =
        |key: &str, message: String| source.wrong(&section.get(key).map_or(0..0, |value| value.span()), message);
    let horizontal = files(section, "horizontal", folder)?;
    let vertical = files(section, "vertical", folder)?;
    if horizontal.is_empty() && vertical.is_empty() {
        return Err(section.lacks("horizontal", "a file, horizontal or vertical or both"));
    }
    if !horizontal.is_empty() && !vertical.is_empty() && horizontal.len() != vertical.len() {
        let (up, along) = (vertical.len(), horizontal.len());
        let message =
            format!("found {up} vertical and {along} horizontal files; expected equal numbers, paired in sorted order");
        return Err(wrong("vertical", message));
    }
    let record = |key: &str, name: &str, read: &dyn Fn(&Path) -> Result<Record, String>| {
        let record = (!name.is_empty()).then(|| read(&folder.join(name))).transpose();
        record.map_err(|message| wrong(key, message))
    };
    let ground = |number: usize| {
        let names = [&horizontal, &vertical].map(|files| files.get(number).cloned().unwrap_or_default());
        let horizontal = record("horizontal", &names[0], &|path| {
            options.read(false, RecordOption::key, |options| rocking_records::read(path, options))
        })?;
        let vertical = record("vertical", &names[1], &|path| {
            options.read(true, RecordOption::key, |options| rocking_records::read(path, options))
        })?;
        Ok((names, Ground { horizontal, vertical }))
    };
    (0..horizontal.len().max(vertical.len())).map(ground).collect()
}

/// The files named by a key, relative to `folder`: none, one, or all matches of a pattern, sorted.
fn files(section: &Section, key: &str, folder: &Path) -> Result<Vec<String>, StudyFileError> {
    let (Some(name), Some(value)) = (section.text(key)?, section.get(key)) else { return Ok(Vec::new()) };
    if !name.contains(['*', '?', '[']) || folder.join(name).exists() {
        return Ok(vec![name.to_string()]);
    }
    // Only `name` is a pattern; the folder may contain its special characters.
    let pattern = Path::new(&glob::Pattern::escape(&folder.to_string_lossy())).join(name);
    let matches = glob::glob(&pattern.to_string_lossy())
        .map_err(|error| section.wrong(key, value, &format!("a pattern; {}", error.msg)))?;
    let mut found = Vec::new();
    for path in matches {
        let path = path.map_err(|error| section.wrong(key, value, &format!("folders that can be read: {error}")))?;
        if path.is_file() {
            found.push(path.strip_prefix(folder).unwrap_or(&path).display().to_string());
        }
    }
    found.sort_unstable();
    if found.is_empty() {
        return Err(section.wrong(key, value, "a pattern that matches a file"));
    }
    Ok(found)
}

/// Reads the options of the table's files.
fn options(section: &Section, gravity: f64) -> Result<RecordOptions, StudyFileError> {
    let of = |vertical: bool| {
        let key = |setting: Setting| RecordOption { setting, vertical }.key();
        Ok(ReadOptions {
            format: section.parsed(&key(Setting::Format))?,
            unit: section.parsed(&key(Setting::Unit))?,
            time_step: section.number(&key(Setting::TimeStep), |x| x > 0.0, "a time > 0 s")?,
            gravity,
            time_column: column(section, &key(Setting::TimeColumn))?,
            acceleration_column: column(section, &key(Setting::AccelerationColumn))?,
            channel: section.integer(&key(Setting::Channel), 1..1001)?.map(|channel| channel as usize),
            processing: if vertical { Processing::default() } else { processing(section)? },
        })
    };
    Ok(RecordOptions { both: of(false)?, vertical: of(true)? })
}

/// Reads the changes to the records of the table, horizontal and vertical.
fn processing(section: &Section) -> Result<Processing, StudyFileError> {
    let band_pass = match section.numbers("band_pass", |x| x > 0.0, "two frequencies in Hz, as in [0.1, 25]")? {
        Some(corners) => Some(<[f64; 2]>::try_from(corners).map_err(|corners| {
            let message = format!("band_pass has {} numbers; expected two, as in [0.1, 25]", corners.len());
            section
                .get("band_pass")
                .map_or_else(|| section.lacks("band_pass", "two"), |value| section.refused(value, message))
        })?),
        None => None,
    };
    Ok(Processing {
        baseline: section.flag("baseline")?.unwrap_or(false),
        band_pass,
        resample: section.number("resample", |x| x > 0.0, "a time > 0 s")?,
    })
}

/// Reads a column by its name or its number.
pub(crate) fn column(section: &Section, key: &str) -> Result<Option<Column>, StudyFileError> {
    match section.get(key).map(|value| value.get_ref()) {
        Some(DeValue::Integer(_)) => {
            Ok(section.integer(key, 1..100_001)?.map(|number| Column::Number(number as usize)))
        }
        _ => Ok(section.text(key)?.map(|name| Column::Name(name.into()))),
    }
}
