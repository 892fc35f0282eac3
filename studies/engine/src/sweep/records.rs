//! `[[records]]` of a study file → ground motions.

use std::path::Path;

use crate::input::ground_files::{RecordOption, RecordOptions};
use crate::input::motion::Motion;
use crate::input::study_file::{Section, StudyFileError};
use crate::intensity::Measure;
use crate::spec::study::{RecordsTable, StudyFile};
use crate::sweep::ground_motion::GroundMotion;
use rocking_block::excitation::records::{Ground, checksum, fingerprint};
use rocking_records::{ReadOptions, Record};

/// Reads the ground motions, computes these measures, and returns doubts about the records. Without `[[records]]` the only motion has no
/// record.
///
/// Paths and patterns are relative to `folder`; `gravity` (m/s²) is called only if there are records.
pub(super) fn read(
    file: &Section<StudyFile>,
    folder: &Path,
    measures: &[Measure],
    gravity: impl FnOnce() -> Result<f64, StudyFileError>,
) -> Result<(Vec<GroundMotion>, Vec<String>), StudyFileError> {
    let Some(tables) = &file.records else {
        return Ok((vec![GroundMotion::new(Default::default(), Ground::default(), &[], f64::NAN)], Vec::new()));
    };
    let gravity = gravity()?;
    let of_table = |(number, table)| Files { file, path: format!("records.{number}"), table, folder }.read(gravity);
    let found: Vec<RecordFiles> = all(tables.iter().enumerate().map(of_table))?.into_iter().flatten().collect();
    let mut remarks: Vec<String> = Vec::new();
    for doubt in found.iter().flat_map(|files| &files.doubts) {
        if !remarks.contains(doubt) {
            remarks.push(doubt.clone());
        }
    }
    remarks.extend(repeated(&found));
    let names = distinct_names(&found);
    let of_events = Motion::of_grounds(found.iter().zip(&names).map(|(of, names)| (&of.ground, names, &of.files)));
    let motions = names.into_iter().zip(found).zip(of_events).map(|((names, of), of_event)| {
        let mut motion = GroundMotion::new(names, of.ground, measures, gravity);
        (motion.files, motion.motion) = (of.files, of_event);
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

/// Returns the names of the records of each ground motion. A file that stands for several records in one direction has its channel, its
/// processing or its checksum.
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

/// Says which ground motions have the samples of another one.
fn repeated(motions: &[RecordFiles]) -> Vec<String> {
    let mut seen: Vec<(String, &str)> = Vec::new();
    let mut remarks = Vec::new();
    for files in motions {
        let Some(record) = files.ground.horizontal.as_ref() else { continue };
        let (content, file) = (files.ground.fingerprint(), files.files[0].as_str());
        match seen.iter().find(|(known, _)| *known == content) {
            Some((_, first)) if *first != file => remarks.push(format!(
                "{first} and {file} hold the same samples ({}): intervals count them as one motion",
                checksum(record)
            )),
            Some(_) => remarks.push(format!("{file} is named more than once: its rows are made and counted as often")),
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

/// A table of record files.
pub(crate) struct Files<'r, 'a, T> {
    /// The file of the table.
    pub file: &'r Section<'a, T>,
    /// Its path in the file.
    pub path: String,
    /// Its values.
    pub table: &'r RecordsTable,
    /// The folder to which its files are relative.
    pub folder: &'r Path,
}

impl<T> Files<'_, '_, T> {
    /// Reads the ground motions with the names of their files. Values in g are multiplied by this gravity (m/s²).
    pub fn read(&self, gravity: f64) -> Result<Vec<RecordFiles>, StudyFileError> {
        let options = self
            .table
            .reading
            .options(gravity)
            .map_err(|error| self.refused(error.parameter().unwrap_or_default(), error.to_string()))?;
        let found = self.grounds(&options)?;
        let grounds: Vec<Ground> = found.iter().map(|files| files.ground.clone()).collect();
        match options.unread(&grounds) {
            Some((option, needed)) => {
                let key = option.key();
                Err(self.refused(&key, format!("{key} has no effect without {needed}")))
            }
            None => Ok(found),
        }
    }

    fn refused(&self, key: &str, message: String) -> StudyFileError {
        self.file.refused(&format!("{}.{key}", self.path), message)
    }

    fn wrong(&self, key: &str, expected: &str) -> StudyFileError {
        self.file.wrong(&format!("{}.{key}", self.path), expected)
    }

    /// Reads the ground motions: one, or one per match of a pattern.
    fn grounds(&self, options: &RecordOptions) -> Result<Vec<RecordFiles>, StudyFileError> {
        let horizontal = self.files("horizontal", self.table.horizontal.as_deref())?;
        let vertical = self.files("vertical", self.table.vertical.as_deref())?;
        let [horizontal, vertical] = self.without_excluded([horizontal, vertical])?;
        if horizontal.is_empty() && vertical.is_empty() {
            let message = "[[records]] has no horizontal; expected a file, horizontal or vertical or both";
            return Err(self.file.refused(&self.path, message));
        }
        if !horizontal.is_empty() && !vertical.is_empty() && horizontal.len() != vertical.len() {
            let (up, along) = (vertical.len(), horizontal.len());
            let message = format!(
                "found {up} vertical and {along} horizontal files; expected equal numbers, paired in sorted order"
            );
            return Err(self.refused("vertical", message));
        }
        let choices = [false, true].map(|vertical| options.of(vertical).choice());
        let ground = |number: usize| {
            let files = [&horizontal, &vertical].map(|files| files.get(number).cloned().unwrap_or_default());
            let read = |(slot, key): (usize, &str)| {
                let file = &files[slot];
                let read = |options: &ReadOptions| rocking_records::read_with_doubt(&self.folder.join(file), options);
                let record = (!file.is_empty()).then(|| options.read(slot == 1, RecordOption::key, read)).transpose();
                record.map_err(|message| self.refused(key, message))
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
    fn without_excluded(&self, mut lists: [Vec<String>; 2]) -> Result<[Vec<String>; 2], StudyFileError> {
        // As in the patterns of files, `*` stays within a folder.
        const OPTIONS: glob::MatchOptions = glob::MatchOptions {
            case_sensitive: true,
            require_literal_separator: true,
            require_literal_leading_dot: false,
        };
        let Some(patterns) = &self.table.exclude else { return Ok(lists) };
        for (number, text) in patterns.iter().enumerate() {
            let wrong = |expected: &str| self.wrong(&format!("exclude.{number}"), expected);
            let pattern = glob::Pattern::new(text).map_err(|error| wrong(&format!("a pattern; {}", error.msg)))?;
            let count = lists.iter().map(Vec::len).sum::<usize>();
            lists.iter_mut().for_each(|list| list.retain(|name| !pattern.matches_with(name, OPTIONS)));
            if lists.iter().map(Vec::len).sum::<usize>() == count {
                return Err(wrong("a pattern that matches a file of this table that no pattern before excludes"));
            }
        }
        if lists.iter().all(Vec::is_empty) {
            return Err(self.wrong("exclude", "patterns that leave a file"));
        }
        Ok(lists)
    }

    /// The files named by a key: none, one, or all matches of a pattern, sorted. A URL of this machine is a path.
    fn files(&self, key: &str, name: Option<&str>) -> Result<Vec<String>, StudyFileError> {
        let Some(name) = name else { return Ok(Vec::new()) };
        let path = rocking_records::local_path(Path::new(name));
        let path = path.map_err(|error| self.refused(key, format!("{name}: {error}")))?;
        let name = path.to_string_lossy().into_owned();
        if !name.contains(['*', '?', '[']) || self.folder.join(&name).exists() {
            return Ok(vec![name]);
        }
        // Only `name` is a pattern; the folder may contain its special characters.
        let pattern = Path::new(&glob::Pattern::escape(&self.folder.to_string_lossy())).join(&name);
        let matches = glob::glob(&pattern.to_string_lossy())
            .map_err(|error| self.wrong(key, &format!("a pattern; {}", error.msg)))?;
        let mut found = Vec::new();
        for path in matches {
            let path = path.map_err(|error| self.wrong(key, &format!("folders that can be read: {error}")))?;
            if path.is_file() {
                found.push(path.strip_prefix(self.folder).unwrap_or(&path).display().to_string());
            }
        }
        found.sort_unstable();
        if found.is_empty() {
            return Err(self.wrong(key, "a pattern that matches a file"));
        }
        Ok(found)
    }
}
