//! Records of the University of Southern California, volumes 1 and 2, one component a file.

use super::error::RecordError;
use super::format::Format;
use super::raw::Raw;
use super::text::{FileText, title};
use super::volume;

/// Columns of text; the file names the length of each line beyond them.
const TEXT_WIDTH: usize = 70;

/// Returns whether these first lines name the uncorrected record. The name is on line 1 of volume 1 and on line 2 of volume 2.
pub(super) fn is_head(head: &[&str]) -> bool {
    head.iter()
        .take(2)
        .any(|line| line.starts_with("FILE") && line.contains("OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME"))
}

/// Reads the accelerations.
pub(super) fn read(source: &FileText<'_>) -> Result<Raw, RecordError> {
    let lines: Vec<(usize, &str)> = source.lines().collect();
    let mut raw = Raw::new(Format::Usc);
    let block = volume::block(&lines);
    let text: Vec<(usize, &str)> = lines
        .iter()
        .map(|&(line, text)| (line, text.split_at_checked(TEXT_WIDTH).map_or(text, |(text, _)| text)))
        .collect();
    // Earthquake, station, component; volume 2 has a line more before them.
    raw.title = title(&text, if block.is_some() { &[2, 6, 7] } else { &[1, 5, 6] });
    match block {
        Some(index) => volume::block_values(&mut raw, source, &lines, index)?,
        None => volume::pairs(&mut raw, source, &lines)?,
    }
    Ok(raw)
}
