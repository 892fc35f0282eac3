//! SMC files of the U.S. Geological Survey: 11 lines of text, 48 integers (8I10), 50 reals (5E15.7), comment lines
//! that start with `|`, then the values in cm/s² (8(1PE10.4E1), without blanks between them).
//!
//! "SMC- and BBF-format data files", USGS National Strong-Motion Program.

use super::claims::StatedStep;
use super::error::RecordError;
use super::format::Format;
use super::raw::{Raw, StatedCount};
use super::text::{FileText, fixed_columns, fixed_width, quoted, title};
use super::unit::Unit;

const TEXT_LINES: usize = 11;
const INTEGER_LINES: usize = 6;
const REAL_LINES: usize = 10;

/// Indices within the headers.
const COMMENT_COUNT: usize = 15;
const VALUE_COUNT: usize = 16;
const UNDEFINED: usize = 0;
const SAMPLING_RATE: usize = 1;

/// Highest plausible sampling rate [1/s]; some headers have nonsensical ones.
const LARGEST_SAMPLING_RATE: f64 = 1e5;

/// Number of increasing times that tell pairs from accelerations.
const PAIRS: usize = 16;

/// Returns whether a line begins an SMC file: a digit and the name of its kind.
pub(super) fn is_first_line(line: &str) -> bool {
    let kinds = ["ACCELEROGRAM", "VELOCITY", "DISPLACEMENT", "RESPONSE SPECTR", "FOURIER"];
    let line = line.trim().to_ascii_uppercase();
    line.starts_with(|c: char| c.is_ascii_digit())
        && line
            .get(1..)
            .is_some_and(|rest| rest.starts_with([' ', '\t']) && kinds.iter().any(|kind| rest.contains(kind)))
}

/// Reads a corrected or uncorrected accelerogram; refuses velocities, displacements and spectra.
pub(super) fn read(source: &FileText<'_>) -> Result<Raw, RecordError> {
    let mut raw = Raw::new(Format::Smc);
    raw.unit = Some((1, Unit::CentimetrePerSecondSquared));
    let mut lines = source.lines();
    let text: Vec<(usize, &str)> = lines.by_ref().take(TEXT_LINES).collect();
    let kind = text.first().map_or("", |(_, text)| text);
    if !kind.to_ascii_uppercase().contains("ACCELEROGRAM") {
        return Err(source.not_acceleration(1, format!("an SMC file of the kind {}", quoted(kind))));
    }
    // Line 4: date and earthquake; line 6: "station = … component = …".
    raw.title = title(&text, &[3, 5]);

    let mut header = |count: usize, width: usize| -> Vec<(usize, &str)> {
        let rows = lines.by_ref().take(count);
        rows.flat_map(|(line, text)| fixed_width(text, width).map(move |field| (line, field))).collect()
    };
    let (integers, reals) = (header(INTEGER_LINES, 10), header(REAL_LINES, 15));
    let count = |index: usize, expected: &str| {
        let (line, field) = integers.get(index).copied().unwrap_or((TEXT_LINES + 1, ""));
        field.parse::<usize>().map(|value| (line, value)).map_err(|_| source.header_error(line, field, expected))
    };
    let real = |index: usize, expected: &str| {
        let (line, field) = reals.get(index).copied().unwrap_or((TEXT_LINES + INTEGER_LINES + 1, ""));
        source.number(line, field).map(|value| (line, value)).map_err(|_| source.header_error(line, field, expected))
    };
    let (_, comments) = count(COMMENT_COUNT, "the count of comment lines (integer header, 16th value)")?;
    let (line, value) = count(VALUE_COUNT, "the count of values (integer header, 17th value)")?;
    raw.count = Some(StatedCount { line, key: "17th integer", value });
    let (_, undefined) = real(UNDEFINED, "the number that stands for undefined (real header, 1st value)")?;
    let (line, rate) = real(SAMPLING_RATE, "the sampling rate (real header, 2nd value)")?;
    if rate != undefined {
        if !(rate > 0.0 && rate <= LARGEST_SAMPLING_RATE) {
            return Err(source.header_error(
                line,
                &rate.to_string(),
                "a sampling rate above 0 and up to 1e5 per second",
            ));
        }
        raw.time_step = Some(StatedStep::exact(line, 1.0 / rate));
    }

    for (line, text) in lines.by_ref().take(comments) {
        if !text.starts_with('|') {
            return Err(source.header_error(line, text, format!("one of {comments} comment lines that start with |")));
        }
    }
    raw.values = fixed_columns(source, lines, 10)?;
    // Times and accelerations alternate in records of digitized film, which are not evenly spaced.
    let times: Vec<f64> = raw.values.iter().copied().step_by(2).take(PAIRS).collect();
    if rate == undefined && times.len() == PAIRS && times.is_sorted_by(|a, b| a < b) {
        return Err(source.not_supported(
            line,
            "an SMC file without sampling rate, whose values are times and accelerations in turn",
            "the corrected record, which has a sampling rate",
        ));
    }
    Ok(raw)
}
