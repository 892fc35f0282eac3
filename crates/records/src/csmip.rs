//! Records of the California Strong Motion Instrumentation Program (CSMIP, earlier DMG, later CESMD), volumes 1 and 2.
//!
//! Each channel of volume 2 has a header and blocks of accelerations, velocities and displacements. A channel of volume 1 has
//! accelerations only, evenly spaced from digital instruments, as pairs with their times from digitized film.

use super::channels::{self, name_after_number};
use super::error::RecordError;
use super::format::Format;
use super::options::Choice;
use super::raw::Raw;
use super::text::{FileText, title};
use super::volume;

/// Returns whether the first line belongs to an uncorrected record.
pub(super) fn is_volume_one(line: &str) -> bool {
    line.trim_start().to_ascii_uppercase().starts_with("UNCORRECTED ACCELEROGRAM DATA")
}

/// Reads the accelerations of a channel.
pub(super) fn read(source: &FileText<'_>, wanted: Option<&Choice>) -> Result<Raw, RecordError> {
    let name = |lines: &[(usize, &str)]| lines.iter().take(8).find_map(|(_, text)| name_after_number(text));
    let lines = &channels::choose(source, wanted, name)?;
    let (start, first) = lines.first().copied().unwrap_or((1, ""));
    let mut raw = Raw::new(Format::Csmip);
    let is_volume_one = is_volume_one(first);
    // Earthquake, station, channel.
    raw.title = title(lines, if is_volume_one { &[1, 5, 6] } else { &[2, 6, 7] });
    match volume::block(lines) {
        Some(index) => volume::block_values(&mut raw, source, lines, index)?,
        None if is_volume_one => volume::pairs(&mut raw, source, lines)?,
        None => {
            let expected = "a CSMIP file, with a line as 3251 POINTS OF ACCEL DATA EQUALLY SPACED AT  .020 SEC.";
            return Err(source.header_error(start, first, expected));
        }
    }
    Ok(raw)
}
