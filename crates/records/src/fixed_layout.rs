//! An edit descriptor of Fortran → the columns of lines of fixed width.

use std::str::FromStr;

/// Widest column and most columns of a line.
const LARGEST: usize = 1000;

/// Layout of a line of numbers, as `10F8.2`: columns of equal width without separators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FixedLayout {
    /// Blanks before the first column.
    pub(super) blanks: usize,
    /// Number of columns.
    pub(super) columns: usize,
    /// Width of a column.
    pub(super) width: usize,
    /// Decimals of numbers without a point.
    pub(super) decimals: i32,
    /// Power of ten by which numbers without an exponent are divided, `k` of `kP`.
    pub(super) power: i32,
}

/// A text that is no [`FixedLayout`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "found layout {0:?}, expected an edit descriptor of Fortran for one line, as 10F8.2, 5E15.7, 8(1PE10.4E1) or 3I10"
)]
pub struct UnknownLayout(pub String);

impl FromStr for FixedLayout {
    type Err = UnknownLayout;

    fn from_str(text: &str) -> Result<FixedLayout, UnknownLayout> {
        let bare: String = text.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
        descriptor(&bare).ok_or_else(|| UnknownLayout(text.to_owned()))
    }
}

/// Reads `10F8.2`. It may have `nX,` before it, `kP` in it, and brackets around it or around its part behind the count.
fn descriptor(text: &str) -> Option<FixedLayout> {
    let whole = text.strip_prefix('(').and_then(|inner| inner.strip_suffix(')'));
    if let Some(inner) = whole.filter(|inner| inner.matches('(').count() == inner.matches(')').count()) {
        return descriptor(inner);
    }
    let integer = |text: &mut &str| {
        let digits = text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let (number, rest) = text.split_at(digits);
        *text = rest;
        number.parse::<usize>().ok().filter(|number| *number <= LARGEST)
    };
    let mut rest = text;
    let mut blanks = 0;
    if let Some((before, after)) = rest.split_once("X,") {
        blanks = if before.is_empty() { 1 } else { integer(&mut { before })? };
        rest = after;
    }
    let mut power = 0;
    let mut scale = |rest: &mut &str| {
        let signed = rest.strip_prefix('-').map_or(*rest, |digits| digits);
        let mut after = signed;
        if let Some((k, behind)) = integer(&mut after).zip(after.strip_prefix('P')) {
            power = i32::try_from(k).unwrap_or(0) * if signed.len() < rest.len() { -1 } else { 1 };
            *rest = behind.trim_start_matches(',');
        }
    };
    scale(&mut rest);
    let columns = if rest.starts_with(|c: char| c.is_ascii_digit()) { integer(&mut rest)? } else { 1 };
    if let Some(inner) = rest.strip_prefix('(') {
        rest = inner.strip_suffix(')')?;
        scale(&mut rest);
    }
    let letters = rest.trim_start_matches(|c: char| c.is_ascii_alphabetic());
    let kind = rest.strip_suffix(letters)?;
    rest = letters;
    let width = integer(&mut rest)?;
    let mut decimals = 0;
    if kind != "I" {
        rest = rest.strip_prefix('.')?;
        decimals = integer(&mut rest)?;
        // The width of the exponent in writing.
        if let Some(mut exponent) = rest.strip_prefix('E') {
            integer(&mut exponent)?;
            rest = exponent;
        }
    }
    let known = matches!(kind, "F" | "E" | "D" | "G" | "ES" | "EN" | "I");
    let decimals = i32::try_from(decimals).ok()?;
    (known && rest.is_empty() && columns > 0 && width > 0).then_some(FixedLayout {
        blanks,
        columns,
        width,
        decimals,
        power,
    })
}
