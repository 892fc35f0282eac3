//! Files of the China Strong Motion Networks Centre: lines of text with unit, count, interval and peak, then eight values a line.

use super::claims::StatedStep;
use super::error::RecordError;
use super::format::Format;
use super::raw::{Raw, StatedCount, StatedPeak};
use super::text::{FileText, HEAD_LINES, Values, number, quoted, squeezed};

/// Returns whether a line is the one common to all headers.
pub(super) fn is_header_line(line: &str) -> bool {
    line.trim_start().starts_with("NO. OF POINTS:") && line.contains("INTERVALS OF:")
}

/// Reads the component of the file; refuses velocities and displacements.
pub(super) fn read(source: &FileText<'_>) -> Result<Raw, RecordError> {
    let mut raw = Raw::new(Format::Csmnc);
    let mut title = Vec::new();
    let header = source
        .lines()
        .take(HEAD_LINES)
        .take_while(|(_, text)| text.split_whitespace().next().and_then(number).is_none() || text.contains(':'));
    let mut last = 1;
    for (line, text) in header {
        last = line;
        let after = |key: &str| text.split_once(key).map(|(_, rest)| rest.trim());
        let first_word = |text: &str| text.split_whitespace().next().unwrap_or("").to_owned();
        if let Some(unit) = after("UNIT:") {
            if !text.contains("ACCELERATION") {
                return Err(source.not_acceleration(line, quoted(text)));
            }
            raw.unit = Some(source.stated_unit(line, text, unit, "a unit as CM/SEC/SEC")?);
        } else if let (Some(count), Some(step)) = (after("NO. OF POINTS:"), after("INTERVALS OF:")) {
            let value = first_word(count).parse().map_err(|_| source.header_error(line, text, "a count of values"))?;
            raw.count = Some(StatedCount { line, key: "NO. OF POINTS", value });
            raw.time_step = Some(StatedStep::exact(line, source.number(line, &first_word(step))?));
        } else if let Some(peak) = after("PEAK VALUE:") {
            raw.peak = StatedPeak::printed(line, &first_word(peak));
        } else if let Some(name) = after("STATION:").or_else(|| after("COMP.")) {
            title.push(squeezed(name));
        }
    }
    if raw.unit.is_none() {
        return Err(source.missing_line(last, "with UNIT:"));
    }
    // The first line with a comma names the earthquake.
    title.extend(source.head().iter().take(last).find(|text| text.contains(',')).map(|text| squeezed(text)));
    raw.title = title.join(", ");
    let mut values = Values::new(source);
    for (line, text) in source.lines().skip(last) {
        for field in text.split_whitespace() {
            values.push(line, field)?;
        }
    }
    raw.values = values.finish()?;
    Ok(raw)
}
