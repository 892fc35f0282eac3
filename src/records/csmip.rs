//! Corrected records of the California Strong Motion Instrumentation Program, volume 2 (".V2", also called DMG): for
//! each channel a header and three blocks of values, the first of them accelerations, as
//! `3251 POINTS OF ACCEL DATA EQUALLY SPACED AT  .020 SEC.  (UNITS: CM/SEC/SEC)`.

use super::raw::{Raw, StatedCount, StatedStep};
use super::text::{Source, Values, fixed_width, is_end_mark, squeezed};
use super::unit::other_quantity;
use super::{Format, RecordError};

/// Width of a value's column: the format is 8F10.3.
const WIDTH: usize = 10;

/// Whether the line opens the block of accelerations.
pub(super) fn is_block_line(line: &str) -> bool {
    let line = line.to_ascii_uppercase();
    line.contains("POINTS OF ACCEL DATA")
}

/// Whether a file's first line is that of a record that is not corrected, whose values are not evenly spaced.
pub(super) fn is_volume_one(line: &str) -> bool {
    line.trim_start().to_ascii_uppercase().starts_with("UNCORRECTED ACCELEROGRAM")
}

/// Reads the accelerations of the channel.
pub(super) fn read(source: &Source<'_>, lines: &[(usize, &str)]) -> Result<Raw, RecordError> {
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
    raw.unit = match (unit.parse(), other_quantity(unit)) {
        (Ok(unit), _) => Some((line, unit)),
        (Err(_), Some(found)) => {
            return Err(source.not_acceleration(line, format!("{found} ({unit})")));
        }
        (Err(_), None) => return Err(error()),
    };

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
