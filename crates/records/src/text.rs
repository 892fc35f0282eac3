//! Bytes of a file → lines and numbers, for all readers.

use std::borrow::Cow;

use super::error::RecordError;
use super::options::Setting;
use super::unit::{Unit, other_quantity};

/// Number of lines searched for the format and the end of the header.
pub(super) const HEAD_LINES: usize = 64;

/// A file with more than one control character in this many bytes is binary.
///
/// Some SMC headers have a few NULs; random bytes have one control character in nine, and floating-point numbers many more.
const CONTROL_BYTES: usize = 100;

/// Number of values with equal digits after which a shorter last value counts as cut off.
const EQUAL_VALUES: usize = 16;

/// Text of a file, with its name for errors.
pub(super) struct FileText<'a> {
    pub(super) name: String,
    pub(super) text: Cow<'a, str>,
}

impl<'a> FileText<'a> {
    /// Decodes UTF-8 with or without byte order mark, otherwise Latin-1; refuses binary and empty files.
    pub(super) fn new(name: &str, bytes: &'a [u8]) -> Result<FileText<'a>, RecordError> {
        let name: String = name.chars().map(|c| if c.is_control() { '?' } else { c }).collect();
        if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
            return Err(not_text(name, "UTF-16 text"));
        }
        let control = |b: &&u8| b.is_ascii_control() && !matches!(b, b'\t' | b'\r' | b'\n' | 0x0C | 0x1A);
        if bytes.iter().filter(control).count() > bytes.len() / CONTROL_BYTES {
            return Err(not_text(name, "binary data"));
        }
        let text = match std::str::from_utf8(bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)) {
            Ok(text) => Cow::Borrowed(text.trim_end_matches('\x1A')),
            Err(_) => Cow::Owned(bytes.iter().map(|&b| char::from(b)).collect()),
        };
        if text.trim().is_empty() {
            let message = "the file is empty, expected an accelerogram".into();
            return Err(RecordError::File { file: name, message });
        }
        Ok(FileText { name, text })
    }

    /// Numbers the lines from 1, without line ends: LF, CR LF, CR CR LF, or CR in files without LF.
    pub(super) fn lines(&self) -> impl Iterator<Item = (usize, &str)> + Clone {
        let end = if self.text.contains('\n') { '\n' } else { '\r' };
        (1..).zip(self.text.split(end).map(|line| line.trim_end_matches('\r')))
    }

    /// Returns the first lines, within which every known header ends.
    pub(super) fn head(&self) -> Vec<&str> {
        self.lines().take(HEAD_LINES).map(|(_, line)| line).collect()
    }

    pub(super) fn header_error(&self, line: usize, found: &str, expected: impl Into<String>) -> RecordError {
        self.line_error(line, format!("found {}, expected {}", quoted(found), expected.into()))
    }

    pub(super) fn line_error(&self, line: usize, message: String) -> RecordError {
        RecordError::Line { file: self.name.clone(), line, message }
    }

    /// Builds the error of a known kind of accelerogram that is not supported; `expected` is the kind to export instead.
    pub(super) fn not_supported(&self, line: usize, found: &str, expected: &str) -> RecordError {
        self.line_error(line, format!("found {found}, which is not supported; expected {expected}"))
    }

    /// Builds the error of a file that was cut off within its last number; all others have the `expected` digits.
    fn truncated(&self, line: usize, number: &str, expected: &str) -> RecordError {
        let found = quoted(number);
        let message = format!("the file ends within the number {found}, expected {expected} as in all numbers before");
        self.line_error(line, message)
    }

    /// Builds the error of a file that needs a setting.
    pub(super) fn needs_setting(
        &self,
        line: Option<usize>,
        found: impl Into<String>,
        setting: Setting,
        expected: impl Into<String>,
    ) -> RecordError {
        let (file, found, expected) = (self.name.clone(), found.into(), expected.into());
        RecordError::NeedsSetting { file, line, found, setting, expected }
    }

    pub(super) fn number(&self, line: usize, token: &str) -> Result<f64, RecordError> {
        let value = number(token).filter(|value| value.is_finite());
        value.ok_or_else(|| self.header_error(line, token, "a finite number"))
    }

    /// Parses a stated unit; refuses units of other quantities and returns `None` for unknown ones.
    pub(super) fn unit(&self, line: usize, stated: &str) -> Result<Option<Unit>, RecordError> {
        match (stated.parse(), other_quantity(stated)) {
            (Ok(unit), _) => Ok(Some(unit)),
            (Err(_), Some(found)) => Err(self.not_acceleration(line, format!("{found} in {stated}"))),
            (Err(_), None) => Ok(None),
        }
    }

    /// Reads a unit that the line `text` states; `expected` describes it if it is unknown.
    pub(super) fn stated_unit(
        &self,
        line: usize,
        text: &str,
        unit: &str,
        expected: &str,
    ) -> Result<(usize, Unit), RecordError> {
        let unit = self.unit(line, unit)?.ok_or_else(|| self.header_error(line, text, expected))?;
        Ok((line, unit))
    }

    /// Builds the error of a header without a line; `line` is its last one.
    pub(super) fn missing_line(&self, line: usize, missing: &str) -> RecordError {
        self.header_error(line, "the end of the header", format!("a line {missing} before it"))
    }

    /// Refuses a file that ends within a column of `width` characters. Columns end `shift` characters later.
    ///
    /// Integers have no decimals that would show it.
    pub(super) fn check_last_column(
        &self,
        line: usize,
        text: &str,
        width: usize,
        shift: usize,
    ) -> Result<(), RecordError> {
        let complete = text.len() % width == shift % width || text.ends_with(char::is_whitespace);
        if complete || !self.text.ends_with(text) {
            return Ok(());
        }
        let last = text.split_whitespace().next_back().unwrap_or("");
        Err(self.truncated(line, last, &format!("columns of {width} characters")))
    }

    pub(super) fn not_acceleration(&self, line: usize, found: impl Into<String>) -> RecordError {
        self.line_error(line, format!("found {}, expected an acceleration time history", found.into()))
    }
}

fn not_text(file: String, found: &str) -> RecordError {
    let message = format!("found {found}, expected an accelerogram as ASCII, Latin-1 or UTF-8 text");
    RecordError::File { file, message }
}

/// Values of a file in reading order, with the digits in which they are printed.
pub(super) struct Values<'s> {
    source: &'s FileText<'s>,
    numbers: Vec<f64>,
    /// Common digits of all values but the last.
    digits: Option<Digits>,
    last_line: usize,
    last: String,
}

/// Digits of a printed number.
#[derive(Clone, Copy)]
struct Digits {
    /// Decimals; `None` if values differ.
    decimals: Option<usize>,
    /// Digits of the exponent, the fewest of all values; 0 without exponent.
    exponent: usize,
}

impl Digits {
    fn of(token: &str) -> Digits {
        let (mantissa, exponent) = split_exponent(token);
        Digits { decimals: Some(decimals(mantissa)), exponent: exponent.trim_start_matches(['+', '-']).len() }
    }

    fn in_common(self, other: Digits) -> Digits {
        Digits {
            decimals: self.decimals.filter(|_| self.decimals == other.decimals),
            exponent: self.exponent.min(other.exponent),
        }
    }
}

impl<'s> Values<'s> {
    pub(super) fn new(source: &'s FileText<'s>) -> Values<'s> {
        Values { source, numbers: Vec::new(), digits: None, last_line: 0, last: String::new() }
    }

    pub(super) fn push(&mut self, line: usize, token: &str) -> Result<(), RecordError> {
        let value = self.source.number(line, token)?;
        if !self.numbers.is_empty() {
            let digits = Digits::of(&self.last);
            self.digits = Some(self.digits.map_or(digits, |common| common.in_common(digits)));
        }
        self.last_line = line;
        self.last.clear();
        self.last.push_str(token);
        self.numbers.push(value);
        Ok(())
    }

    /// Returns the number of values so far.
    pub(super) fn len(&self) -> usize {
        self.numbers.len()
    }

    /// Returns the numbers; refuses a file that ends within the last one.
    pub(super) fn finish(self) -> Result<Vec<f64>, RecordError> {
        let Some(others) = self.digits else {
            return Ok(self.numbers);
        };
        let last = Digits::of(&self.last);
        let fewer = last.decimals < others.decimals || last.exponent < others.exponent;
        if fewer && self.numbers.len() > EQUAL_VALUES && self.source.text.ends_with(&self.last) {
            let decimals = others.decimals.map_or(String::new(), |n| format!(" {n} decimals"));
            let exponent = if others.exponent > 0 { " an exponent" } else { "" };
            let and = if decimals.is_empty() || exponent.is_empty() { "" } else { " and" };
            let expected = format!("{decimals}{and}{exponent}");
            return Err(self.source.truncated(self.last_line, &self.last, expected.trim_start()));
        }
        Ok(self.numbers)
    }
}

/// Reads lines of columns of equal width.
pub(super) fn fixed_columns<'l>(
    source: &FileText<'_>,
    lines: impl IntoIterator<Item = (usize, &'l str)>,
    width: usize,
) -> Result<Vec<f64>, RecordError> {
    let mut values = Values::new(source);
    for (line, text) in lines {
        for field in fixed_width(text, width) {
            values.push(line, field)?;
        }
    }
    values.finish()
}

/// Splits a number into mantissa and exponent, which may be empty.
fn split_exponent(token: &str) -> (&str, &str) {
    let position = token.bytes().position(|byte| matches!(byte, b'e' | b'E' | b'd' | b'D'));
    let split = position.and_then(|position| Some((token.get(..position)?, token.get(position + 1..)?)));
    split.unwrap_or((token, ""))
}

/// Counts the decimals of a mantissa.
fn decimals(mantissa: &str) -> usize {
    mantissa.bytes().position(|byte| byte == b'.').map_or(0, |point| mantissa.len() - point - 1)
}

/// Reads a number printed by C or Fortran (`.5E-02`, `0.5D-02`), also infinite ones and NaN.
pub(super) fn number(token: &str) -> Option<f64> {
    // Nearly all numbers are in the notation of C, which has no `d`.
    token.parse().ok().or_else(|| token.replace(['D', 'd'], "e").parse().ok())
}

/// Returns one unit of the last printed digit. The rounding error is at most half of it.
pub(super) fn print_quantum(token: &str) -> f64 {
    let (mantissa, exponent) = split_exponent(token);
    let decimals = decimals(mantissa);
    let power = exponent.parse::<i32>().unwrap_or(0).saturating_sub(i32::try_from(decimals).unwrap_or(0));
    format!("1e{power}").parse().unwrap_or(f64::NAN)
}

/// Splits a line into columns of equal width, trimmed, without empty ones at the end.
pub(super) fn fixed_width(line: &str, width: usize) -> impl Iterator<Item = &str> {
    let line = line.trim_end();
    // A line that is not ASCII has no numbers; as a single column it is refused as a number.
    let width = if line.is_ascii() { width.max(1) } else { line.len().max(1) };
    (0..line.len())
        .step_by(width)
        .filter_map(move |start| line.get(start..line.len().min(start + width)).map(str::trim))
}

/// Quotes a piece of the file in an error message, shortened to one line.
pub(super) fn quoted(piece: &str) -> String {
    const LONGEST: usize = 60;
    let piece = piece.trim();
    let more = if piece.chars().count() > LONGEST { "…" } else { "" };
    format!("{:?}", piece.chars().take(LONGEST).collect::<String>() + more)
}

/// Joins the lines of a header at these indices.
pub(super) fn title(lines: &[(usize, &str)], indices: &[usize]) -> String {
    let words: Vec<String> =
        indices.iter().filter_map(|&index| lines.get(index)).map(|(_, line)| squeezed(line)).collect();
    words.join("; ")
}

/// Joins the words of a header line with single blanks.
pub(super) fn squeezed(line: &str) -> String {
    line.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns whether a line marks the end of the data: `*** End Data ***`, `/& --- END OF DATA`, `End-of-data for`.
pub(super) fn is_end_mark(line: &str) -> bool {
    let line = line.trim_start();
    line.starts_with("***") || line.starts_with("/&") || line.to_ascii_lowercase().starts_with("end-of-data")
}

/// Returns the lines from an index on, before the mark of their end.
pub(super) fn before_end_mark<'s>(lines: &[(usize, &'s str)], from: usize) -> impl Iterator<Item = (usize, &'s str)> {
    lines.iter().skip(from).copied().take_while(|(_, text)| !is_end_mark(text))
}

/// Lists names for a message: the first ten and how many there are beyond.
pub(super) fn first_of(names: &[impl AsRef<str>]) -> String {
    const SHOWN: usize = 10;
    let shown = names.iter().take(SHOWN).map(AsRef::as_ref).collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}
