//! Uncorrected records of RENADIC, Universidad de Chile: several channels, each of pairs of a time and an acceleration in g/10.

use super::channels::{self, name_after_number};
use super::error::RecordError;
use super::format::Format;
use super::options::Choice;
use super::raw::Raw;
use super::text::{FileText, title};
use super::volume;

/// Returns whether a line is the one of the network, the eighth.
pub(super) fn is_header_line(line: &str) -> bool {
    line.trim_end() == "UNIVERSIDAD DE CHILE - RENADIC"
}

/// Reads the accelerations of a channel.
pub(super) fn read(source: &FileText<'_>, wanted: Option<&Choice>) -> Result<Raw, RecordError> {
    let name = |lines: &[(usize, &str)]| lines.get(6).and_then(|(_, text)| name_after_number(text));
    let lines = channels::choose(source, wanted, name)?;
    let mut raw = Raw::new(Format::Renadic);
    // Earthquake, station, channel.
    raw.title = title(&lines, &[1, 5, 6]);
    volume::pairs(&mut raw, source, &lines)?;
    Ok(raw)
}
