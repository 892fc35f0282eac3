//! A study → its parts, each a file of a folder.
//!
//! The rows of a study depend on their numbers alone, so that parts can be made anywhere and in any order. Blocks of rows go to the parts
//! in turn, in an order drawn anew for each round: neighbouring rows share a block or a record, and thus their cost.

use std::fmt::{self, Display};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;
use std::str::FromStr;

use rocking_block::numerics::wide::VectorWidth;

use crate::output::csv::lines;
use crate::output::format::TableFormat;
use crate::output::parquet;
use crate::output::reading::{TableReadError, parquet_description};
use crate::output::resumable::TableHeader;
use crate::output::runner::{Study, StudyRows};
use crate::output::seal::{self, Seal, SealingWriter};
use crate::output::table::Table;
use crate::spec::words::Words;

/// Number of blocks of rows in a part of a large study. It is enough for all parts to cost about the same.
const BLOCKS: u64 = 32;

/// Most rows of a block: enough to fill the lanes of vectors.
const MAX_BLOCK: u64 = 256;

/// Most parts of a range.
const MAX_PARTS: u64 = 1 << 20;

/// The number of a part, from 1, and the number of parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PartNumber {
    count: u64,
    number: u64,
}

impl PartNumber {
    /// Returns the number of a part. `None` unless it is at least 1 and at most the number of parts.
    pub fn new(number: u64, count: u64) -> Option<PartNumber> {
        (1..=count).contains(&number).then_some(PartNumber { count, number })
    }

    /// The number of the part, from 1.
    pub fn number(self) -> u64 {
        self.number
    }

    /// The number of parts.
    pub fn count(self) -> u64 {
        self.count
    }

    /// The name of its file, such as `part-00003-of-00100.csv`.
    pub fn file_name(self, format: TableFormat) -> String {
        format!("part-{:05}-of-{:05}.{}", self.number, self.count, format.word())
    }

    /// The part whose file has this name, and its format.
    pub(super) fn of_file(name: &str) -> Option<(PartNumber, TableFormat)> {
        let (stem, extension) = name.rsplit_once('.')?;
        let (number, count) = stem.strip_prefix("part-")?.split_once("-of-")?;
        let part = PartNumber::new(number.parse().ok()?, count.parse().ok()?)?;
        let format = TableFormat::named(extension)?;
        (part.file_name(format) == name).then_some((part, format))
    }
}

impl Display for PartNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {}", self.number, self.count)
    }
}

/// The numbers of some parts of a study, ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartNumbers(Vec<PartNumber>);

impl PartNumbers {
    /// The parts, at least one.
    pub fn parts(&self) -> &[PartNumber] {
        &self.0
    }

    /// The number of parts of the study.
    pub fn count(&self) -> u64 {
        self.0[0].count
    }
}

/// Writes `3` or `1-10,17`, the numbers without that of all parts.
impl Display for PartNumbers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&ranges(self.0.iter().map(|part| part.number)))
    }
}

/// Reads `3/100`, `1-10/100` and lists of both, `3,17,40-42/100`.
impl FromStr for PartNumbers {
    type Err = String;

    fn from_str(text: &str) -> Result<PartNumbers, String> {
        let read = || {
            let (list, count) = text.split_once('/')?;
            let count = count.parse().ok()?;
            let mut parts: Vec<PartNumber> = Vec::new();
            for range in list.split(',') {
                let (first, last) = range.split_once('-').unwrap_or((range, range));
                let [first, last] =
                    [PartNumber::new(first.parse().ok()?, count)?, PartNumber::new(last.parse().ok()?, count)?];
                // No task makes more.
                if last.number.checked_sub(first.number)? >= MAX_PARTS {
                    return None;
                }
                parts.extend((first.number..=last.number).map(|number| PartNumber { count, number }));
            }
            parts.sort_unstable();
            parts.dedup();
            (!parts.is_empty()).then_some(PartNumbers(parts))
        };
        read().ok_or_else(|| {
            "expected the numbers of parts from 1 and the number of all parts, such as 3/100, 1-10/100 or 3,17,40/100; number the tasks of \
             a job array from 1"
                .into()
        })
    }
}

/// Writes ascending numbers as job arrays take them, such as `3,17,40-42`.
pub fn ranges(numbers: impl IntoIterator<Item = u64>) -> String {
    let mut found: Vec<[u64; 2]> = Vec::new();
    for number in numbers {
        match found.last_mut() {
            Some([_, last]) if *last + 1 == number => *last = number,
            _ => found.push([number; 2]),
        }
    }
    let text = |[first, last]: &[u64; 2]| if first == last { first.to_string() } else { format!("{first}-{last}") };
    found.iter().map(text).collect::<Vec<_>>().join(",")
}

/// Returns the file of a part, or of a table of its own, in a format.
///
/// # Errors
/// None in practice: the file is written to memory.
pub fn file(header: &TableHeader, rows: Table, format: TableFormat) -> io::Result<Vec<u8>> {
    match format {
        TableFormat::Csv => {
            let mut writer = SealingWriter::new(Vec::new());
            writer.write_all((header.text()? + &lines(&rows)?).as_bytes())?;
            writer.finish_text()
        }
        TableFormat::Parquet => parquet::file(&header.study, &header.columns, rows),
    }
}

/// The format of a part in a folder with files of these names: that which is wanted, of the parts that are there, or the usual one.
///
/// # Errors
/// There are parts of another set or format, which would not be read together.
pub fn format_in(
    names: impl IntoIterator<Item = String>,
    count: u64,
    wanted: Option<TableFormat>,
) -> Result<TableFormat, String> {
    let mut parts = names.into_iter().filter_map(|name| Some((PartNumber::of_file(&name)?, name)));
    let other = |((part, format), _): &((PartNumber, TableFormat), String)| {
        part.count != count || wanted.is_some_and(|wanted| wanted != *format)
    };
    let first = parts.next();
    match first.iter().cloned().chain(parts).find(other) {
        Some((_, name)) => {
            let format = wanted.map(|format| format!(" in {}", format.word())).unwrap_or_default();
            let expected = format!("expected some of {count} parts{format}, or another folder");
            Err(format!("has parts of another set, such as {name}; {expected}"))
        }
        None => Ok(wanted.or(first.map(|((_, format), _)| format)).unwrap_or(TableFormat::OF_PARTS)),
    }
}

/// The rows of a part, by their numbers in the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartPlan {
    part: PartNumber,
    /// Rows of the study.
    of: u64,
    /// Rows of a block; the last block of the study may have fewer.
    block: u64,
}

impl PartPlan {
    /// The part.
    pub fn part(&self) -> PartNumber {
        self.part
    }

    /// Number of its rows.
    pub fn rows(&self) -> u64 {
        let rounds = self.rounds();
        let Some(last) = rounds.checked_sub(1) else { return 0 };
        let begin = self.block_of(last) * self.block;
        last * self.block + self.block.min(self.of - begin)
    }

    /// Rows of the study.
    pub fn rows_of_study(&self) -> u64 {
        self.of
    }

    /// Rows of a block of the study, whose last block may have fewer. Parts have whole blocks, in the order of their numbers.
    pub fn rows_of_block(&self) -> u64 {
        self.block
    }

    /// The number in the study of the row at a position in the part.
    pub fn row(&self, position: u64) -> u64 {
        self.block_of(position / self.block) * self.block + position % self.block
    }

    /// The block of a round, by its number in the study.
    fn block_of(&self, round: u64) -> u64 {
        let PartNumber { count, number } = self.part;
        round * count + (number - 1 + mixed(round)) % count
    }

    fn rounds(&self) -> u64 {
        let blocks = self.of.div_ceil(self.block);
        let complete = blocks / self.part.count;
        complete + u64::from(self.block_of(complete) < blocks)
    }
}

/// Writes `part 3 of 100, 720 rows of 72000 in blocks of 24`, the line of its description that tells parts apart.
impl Display for PartPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{PART}{}, {} rows of {} in blocks of {}", self.part, self.rows(), self.of, self.block)
    }
}

impl FromStr for PartPlan {
    type Err = ();

    fn from_str(line: &str) -> Result<PartPlan, ()> {
        let read = || {
            let (part, rows) = line.strip_prefix(PART)?.split_once(", ")?;
            let (number, count) = part.split_once(" of ")?;
            let part = PartNumber::new(number.parse().ok()?, count.parse().ok()?)?;
            let (of, block) = rows.split_once(" rows of ")?.1.split_once(" in blocks of ")?;
            let plan = PartPlan { part, of: of.parse().ok()?, block: block.parse().ok().filter(|block| *block > 0)? };
            // The number of rows is that of the plan.
            (plan.to_string() == line).then_some(plan)
        };
        read().ok_or(())
    }
}

/// A part of a study.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a, S> {
    study: &'a S,
    plan: PartPlan,
}

impl<S: Study> Part<'_, S> {
    /// Takes a part of a study.
    pub fn new(study: &S, part: PartNumber) -> Part<'_, S> {
        let of = study.rows();
        let block = (of / (BLOCKS * part.count)).clamp(1, MAX_BLOCK);
        Part { study, plan: PartPlan { part, of, block: block.next_multiple_of(study.rows_together()) } }
    }

    /// The numbers of its rows.
    pub fn plan(&self) -> PartPlan {
        self.plan
    }
}

/// Mixes the bits of a number (the finalizer of SplitMix64; G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014, 453-472), without the upper
/// half, so that sums with it do not overflow.
fn mixed(number: u64) -> u64 {
    let number = (number ^ (number >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let number = (number ^ (number >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (number ^ (number >> 31)) >> 32
}

impl<S: Study> Study for Part<'_, S> {
    fn header(&self) -> TableHeader {
        let mut header = self.study.header();
        header.study.push(self.plan.to_string());
        header
    }

    fn rows(&self) -> u64 {
        self.plan.rows()
    }

    fn runs_in_a_row(&self) -> u64 {
        self.study.runs_in_a_row()
    }

    fn rows_together(&self) -> u64 {
        self.study.rows_together()
    }

    fn uses_lanes(&self) -> bool {
        self.study.uses_lanes()
    }

    /// Makes rows by their positions in the part.
    fn make(&self, numbers: &[u64], width: Option<VectorWidth>) -> StudyRows {
        self.study.make(&numbers.iter().map(|&position| self.plan.row(position)).collect::<Vec<_>>(), width)
    }
}

/// The beginning of the line of the description that tells parts apart.
pub(super) const PART: &str = "part ";

/// The state of the file of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartState {
    /// There is no file.
    Absent,
    /// All rows of this study's part.
    Complete,
    /// The file ends early, or has other bytes than were written.
    Broken,
}

/// The reason why a part or a folder of parts cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PartsError {
    /// The file or folder, the fault, and what was expected.
    #[error("{0}")]
    Refused(String),
    /// A file is no table.
    #[error(transparent)]
    Read(#[from] TableReadError),
}

impl PartsError {
    /// The error of a part of another study. It has a line of its description, and the line of this study.
    pub(super) fn of_other_study(path: &Path, found: &str, expected: &str) -> PartsError {
        let file = path.display();
        PartsError::Refused(format!("{file}: is a part of another study; found `{found}`, expected `{expected}`"))
    }
}

/// Returns whether the file of a part is there and complete.
///
/// # Errors
/// It is that of another study, or cannot be read.
pub fn state(path: &Path, header: &TableHeader) -> Result<PartState, PartsError> {
    if !path.exists() {
        return Ok(PartState::Absent);
    }
    let seal = seal::check(path).map_err(|error| refused(path, error))?;
    if seal == Seal::Broken {
        return Ok(PartState::Broken);
    }
    let found = match description(path) {
        Ok(description) => description,
        Err(PartsError::Read(_)) => return Ok(PartState::Broken),
        Err(error) => return Err(error),
    };
    let expected = header.study.iter().map(|line| line.replace(['\n', '\r'], " "));
    for (number, expected) in expected.enumerate() {
        match found.get(number) {
            Some(found) if *found == expected => (),
            Some(cut) if number + 1 == found.len() && expected.starts_with(cut) => return Ok(PartState::Broken),
            Some(found) => return Err(PartsError::of_other_study(path, found, &expected)),
            None => return Ok(PartState::Broken),
        }
    }
    Ok(if seal == Seal::Whole { PartState::Complete } else { PartState::Broken })
}

/// The description in the file of a part, line by line.
pub(super) fn description(path: &Path) -> Result<Vec<String>, PartsError> {
    let file = open(path)?;
    if TableFormat::of(path) == TableFormat::Parquet {
        return Ok(parquet_description(&path.display().to_string(), file)?);
    }
    // A damaged file may have bytes that are no text.
    let text = |line: io::Result<Vec<u8>>| match line {
        Ok(line) => Ok(String::from_utf8_lossy(line.strip_suffix(b"\r").unwrap_or(&line)).into_owned()),
        Err(error) => Err(refused(path, error)),
    };
    let comments = BufReader::new(file).split(b'\n').map(text);
    let is_comment = |line: &Result<String, PartsError>| line.as_ref().map_or(true, |line| line.starts_with("# "));
    comments.take_while(is_comment).map(|line| Ok(line?["# ".len()..].into())).collect()
}

fn open(path: &Path) -> Result<File, PartsError> {
    File::open(path).map_err(|error| refused(path, error))
}

pub(super) fn refused(path: &Path, error: io::Error) -> PartsError {
    PartsError::Refused(format!("{}: cannot be read: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_parts_are_read_as_job_arrays_write_them() {
        let read = |text: &str| text.parse::<PartNumbers>().map(|parts| (parts.to_string(), parts.parts().len()));
        for (text, shown, count) in [
            ("3/100", "3", 1),
            ("1-10/10000", "1-10", 10),
            ("40,3,17-18,18,41/41", "3,17-18,40-41", 5),
            ("7-7/7", "7", 1),
        ] {
            assert_eq!(read(text), Ok((shown.into(), count)), "{text}");
        }
        for text in ["", "3", "0/4", "5/4", "3-2/4", "1-5/4", "1,/4", "-2/4", "1-/4", "a/4", "1/0", "1/4/5"] {
            assert!(read(text).is_err_and(|error| error.contains("such as 3/100, 1-10/100")), "{text}");
        }
    }
}
