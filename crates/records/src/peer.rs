//! PEER AT2 files: a header that ends with the line of NPTS and DT, then the values in reading order.
//!
//! Four variants of that line exist, `NPTS=  4000, DT= .01000 SEC`, `NPTS=   7999, DT=   .0050 SEC,`,
//! `NPTS=   1451, dt=  .02000` and `1991    0.0100    NPTS, DT`, on line 4 or later. Some files have no header.

use super::claims::{self, StatedStep};
use super::error::RecordError;
use super::format::Format;
use super::raw::{Raw, StatedCount};
use super::text::{FileText, HEAD_LINES, Values, is_end_mark, number, squeezed};

/// Reads the file; without a header the caller must give time step and unit.
pub(super) fn read(source: &FileText<'_>) -> Result<Raw, RecordError> {
    let mut raw = Raw::new(Format::Peer);
    let head = source.head();
    let header_lines = head.iter().position(|line| has_npts(line)).map_or(0, |index| index + 1);
    raw.claims = claims::of_text(source.lines().take(header_lines));
    if let Some((line, text)) = source.lines().take(header_lines).last() {
        let (count, time_step) = npts_and_dt(source, line, text)?;
        raw.count = Some(StatedCount { line, key: "NPTS", value: count });
        raw.time_step = time_step.map(|value| StatedStep::exact(line, value));
    }
    raw.title = title(head.get(..header_lines).unwrap_or_default());

    let mut values = Values::new(source);
    // Number of values in the first line, and whether a shorter line, which must be the last, has occurred.
    let (mut width, mut ended) = (0, false);
    for (line, text) in source.lines().skip(header_lines) {
        if is_end_mark(text) {
            break;
        }
        let mut count = 0;
        for token in text.split_whitespace() {
            if header_lines == 0 && line <= HEAD_LINES && number(token).is_none() {
                let expected = "numbers, or the NPTS line of a PEER header before them";
                return Err(source.header_error(line, text, expected));
            }
            values.push(line, token)?;
            count += 1;
        }
        if header_lines == 0 && count > 0 {
            width = if width == 0 { count } else { width };
            // Without a header, a line of another width is not a row of values; it may hold a count and a time step.
            if ended || count > width {
                let found = format!("{count} numbers in a line");
                let expected = format!("{width} as in the lines before, or an NPTS line before them");
                return Err(source.header_error(line, &found, expected));
            }
            ended = count < width;
        }
    }
    raw.values = values.finish()?;
    Ok(raw)
}

/// Returns whether this is the last line of a PEER header. A comment may name a file with this word.
pub(super) fn has_npts(line: &str) -> bool {
    let upper = line.to_ascii_uppercase();
    // A line without a number only names those of the next one.
    let after = upper
        .split_once("NPTS")
        .filter(|_| line.contains(|c: char| c.is_ascii_digit()))
        .map(|(_, after)| after.trim_start());
    after.is_some_and(|after| !line.starts_with('#') || after.starts_with(['=', ',', ':']))
}

/// Returns the line that names earthquake, station and component.
fn title(header: &[&str]) -> String {
    let database = |line: &str| {
        let line = line.to_ascii_uppercase();
        line.contains("PEER ") && !line.starts_with("ORIG") || line.contains("PACIFIC ENGINEERING")
    };
    match header {
        [first, second, _, ..] if database(first) => squeezed(second),
        [first, _, ..] => squeezed(first),
        _ => String::new(),
    }
}

/// Returns count and time step (s) from the last line of the header. The time step may be missing.
fn npts_and_dt(source: &FileText<'_>, line: usize, text: &str) -> Result<(usize, Option<f64>), RecordError> {
    let upper = text.to_ascii_uppercase();
    let after = |key: &str| {
        let (_, rest) = upper.split_once(key)?;
        rest.trim_start().strip_prefix(['=', ':'])?.split([',', ' ', '\t']).find(|word| !word.is_empty())
    };
    let mut words = upper.split_whitespace();
    let (count, time_step) = match after("NPTS") {
        Some(count) => (Some(count), after("DT")),
        None => (words.next(), words.next()),
    };
    let count = count
        .and_then(|word| word.trim_end_matches('.').parse().ok())
        .ok_or_else(|| source.header_error(line, text, "the count of values as NPTS= 4000 or 4000 0.01 NPTS, DT"))?;
    let time_step = match time_step {
        Some(word) if upper.contains("DT") => Some(source.number(line, word).map_err(|_| {
            source.header_error(line, text, "a time step in seconds as DT= 0.01 or 4000 0.01 NPTS, DT")
        })?),
        _ => None,
    };
    Ok((count, time_step))
}
