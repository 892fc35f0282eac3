//! The parts of a study, or other files of one table → its rows.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::output::parts::{PART, PartNumber, PartPlan, PartsError, description, refused};
use crate::output::reading::{ROW, TableReadError, TableReader};
use crate::output::seal::{self, Seal};
use crate::output::table::{Table, Values};

/// The files of a table: a single one, the parts of a folder, or others. The parts are all of one set. Folders named `key=value` split it: each has a set
/// of its own.
pub struct TableFiles {
    folder: String,
    files: Vec<TableFile>,
}

/// A file of a table.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TableFile {
    /// Keys in the names of its folders, with their values: columns of its rows.
    pub keys: Vec<(String, String)>,
    /// The part, if the file is one.
    pub part: Option<PartNumber>,
    /// Its path.
    pub path: PathBuf,
}

/// Takes a batch of rows, with the headings of all columns of the file.
pub type TakeBatch<'a, E> = dyn FnMut(Table, &[String]) -> Result<(), E> + 'a;

/// The parts of a study in a folder.
#[derive(Debug)]
pub struct PartsState {
    /// The number of parts of the study.
    pub count: u64,
    /// The numbers of the parts without a file.
    pub missing: Vec<u64>,
    /// The numbers of the parts that are damaged or of another study, with the reasons.
    pub faults: Vec<(u64, PartsError)>,
    /// Rows of the others.
    pub rows: u64,
    /// Rows of the study, if a part tells them.
    pub rows_of_study: Option<u64>,
}

impl PartsState {
    /// The numbers of the parts to make, ascending.
    pub fn to_make(&self) -> Vec<u64> {
        let mut numbers: Vec<u64> =
            self.missing.iter().copied().chain(self.faults.iter().map(|(number, _)| *number)).collect();
        numbers.sort_unstable();
        numbers
    }
}

impl TableFiles {
    /// Whether a path stands for several files: a folder, or a pattern such as `runs/*.parquet`.
    pub fn are_at(path: &Path) -> bool {
        path.is_dir() || !path.exists() && is_pattern(path)
    }

    /// Lists the parts of a folder, or the files that match a pattern; another path is that of a single file. A folder without parts is a set of files in Parquet or CSV, or of
    /// such folders; names that begin with a dot or an underscore are left out.
    ///
    /// # Errors
    /// The folder cannot be read, or has no tables, or parts of several sets.
    pub fn of(path: &Path) -> Result<TableFiles, PartsError> {
        let folder = path.display().to_string();
        if !TableFiles::are_at(path) {
            return Ok(TableFiles {
                folder,
                files: vec![TableFile { keys: Vec::new(), part: None, path: path.into() }],
            });
        }
        let mut paths = Vec::new();
        let root = if path.is_dir() {
            list(path, &mut paths)?;
            path.to_path_buf()
        } else {
            let matches =
                glob::glob(&path.to_string_lossy()).map_err(|error| refused(path, io::Error::other(error)))?;
            for path in matches {
                paths.push(path.map_err(|error| refused(error.path(), io::Error::other(error.error().to_string())))?);
            }
            path.components().take_while(|name| !is_pattern(name.as_ref())).collect()
        };
        let file = |path: PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            TableFile {
                keys: keys(path.strip_prefix(&root).unwrap_or(&path)),
                part: PartNumber::of_file(&name).map(|(part, _)| part),
                path,
            }
        };
        let mut files: Vec<TableFile> = paths.into_iter().map(file).collect();
        if files.iter().any(|file| file.part.is_some()) {
            files.retain(|file| file.part.is_some());
        }
        files.sort();
        if files.is_empty() {
            return Err(PartsError::Refused(format!(
                "{folder}: has no parts of a study; expected files such as part-00001-of-00010.csv, or others in .parquet or .csv"
            )));
        }
        let count = |file: &TableFile| file.part.map(PartNumber::count);
        let are_apart = |one: &TableFile, other: &TableFile| {
            let of_a_set =
                one.keys != other.keys || count(one) == count(other) && (one.part.is_none() || one.part != other.part);
            !of_a_set || one.path.extension() != other.path.extension()
        };
        if let Some(pair) = files.windows(2).find(|pair| are_apart(&pair[0], &pair[1])) {
            let name = |file: &TableFile| file.path.strip_prefix(&root).unwrap_or(&file.path).display().to_string();
            let (first, other) = (name(&pair[0]), name(&pair[1]));
            return Err(PartsError::Refused(format!(
                "{folder}: has parts of different sets, {first} and {other}; expected one set in a folder"
            )));
        }
        Ok(TableFiles { folder, files })
    }

    /// The files, in the order of their keys, and of their numbers or names.
    pub fn files(&self) -> &[TableFile] {
        &self.files
    }

    /// Whether the files are the parts of one study, whose rows have numbers.
    pub fn are_numbered(&self) -> bool {
        self.files.iter().all(|file| file.part.is_some() && file.keys == self.files[0].keys)
    }

    /// Checks that all parts are there.
    ///
    /// # Errors
    /// Names the missing ones, and `partial`, the option that does without them, if there is one.
    pub fn check_complete(&self, partial: Option<&str>) -> Result<(), PartsError> {
        for set in self.files.chunk_by(|one, other| one.keys == other.keys) {
            let (parts, missing) = missing(set);
            if missing.is_empty() {
                continue;
            }
            let shown: Vec<String> = missing.iter().take(10).map(u64::to_string).collect();
            let more = if missing.len() > 10 { ", …" } else { "" };
            let folder = match set[0].path.parent() {
                Some(folder) if !set[0].keys.is_empty() => folder.display().to_string(),
                _ => self.folder.clone(),
            };
            let (count, missing) = (missing.len(), shown.join(", ") + more);
            let remedy =
                partial.map_or(String::new(), |option| format!(", or evaluate the others alone with {option}"));
            return Err(PartsError::Refused(format!(
                "{folder}: lacks {count} of {parts} parts: {missing}; make these{remedy}"
            )));
        }
        Ok(())
    }

    /// Compares the bytes of each part of one study with their checksum, and its description with that of the first one; rows are not read.
    /// `progress` receives the number of parts so far.
    ///
    /// # Errors
    /// The files are not the parts of one study.
    pub fn state(&self, mut progress: impl FnMut(u64)) -> Result<PartsState, PartsError> {
        let count = self.count_of_parts()?;
        let mut first = None;
        let (_, missing) = missing(&self.files);
        let mut found = PartsState { count, missing, faults: Vec::new(), rows: 0, rows_of_study: None };
        for (done, file) in (1..).zip(&self.files) {
            let Some(part) = file.part else { continue };
            match checked(file, part, &mut first) {
                Ok(plan) => {
                    found.rows += plan.rows();
                    found.rows_of_study = Some(plan.rows_of_study());
                }
                Err(error) => found.faults.push((part.number(), error)),
            }
            progress(done);
        }
        Ok(found)
    }

    /// The number of parts of the only study.
    ///
    /// # Errors
    /// The files are not the parts of one study.
    pub fn count_of_parts(&self) -> Result<u64, PartsError> {
        let count = self.files[0].part.filter(|_| self.are_numbered() && self.files[0].keys.is_empty());
        let count = count.map(PartNumber::count);
        count.ok_or_else(|| {
            PartsError::Refused(format!(
                "{}: found other files; expected the parts of one study, such as part-00001-of-00010.csv",
                self.folder
            ))
        })
    }

    /// The description of the study of a single set of parts, line by line, and the plan of its first part.
    ///
    /// # Errors
    /// The files are not the parts of one study, or the first is damaged.
    pub(super) fn study(&self) -> Result<(Vec<String>, PartPlan), PartsError> {
        self.count_of_parts()?;
        let mut first = None;
        let file = &self.files[0];
        file.part.map(|part| checked(file, part, &mut first)).transpose()?;
        let Description { study, plan, .. } = first.unwrap_or_else(|| unreachable!("the file is a part"));
        Ok((study, plan))
    }

    /// Reads the wanted columns of all files. Parts of a study are in the order of the rows; the headings of all columns are returned as
    /// well.
    ///
    /// # Errors
    /// A part is damaged or no table, or one of another study.
    pub fn read(&self, is_wanted: &dyn Fn(&str) -> bool) -> Result<(Table, Vec<String>), PartsError> {
        let with_row = |name: &str| name == ROW || is_wanted(name);
        let mut reader = TableReader::new(&with_row);
        self.visit(&mut reader, |_| Ok::<(), PartsError>(()))?;
        let headings = reader.headings().to_vec();
        let mut table = reader.table();
        if let Some(Values::Integer(rows)) = table.column(ROW).map(|column| &column.values)
            && self.are_numbered()
            && !rows.is_sorted()
        {
            let mut order: Vec<usize> = (0..rows.len()).collect();
            order.sort_by_key(|&position| rows[position]);
            table.reorder(&order);
        }
        Ok((table, headings))
    }

    /// Passes the wanted columns on in batches of rows, file by file. Returns the headings of all columns.
    ///
    /// # Errors
    /// Those of [`TableFiles::read`], and of `each`.
    pub fn read_batches<E: From<PartsError>>(
        &self,
        is_wanted: &dyn Fn(&str) -> bool,
        each: &mut TakeBatch<E>,
    ) -> Result<(), E> {
        let with_row = |name: &str| name == ROW || is_wanted(name);
        let mut reader = TableReader::new(&with_row);
        self.visit(&mut reader, |reader| each(reader.take(), reader.headings()))
    }

    /// Reads file by file, with a call after each batch of rows, and checks that the parts are whole.
    fn visit<'a, E: From<PartsError>>(
        &self,
        reader: &mut TableReader<'a>,
        mut each: impl FnMut(&mut TableReader<'a>) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut first = None;
        for file in &self.files {
            let TableFile { keys, part, path } = file;
            reader.set_keys(keys);
            let Some(part) = *part else {
                let mut rows = reader.begin_file(path).map_err(PartsError::Read)?;
                while reader.next_batch(&mut rows).map_err(PartsError::Read)? {
                    each(reader)?;
                }
                continue;
            };
            let plan = checked(file, part, &mut first)?;
            let damaged = |reason| damaged(path, part, reason);
            let unread = |error| unread(path, part, error);
            let (before, mut passed) = (reader.rows(), 0);
            let mut rows = reader.begin_file(path).map_err(unread)?;
            while reader.next_batch(&mut rows).map_err(unread)? {
                let found = reader.rows() - before;
                check_rows(reader, &plan, passed..found).map_err(damaged)?;
                passed = found;
                each(reader)?;
            }
            if passed != plan.rows() {
                return Err(damaged(format!("found {passed} rows, expected {}", plan.rows())).into());
            }
        }
        Ok(())
    }
}

/// The description of a study without that of a part, and the plan of the part.
struct Description<'f> {
    of: &'f TableFile,
    study: Vec<String>,
    plan: PartPlan,
}

/// Checks that the file of a part has the bytes that were written, and belongs to the study of the `first` part of its set. Its rows are
/// not read.
fn checked<'f>(
    file: &'f TableFile,
    part: PartNumber,
    first: &mut Option<Description<'f>>,
) -> Result<PartPlan, PartsError> {
    let path = &file.path;
    match seal::check(path).map_err(|error| refused(path, error))? {
        Seal::Whole => (),
        Seal::Broken => return Err(damaged(path, part, "its bytes do not have their checksum".into())),
        Seal::Absent => return Err(damaged(path, part, "found no checksum in its end".into())),
    }
    let mut study = description(path).map_err(|error| match error {
        PartsError::Read(error) => unread(path, part, error),
        other => other,
    })?;
    let own = study.pop().unwrap_or_default();
    let begin = format!("{PART}{part}, ");
    let plan = match own.parse::<PartPlan>() {
        Ok(plan) if plan.part() == part => plan,
        _ if own.starts_with(PART) && !own.starts_with(&begin) => {
            return Err(PartsError::of_other_study(path, &own, &(begin + "…")));
        }
        _ => return Err(damaged(path, part, format!("found `{own}`, expected `{begin}…`"))),
    };
    match first {
        Some(first) if first.of.keys == file.keys => {
            let mut lines = first.study.iter().zip(&study);
            if let Some((expected, found)) = lines.find(|(first, other)| first != other) {
                return Err(PartsError::of_other_study(path, found, expected));
            }
            let of = |plan: &PartPlan| (plan.rows_of_study(), plan.rows_of_block());
            if of(&first.plan) != of(&plan) {
                return Err(PartsError::of_other_study(path, &own, &first.plan.to_string()));
            }
        }
        _ => *first = Some(Description { of: file, study, plan }),
    }
    Ok(plan)
}

/// The error of a damaged part, with its remedy.
fn damaged(path: &Path, part: PartNumber, reason: String) -> PartsError {
    let file = path.display();
    PartsError::Refused(format!("{file}: is damaged: {reason}; make it anew: delete it, and run part {part} again"))
}

fn unread(path: &Path, part: PartNumber, error: TableReadError) -> PartsError {
    match error {
        TableReadError::Damaged { reason, .. } => damaged(path, part, reason),
        TableReadError::Refused { .. } => PartsError::Read(error),
    }
}

/// Compares the last rows of a reader with those of a part at these positions; the error says what was found.
fn check_rows(reader: &TableReader, plan: &PartPlan, positions: Range<u64>) -> Result<(), String> {
    let Some(found) = reader.last_numbers(positions.end - positions.start) else {
        return Err(format!("found no whole numbers in the column {ROW}"));
    };
    if positions.end > plan.rows() {
        return Err(format!("found {} rows or more, expected {}", positions.end, plan.rows()));
    }
    let place = positions.zip(found).find(|(position, found)| i64::try_from(plan.row(*position)) != Ok(**found));
    place.map_or(Ok(()), |(position, found)| Err(format!("found row {found} in place of row {}", plan.row(position))))
}

/// The number of parts of a set, and the numbers of those that are not among its files.
fn missing(set: &[TableFile]) -> (u64, Vec<u64>) {
    let known: Vec<u64> = set.iter().filter_map(|file| Some(file.part?.number())).collect();
    let parts = set[0].part.map_or(0, PartNumber::count);
    (parts, (1..=parts).filter(|number| known.binary_search(number).is_err()).collect())
}

fn is_pattern(path: &Path) -> bool {
    path.to_string_lossy().contains(['*', '?', '['])
}

/// The keys in the names of a file's folders, such as `region=north`. Dask, Spark and others write them.
fn keys(path: &Path) -> Vec<(String, String)> {
    let folders = path.parent().into_iter().flat_map(Path::components);
    let key = |name: std::path::Component| {
        let name = name.as_os_str().to_string_lossy();
        let (key, value) = name.split_once('=').filter(|(key, _)| !key.is_empty())?;
        let value = if value == "__HIVE_DEFAULT_PARTITION__" { "" } else { value };
        Some((decoded(key), decoded(value)))
    };
    folders.filter_map(key).collect()
}

/// Decodes characters such as `%20`.
fn decoded(text: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = text.as_bytes();
    while let Some((&first, more)) = rest.split_first() {
        let digit = |place: usize| char::from(*more.get(place)?).to_digit(16);
        let coded =
            if first == b'%' { digit(0).zip(digit(1)).map(|(high, low)| (16 * high + low) as u8) } else { None };
        bytes.push(coded.unwrap_or(first));
        rest = if coded.is_some() { &more[2..] } else { more };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Lists the tables in a folder, or those in its folders if it has none.
fn list(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<(), PartsError> {
    let refused = |error| refused(folder, error);
    let (mut folders, before) = (Vec::new(), paths.len());
    for entry in folder.read_dir().map_err(refused)? {
        let path = entry.map_err(refused)?.path();
        let is_hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(['.', '_']));
        if is_hidden {
            continue;
        }
        if path.is_dir() {
            folders.push(path);
        } else if path.extension().is_some_and(|extension| extension == "csv" || extension == "parquet") {
            paths.push(path);
        }
    }
    if paths.len() == before {
        folders.iter().try_for_each(|folder| list(folder, paths))?;
    }
    Ok(())
}
