//! COSMOS files, volumes 1 and 2 (".V1", ".V2", ".V2c"): lines of text, integers, reals and comments, each part
//! announced by a line with its length and Fortran format, then the values of one or more channels.
//!
//! "COSMOS Strong Motion Data Format", Consortium of Organizations for Strong-Motion Observation Systems, 2001.

use super::channels::{self, name_after_number};
use super::claims::StatedStep;
use super::error::RecordError;
use super::format::Format;
use super::options::Choice;
use super::raw::{Raw, StatedCount, StatedPeak};
use super::text::{FileText, before_end_mark, fixed_columns, fixed_width, quoted, title};

/// Index of the time step (ms) within the real header.
const TIME_STEP: usize = 61;

/// Returns whether the first line of a file names the format. It does as in "Corrected acceleration    (Format v01.20 with 13 text lines)".
pub(super) fn is_first_line(line: &str) -> bool {
    let line = line.to_ascii_lowercase();
    line.contains("(format v") && line.contains("text lines")
}

/// Reads a channel; refuses raw counts, velocities, displacements and spectra.
pub(super) fn read(source: &FileText<'_>, wanted: Option<&Choice>) -> Result<Raw, RecordError> {
    // "Sta Chan   1: 90 Deg (Rcrdr Chan  ?) Location:Basement"
    let name = |lines: &[(usize, &str)]| lines.get(8).and_then(|(_, text)| name_after_number(text));
    let lines = &channels::choose(source, wanted, name)?;
    let mut raw = Raw::new(Format::Cosmos);
    let (start, first) = lines.first().copied().unwrap_or((1, ""));
    if !first.to_ascii_lowercase().contains("acceleration") || first.to_ascii_lowercase().contains("counts") {
        return Err(source.not_acceleration(start, format!("a COSMOS file of the kind {}", quoted(first))));
    }
    // Line 2: earthquake; line 5: station; line 9: channel.
    raw.title = title(lines, &[1, 4, 8]);

    let announced = |key: &str| {
        let index = lines.iter().position(|(_, text)| text.to_ascii_lowercase().contains(key));
        index.and_then(|index| lines.get(index).map(|&(line, text)| (index, line, text)))
    };
    let missing =
        |expected: &str| source.header_error(start, first, format!("a COSMOS file, with a line \"{expected}\""));

    let (index, line, text) =
        announced("real-header values follow").ok_or_else(|| missing("… Real-header values follow …"))?;
    let width = width_of_format(text).ok_or_else(|| source.header_error(line, text, "a format as Format= (6F13.6)"))?;
    let reals = lines.iter().skip(index + 1);
    let mut reals = reals.flat_map(|&(line, text)| fixed_width(text, width).map(move |field| (line, field)));
    let (line, field) = reals.nth(TIME_STEP).unwrap_or((line, ""));
    let time_step = source
        .number(line, field)
        .map_err(|_| source.header_error(line, field, "the time step in milliseconds (real header, 62nd value)"))?;
    // Unknown values are -999.
    if time_step > 0.0 {
        raw.time_step = Some(StatedStep::exact(line, time_step / 1000.0));
    }

    let (index, line, text) = announced("units=")
        .filter(|(.., text)| text.to_ascii_lowercase().contains("format="))
        .ok_or_else(|| missing("7000  acceleration pts, …, units=cm/sec2(04),Format=(8F10.5)"))?;
    let expected = "as 7000  acceleration pts, …, units=cm/sec2(04),Format=(8F10.5)";
    if !text.to_ascii_lowercase().contains("acceleration") {
        return Err(source.not_acceleration(line, quoted(text)));
    }
    let count = text.split_whitespace().next().and_then(|word| word.parse().ok());
    let value = count.ok_or_else(|| source.header_error(line, text, format!("a count of values {expected}")))?;
    raw.count = Some(StatedCount { line, key: "acceleration pts", value });
    let width = width_of_format(text).ok_or_else(|| source.header_error(line, text, format!("a format {expected}")))?;
    let unit = text.split_once("units=").map_or("", |(_, rest)| rest.split(['(', ',']).next().unwrap_or(""));
    let unit = source.stated_unit(line, text, unit.trim().trim_end_matches('.'), &format!("a unit {expected}"))?;
    raw.unit = Some(unit);

    // "Processed: 06/17/2005, PDT      Max =  -161.962 cm/sec2  at  27.850 sec"
    raw.peak = lines.get(10).and_then(|&(line, text)| {
        let mut words = text.split_once("Max =")?.1.split_whitespace();
        let peak = StatedPeak::printed(line, words.next()?)?;
        (words.next()?.parse() == Ok(unit.1)).then_some(peak)
    });

    raw.values = fixed_columns(source, before_end_mark(lines, index + 1), width)?;
    Ok(raw)
}

/// Returns the width 13 of "… Format= (6F13.6)".
fn width_of_format(line: &str) -> Option<usize> {
    let line = line.to_ascii_lowercase();
    let (_, format) = line.rsplit_once("format=")?;
    let format = format.trim().strip_prefix('(')?.trim_start_matches(|c: char| c.is_ascii_digit());
    let width = format.strip_prefix(['f', 'e', 'i', 'g'])?.split(['.', ')']).next()?;
    width.parse().ok().filter(|&width| width > 0)
}
