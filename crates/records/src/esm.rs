//! ASC files of the Engineering Strong-Motion database, of ITACA, and of AFAD (DYNA): lines `KEY: value`, then one value a line.

use super::claims::StatedStep;
use super::error::RecordError;
use super::format::Format;
use super::raw::{Raw, StatedCount, StatedPeak};
use super::text::{FileText, Values, number, quoted};
use super::unit::Unit;

/// Returns whether a line is the one common to all headers.
pub(super) fn is_header_line(line: &str) -> bool {
    line.starts_with("SAMPLING_INTERVAL_S:")
}

/// Reads one component; refuses data types other than ACCELERATION.
pub(super) fn read(source: &FileText<'_>) -> Result<Raw, RecordError> {
    let mut raw = Raw::new(Format::Esm);
    let mut values = Values::new(source);
    let mut title = Vec::new();
    let mut in_header = true;
    for (line, text) in source.lines() {
        let text = text.trim();
        in_header &= text.is_empty() || number(text).is_none();
        if !in_header {
            for token in text.split_whitespace() {
                values.push(line, token)?;
            }
            continue;
        }
        let Some((key, value)) = text.split_once(':').map(|(key, value)| (key, value.trim())) else {
            if text.is_empty() {
                continue;
            }
            return Err(source.header_error(line, text, "a header line KEY: value, or a number"));
        };
        match key {
            "EVENT_NAME" | "NETWORK" | "STATION_CODE" | "STATION_NAME" | "STREAM" if !value.is_empty() => {
                title.push(value)
            }
            "NDATA" => {
                let value = value.parse().map_err(|_| source.header_error(line, text, "a count of values"))?;
                raw.count = Some(StatedCount { line, key: "NDATA", value });
            }
            "SAMPLING_INTERVAL_S" => {
                let value = number(value).ok_or_else(|| source.header_error(line, text, "a time step in seconds"))?;
                raw.time_step = Some(StatedStep::exact(line, value));
            }
            "UNITS" => {
                raw.unit = Some(source.stated_unit(line, text, value, "a unit among g, m/s2, cm/s2")?);
            }
            "PGA_CM/S^2" => raw.peak = StatedPeak::printed(line, value),
            // In lower case from DYNA 1.2 of AFAD.
            "DATA_TYPE" if !value.is_empty() && !value.eq_ignore_ascii_case("ACCELERATION") => {
                return Err(source.not_acceleration(line, quoted(text)));
            }
            _ => {}
        }
    }
    // The peak is in cm/s² whatever the unit of the values.
    raw.peak = raw.peak.filter(|_| raw.unit.is_some_and(|(_, unit)| unit == Unit::CentimetrePerSecondSquared));
    raw.title = title.join(", ");
    raw.values = values.finish()?;
    Ok(raw)
}
