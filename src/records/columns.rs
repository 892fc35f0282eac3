//! Columns of numbers, with or without lines of text before them: acceleration alone, or time and acceleration among
//! others, separated by commas, semicolons, tabs or blanks.

use std::{borrow::Cow, convert::Infallible, fmt, str::FromStr};

use super::raw::Raw;
use super::table::{Layout, Name, Separator, is_comment, layout};
use super::text::{Source, Values, print_quantum, quoted};
use super::time_axis::TimeAxis;
use super::unit::other_quantity;
use super::{Format, ReadOptions, RecordError, Setting, Unit};

/// From so many values on, a first number that counts them exactly is their count and no acceleration.
const FEWEST_COUNTED: usize = 20;

/// A column of the file, chosen by the caller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Column {
    /// Its place, from 1.
    Number(usize),
    /// Its name in the header row, in any case, with or without the unit in brackets.
    Name(String),
}

impl FromStr for Column {
    type Err = Infallible;

    /// A whole number is a place, everything else a name.
    fn from_str(text: &str) -> Result<Column, Infallible> {
        Ok(text.parse().map_or_else(|_| Column::Name(text.to_owned()), Column::Number))
    }
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Column::Number(number) => write!(f, "column {number}"),
            Column::Name(name) => write!(f, "{name:?}"),
        }
    }
}

/// Reads the acceleration column and, if there is one, the time column, which must be evenly spaced.
pub(super) fn read(source: &Source<'_>, options: &ReadOptions) -> Result<Raw, RecordError> {
    let layout = layout(source)?;
    let (time, acceleration) = choose(source, &layout, options)?;
    let mut raw = Raw::new(Format::Columns);
    raw.title.clone_from(&layout.title);
    raw.unit = unit(source, &layout, acceleration)?;
    let time_unit = time.and_then(|index| layout.names.get(index)).and_then(|name| name.unit);
    if let Some(unit) = time_unit
        && !matches!(unit.to_lowercase().as_str(), "s" | "sec" | "secs" | "second" | "seconds")
    {
        return Err(source.header_error(layout.header, unit, "times in seconds, as t [s]"));
    }

    let mut axis = TimeAxis::new();
    let mut values = Values::new(source);
    let mut visit = |line: usize, width: usize, time: Option<&str>, acceleration: &str| {
        if width != layout.width {
            let expected = format!("{} columns as in line {}", layout.width, layout.first_row);
            return Err(source.header_error(line, &format!("{width} columns"), expected));
        }
        if let Some(time) = time {
            axis.push(line, source.number(line, time)?, print_quantum(time));
        }
        values.push(line, acceleration)
    };
    match layout.separator {
        Separator::Blanks => {
            for (line, text) in source.lines().skip(layout.first_row.saturating_sub(1)) {
                if text.trim().is_empty() || is_comment(text) {
                    continue;
                }
                let fields: Vec<&str> = text.split_whitespace().collect();
                let field = |index: usize| fields.get(index).copied().unwrap_or("");
                visit(line, fields.len(), time.map(field), field(acceleration))?;
            }
        }
        Separator::Byte(separator) => {
            delimited(source, layout.first_row, separator, |line, fields| {
                let width = fields.len() - fields.iter().rev().take_while(|field| field.is_empty()).count();
                let field = |index: usize| {
                    let field = fields.get(index).copied().unwrap_or("");
                    // Where commas do not separate columns they are decimal commas.
                    let is_decimal = separator != b',' && field.contains(',');
                    if is_decimal { Cow::Owned(field.replace(',', ".")) } else { Cow::Borrowed(field) }
                };
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

/// Hands every row of a delimited file to `visit`, from line `first` on, with its line number.
fn delimited(
    source: &Source<'_>,
    first: usize,
    separator: u8,
    mut visit: impl FnMut(usize, &[&str]) -> Result<(), RecordError>,
) -> Result<(), RecordError> {
    if !source.text.contains('"') {
        // Nothing is quoted: a separator separates wherever it stands.
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
    // One kind of line end, also on the last line: only so the reader's line count is that of the file.
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

/// Places of the time column, if there is one, and of the acceleration column, from 0.
fn choose(
    source: &Source<'_>,
    layout: &Layout<'_>,
    options: &ReadOptions,
) -> Result<(Option<usize>, usize), RecordError> {
    let Layout { names, width, header, .. } = layout;
    let error = |but: String, setting: Setting| {
        let columns = names.iter().map(|name| name.whole).collect::<Vec<_>>().join(", ");
        let (named, or) = match names.as_slice() {
            [] => (String::from("without names"), ""),
            _ => (format!("named {columns}"), " or a name"),
        };
        let (plural, last) = if *width == 1 { ("", String::new()) } else { ("s", format!(" to {width}")) };
        let found = format!("found {width} column{plural} {named}, {but}");
        source.open(Some(*header), found, setting, format!("1{last}{or}"))
    };
    let place = |column: &Column, setting: Setting| {
        let index = match column {
            Column::Number(number) => number.checked_sub(1).filter(|index| index < width),
            Column::Name(name) => {
                names.iter().position(|n| [n.whole, n.word].iter().any(|n| n.eq_ignore_ascii_case(name)))
            }
        };
        index.ok_or_else(|| error(format!("not {column}"), setting))
    };
    let chosen = options.acceleration_column.as_ref().map(|column| place(column, Setting::AccelerationColumn));
    let chosen = chosen.transpose()?;
    let time = match &options.time_column {
        Some(column) => Some(place(column, Setting::TimeColumn)?),
        None if *width == 1 => None,
        None if !names.is_empty() => names.iter().position(Name::is_time),
        // Without names: time first, unless the time step is given and a table of accelerations alone is possible.
        None => (*width == 2 || *width > 2 && options.time_step.is_none()).then_some(0),
    };
    let time = time.filter(|&index| Some(index) != chosen);
    if let Some(chosen) = chosen {
        return Ok((time, chosen));
    }
    let others: Vec<usize> = (0..*width).filter(|&index| Some(index) != time).collect();
    let named: Vec<usize> =
        others.iter().copied().filter(|&index| names.get(index).is_some_and(Name::is_acceleration)).collect();
    match (others.as_slice(), named.as_slice()) {
        (&[only], _) | (_, &[only]) => Ok((time, only)),
        _ => {
            let but = String::from("which leaves open where the accelerations are");
            Err(error(but, Setting::AccelerationColumn))
        }
    }
}

/// The unit in the brackets of the acceleration column's name.
fn unit(source: &Source<'_>, layout: &Layout<'_>, column: usize) -> Result<Option<(usize, Unit)>, RecordError> {
    let of_all = || match layout.stated {
        Some((line, unit)) => match (unit.parse(), other_quantity(unit)) {
            (Ok(unit), _) => Ok(Some((line, unit))),
            (Err(_), Some(found)) => Err(source.not_acceleration(line, format!("{found} ({})", quoted(unit)))),
            (Err(_), None) => Ok(None),
        },
        None => Ok(None),
    };
    let Some(name) = layout.names.get(column) else {
        return of_all();
    };
    if name.is_other_quantity() {
        let found = format!("a column named {}", quoted(name.whole));
        return Err(source.not_acceleration(layout.header, found));
    }
    let Some(unit) = name.unit else {
        return of_all();
    };
    match (unit.parse(), other_quantity(unit)) {
        (Ok(unit), _) => Ok(Some((layout.header, unit))),
        (Err(_), Some(found)) => {
            Err(source.not_acceleration(layout.header, format!("{found} ({})", quoted(name.whole))))
        }
        (Err(_), None) if name.is_acceleration() => {
            Err(source.header_error(layout.header, name.whole, "a unit among g, m/s2, cm/s2"))
        }
        // Not the name of a column but a title, as "Tabas (Iran)".
        (Err(_), None) => Ok(None),
    }
}
