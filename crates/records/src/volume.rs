//! Volumes 1 and 2 as laid out by the California Institute of Technology, for the networks that took them over.
//!
//! Each channel has lines of text, integers and reals. Then follow evenly spaced accelerations below a line such as
//! `3251 POINTS OF ACCEL DATA EQUALLY SPACED AT  .020 SEC.  (UNITS: CM/SEC/SEC)`, or pairs of a time and an acceleration.

use super::claims::StatedStep;
use super::error::RecordError;
use super::raw::{Raw, StatedCount, StatedPeak};
use super::text::{FileText, Values, before_end_mark, fixed_columns, fixed_width, number, print_quantum};
use super::time_axis::TimeAxis;
use super::unit::Unit;

/// Number of lines before pairs of a volume 1: text, integers and reals.
const HEADER_LINES: usize = 13 + 7 + 7;

/// Number of lines of text in the longest header.
const TEXT_LINES: usize = 25;

/// Width of the columns of a pair.
const PAIR_WIDTH: usize = 7;

/// Returns the index of the line above the accelerations.
pub(super) fn block(lines: &[(usize, &str)]) -> Option<usize> {
    lines.iter().position(|(_, text)| is_block_line(text))
}

/// Returns whether a line stands above the accelerations.
pub(super) fn is_block_line(line: &str) -> bool {
    if line.starts_with('#') {
        return false;
    }
    let line = line.to_ascii_uppercase();
    line.contains("POINTS OF ACC") || line.contains("ACCELEROGRAM POINTS AT")
}

/// Reads the evenly spaced accelerations below line `index` of a channel.
pub(super) fn block_values(
    raw: &mut Raw,
    source: &FileText<'_>,
    lines: &[(usize, &str)],
    index: usize,
) -> Result<(), RecordError> {
    let (line, text) = lines.get(index).copied().unwrap_or((1, ""));
    let upper = text.to_ascii_uppercase();
    let error = |expected: &str| {
        let example = "as 3251 POINTS OF ACCEL DATA EQUALLY SPACED AT  .020 SEC.  (UNITS: CM/SEC/SEC)";
        source.header_error(line, text, format!("{expected} {example}"))
    };
    let value = upper.split_whitespace().next().and_then(|word| word.parse().ok());
    raw.count = Some(StatedCount { line, key: "POINTS", value: value.ok_or_else(|| error("a count of values"))? });
    let after = |key: &str| upper.split_once(key).map(|(_, rest)| rest.trim());
    let step = match after("SPACED AT") {
        Some(step) => step.split_whitespace().next().and_then(number),
        None => after("POINTS AT").and_then(|rate| number(rate.split_whitespace().next()?)).map(|rate| 1.0 / rate),
    };
    raw.time_step = Some(StatedStep::exact(line, step.ok_or_else(|| error("a time step"))?));

    let stated = ["UNITS:", "IN UNITS OF", "IN UNITS", ", IN"].into_iter().find_map(after);
    let unit = match stated {
        // The Fortran format may follow.
        Some(unit) => Some((line, unit.split([')', '(', ' ']).next().unwrap_or("").trim_end_matches('.').to_owned())),
        None => peak(lines, "PEAK ACCELERATION").map(|(peak, unit)| (peak.line, unit)),
    };
    let (unit_line, unit) = unit.ok_or_else(|| error("a unit"))?;
    let unit = source.unit(unit_line, &unit)?.ok_or_else(|| error("a unit"))?;
    raw.unit = Some((unit_line, unit));
    raw.peak = peak(lines, "PEAK ACCELERATION").or_else(|| peak(lines, "MAX")).and_then(|peak| converted(peak, unit));

    let rows = lines.get(index + 1..).unwrap_or_default();
    let width = match after("(8F").and_then(|format| format.split('.').next()?.parse().ok()) {
        Some(width) => width,
        // Eight columns fill a line.
        None => rows.first().map_or(10, |(_, text)| if text.trim_end().len() == 72 { 9 } else { 10 }),
    };
    let block = before_end_mark(rows, 0).take_while(|(_, text)| !text.to_ascii_uppercase().contains("POINTS OF "));
    raw.values = fixed_columns(source, block, width)?;
    Ok(())
}

/// Reads the pairs of a channel of volume 1, whose times must be evenly spaced.
pub(super) fn pairs(raw: &mut Raw, source: &FileText<'_>, lines: &[(usize, &str)]) -> Result<(), RecordError> {
    let (start, _) = lines.first().copied().unwrap_or((1, ""));
    let missing = |expected: &str| {
        source.header_error(start, "the header of a channel", format!("{expected} in its first {TEXT_LINES} lines"))
    };
    raw.count = Some(points(lines).ok_or_else(|| missing("a count as NO. OF POINTS = 12080"))?);
    let (line, unit) = unit_of_pairs(source, lines)?.ok_or_else(|| missing("units as SEC AND G/10"))?;
    raw.unit = Some((line, unit));
    raw.peak = peak(lines, "MAX").and_then(|peak| converted(peak, unit));

    let (mut axis, mut values) = (TimeAxis::new(), Values::new(source));
    for (line, text) in before_end_mark(lines, HEADER_LINES) {
        let text = text.trim_end();
        // The first column may be wider by a blank.
        let text = if text.len() % PAIR_WIDTH == 1 { text.strip_prefix(' ').unwrap_or(text) } else { text };
        let fields: Vec<&str> = fixed_width(text, PAIR_WIDTH).collect();
        for pair in fields.chunks(2) {
            let &[time, acceleration] = pair else {
                return Err(source.header_error(line, text, "pairs of a time and an acceleration, 7 characters each"));
            };
            axis.push(line, source.number(line, time)?, print_quantum(time));
            values.push(line, acceleration)?;
        }
    }
    raw.values = values.finish()?;
    (raw.start_time, raw.time_step) = axis.even_spacing(source).map_err(|error| match (error, axis.farthest()) {
        (RecordError::UnevenTime { .. }, Some((line, found, expected, step))) => {
            let found = format!(
                "an uncorrected accelerogram (volume 1) whose times are not evenly spaced: {found} s, where steps of {step:.6} s give {expected:.3} s"
            );
            source.not_supported(line, &found, "the corrected record (volume 2)")
        }
        (error, _) => error,
    })?;
    Ok(())
}

/// Returns the count in a line such as `NO. OF POINTS =  12080  RECORD LENGTH = 59.998 SEC`.
pub(super) fn points(lines: &[(usize, &str)]) -> Option<StatedCount> {
    let (line, rest) = value_of(lines, "NO. OF POINTS")?;
    let value = rest.split_whitespace().next()?.parse().ok()?;
    Some(StatedCount { line, key: "NO. OF POINTS", value })
}

/// Returns the text after a key and `=` in the header of a channel, in any case.
pub(super) fn value_of<'s>(lines: &[(usize, &'s str)], key: &str) -> Option<(usize, &'s str)> {
    lines.iter().take(TEXT_LINES).find_map(|&(line, text)| {
        // Upper case of ASCII has the same length.
        let start = text.to_ascii_uppercase().find(key)?;
        Some((line, text.get(start + key.len()..)?.trim_start().strip_prefix('=')?))
    })
}

/// Returns the unit in a line such as `UNITS OF UNCOR ACCEL ARE SEC AND G/10.`.
pub(super) fn unit_of_pairs(
    source: &FileText<'_>,
    lines: &[(usize, &str)],
) -> Result<Option<(usize, Unit)>, RecordError> {
    let stated = lines.iter().take(TEXT_LINES).find_map(|&(line, text)| {
        let upper = text.trim_start().to_ascii_uppercase();
        let (_, unit) = upper.strip_prefix("UNITS ")?.split_once(" AND ")?;
        Some((line, unit.split_whitespace().next()?.trim_end_matches('.').to_owned()))
    });
    let Some((line, unit)) = stated else { return Ok(None) };
    Ok(source.unit(line, &unit)?.map(|unit| (line, unit)))
}

/// Returns a peak with its unit, as in `MAX  = -0.030 G, AT  23.180 SEC`.
fn peak(lines: &[(usize, &str)], key: &str) -> Option<(StatedPeak, String)> {
    let (line, rest) = value_of(lines, key)?;
    let mut words = rest.split_whitespace();
    let peak = StatedPeak::printed(line, words.next()?)?;
    Some((peak, words.next()?.trim_end_matches([',', '.']).to_owned()))
}

/// Converts a peak of the header to the unit of the values.
fn converted((peak, stated): (StatedPeak, String), unit: Unit) -> Option<StatedPeak> {
    // Any gravity: peaks in g are of values in g or a tenth of it.
    let stated: Unit = stated.parse().ok()?;
    let same_kind = stated == unit || matches!((stated, unit), (Unit::G, Unit::TenthOfG));
    same_kind.then(|| peak.times(stated.factor(1.0) / unit.factor(1.0)))
}
