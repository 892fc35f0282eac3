//! Lines → layout of a table: separator, header row, first row of numbers.

use std::borrow::Cow;

use super::clock::{Instant, is_date};
use super::error::RecordError;
use super::format::Format;
use super::text::{FileText, HEAD_LINES, number, quoted, squeezed};
use super::unit::{Unit, other_quantity};

/// Number of columns from which values without names are in reading order, as in PEER files.
const FEWEST_IN_BLOCK: usize = 3;

/// Relative difference below which two steps of a time column are equal.
const EQUAL_STEPS: f64 = 1e-3;

/// Separator of columns.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Separator {
    Byte(u8),
    Blanks,
}

impl Separator {
    pub(super) fn of(line: &str) -> Separator {
        let found = [b';', b'\t', b','].into_iter().find(|&byte| line.trim().contains(char::from(byte)));
        found.map_or(Separator::Blanks, Separator::Byte)
    }

    pub(super) fn split(self, line: &str) -> Vec<&str> {
        match self {
            Separator::Byte(byte) => {
                line.trim().trim_end_matches(char::from(byte)).split(char::from(byte)).map(str::trim).collect()
            }
            Separator::Blanks => blank_separated(line),
        }
    }

    /// Returns whether a field is a number or a date with a time.
    fn is_value(self, field: &str) -> bool {
        self.number(field).is_some() || self.instant(field).is_some()
    }

    /// Reads a date with a time.
    pub(super) fn instant(self, field: &str) -> Option<Instant> {
        Instant::parse(&self.with_points(field))
    }

    /// Reads a number.
    pub(super) fn number(self, field: &str) -> Option<f64> {
        number(&self.with_points(field))
    }

    /// Replaces decimal commas by points: commas that do not separate columns.
    pub(super) fn with_points(self, field: &str) -> Cow<'_, str> {
        match self {
            Separator::Byte(byte) if byte != b',' && field.contains(',') => Cow::Owned(field.replace(',', ".")),
            Separator::Byte(_) | Separator::Blanks => Cow::Borrowed(field),
        }
    }
}

/// Splits a line at blanks, except between a date and the time behind it.
pub(super) fn blank_separated(line: &str) -> Vec<&str> {
    let mut fields: Vec<&str> = Vec::new();
    let mut rest = line.trim();
    while !rest.is_empty() {
        let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
        let (field, after) = rest.split_at(end);
        let next = after.split_whitespace().next().filter(|next| is_date(field) && Instant::parse(next).is_some());
        let end = next.and_then(|next| Some(end + after.find(next)? + next.len())).unwrap_or(end);
        let (field, after) = rest.split_at(end);
        fields.push(field);
        rest = after.trim_start();
    }
    fields
}

/// Heading of a column: a name and its unit in brackets, as `a_gx [m/s2]`.
pub(super) struct Heading<'a> {
    pub(super) whole: &'a str,
    pub(super) word: &'a str,
    pub(super) unit: Option<&'a str>,
}

impl<'a> Heading<'a> {
    fn new(whole: &'a str) -> Heading<'a> {
        let whole = whole.trim().trim_matches('"').trim();
        match whole.split_once(['[', '(']) {
            Some((word, rest)) => {
                Heading { whole, word: word.trim(), unit: rest.split([']', ')']).next().map(str::trim) }
            }
            None => Heading { whole, word: whole, unit: None },
        }
    }

    pub(super) fn starts_with(&self, starts: &[&str]) -> bool {
        let word = self.word.to_lowercase();
        starts.iter().any(|start| word.starts_with(start))
    }

    /// Returns whether this is the column of times, in whatever language. A unit of time says so too.
    pub(super) fn is_time(&self) -> bool {
        let is_in_seconds = !self.is_other_quantity() && self.unit.is_some_and(is_time_unit);
        let words = ["time", "date", "utc", "zeit", "temps", "tempo", "tiempo"];
        is_in_seconds || self.word.eq_ignore_ascii_case("t") || self.starts_with(&words)
    }

    /// Returns whether this is a velocity, a displacement, or the abscissa of a spectrum.
    pub(super) fn is_other_quantity(&self) -> bool {
        let short = ["v", "vel", "d", "disp"];
        short.iter().any(|word| self.word.eq_ignore_ascii_case(word))
            || self.starts_with(&["velocity", "displacement", "period", "frequency"])
    }

    pub(super) fn is_acceleration(&self) -> bool {
        let has_its_unit = self.word.is_empty() && self.unit.is_some_and(|unit| unit.parse::<Unit>().is_ok());
        has_its_unit || self.word.eq_ignore_ascii_case("a") || self.starts_with(&["acc", "a_", "ag"])
    }
}

/// Layout of a table, and the text before its numbers.
pub(super) struct Layout<'a> {
    pub(super) separator: Separator,
    /// Line of the first row of numbers.
    pub(super) first_row: usize,
    /// Number of columns.
    pub(super) width: usize,
    /// Index of the first column of dates with a time.
    pub(super) dates: Option<usize>,
    /// Line of the header row.
    pub(super) header: usize,
    pub(super) names: Vec<Heading<'a>>,
    /// Lines of names and units of columns.
    pub(super) headings: Vec<usize>,
    pub(super) title: String,
}

/// Returns whether the file is a block in reading order. Such a block has numbers from the first line, three or more per line, and no
/// times.
pub(super) fn is_block(head: &[&str]) -> bool {
    let rows: Vec<Vec<f64>> = head
        .iter()
        .filter(|line| !line.trim().is_empty())
        .map_while(|line| line.split_whitespace().map(number).collect())
        .collect();
    let wide = rows.first().is_some_and(|row| row.len() >= FEWEST_IN_BLOCK);
    let times: Vec<f64> = rows.iter().filter_map(|row| row.first().copied()).collect();
    let steps: Vec<f64> = times.windows(2).filter_map(|pair| Some(pair.get(1)? - pair.first()?)).collect();
    let first = steps.first().copied().unwrap_or(0.0);
    let even = first > 0.0 && steps.len() > 1 && steps.iter().all(|step| (step - first).abs() <= EQUAL_STEPS * first);
    wide && !even
}

/// Finds the first row of numbers and the header row before it.
pub(super) fn layout<'a>(source: &'a FileText<'_>) -> Result<Layout<'a>, RecordError> {
    let mut before: Vec<(usize, &str)> = Vec::new();
    let mut spectrum = None;
    for (line, text) in source.lines().take(HEAD_LINES) {
        let separator = Separator::of(text);
        let fields = separator.split(text);
        if !fields.is_empty() && fields.iter().all(|field| separator.is_value(field.trim_matches('"'))) {
            let dates = fields.iter().position(|field| separator.instant(field.trim_matches('"')).is_some());
            // A comment may be the header row, as "# t [s], a [m/s2]".
            let bare = |text: &'a str| text.trim_start_matches(['#', '%', '!', '/']).trim();
            let last = before.last().map(|&(line, text)| (line, bare(text)));
            let units = last.map(|(_, text)| units(text, separator, fields.len())).unwrap_or_default();
            let mut headings = Vec::new();
            if let Some((of_units, text)) = last
                && (states_unit(text) || !units.is_empty())
            {
                before.pop();
                headings.extend((!units.is_empty()).then_some(of_units));
            }
            let header = before.last().map(|&(header, text)| (header, names(bare(text), separator, fields.len())));
            let (mut header, mut names) = header.unwrap_or((line, Vec::new()));
            if let (true, false, Some((of_units, _))) = (names.is_empty(), units.is_empty(), last) {
                header = of_units;
                names = units.iter().map(|&unit| Heading { whole: unit, word: "", unit: Some(unit) }).collect();
            }
            for (name, unit) in names.iter_mut().zip(units) {
                name.unit = name.unit.or(Some(unit));
            }
            headings.extend((!names.is_empty()).then_some(header));
            // The title of a table of times and accelerations may speak of a spectrum.
            let is_history = names.iter().any(Heading::is_time) && names.iter().any(Heading::is_acceleration);
            if let Some(spectrum) = spectrum.filter(|_| !is_history) {
                return Err(spectrum);
            }
            let title = before.first().filter(|&&(first, _)| names.is_empty() || first != header);
            let title = title.map_or(String::new(), |(_, text)| squeezed(bare(text)));
            return Ok(Layout {
                separator,
                first_row: line,
                width: fields.len(),
                dates,
                header,
                names,
                headings,
                title,
            });
        }
        let lower = text.to_lowercase();
        let spectral = ["spectrum", "spectra"].iter().any(|word| lower.contains(word)) && !lower.contains("matched");
        if spectral || lower.trim_start().trim_start_matches('"').starts_with("period") {
            spectrum =
                spectrum.or(Some(source.not_acceleration(line, format!("a response spectrum ({})", quoted(text)))));
        }
        if !text.trim().is_empty() {
            before.push((line, text));
        }
    }
    if let Some(spectrum) = spectrum {
        return Err(spectrum);
    }
    let (line, text) = before.last().copied().unwrap_or((1, ""));
    let expected =
        format!("the header of a known format ({}) or a row of numbers in the first {HEAD_LINES} lines", Format::NAMES);
    Err(source.header_error(line, text, expected))
}

/// Returns whether a line is one such as `unit: g` or `Units = cm/s^2`.
fn states_unit(line: &str) -> bool {
    let unit = line.get(..4).filter(|start| start.eq_ignore_ascii_case("unit")).and_then(|_| line.get(4..));
    unit.is_some_and(|rest| is_unit(rest.trim_start_matches(['s', 'S', ' ', ':', '=']).trim()))
}

/// Returns the units in a row such as `s, m/s2`, one per column. The list is empty for any other row.
fn units(line: &str, separator: Separator, width: usize) -> Vec<&str> {
    let fields =
        if separator.split(line).len() == width { separator.split(line) } else { Separator::of(line).split(line) };
    let bare: Vec<&str> = fields.iter().map(|field| field.trim_matches(['[', ']', '(', ')', '"']).trim()).collect();
    let are_units = bare.len() == width && bare.iter().all(|field| is_unit(field) || is_second(field));
    if are_units && bare.iter().any(|field| is_unit(field)) { bare } else { Vec::new() }
}

fn is_unit(text: &str) -> bool {
    text.parse::<Unit>().is_ok() || other_quantity(text).is_some()
}

pub(super) fn is_second(text: &str) -> bool {
    matches!(text.to_lowercase().as_str(), "s" | "sec" | "secs" | "seg" | "second" | "seconds")
}

fn is_time_unit(text: &str) -> bool {
    is_second(text) || matches!(text.to_lowercase().as_str(), "ms" | "msec" | "µs" | "μs" | "min" | "h")
}

/// Returns the headings of the columns. The list is empty if the line does not fit the columns.
fn names(line: &str, separator: Separator, width: usize) -> Vec<Heading<'_>> {
    // One blank may separate a name from its unit; two blanks separate names.
    let wide = || line.split("  ").map(str::trim).filter(|name| !name.is_empty()).collect();
    let units = || line.split_inclusive([']', ')']).map(str::trim).collect();
    let words = || line.split_whitespace().collect();
    let candidates: Vec<Vec<&str>> = match separator {
        Separator::Byte(byte) if line.contains(char::from(byte)) => vec![separator.split(line)],
        // Blanks between names whose numbers have another separator are those of a sentence, unless each has its unit.
        Separator::Byte(_) => vec![units()],
        Separator::Blanks if line.contains('\t') => vec![Separator::Byte(b'\t').split(line)],
        // Text with numbers in it, as "peak 0.131 mm", is a remark. A unit in brackets is no name.
        Separator::Blanks => [wide(), units(), words()]
            .into_iter()
            .filter(|names: &Vec<&str>| {
                names.iter().all(|name| number(name).is_none() && !name.starts_with(['(', '[']))
            })
            .collect(),
    };
    let fitting = candidates.into_iter().find(|names| names.len() == width);
    fitting.unwrap_or_default().into_iter().map(Heading::new).collect()
}

/// Returns whether a line among the numbers is a comment.
pub(super) fn is_comment(line: &str) -> bool {
    line.trim_start().starts_with(['#', '%', '!'])
}
