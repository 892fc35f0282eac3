//! The parts of a study, or other files of one table → its rows.

use std::io;
use std::path::{Path, PathBuf};

use crate::output::parts::{PART, PartNumber, PartsError, description, ends_with_line, refused};
use crate::output::reading::{TableReadError, TableReader, TakeBatch, is_parquet};
use crate::output::table::{Table, Values};

/// The files of a table: the parts of a folder, all of one set, or other files.
pub struct TableFiles {
    folder: String,
    /// Number of parts; none for other files.
    count: u64,
    files: Vec<(Option<PartNumber>, PathBuf)>,
}

impl TableFiles {
    /// Whether a path stands for several files: a folder, or a pattern such as `runs/*.parquet`.
    pub fn are_at(path: &Path) -> bool {
        path.is_dir() || !path.exists() && path.to_string_lossy().contains(['*', '?', '['])
    }

    /// Lists the parts of a folder, or the files that match a pattern. A folder without parts is a set of files in Parquet or CSV, or of
    /// such folders; names that begin with a dot or an underscore are left out.
    ///
    /// # Errors
    /// The folder cannot be read, or has no tables, or parts of several sets.
    pub fn of(path: &Path) -> Result<TableFiles, PartsError> {
        let folder = path.display().to_string();
        let mut paths = Vec::new();
        if path.is_dir() {
            list(path, &mut paths)?;
        } else {
            let matches =
                glob::glob(&path.to_string_lossy()).map_err(|error| refused(path, io::Error::other(error)))?;
            for path in matches {
                paths.push(path.map_err(|error| refused(error.path(), io::Error::other(error.error().to_string())))?);
            }
        }
        let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let numbered = |path: PathBuf| (PartNumber::of_file(&name(&path)), path);
        let mut files: Vec<(Option<PartNumber>, PathBuf)> = paths.into_iter().map(numbered).collect();
        if files.iter().any(|(part, _)| part.is_some()) {
            files.retain(|(part, _)| part.is_some());
        }
        files.sort();
        let Some((part, first)) = files.first().cloned() else { return Err(PartsError::None(folder)) };
        let count = |part: Option<PartNumber>| part.map_or(0, |part| part.count());
        let other = |(other, path): &&(Option<PartNumber>, PathBuf)| {
            count(*other) != count(part) || path.extension() != first.extension()
        };
        if let Some((_, other)) = files.iter().find(other) {
            let [first, other] = [&first, other].map(|path| name(path));
            return Err(PartsError::Sets { folder, first, other });
        }
        Ok(TableFiles { folder, count: count(part), files })
    }

    /// The files, in the order of their numbers, or of their names.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().map(|(_, path)| path.as_path())
    }

    /// Whether the files are parts, whose rows have numbers.
    pub fn are_numbered(&self) -> bool {
        self.count > 0
    }

    /// Checks that all parts are there.
    ///
    /// # Errors
    /// Names the missing ones, and `partial`, the option that does without them.
    pub fn check_complete(&self, partial: &'static str) -> Result<(), PartsError> {
        let known: Vec<u64> = self.files.iter().filter_map(|(part, _)| Some((*part)?.number())).collect();
        let missing: Vec<u64> = (1..=self.count).filter(|number| known.binary_search(number).is_err()).collect();
        if missing.is_empty() {
            return Ok(());
        }
        let shown: Vec<String> = missing.iter().take(10).map(u64::to_string).collect();
        let more = if missing.len() > 10 { ", …" } else { "" };
        let (folder, count, parts) = (self.folder.clone(), missing.len() as u64, self.count);
        Err(PartsError::Missing { folder, count, parts, missing: shown.join(", ") + more, partial })
    }

    /// Reads the wanted columns of all files, of parts in the order of the rows; returns the headings of all columns as well.
    ///
    /// # Errors
    /// A part is damaged or no table, or one of another study.
    pub fn read(&self, is_wanted: &dyn Fn(&str) -> bool) -> Result<(Table, Vec<String>), PartsError> {
        let with_row = |name: &str| name == ROW || is_wanted(name);
        let mut reader = TableReader::new(&with_row);
        self.visit::<PartsError>(&mut reader, |reader, path| Ok(reader.read_file(path)?))?;
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

    /// Passes the wanted columns on in batches of rows, in the order of the files, with the headings of all columns.
    ///
    /// # Errors
    /// Those of [`TableFiles::read`], and of `each`.
    pub fn read_batches<E: From<PartsError> + From<TableReadError>>(
        &self,
        is_wanted: &dyn Fn(&str) -> bool,
        each: &mut TakeBatch<E>,
    ) -> Result<(), E> {
        let with_row = |name: &str| name == ROW || is_wanted(name);
        let mut reader = TableReader::new(&with_row);
        self.visit(&mut reader, |reader, path| reader.read_batches(path, each))
    }

    /// Reads file by file, and checks that the parts are whole.
    fn visit<'a, E: From<PartsError>>(
        &self,
        reader: &mut TableReader<'a>,
        mut read: impl FnMut(&mut TableReader<'a>, &Path) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut first: Option<Vec<String>> = None;
        for (part, path) in &self.files {
            let Some(part) = part else {
                read(reader, path)?;
                continue;
            };
            let file = path.display().to_string();
            let mut study = description(path)?;
            let own = study.pop().unwrap_or_default();
            let rows = own.strip_prefix(&format!("{PART}{part}, ")).and_then(|rows| rows.strip_suffix(" rows"));
            let Some(expected) = rows.and_then(|rows| rows.parse().ok()) else {
                return Err(PartsError::Other { file, found: own, expected: format!("{PART}{part}, …") }.into());
            };
            let first = first.get_or_insert_with(|| study.clone());
            if let Some((expected, found)) = first.iter().zip(&study).find(|(first, other)| first != other) {
                return Err(PartsError::Other { file, found: found.clone(), expected: expected.clone() }.into());
            }
            let before = reader.rows();
            read(reader, path)?;
            let found = reader.rows() - before;
            if found != expected || !is_parquet(path) && !ends_with_line(path)? {
                return Err(PartsError::Broken { file, found, expected }.into());
            }
        }
        Ok(())
    }
}

/// Column of the numbers of rows.
const ROW: &str = "row";

/// Lists the tables in a folder, or those in its folders if it has none.
fn list(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<(), PartsError> {
    let refused = |error| refused(folder, error);
    let mut folders = Vec::new();
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
    if paths.is_empty() {
        folders.iter().try_for_each(|folder| list(folder, paths))?;
    }
    Ok(())
}
