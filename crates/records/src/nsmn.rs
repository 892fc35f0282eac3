//! Text files of the National Strong-Motion Network of Turkey, before DYNA: lines `KEY : value`, then rows of three components in gal.

use super::channels;
use super::claims::StatedStep;
use super::error::RecordError;
use super::format::Format;
use super::options::Choice;
use super::raw::{Raw, StatedCount, StatedPeak};
use super::rows::Rows;
use super::text::{FileText, number};

/// Key of the largest accelerations, with their unit in brackets.
const PEAKS: &str = "RAW PGA VALUES (";

/// Returns whether a line is the one common to all headers.
pub(super) fn is_header_line(line: &str) -> bool {
    line.starts_with(PEAKS)
}

/// Reads one component.
pub(super) fn read(source: &FileText<'_>, wanted: Option<&Choice>) -> Result<Raw, RecordError> {
    let mut raw = Raw::new(Format::Nsmn);
    let (mut names, mut peaks, mut title): (Vec<&str>, Vec<&str>, Vec<&str>) = Default::default();
    let mut lines = source.lines().peekable();
    let mut peak_line = 1;
    while let Some((line, text)) = lines.next_if(|(_, text)| text.split_whitespace().next().and_then(number).is_none())
    {
        let Some((key, value)) = text.split_once(':').map(|(key, value)| (key.trim(), value.trim())) else {
            // The last line without a key names the columns.
            names = text.split_whitespace().collect();
            continue;
        };
        match key {
            "PLACE" | "EARTHQUAKE DATE" | "STATION ID" => title.push(value),
            "NUMBER OF DATA" => {
                let value = value.parse().map_err(|_| source.header_error(line, text, "a count of values"))?;
                raw.count = Some(StatedCount { line, key: "NUMBER OF DATA", value });
            }
            "SAMPLING INTERVAL (sec)" => raw.time_step = Some(StatedStep::exact(line, source.number(line, value)?)),
            _ => {
                let Some(unit) = text.strip_prefix(PEAKS).and_then(|rest| rest.split(')').next()) else { continue };
                peak_line = line;
                peaks = value.split_whitespace().collect();
                raw.unit = Some(source.stated_unit(line, text, unit, "a unit as RAW PGA VALUES (gal)")?);
            }
        }
    }
    let chosen = channels::index(source, &names, wanted)?;
    let name = names.get(chosen).copied().unwrap_or_default();
    let peak =
        peaks.iter().position(|word| word.trim_matches(['(', ')']) == name).and_then(|index| peaks.get(index + 1));
    raw.peak = peak.and_then(|peak| StatedPeak::printed(peak_line, peak));
    title.push(name);
    raw.title = title.join(", ");
    let rows = Rows { columns: names.len(), time: None, chosen };
    (raw.values, _) = rows.read(source, lines, str::split_whitespace)?;
    Ok(raw)
}
