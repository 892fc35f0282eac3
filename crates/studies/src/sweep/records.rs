//! `[[records]]` of a study file → ground motions.

use std::ops::Range;
use std::path::Path;

use toml::Spanned;
use toml::de::DeValue;

use crate::input::ground_files::{RecordOption, RecordOptions};
use crate::input::study_file::{Section, StudyFileError, StudyText};
use crate::intensity::Measure;
use crate::spec::study::RecordsTable;
use crate::sweep::ground_motion::GroundMotion;
use rocking_block::excitation::records::{Ground, checksum, fingerprint};
use rocking_records::{Choice, Processing, ReadOptions, Record, Setting};

/// Reads the ground motions, computes these measures, and returns doubts about the records. Without `[[records]]` the only motion has no
/// record.
///
/// Paths and patterns are relative to `folder`; `gravity` (m/s²) is called only if there are records.
pub(super) fn read(
    root: &Section,
    source: StudyText,
    folder: &Path,
    measures: &[Measure],
    gravity: impl FnOnce() -> Result<f64, StudyFileError>,
) -> Result<(Vec<GroundMotion>, Vec<String>), StudyFileError> {
    let Some(value) = root.get("records") else {
        return Ok((vec![GroundMotion::new(Default::default(), Ground::default(), &[], f64::NAN)], Vec::new()));
    };
    let list = value.get_ref().as_array().filter(|list| !list.is_empty());
    let list = list.ok_or_else(|| root.wrong("records", value, "[[records]], a table for each ground motion"))?;
    let gravity = gravity()?;
    let of_table = |value: &Spanned<DeValue>| {
        let table = value.get_ref().as_table().ok_or_else(|| root.wrong("records", value, "tables"))?;
        let section = Section::of::<RecordsTable>(source, "[[records]]", value.span(), table)?;
        in_table(&section, value.span(), source, folder, gravity)
    };
    let found: Vec<RecordFiles> = all(list.iter().map(of_table))?.into_iter().flatten().collect();
    let mut remarks: Vec<String> = Vec::new();
    for doubt in found.iter().flat_map(|files| &files.doubts) {
        if !remarks.contains(doubt) {
            remarks.push(doubt.clone());
        }
    }
    remarks.extend(repeated(&found));
    let names = distinct_names(&found);
    let motions = names.into_iter().zip(found).map(|(names, RecordFiles { files, ground, .. })| {
        let mut motion = GroundMotion::new(names, ground, measures, gravity);
        motion.files = files;
        motion
    });
    Ok((motions.collect(), remarks))
}

/// The files of a ground motion and their content.
pub(crate) struct RecordFiles {
    /// The horizontal and the vertical file, as written in the study.
    pub files: [String; 2],
    /// The channel or column that the study chooses in each, if it does.
    choices: [Option<String>; 2],
    pub ground: Ground,
    /// Reasons to doubt the records, with their files.
    doubts: Vec<String>,
}

impl RecordFiles {
    fn records(&self) -> [Option<&Record>; 2] {
        [self.ground.horizontal.as_ref(), self.ground.vertical.as_ref()]
    }
}

/// Returns the names of the records of each ground motion: of the file, with the channel, the processing or the checksum if a file
/// stands for several records in one direction.
fn distinct_names(motions: &[RecordFiles]) -> Vec<[String; 2]> {
    type Describe = fn(&RecordFiles, usize) -> Option<String>;
    const DESCRIPTIONS: [Describe; 3] = [
        |files, slot| files.choices[slot].clone(),
        |files, slot| Some(files.records()[slot]?.processing.to_string()).filter(|words| !words.is_empty()),
        |files, slot| files.records()[slot].map(checksum),
    ];
    let name = |files: &RecordFiles, slot: usize| {
        let file = &files.files[slot];
        let content = |files: &RecordFiles| files.records()[slot].map(fingerprint);
        let others: Vec<&RecordFiles> =
            motions.iter().filter(|other| other.files[slot] == *file && content(other) != content(files)).collect();
        if others.is_empty() {
            return file.clone();
        }
        let told = DESCRIPTIONS.iter().find_map(|describe| {
            let here = describe(files, slot)?;
            others.iter().all(|other| describe(other, slot).as_ref() != Some(&here)).then_some(here)
        });
        told.map_or_else(|| file.clone(), |words| format!("{file} ({words})"))
    };
    motions.iter().map(|files| [name(files, 0), name(files, 1)]).collect()
}

/// Says which horizontal records of different files have the same samples.
fn repeated(motions: &[RecordFiles]) -> Vec<String> {
    let mut seen: Vec<(String, &str)> = Vec::new();
    let mut remarks = Vec::new();
    for files in motions {
        let Some(record) = files.ground.horizontal.as_ref() else { continue };
        let (content, file) = (files.ground.fingerprint(), files.files[0].as_str());
        match seen.iter().find(|(known, _)| *known == content) {
            Some((_, first)) if *first != file => remarks.push(format!(
                "{first} and {file} hold the same samples ({}): intervals count them as two records",
                checksum(record)
            )),
            Some(_) => {}
            None => seen.push((content, file)),
        }
    }
    remarks
}

/// Returns all values, or one error with the messages of all errors.
fn all<T>(results: impl Iterator<Item = Result<T, StudyFileError>>) -> Result<Vec<T>, StudyFileError> {
    let mut values = Vec::new();
    let mut failed: Option<StudyFileError> = None;
    for result in results {
        match (result, &mut failed) {
            (Ok(value), _) => values.push(value),
            (Err(error), Some(first)) if error.line == first.line => first.message += &format!("; {}", error.message),
            (Err(error), Some(first)) => first.message += &format!("; line {}: {}", error.line, error.message),
            (Err(error), None) => failed = Some(error),
        }
    }
    failed.map_or(Ok(values), Err)
}

/// Reads the ground motions of one table with the names of their files. The table is at these bytes of the text.
pub(crate) fn in_table(
    section: &Section,
    range: Range<usize>,
    source: StudyText,
    folder: &Path,
    gravity: f64,
) -> Result<Vec<RecordFiles>, StudyFileError> {
    let options = options(section, gravity)?;
    let found = grounds(section, source, folder, &options)?;
    let grounds: Vec<Ground> = found.iter().map(|files| files.ground.clone()).collect();
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
) -> Result<Vec<RecordFiles>, StudyFileError> {
    let wrong =
        |key: &str, message: String| source.wrong(&section.get(key).map_or(0..0, |value| value.span()), message);
    let horizontal = files(section, "horizontal", folder)?;
    let vertical = files(section, "vertical", folder)?;
    let [horizontal, vertical] = without_excluded(section, [horizontal, vertical])?;
    if horizontal.is_empty() && vertical.is_empty() {
        return Err(section.lacks("horizontal", "a file, horizontal or vertical or both"));
    }
    if !horizontal.is_empty() && !vertical.is_empty() && horizontal.len() != vertical.len() {
        let (up, along) = (vertical.len(), horizontal.len());
        let message =
            format!("found {up} vertical and {along} horizontal files; expected equal numbers, paired in sorted order");
        return Err(wrong("vertical", message));
    }
    let choices = [false, true].map(|vertical| options.of(vertical).choice());
    let ground = |number: usize| {
        let files = [&horizontal, &vertical].map(|files| files.get(number).cloned().unwrap_or_default());
        let read = |(slot, key): (usize, &str)| {
            let file = &files[slot];
            let read = |options: &ReadOptions| rocking_records::read_with_doubt(&folder.join(file), options);
            let record = (!file.is_empty()).then(|| options.read(slot == 1, RecordOption::key, read)).transpose();
            record.map_err(|message| wrong(key, message))
        };
        let (records, doubts): (Vec<_>, Vec<_>) =
            all([(0, "horizontal"), (1, "vertical")].into_iter().map(read))?.into_iter().map(Option::unzip).unzip();
        let doubt =
            |(file, doubt): (&String, Option<Option<String>>)| doubt.flatten().map(|why| format!("{file}: {why}"));
        let doubts = files.iter().zip(doubts).filter_map(doubt).collect();
        let mut records = records.into_iter();
        let ground = Ground { horizontal: records.next().flatten(), vertical: records.next().flatten() };
        Ok(RecordFiles { files, choices: choices.clone(), ground, doubts })
    };
    all((0..horizontal.len().max(vertical.len())).map(ground))
}

/// Removes the files that match a pattern of `exclude`; each pattern must match one.
fn without_excluded(section: &Section, mut lists: [Vec<String>; 2]) -> Result<[Vec<String>; 2], StudyFileError> {
    const EXPECTED: &str = "a list of patterns in quotes, as in [\"records/*-V.AT2\"]";
    // As in the patterns of files, `*` stays within a folder.
    const OPTIONS: glob::MatchOptions = glob::MatchOptions {
        case_sensitive: true,
        require_literal_separator: true,
        require_literal_leading_dot: false,
    };
    let Some(value) = section.get("exclude") else { return Ok(lists) };
    let patterns = value.get_ref().as_array().ok_or_else(|| section.wrong("exclude", value, EXPECTED))?;
    for value in patterns {
        let text = value.get_ref().as_str().ok_or_else(|| section.wrong("exclude", value, EXPECTED))?;
        let pattern = glob::Pattern::new(text)
            .map_err(|error| section.wrong("exclude", value, &format!("a pattern; {}", error.msg)))?;
        let count = lists.iter().map(Vec::len).sum::<usize>();
        lists.iter_mut().for_each(|list| list.retain(|name| !pattern.matches_with(name, OPTIONS)));
        if lists.iter().map(Vec::len).sum::<usize>() == count {
            let expected = "a pattern that matches a file of this table that no pattern before excludes";
            return Err(section.wrong("exclude", value, expected));
        }
    }
    if lists.iter().all(Vec::is_empty) {
        return Err(section.wrong("exclude", value, "patterns that leave a file"));
    }
    Ok(lists)
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
            layout: section.parsed(&key(Setting::Layout))?,
            skip: section.integer(&key(Setting::Skip), 0..100_001)?.map(|lines| lines as usize),
            value_scale: section.number(&key(Setting::ValueScale), |x| x > 0.0, "a number > 0")?,
            time_column: column(section, &key(Setting::TimeColumn))?,
            acceleration_column: column(section, &key(Setting::AccelerationColumn))?,
            channel: choice(section, &key(Setting::Channel), 1000)?,
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
pub(crate) fn column(section: &Section, key: &str) -> Result<Option<Choice>, StudyFileError> {
    choice(section, key, 100_000)
}

/// Reads a column or a channel by its name or its number, up to the last one that a file may have.
fn choice(section: &Section, key: &str, last: u64) -> Result<Option<Choice>, StudyFileError> {
    match section.get(key).map(|value| value.get_ref()) {
        Some(DeValue::Integer(_)) => {
            Ok(section.integer(key, 1..last + 1)?.map(|number| Choice::Number(number as usize)))
        }
        _ => Ok(section.text(key)?.map(|name| Choice::Name(name.into()))),
    }
}
