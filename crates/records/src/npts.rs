//! Files of programs: lines of text, a line of count and time step, then the values in reading order or below each other with their times.
//!
//! eqsig, RspMatch, SIV and others write `4000 0.01`, DEEPSOIL adds a column of times, and EMOD3D follows with six numbers of place and
//! time. No unit is stated, except in the text.

use super::claims::{self, StatedStep};
use super::error::RecordError;
use super::format::Format;
use super::raw::{Raw, StatedCount};
use super::text::{FileText, Values, is_end_mark, number, print_quantum, squeezed};
use super::time_axis::TimeAxis;

/// Numbers in the line of count and time step: these two alone, or those of EMOD3D.
const WIDTHS: [usize; 2] = [2, 8];

/// Longest time step (s).
const LONGEST_STEP: f64 = 1.0;

/// Relative difference below which a step of the times is that of the header; times are printed to a few digits.
const EQUAL_STEPS: f64 = 0.01;

/// Count and time step of a header.
struct Counted {
    /// Index of their line.
    index: usize,
    count: usize,
    time_step: f64,
    /// Whether times stand before the values.
    has_times: bool,
}

/// Finds the line of count and time step, the first one of numbers.
fn counted(head: &[&str]) -> Option<Counted> {
    let mut rows = head.iter().enumerate().filter_map(|(index, line)| Some((index, numbers(line)?)));
    let (index, first) = rows.next()?;
    let count: usize = fields(head.get(index)?).next()?.trim_end_matches('.').parse().ok()?;
    let time_step = first.get(1).copied().filter(|step| (0.0..=LONGEST_STEP).contains(step) && *step > 0.0)?;
    let (_, next) = rows.next()?;
    let after = rows.next().map(|(_, row)| row);
    let has_times = match (next.as_slice(), after.as_deref()) {
        ([before, _], Some([after, _])) => (after - before - time_step).abs() <= EQUAL_STEPS * time_step,
        _ => false,
    };
    let is_header = WIDTHS.contains(&first.len()) && (next.len() != first.len() || has_times) && count > 1;
    is_header.then_some(Counted { index, count, time_step, has_times })
}

fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.split(|c: char| c == ',' || c.is_whitespace()).filter(|field| !field.is_empty())
}

/// Returns the numbers of a line that has nothing else.
fn numbers(line: &str) -> Option<Vec<f64>> {
    let numbers: Option<Vec<f64>> = fields(line).map(number).collect();
    numbers.filter(|numbers| !numbers.is_empty())
}

/// Returns whether the first lines have a line of count and time step.
pub(super) fn is_head(head: &[&str]) -> bool {
    counted(head).is_some()
}

/// Reads the values of the one record in the file.
pub(super) fn read(source: &FileText<'_>) -> Result<Raw, RecordError> {
    let mut raw = Raw::new(Format::Npts);
    let head = source.head();
    let Some(Counted { index, count, time_step, has_times }) = counted(&head) else {
        return Err(source.header_error(
            1,
            head.first().unwrap_or(&""),
            "text, then a line of count and time step as 4000 0.01",
        ));
    };
    let line = index + 1;
    raw.count = Some(StatedCount { line, key: "count before the time step", value: count });
    raw.time_step = Some(StatedStep::exact(line, time_step));
    raw.claims = claims::of_text(source.lines().take(index));
    raw.title = head.iter().take(index).map(|text| squeezed(text)).find(|text| !text.is_empty()).unwrap_or_default();
    let (mut axis, mut values) = (TimeAxis::new(), Values::new(source));
    for (line, text) in source.lines().skip(line).take_while(|(_, text)| !is_end_mark(text)) {
        let mut fields = fields(text);
        if has_times && let Some(time) = fields.next() {
            axis.push(line, source.number(line, time)?, print_quantum(time));
            let value = fields.next().filter(|_| fields.next().is_none());
            values.push(line, value.ok_or_else(|| source.header_error(line, text, "a time and a value"))?)?;
            continue;
        }
        for field in fields {
            values.push(line, field)?;
        }
    }
    raw.values = values.finish()?;
    if has_times {
        let (start, step) = axis.even_spacing(source)?;
        raw.start_time = start;
        if let Some(step) = step.filter(|step| (step.value - time_step).abs() > step.tolerance) {
            let found = format!("times in steps of {} s, and a time step of {time_step} s in line {line}", step.value);
            return Err(source.line_error(step.line, format!("found {found}; expected one step")));
        }
    }
    Ok(raw)
}
