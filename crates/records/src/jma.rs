//! CSV files of the Japan Meteorological Agency: six lines of station, sampling rate, unit and time, then rows of three components.
//!
//! Of some years, all lines have the commas of eight columns, and the rate is that of `Sampling Freq`.

use super::channels;
use super::claims::StatedStep;
use super::error::RecordError;
use super::format::Format;
use super::options::Choice;
use super::raw::Raw;
use super::rows::Rows;
use super::text::{FileText, number, squeezed};

/// Returns whether a line is the first of a header.
pub(super) fn is_first_line(line: &str) -> bool {
    line.trim_start().strip_prefix("SITE CODE").is_some_and(|rest| rest.trim_start().starts_with('='))
}

/// Reads one component.
pub(super) fn read(source: &FileText<'_>, wanted: Option<&Choice>) -> Result<Raw, RecordError> {
    let mut raw = Raw::new(Format::Jma);
    let mut title = Vec::new();
    let mut lines = source.lines();
    let mut names = None;
    for (line, text) in lines.by_ref() {
        let Some((key, value)) = text.split_once('=').map(|(key, value)| (key.trim(), filled(value))) else {
            names = Some((line, text));
            break;
        };
        match key {
            "SITE CODE" => title.push(squeezed(value.split(',').next().unwrap_or(""))),
            "INITIAL TIME" => title.push(squeezed(value)),
            "SAMPLING RATE" | "Sampling Freq" => {
                let rate =
                    number(value.trim_end_matches(|c: char| c.is_alphabetic()).trim()).filter(|rate| *rate > 0.0);
                let rate =
                    rate.ok_or_else(|| source.header_error(line, text, "a sampling rate above 0 Hz, as 100Hz"))?;
                raw.time_step = Some(StatedStep::exact(line, 1.0 / rate));
            }
            "UNIT" => {
                let unit = value.split('(').next().unwrap_or("");
                raw.unit = Some(source.stated_unit(line, text, unit, "a unit as gal(cm/s/s)")?);
            }
            _ => {}
        }
    }
    let (line, text) = names.unwrap_or((1, ""));
    let names: Vec<String> = filled(text).split(',').map(|name| name.trim().to_owned()).collect();
    if names.iter().any(|name| name.is_empty() || number(name).is_some()) {
        return Err(source.header_error(line, text, "the names of the components, as NS,EW,UD"));
    }
    let chosen = channels::index(source, &names, wanted)?;
    title.extend(names.get(chosen).cloned());
    raw.title = title.join(", ");
    let rows = Rows { columns: names.len(), time: None, chosen };
    (raw.values, _) = rows.read(source, lines, |text| filled(text).split(',').map(str::trim))?;
    Ok(raw)
}

/// Removes the empty columns at the end of a line.
fn filled(text: &str) -> &str {
    text.trim_end_matches(|c: char| c == ',' || c.is_whitespace()).trim_start()
}
