//! The parts of a study → the table of one run, byte for byte.
//!
//! The rows of parts come in blocks of the study. Blocks are written to a temporary file as lines of CSV, part by part, and then taken from
//! it in the order of the study: memory for a batch of rows and the places of the blocks is enough.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};

use crate::output::csv::{comments, lines_of, read_batches, record_line};
use crate::output::format::TableFormat;
use crate::output::parquet::{Groups, ParquetWriter};
use crate::output::parts::PartsError;
use crate::output::reading::ROW;
use crate::output::table::{Heading, Table, Values};
use crate::output::table_files::TableFiles;

/// The reason why parts cannot be merged.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// A part, or the folder.
    #[error(transparent)]
    Parts(#[from] PartsError),
    /// The temporary file, in the folder that `TMPDIR` names.
    #[error("the temporary file of the rows, in {folder}: {error}")]
    Temporary {
        /// Its folder.
        folder: String,
        /// The reason given by the operating system.
        error: io::Error,
    },
    /// The output.
    #[error("cannot be written: {0}")]
    Output(io::Error),
}

impl MergeError {
    fn temporary(error: io::Error) -> MergeError {
        MergeError::Temporary { folder: std::env::temp_dir().display().to_string(), error }
    }
}

/// The rows of all parts of a study, block by block.
pub struct MergedParts {
    study: Vec<String>,
    /// Headings of all columns, as in the parts.
    headings: Vec<String>,
    /// Lines of CSV, the blocks in the order of the parts.
    lines: File,
    /// The place of each block among the lines, and its length, in bytes.
    blocks: Vec<(u64, u64)>,
    rows: u64,
}

/// Bytes of lines that are taken from the temporary file at once.
const CHUNK: usize = 1 << 22;

impl MergedParts {
    /// Reads all parts. `progress` receives the numbers of rows so far and in all.
    ///
    /// # Errors
    /// A part is missing, damaged, or one of another study; or there is no room for the temporary file.
    pub fn read(files: &TableFiles, mut progress: impl FnMut(u64, u64)) -> Result<MergedParts, MergeError> {
        files.count_of_parts()?;
        files.check_complete(None)?;
        let (study, plan) = files.study()?;
        let (rows, of_block) = (plan.rows_of_study(), plan.rows_of_block());
        let file = tempfile::tempfile().map_err(MergeError::temporary)?;
        let mut lines = BufWriter::with_capacity(1 << 18, file);
        let mut blocks = vec![(0, 0); rows.div_ceil(of_block) as usize];
        let (mut headings, mut end, mut done) = (Vec::new(), 0, 0);
        files.read_batches::<MergeError>(&|_| true, &mut |batch, of_file| {
            headings = of_file.to_vec();
            for (block, of) in runs(&batch, of_block) {
                let text = lines_of(&batch, of).map_err(MergeError::temporary)?;
                lines.write_all(text.as_bytes()).map_err(MergeError::temporary)?;
                let (begin, length) = &mut blocks[block];
                // A block may go on in the next batch of its part.
                if *length == 0 {
                    *begin = end;
                }
                *length += text.len() as u64;
                end += text.len() as u64;
            }
            done += batch.rows() as u64;
            progress(done, rows);
            Ok(())
        })?;
        let lines = lines.into_inner().map_err(|error| MergeError::temporary(error.into_error()))?;
        Ok(MergedParts { study, headings, lines, blocks, rows })
    }

    /// Number of rows.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Writes the table as CSV, and returns the output.
    ///
    /// # Errors
    /// `out` takes no bytes, or the temporary file cannot be read.
    pub fn write_csv<W: Write>(&mut self, mut out: W) -> Result<W, MergeError> {
        let head = comments(&self.study);
        let head = head + &record_line(&self.headings).map_err(MergeError::Output)?;
        out.write_all(head.as_bytes()).map_err(MergeError::Output)?;
        self.each_chunk(|text| out.write_all(text).map_err(MergeError::Output))?;
        out.flush().map_err(MergeError::Output)?;
        Ok(out)
    }

    /// Writes the table as Parquet, and returns the output. `columns` are the [`types`] of the parts.
    ///
    /// # Errors
    /// Those of [`MergedParts::write_csv`].
    pub fn write_parquet<W: Write + Send>(&mut self, columns: &[Heading], out: W) -> Result<W, MergeError> {
        let mut writer = ParquetWriter::new(out, &self.study, columns).map_err(MergeError::Output)?;
        let head = record_line(&self.headings).map_err(MergeError::Output)?;
        self.each_chunk(|text| {
            // The text has the digits that restore each number.
            read_batches::<String>(columns, head.as_bytes().chain(text), |rows| {
                writer.push(rows).map_err(|error| error.to_string())
            })
            .map_err(|reason| MergeError::Output(io::Error::other(reason)))
        })?;
        writer.finish().map_err(MergeError::Output)
    }

    /// Passes the lines on in the order of the study, whole blocks at a time.
    fn each_chunk(&mut self, mut each: impl FnMut(&[u8]) -> Result<(), MergeError>) -> Result<(), MergeError> {
        let mut text = Vec::new();
        for (begin, length) in &self.blocks {
            self.lines.seek(SeekFrom::Start(*begin)).map_err(MergeError::temporary)?;
            let read = (&self.lines).take(*length).read_to_end(&mut text).map_err(MergeError::temporary)?;
            debug_assert_eq!(read as u64, *length);
            if text.len() >= CHUNK {
                each(&text)?;
                text.clear();
            }
        }
        if text.is_empty() { Ok(()) } else { each(&text) }
    }
}

/// The columns of parts in Parquet with their types.
///
/// # Errors
/// The parts are CSV, which does not tell the types, or the first is damaged.
pub fn types(files: &TableFiles) -> Result<Vec<Heading>, MergeError> {
    let path = &files.files()[0].path;
    let refused = |reason: String| PartsError::Refused(format!("{}: {reason}", path.display()));
    if TableFormat::of(path) != TableFormat::Parquet {
        let reason = "is CSV, which does not tell numbers, whole numbers and words apart; expected parts in Parquet, or a table in CSV";
        return Err(refused(reason.into()).into());
    }
    let groups = File::open(path).and_then(Groups::new);
    Ok(groups.map_err(|error| refused(error.to_string()))?.headings)
}

/// The rows of a batch of a part, cut where another block of the study begins, with the numbers of the blocks.
fn runs(batch: &Table, of_block: u64) -> Vec<(usize, std::ops::Range<usize>)> {
    let Some(Values::Integer(numbers)) = batch.column(ROW).map(|column| &column.values) else {
        unreachable!("readers of parts check the numbers of their rows")
    };
    let mut found: Vec<(usize, std::ops::Range<usize>)> = Vec::new();
    for (row, number) in numbers.iter().enumerate() {
        let block = (*number as u64 / of_block) as usize;
        match found.last_mut() {
            Some((last, rows)) if *last == block => rows.end = row + 1,
            _ => found.push((block, row..row + 1)),
        }
    }
    found
}
