//! Columns of fixed width, described by the caller with an edit descriptor of Fortran, below a number of lines of any text.

use super::claims;
use super::error::RecordError;
use super::fixed_layout::FixedLayout;
use super::format::Format;
use super::options::{Choice, ReadOptions, Setting};
use super::raw::Raw;
use super::text::{FileText, Values, fixed_width, is_end_mark, number, print_quantum, squeezed};
use super::time_axis::TimeAxis;

impl FixedLayout {
    /// Splits a line into its columns, those at its end that are blank left out.
    fn split<'a>(&self, line: &'a str) -> impl Iterator<Item = &'a str> {
        fixed_width(line.get(self.blanks..).unwrap_or_default(), self.width)
    }

    /// Writes a field as a number with point and exponent: `12345` is 123.45 in F8.2, `1.5-3` is 1.5E-3.
    fn plain(&self, field: &str) -> String {
        let field = field.to_ascii_uppercase().replace('D', "E");
        let sign =
            field.rfind(['+', '-']).filter(|&i| i > 0 && !field[..i].ends_with('E') && number(&field[..i]).is_some());
        let field = sign.map_or(field.clone(), |i| format!("{}E{}", &field[..i], &field[i..]));
        let (mantissa, exponent) = field.split_once('E').unwrap_or((&field, ""));
        let implied = if mantissa.contains('.') { 0 } else { self.decimals };
        let power = if exponent.is_empty() { self.power } else { 0 };
        match (implied + power, exponent.is_empty()) {
            (0, _) => field,
            (shift, true) => format!("{mantissa}E{}", -shift),
            (shift, false) => match exponent.parse::<i32>() {
                Ok(exponent) => format!("{mantissa}E{}", exponent.saturating_sub(shift)),
                Err(_) => field,
            },
        }
    }
}

/// Reads the numbers of all lines in reading order, or a column of them.
pub(super) fn read(source: &FileText<'_>, options: &ReadOptions) -> Result<Raw, RecordError> {
    let Some(layout) = options.layout else {
        let found = "columns of fixed width without a layout";
        return Err(source.needs_setting(None, found, Setting::Layout, "as 10F8.2"));
    };
    let index = |column: &Option<Choice>, setting: Setting| match column {
        None => Ok(None),
        Some(Choice::Number(number)) if (1..=layout.columns).contains(number) => Ok(Some(number - 1)),
        Some(other) => {
            let found = format!("the layout has {} columns, not {}", layout.columns, other.described("column"));
            Err(source.needs_setting(None, found, setting, format!("1 to {}", layout.columns)))
        }
    };
    let time = index(&options.time_column, Setting::TimeColumn)?;
    let mut chosen = index(&options.acceleration_column, Setting::AccelerationColumn)?;
    if let (Some(time), None, 2) = (time, chosen, layout.columns) {
        chosen = Some(1 - time);
    }
    if let (Some(_), None) = (time, chosen) {
        let found = "a column of times without one of accelerations";
        return Err(source.needs_setting(None, found, Setting::AccelerationColumn, format!("1 to {}", layout.columns)));
    }

    let mut raw = Raw::new(Format::Fixed);
    let skip = options.skip.unwrap_or(0);
    let header = source.lines().take(skip).map(|(_, text)| squeezed(text)).find(|text| !text.is_empty());
    raw.title = header.unwrap_or_default();
    raw.claims = claims::of_text(source.lines().take(skip));
    let (mut axis, mut values) = (TimeAxis::new(), Values::new(source));
    let (mut short, mut last) = (None, None);
    let other_width = |(line, count): (usize, usize)| {
        let found = format!("{count} columns of {} characters", layout.width);
        source.header_error(line, &found, format!("{}, as in the layout", layout.columns))
    };
    for (line, text) in source.lines().skip(skip) {
        if options.npts.is_some_and(|npts| values.len() >= npts) {
            break;
        }
        if text.trim().is_empty() {
            continue;
        }
        if is_end_mark(text) {
            break;
        }
        last = Some((line, text));
        let fields: Vec<&str> = layout.split(text).collect();
        // Only the last line may be short, and none if a column is chosen.
        if let Some(row) = short.or((fields.len() > layout.columns).then_some((line, fields.len()))) {
            return Err(other_width(row));
        }
        if fields.len() < layout.columns {
            short = Some((line, fields.len()));
        }
        for (index, field) in fields.iter().enumerate() {
            let field = layout.plain(field);
            if time == Some(index) {
                axis.push(line, source.number(line, &field)?, print_quantum(&field));
            }
            if chosen.is_none_or(|chosen| chosen == index) {
                values.push(line, &field)?;
            }
        }
    }
    if let (Some(row), Some(_)) = (short, chosen) {
        return Err(other_width(row));
    }
    (raw.start_time, raw.time_step) = axis.even_spacing(source)?;
    raw.values = values.finish()?;
    if let Some(npts) = options.npts.filter(|npts| *npts != raw.values.len()) {
        let counted = raw.values.len();
        let found = format!("found {counted} values up to the end of a line in the layout, not {npts}");
        return Err(source.needs_setting(last.map(|(line, _)| line), found, Setting::Npts, counted.to_string()));
    }
    if let Some((line, text)) = last {
        source.check_last_column(line, text, layout.width, layout.blanks)?;
    }
    Ok(raw)
}
