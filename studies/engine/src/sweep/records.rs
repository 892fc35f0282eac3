//! `[[records]]` of a study file → ground motions.

use std::path::Path;

use crate::input::ground_files::{RecordOption, RecordOptions};
use crate::input::motion::Motion;
use crate::input::parameters::Vocabulary;
use crate::input::study_file::{Section, StudyFileError};
use crate::intensity::Measure;
use crate::space::ground::{ComponentNames, of_components};
use crate::spec::study::{PolarityWord, RecordsTable, StudyFile};
use crate::sweep::ground_motion::{GroundMotion, Transverse};
use rocking_block::excitation::records::{Ground, checksum, fingerprint};
use rocking_records::{ReadOptions, Record};

/// Reads the ground motions, computes these measures, and returns doubts about the records. Without `[[records]]` the only motion has no
/// record.
///
/// Paths and patterns are relative to `folder`; `gravity` (m/s²) is called only if there are records.
pub(super) fn read(
    file: &Section<StudyFile>,
    folder: &Path,
    vocabulary: Vocabulary,
    measures: &[Measure],
    gravity: impl FnOnce() -> Result<f64, StudyFileError>,
) -> Result<(Vec<GroundMotion>, Vec<String>), StudyFileError> {
    let Some(tables) = &file.records else {
        return Ok((vec![GroundMotion::new(Default::default(), Ground::default(), &[], f64::NAN)], Vec::new()));
    };
    let gravity = gravity()?;
    let of_table =
        |(number, table)| Files { file, path: format!("records.{number}"), table, folder, vocabulary }.read(gravity);
    let found: Vec<RecordFiles> = all(tables.iter().enumerate().map(of_table))?.into_iter().flatten().collect();
    let mut remarks: Vec<String> = Vec::new();
    for doubt in found.iter().flat_map(|files| &files.doubts) {
        if !remarks.contains(doubt) {
            remarks.push(doubt.clone());
        }
    }
    remarks.extend(repeated(&found));
    let names = distinct_names(&found);
    let of_events = Motion::of_all(found.iter().zip(&names).map(|(of, names)| {
        let component = |slot: usize| Some((of.records()[slot]?, &*names[slot], &*of.files[slot]));
        [component(0), component(2), component(1)]
    }));
    let motions = names.into_iter().zip(found).zip(of_events).map(|((names, of), of_event)| {
        let [horizontal, vertical, of_transverse] = names;
        let [horizontal_file, vertical_file, file] = of.files;
        let is_reversed_too = of.polarity == PolarityWord::Both;
        let transverse = of.transverse.map(|record| Transverse { file, name: of_transverse, record });
        let names = [horizontal, vertical];
        let mut motion = GroundMotion::of_components(names, of.ground, transverse, measures, gravity);
        (motion.files, motion.motion) = ([horizontal_file, vertical_file], of_event);
        let reversed = is_reversed_too.then(|| motion.reversed());
        std::iter::once(motion).chain(reversed)
    });
    Ok((motions.flatten().collect(), remarks))
}

/// The files of a ground motion and their content. Slots are those of the horizontal file or x, of the vertical one or z, and of y.
pub(crate) struct RecordFiles {
    /// The files as written in the study, or empty.
    pub files: [String; 3],
    /// The channel or column that the study chooses in each, if it does.
    choices: [Option<String>; 3],
    pub ground: Ground,
    /// The second horizontal component of a block in space.
    transverse: Option<Record>,
    /// The polarities of the horizontal record.
    polarity: PolarityWord,
    /// Reasons to doubt the records, with their files.
    doubts: Vec<String>,
}

impl RecordFiles {
    fn records(&self) -> [Option<&Record>; 3] {
        [self.ground.horizontal.as_ref(), self.ground.vertical.as_ref(), self.transverse.as_ref()]
    }

    /// Describes the content of all records.
    fn fingerprint(&self) -> String {
        let transverse = self.transverse.as_ref().map(|record| format!("; transverse {}", fingerprint(record)));
        self.ground.fingerprint() + &transverse.unwrap_or_default()
    }
}

/// Returns the names of the records of each ground motion. A file that stands for several records in one direction has its channel, its
/// processing or its checksum.
fn distinct_names(motions: &[RecordFiles]) -> Vec<[String; 3]> {
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
    motions.iter().map(|files| [0, 1, 2].map(|slot| name(files, slot))).collect()
}

/// Says which ground motions have the samples of another one.
fn repeated(motions: &[RecordFiles]) -> Vec<String> {
    let mut seen: Vec<(String, &str)> = Vec::new();
    let mut remarks = Vec::new();
    for files in motions {
        let Some(record) = files.ground.horizontal.as_ref() else { continue };
        let (content, file) = (files.fingerprint(), files.files[0].as_str());
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

/// Cuts the components of a motion to the samples that all of them have.
fn cut(records: &mut [Option<Record>]) {
    let shortest = records.iter().flatten().map(|record| record.acceleration.len()).min();
    for record in records.iter_mut().flatten() {
        let samples = shortest.unwrap_or_default();
        record.acceleration = record.acceleration[..samples].into();
    }
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
    /// The bodies that the motions shake, which decides the names of the components.
    pub vocabulary: Vocabulary,
}

/// The components of a block in space by their keys.
const COMPONENTS: ComponentNames = ComponentNames {
    names: ["x", "y", "z"],
    resample: "resample in [[records]] gives all components one step",
    cut: "cut = true in [[records]] cuts the components to the samples that all have",
};

impl<T> Files<'_, '_, T> {
    /// Reads the ground motions with the names of their files. Values in g are multiplied by this gravity (m/s²).
    pub fn read(&self, gravity: f64) -> Result<Vec<RecordFiles>, StudyFileError> {
        let options = self
            .table
            .reading
            .options(gravity)
            .map_err(|error| self.refused(error.parameter().unwrap_or_default(), error.to_string()))?;
        let found = self.grounds(&options)?;
        let second = found.iter().filter_map(|files| files.transverse.clone());
        let second = second.map(|record| Ground { horizontal: Some(record), vertical: None });
        let grounds: Vec<Ground> = found.iter().map(|files| files.ground.clone()).chain(second).collect();
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

    /// The keys of the slots.
    fn keys(&self) -> [&'static str; 3] {
        match self.vocabulary {
            Vocabulary::Plane => ["horizontal", "vertical", "y"],
            Vocabulary::Space => ["x", "z", "y"],
        }
    }

    /// Refuses the components of the other body, and settings of a component that is missing.
    fn refuse_without_effect(&self) -> Result<(), StudyFileError> {
        const OF_SPACE: &str = "is for a block in space; expected horizontal or vertical, or depth, depth_ratio, base or feet in [parameters]";
        let RecordsTable { horizontal, vertical, x, y, z, cut, y_channel, y_acceleration_column, polarity, .. } =
            self.table;
        let in_space = self.vocabulary == Vocabulary::Space;
        let is_both = *polarity == Some(PolarityWord::Both);
        let of_y = y_channel.is_some() || y_acceleration_column.is_some();
        let rules = [
            ("x", !in_space && x.is_some(), OF_SPACE),
            ("y", !in_space && y.is_some(), OF_SPACE),
            ("z", !in_space && z.is_some(), OF_SPACE),
            ("cut", cut.is_some() && y.is_none() && z.is_none(), "has no effect without y or z"),
            (
                "polarity",
                in_space && polarity.is_some(),
                "is for a block in the plane; expected azimuths in [study]: an azimuth of 180 reverses a pair of records",
            ),
            ("polarity", is_both && horizontal.is_none(), "has no effect without horizontal"),
            (
                "horizontal",
                in_space && horizontal.is_some(),
                "is for a block in the plane; expected x, and y beside it",
            ),
            ("vertical", in_space && vertical.is_some(), "is for a block in the plane; expected z"),
            (
                if y_channel.is_some() { "y_channel" } else { "y_acceleration_column" },
                of_y && y.is_none(),
                "has no effect without y",
            ),
        ];
        match rules.into_iter().find(|(_, holds, _)| *holds) {
            Some((key, _, why)) => Err(self.refused(key, format!("{key} {why}"))),
            None => Ok(()),
        }
    }

    /// Reads the ground motions: one, or one per match of a pattern.
    fn grounds(&self, options: &RecordOptions) -> Result<Vec<RecordFiles>, StudyFileError> {
        self.refuse_without_effect()?;
        let (keys, RecordsTable { horizontal, vertical, x, y, z, .. }) = (self.keys(), self.table);
        let given = [horizontal.as_ref().or(x.as_ref()), vertical.as_ref().or(z.as_ref()), y.as_ref()];
        let lists = all((0..3).map(|slot| self.files(keys[slot], given[slot].map(String::as_str))))?;
        let lists = self.without_excluded([0, 1, 2].map(|slot: usize| lists[slot].clone()))?;
        let [along, up, across] = lists.each_ref().map(Vec::len);
        let missing = match self.vocabulary {
            Vocabulary::Plane if along + up == 0 => {
                Some("[[records]] has no horizontal; expected a file, horizontal or vertical or both")
            }
            Vocabulary::Space if along == 0 => {
                Some("[[records]] has no x; expected a file, x alone or with y, and z for the vertical component")
            }
            Vocabulary::Plane | Vocabulary::Space => None,
        };
        if let Some(message) = missing {
            return Err(self.file.refused(&self.path, message));
        }
        for (slot, count) in [(1, up), (2, across)] {
            if along > 0 && count > 0 && along != count {
                let found = format!("found {count} {} and {along} {} files", keys[slot], keys[0]);
                return Err(
                    self.refused(keys[slot], format!("{found}; expected equal numbers, paired in sorted order"))
                );
            }
        }
        all((0..along.max(up))
            .map(|number| self.ground(options, lists.each_ref().map(|list| list.get(number).cloned()))))
    }

    /// Reads a ground motion from its files.
    fn ground(&self, options: &RecordOptions, files: [Option<String>; 3]) -> Result<RecordFiles, StudyFileError> {
        let RecordsTable { y_channel, y_acceleration_column, .. } = self.table;
        let of_slot = |slot: usize, options: &ReadOptions| match slot {
            2 => ReadOptions {
                channel: y_channel.clone().or(options.channel.clone()),
                acceleration_column: y_acceleration_column.clone().or(options.acceleration_column.clone()),
                ..options.clone()
            },
            _ => options.clone(),
        };
        let choices = [0, 1, 2].map(|slot| of_slot(slot, &options.of(slot == 1)).choice());
        let read = |(slot, key): (usize, &str)| {
            let Some(file) = &files[slot] else { return Ok(None) };
            let read = |options: &ReadOptions| {
                rocking_records::read_with_doubt(&self.folder.join(file), &of_slot(slot, options))
            };
            let record = options.read(slot == 1, RecordOption::key, read);
            record.map(Some).map_err(|message| self.refused(key, message))
        };
        let found = all(self.keys().into_iter().enumerate().map(read))?;
        let (records, doubts): (Vec<_>, Vec<_>) = found.into_iter().map(Option::unzip).unzip();
        let doubt = |(file, doubt): (&Option<String>, Option<Option<String>>)| {
            doubt.flatten().map(|why| format!("{}: {why}", file.as_deref().unwrap_or_default()))
        };
        let doubts = files.iter().zip(doubts).filter_map(doubt).collect();
        let mut records = records;
        if self.table.cut == Some(true) {
            cut(&mut records);
        }
        let mut records = records.into_iter();
        let ground = Ground { horizontal: records.next().flatten(), vertical: records.next().flatten() };
        let transverse = records.next().flatten();
        if self.vocabulary == Vocabulary::Space {
            let components = [ground.horizontal.clone(), transverse.clone(), ground.vertical.clone()];
            of_components(components, 0.0, COMPONENTS).map_err(|message| self.file.refused(&self.path, message))?;
        }
        let files = files.map(Option::unwrap_or_default);
        let polarity = self.table.polarity.unwrap_or(PolarityWord::AsRecorded);
        Ok(RecordFiles { files, choices, ground, transverse, polarity, doubts })
    }

    /// Removes the files that match a pattern of `exclude`; each pattern must match one.
    fn without_excluded(&self, mut lists: [Vec<String>; 3]) -> Result<[Vec<String>; 3], StudyFileError> {
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
