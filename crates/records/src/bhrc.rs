//! Uncorrected records of the Building and Housing Research Center of Iran (volume 1): channels of evenly spaced accelerations in g/10.

use super::channels;
use super::claims::StatedStep;
use super::error::RecordError;
use super::format::Format;
use super::options::Choice;
use super::raw::Raw;
use super::text::{FileText, before_end_mark, fixed_columns, fixed_width, squeezed, title};
use super::volume;

/// Number of lines of a header: text, integers and reals.
const HEADER_LINES: usize = 13 + 7 + 7;

/// Index of the line that begins with the sampling rate, the seventh real number.
const RATE_LINE: usize = 13 + 7 + 1;

/// Width of a column of reals and of accelerations.
const WIDTH: usize = 13;

/// Returns whether the first line of a file begins a volume 1.
pub(super) fn is_first_line(line: &str) -> bool {
    line.starts_with("* VOL1DS FILE")
}

/// Reads the accelerations of a channel.
pub(super) fn read(source: &FileText<'_>, wanted: Option<&Choice>) -> Result<Raw, RecordError> {
    let component =
        |lines: &[(usize, &str)]| lines.get(4).map(|(_, text)| squeezed(text)).filter(|name| !name.is_empty());
    let lines = channels::choose(source, wanted, component)?;
    let mut raw = Raw::new(Format::Bhrc);
    // Time of the earthquake, component, station.
    raw.title = title(&lines, &[2, 6, 7]);
    let (start, first) = lines.first().copied().unwrap_or((1, ""));
    let missing = |expected: &str| source.header_error(start, first, format!("a BHRC file, with {expected}"));
    raw.count = Some(volume::points(&lines).ok_or_else(|| missing("a count as NO. OF POINTS =  15616"))?);
    raw.unit = Some(volume::unit_of_pairs(source, &lines)?.ok_or_else(|| missing("units as SECONDS AND G/10"))?);
    let (line, reals) = lines.get(RATE_LINE).copied().unwrap_or((start, ""));
    let rate = fixed_width(reals, WIDTH).next().unwrap_or("");
    let rate = source.number(line, rate).ok().filter(|rate| *rate > 0.0);
    let rate = rate.ok_or_else(|| source.header_error(line, reals, "the sampling rate (real header, 7th value)"))?;
    raw.time_step = Some(StatedStep::exact(line, 1.0 / rate));

    raw.values = fixed_columns(source, before_end_mark(&lines, HEADER_LINES), WIDTH)?;
    Ok(raw)
}
