//! Corrected records of the California Strong Motion Instrumentation Program, volume 2 (".V2", also called DMG).
//!
//! Each channel has a header and three blocks of values. The first holds accelerations and begins with a line such as
//! `3251 POINTS OF ACCEL DATA EQUALLY SPACED AT  .020 SEC.  (UNITS: CM/SEC/SEC)`.

use super::error::RecordError;
use super::format::Format;
use super::raw::{Raw, StatedCount, StatedStep};
use super::text::{FileText, Values, fixed_width, is_end_mark, squeezed};

/// Width of a column: the format is 8F10.3.
const WIDTH: usize = 10;

/// Returns whether a line begins the block of accelerations.
pub(super) fn is_block_line(line: &str) -> bool {
    let line = line.to_ascii_uppercase();
    line.contains("POINTS OF ACCEL DATA")
}

/// Returns whether the first line belongs to an uncorrected record, whose values are not evenly spaced.
pub(super) fn is_volume_one(line: &str) -> bool {
    line.trim_start().to_ascii_uppercase().starts_with("UNCORRECTED ACCELEROGRAM")
}

/// Reads the accelerations of a channel.
pub(super) fn read(source: &FileText<'_>, lines: &[(usize, &str)]) -> Result<Raw, RecordError> {
    let mut raw = Raw::new(Format::Csmip);
    // Line 3: earthquake; line 7: station; line 8: channel.
    raw.title =
        [2, 6, 7].iter().filter_map(|&i| lines.get(i)).map(|(_, line)| squeezed(line)).collect::<Vec<_>>().join("; ");
    let (start, first) = lines.first().copied().unwrap_or((1, ""));
    let expected = "a line as 3251 POINTS OF ACCEL DATA EQUALLY SPACED AT  .020 SEC.  (UNITS: CM/SEC/SEC)";
    let index = lines.iter().position(|(_, text)| is_block_line(text));
    let Some((index, &(line, text))) = index.and_then(|index| Some((index, lines.get(index)?))) else {
        return Err(source.header_error(start, first, format!("a CSMIP volume 2 file, with {expected}")));
    };

    let error = || source.header_error(line, text, expected);
    let upper = text.to_ascii_uppercase();
    let value = upper.split_whitespace().next().and_then(|word| word.parse().ok()).ok_or_else(error)?;
    raw.count = Some(StatedCount { line, key: "POINTS", value });
    let time_step =
        upper.split_once("SPACED AT").and_then(|(_, rest)| rest.split_whitespace().next()).ok_or_else(error)?;
    raw.time_step = Some(StatedStep::exact(line, source.number(line, time_step).map_err(|_| error())?));
    let unit = upper.split_once("UNITS:").map_or("", |(_, rest)| rest.trim_end().trim_end_matches(')').trim());
    raw.unit = Some((line, source.unit(line, unit)?.ok_or_else(error)?));

    let mut values = Values::new(source);
    for &(line, text) in lines.get(index + 1..).unwrap_or_default() {
        if is_end_mark(text) || text.contains("POINTS OF ") {
            break;
        }
        for field in fixed_width(text, WIDTH) {
            values.push(line, field)?;
        }
    }
    raw.values = values.finish()?;
    Ok(raw)
}
