//! `[[records]]` of a study file → ground motions.

use std::path::Path;

use toml::de::DeValue;

use crate::records::ground::Ground;
use crate::records::{self, Column, ReadOptions, Record, Setting};
use crate::study::ground_files::{Name, Said};
use crate::study::intensity::Measure;
use crate::study::study_file::{Section, Source, StudyFileError};
use crate::study::sweep::Motion;

/// What `[[records]]` may have.
const KEYS: [&str; 14] = [
    "horizontal",
    "vertical",
    "unit",
    "dt",
    "format",
    "channel",
    "acceleration_column",
    "time_column",
    "vertical_unit",
    "vertical_dt",
    "vertical_format",
    "vertical_channel",
    "vertical_acceleration_column",
    "vertical_time_column",
];

/// The ground motions with these measures, or the one that is none. Paths and patterns start from `folder`; `gravity`
/// (m/s²) is asked for if there are records.
pub(super) fn read(
    root: &Section,
    source: Source,
    folder: &Path,
    measures: &[Measure],
    gravity: impl FnOnce() -> Result<f64, StudyFileError>,
) -> Result<Vec<Motion>, StudyFileError> {
    let Some(value) = root.get("records") else {
        return Ok(vec![Motion::new(Default::default(), Ground::default(), &[], f64::NAN)]);
    };
    let list = value.get_ref().as_array().filter(|list| !list.is_empty());
    let list = list.ok_or_else(|| root.wrong("records", value, "[[records]], a table for each ground motion"))?;
    let gravity = gravity()?;
    let mut motions = Vec::new();
    for value in list {
        let table = value.get_ref().as_table().ok_or_else(|| root.wrong("records", value, "tables"))?;
        let section = Section::new(source, "[[records]]", value.span(), table, &KEYS)?;
        let said = said(&section, gravity)?;
        let found = grounds(&section, source, folder, &said)?;
        let grounds: Vec<Ground> = found.iter().map(|(_, ground)| ground.clone()).collect();
        if let Some((name, needed)) = said.unread(&grounds) {
            let key = name.key();
            let place = section.get(&key).map_or(value.span(), |value| value.span());
            return Err(source.wrong(&place, format!("{key} has no effect without {needed}")));
        }
        motions.extend(found.into_iter().map(|(names, ground)| Motion::new(names, ground, measures, gravity)));
    }
    Ok(motions)
}

/// The ground motions of one table with the names of their files: one, or one for each match of a pattern.
fn grounds(
    section: &Section,
    source: Source,
    folder: &Path,
    said: &Said,
) -> Result<Vec<([String; 2], Ground)>, StudyFileError> {
    let wrong =
        |key: &str, message: String| source.wrong(&section.get(key).map_or(0..0, |value| value.span()), message);
    let along = files(section, "horizontal", folder)?;
    let up = files(section, "vertical", folder)?;
    if along.is_empty() && up.is_empty() {
        return Err(section.lacks("horizontal", "a file, horizontal or vertical or both"));
    }
    if !along.is_empty() && !up.is_empty() && along.len() != up.len() {
        let (up, along) = (up.len(), along.len());
        let message =
            format!("found {up} vertical and {along} horizontal files; expected as many, paired in sorted order");
        return Err(wrong("vertical", message));
    }
    let record = |key: &str, name: &str, read: &dyn Fn(&Path) -> Result<Record, String>| {
        let record = (!name.is_empty()).then(|| read(&folder.join(name))).transpose();
        record.map_err(|message| wrong(key, message))
    };
    let ground = |number: usize| {
        let names = [&along, &up].map(|files| files.get(number).cloned().unwrap_or_default());
        let horizontal = record("horizontal", &names[0], &|path| {
            said.read(false, Name::key, |options| records::read(path, options))
        })?;
        let vertical =
            record("vertical", &names[1], &|path| said.read(true, Name::key, |options| records::read(path, options)))?;
        Ok((names, Ground { horizontal, vertical }))
    };
    (0..along.len().max(up.len())).map(ground).collect()
}

/// The files that a key names, as they are called from `folder`: none, one, or all that match a pattern, sorted.
fn files(section: &Section, key: &str, folder: &Path) -> Result<Vec<String>, StudyFileError> {
    let (Some(name), Some(value)) = (section.text(key)?, section.get(key)) else { return Ok(Vec::new()) };
    if !name.contains(['*', '?', '[']) || folder.join(name).exists() {
        return Ok(vec![name.to_string()]);
    }
    // The name of the folder itself is no pattern.
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
        return Err(section.wrong(key, value, "a pattern that a file matches"));
    }
    Ok(found)
}

/// What the table says of its files.
fn said(section: &Section, gravity: f64) -> Result<Said, StudyFileError> {
    let of = |vertical: bool| {
        let key = |setting: Setting| Name { setting, vertical }.key();
        Ok(ReadOptions {
            format: section.parsed(&key(Setting::Format))?,
            unit: section.parsed(&key(Setting::Unit))?,
            time_step: section.number(&key(Setting::TimeStep), |x| x > 0.0, "a time > 0 s")?,
            gravity,
            time_column: column(section, &key(Setting::TimeColumn))?,
            acceleration_column: column(section, &key(Setting::AccelerationColumn))?,
            channel: section.integer(&key(Setting::Channel), 1..1001)?.map(|channel| channel as usize),
        })
    };
    Ok(Said { of_both: of(false)?, of_vertical: of(true)? })
}

/// A column by its name or its number.
fn column(section: &Section, key: &str) -> Result<Option<Column>, StudyFileError> {
    match section.get(key).map(|value| value.get_ref()) {
        Some(DeValue::Integer(_)) => {
            Ok(section.integer(key, 1..100_001)?.map(|number| Column::Number(number as usize)))
        }
        _ => Ok(section.text(key)?.map(|name| Column::Name(name.into()))),
    }
}
