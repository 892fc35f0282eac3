//! Files of the European Strong-Motion Database and of ISESD (".cor", ".raw"): lines `key: value` and comments, then blocks of
//! accelerations, velocities and displacements, each below a line such as `-> corrected acceleration time histories`.

use super::claims::StatedStep;
use super::error::RecordError;
use super::format::Format;
use super::raw::{Raw, StatedCount};
use super::text::{FileText, Values, squeezed};

/// Beginning of the line above a block.
const BLOCK: &str = "->";

/// Returns whether a line stands above the accelerations.
pub(super) fn is_header_line(line: &str) -> bool {
    line.starts_with(BLOCK) && line.contains("acceleration time histor")
}

/// Reads the block of accelerations.
pub(super) fn read(source: &FileText<'_>) -> Result<Raw, RecordError> {
    let mut raw = Raw::new(Format::Esd);
    let mut title = Vec::new();
    let mut lines = source.lines();
    let mut last = 1;
    for (line, text) in lines.by_ref().take_while(|(_, text)| !is_header_line(text)) {
        last = line;
        let Some((key, value)) = text.split_once(':').map(|(key, value)| (key.trim(), value.trim())) else { continue };
        match key {
            "station code" | "earthquake code" | "waveform code" => title.push(squeezed(text)),
            "orientation of transducer" => title.push(squeezed(value)),
            "sampling period" => {
                let step = value.trim_end_matches(|c: char| c.is_alphabetic()).trim_end();
                raw.time_step = Some(StatedStep::exact(line, source.number(line, step)?));
            }
            "number of samples" => {
                let value = value.parse().map_err(|_| source.header_error(line, text, "a count of values"))?;
                raw.count = Some(StatedCount { line, key: "number of samples", value });
            }
            // Of accelerations, velocities and displacements.
            "units" => {
                let unit = value.split([',', '&']).next().unwrap_or("").trim();
                raw.unit = Some(source.stated_unit(line, text, unit, "units as m/s*s, m/s & m")?);
            }
            _ => {}
        }
    }
    let missing = |key: &str| source.missing_line(last, key);
    if raw.time_step.is_none() || raw.count.is_none() || raw.unit.is_none() {
        return Err(missing("each of \"sampling period:\", \"number of samples:\" and \"units:\""));
    }
    raw.title = title.join(", ");
    let mut values = Values::new(source);
    for (line, text) in lines.take_while(|(_, text)| !text.starts_with(BLOCK) && text.trim() != "STOP") {
        for field in text.split_whitespace() {
            values.push(line, field)?;
        }
    }
    raw.values = values.finish()?;
    Ok(raw)
}
