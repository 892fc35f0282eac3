//! Columns of numbers after optional lines of text: acceleration alone, or time and acceleration among others.
//!
//! Commas, semicolons, tabs or blanks separate the columns.

use super::claims::{self, Claim};
use super::clock::Instant;
use super::error::RecordError;
use super::format::Format;
use super::options::{Choice, ReadOptions, Setting};
use super::raw::Raw;
use super::table::{Heading, Layout, Separator, blank_separated, is_block, is_comment, is_second, layout};
use super::text::{FileText, HEAD_LINES, Values, first_of, print_quantum, quoted};
use super::time_axis::TimeAxis;
use super::unit::other_quantity;

/// Number of values from which a first number may be their count. It is a count if it is equal, and no acceleration.
const FEWEST_COUNTED: usize = 20;

/// Value of a layout in messages.
const LAYOUT_EXAMPLE: &str =
    "as 10F8.2, with the lines to skip before the numbers and npts, the count of them, if others follow";

/// Reads the acceleration column and an optional time column, which must be evenly spaced.
pub(super) fn read(source: &FileText<'_>, options: &ReadOptions) -> Result<Raw, RecordError> {
    let layout = layout(source)?;
    let (time, acceleration) = choose(source, &layout, options)?;
    let mut raw = Raw::new(Format::Columns);
    raw.title.clone_from(&layout.title);
    state_claims(&mut raw, source, &layout, acceleration)?;
    if time.is_none() && is_block_under_text(source, &layout) {
        let width = layout.width;
        raw.doubt = Some(format!(
            "line {} has {width} numbers without names below text, as in reading order, and column {} of them was read; a layout reads all",
            layout.first_row,
            acceleration + 1
        ));
    }
    let is_date = time.is_some() && time == layout.dates;
    if !is_date {
        check_seconds(source, &layout, time)?;
    }

    let mut axis = TimeAxis::new();
    let mut values = Values::new(source);
    let mut first: Option<Instant> = None;
    let mut visit = |line: usize, width: usize, time: Option<&str>, acceleration: &str| {
        if width != layout.width {
            let expected = format!("{} columns as in line {}", layout.width, layout.first_row);
            return Err(source.header_error(line, &format!("{width} columns"), expected));
        }
        if let Some(time) = time {
            match Instant::parse(time).filter(|_| is_date) {
                // Times of day count from the first one.
                Some(instant) => axis.push(line, instant.since(*first.get_or_insert(instant)), instant.quantum),
                None if is_date => {
                    return Err(source.header_error(line, time, "a date and a time as 2024-08-08T16:43:15.25"));
                }
                None => axis.push(line, source.number(line, time)?, print_quantum(time)),
            }
        }
        values.push(line, acceleration)
    };
    match layout.separator {
        Separator::Blanks => {
            for (line, text) in source.lines().skip(layout.first_row.saturating_sub(1)) {
                if text.trim().is_empty() || is_comment(text) {
                    continue;
                }
                let fields = blank_separated(text);
                let field = |index: usize| fields.get(index).copied().unwrap_or("");
                visit(line, fields.len(), time.map(field), field(acceleration))?;
            }
        }
        Separator::Byte(separator) => {
            delimited(source, layout.first_row, separator, |line, fields| {
                let width = fields.len() - fields.iter().rev().take_while(|field| field.is_empty()).count();
                let field = |index: usize| layout.separator.with_points(fields.get(index).copied().unwrap_or(""));
                visit(line, width, time.map(field).as_deref(), &field(acceleration))
            })?;
        }
    }
    (raw.start_time, raw.time_step) = axis.even_spacing(source)?;
    raw.values = values.finish()?;
    if let [first, after @ ..] = raw.values.as_slice()
        && time.is_none()
        && after.len() >= FEWEST_COUNTED
        && *first == after.len() as f64
    {
        return Err(source.header_error(
            layout.first_row,
            &format!("{first}, the count of the values after it"),
            "an acceleration",
        ));
    }
    Ok(raw)
}

/// Checks that the heading of the time column names no unit other than seconds.
fn check_seconds(source: &FileText<'_>, layout: &Layout<'_>, time: Option<usize>) -> Result<(), RecordError> {
    let unit = time.and_then(|index| layout.names.get(index)).and_then(|name| name.unit);
    match unit {
        Some(unit) if !is_second(unit) => Err(source.header_error(layout.header, unit, "times in seconds, as t [s]")),
        Some(_) | None => Ok(()),
    }
}

/// Passes every row of a delimited file to `visit` with its line number. The first is line `first`.
fn delimited(
    source: &FileText<'_>,
    first: usize,
    separator: u8,
    mut visit: impl FnMut(usize, &[&str]) -> Result<(), RecordError>,
) -> Result<(), RecordError> {
    if !source.text.contains('"') {
        // Without quotes every separator separates.
        let mut fields = Vec::new();
        for (line, text) in source.lines().skip(first.saturating_sub(1)) {
            if text.starts_with('#') {
                continue;
            }
            fields.clear();
            fields.extend(text.split(char::from(separator)).map(str::trim));
            if fields.iter().any(|field| !field.is_empty()) {
                visit(line, &fields)?;
            }
        }
        return Ok(());
    }
    // With one kind of line end, also on the last line, the line count of the reader is that of the file.
    let mut rows = String::with_capacity(source.text.len() + 1);
    for (_, text) in source.lines().skip(first.saturating_sub(1)) {
        rows.push_str(text);
        rows.push('\n');
    }
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(rows.as_bytes());
    let mut fields = csv::StringRecord::new();
    loop {
        let more = reader.read_record(&mut fields);
        let line = first + usize::try_from(reader.position().line()).unwrap_or(usize::MAX).saturating_sub(2);
        match more {
            Ok(false) => return Ok(()),
            Ok(true) if fields.iter().all(str::is_empty) => {}
            Ok(true) => visit(line, &fields.iter().collect::<Vec<_>>())?,
            Err(error) => {
                return Err(source.header_error(line, &error.to_string(), "delimited columns"));
            }
        }
    }
}

/// Returns the indices of the optional time column and of the acceleration column.
fn choose(
    source: &FileText<'_>,
    layout: &Layout<'_>,
    options: &ReadOptions,
) -> Result<(Option<usize>, usize), RecordError> {
    let Layout { names, width, header, .. } = layout;
    let error = |but: String, setting: Setting| {
        let columns = first_of(&names.iter().map(|name| name.whole).collect::<Vec<_>>());
        let (named, or) = match names.as_slice() {
            [] => (String::from("without names"), ""),
            _ => (format!("named {columns}"), " or a name"),
        };
        let (plural, last) = if *width == 1 { ("", String::new()) } else { ("s", format!(" to {width}")) };
        let found = format!("found {width} column{plural} {named}, {but}");
        source.needs_setting(Some(*header), found, setting, format!("1{last}{or}"))
    };
    let index_of = |column: &Choice, setting: Setting| {
        let index = match column {
            Choice::Number(number) => number.checked_sub(1).filter(|index| index < width),
            Choice::Name(name) => {
                names.iter().position(|n| [n.whole, n.word].iter().any(|n| n.eq_ignore_ascii_case(name)))
            }
        };
        index.ok_or_else(|| error(format!("not {}", column.described("column")), setting))
    };
    let chosen = options.acceleration_column.as_ref().map(|column| index_of(column, Setting::AccelerationColumn));
    let chosen = chosen.transpose()?;
    let time = match &options.time_column {
        Some(column) => Some(index_of(column, Setting::TimeColumn)?),
        None if *width == 1 => None,
        None if layout.dates.is_some() => layout.dates,
        None if !names.is_empty() => names.iter().position(Heading::is_time),
        // Without names the first column is time, unless a given time step makes a table of accelerations possible.
        None => (*width == 2 || *width > 2 && options.time_step.is_none()).then_some(0),
    };
    let time = time.filter(|&index| Some(index) != chosen);
    if let Some(chosen) = chosen {
        return Ok((time, chosen));
    }
    let others: Vec<usize> = (0..*width).filter(|&index| Some(index) != time).collect();
    let named: Vec<usize> =
        others.iter().copied().filter(|&index| names.get(index).is_some_and(Heading::is_acceleration)).collect();
    match (others.as_slice(), named.as_slice()) {
        (&[only], _) | (_, &[only]) => Ok((time, only)),
        _ if is_block_under_text(source, layout) => {
            let found = format!(
                "found {width} numbers a line under a header of text that is of no known format ({}) and names no columns",
                Format::NAMES
            );
            Err(source.needs_setting(Some(layout.first_row), found, Setting::Layout, LAYOUT_EXAMPLE))
        }
        _ => {
            let but = String::from("but no clear acceleration column");
            Err(error(but, Setting::AccelerationColumn))
        }
    }
}

/// Returns whether text without names precedes numbers that look like a block in reading order.
fn is_block_under_text(source: &FileText<'_>, layout: &Layout<'_>) -> bool {
    let rows: Vec<&str> =
        source.lines().skip(layout.first_row.saturating_sub(1)).take(HEAD_LINES).map(|(_, line)| line).collect();
    layout.names.is_empty() && layout.header < layout.first_row && is_block(&rows)
}

/// Takes the claims of heading and text. The heading of the values' own column is definite; those of the others say nothing of it.
fn state_claims(
    raw: &mut Raw,
    source: &FileText<'_>,
    layout: &Layout<'_>,
    acceleration: usize,
) -> Result<(), RecordError> {
    let is_heading = |line: usize| layout.width > 1 && layout.headings.contains(&line);
    let before = source.lines().take(layout.first_row.saturating_sub(1));
    raw.claims = claims::of_text(before.filter(|&(line, _)| !is_heading(line)));
    let Some(name) = layout.names.get(acceleration) else { return Ok(()) };
    if name.is_other_quantity() {
        let found = format!("a column named {}", quoted(name.whole));
        return Err(source.not_acceleration(layout.header, found));
    }
    let Some(unit) = name.unit else { return Ok(()) };
    match (unit.parse(), other_quantity(unit)) {
        (Ok(unit), _) => raw.unit = Some((layout.header, unit)),
        (Err(_), Some(quantity)) => raw.claims.push(Claim::other(layout.header, name.whole, quantity)),
        (Err(_), None) if name.is_acceleration() => {
            return Err(source.header_error(layout.header, name.whole, "a unit among g, m/s2, cm/s2"));
        }
        // A title rather than a column name, as "Tabas (Iran)".
        (Err(_), None) => {}
    }
    Ok(())
}
