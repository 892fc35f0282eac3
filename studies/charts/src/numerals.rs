//! Numbers → short text without the noise of the last digits.

use std::ops::Range;

/// Formats a number with at most six significant digits, without trailing zeros.
pub fn short(value: f64) -> String {
    significant(value, 6)
}

/// Formats a number with at most `digits` significant digits, without trailing zeros.
pub fn significant(value: f64, digits: usize) -> String {
    signed(readable(value, digits))
}

/// Formats a number as [`significant`] does, with the hyphen as minus sign. Other programs read it.
pub fn readable(value: f64, digits: usize) -> String {
    let rounded = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    if rounded == 0.0 { "0".into() } else { format!("{rounded}") }
}

/// Formats both ends of an interval with this number of digits, or as many more as tell them apart: no interval looks as if it had no width.
/// `write` takes a number and its digits.
pub fn ends([low, high]: [f64; 2], digits: usize, write: impl Fn(f64, usize) -> String) -> [String; 2] {
    /// Digits that tell any two numbers apart.
    const ALL: usize = 17;
    let texts = |digits| [low, high].map(|end| write(end, digits));
    (digits..ALL).map(texts).find(|[low, high]| low != high).unwrap_or_else(|| texts(digits))
}

/// Formats a tick of an axis with enough digits to distinguish neighbouring ticks.
pub fn tick(value: f64, range: &Range<f64>) -> String {
    let span = (range.end - range.start).abs().max(f64::MIN_POSITIVE);
    // Ticks are at least a hundredth of the span apart.
    let decimals = (2.0 - span.log10().floor()).clamp(0.0, 17.0) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    signed(if text == "-0" { "0".into() } else { text.into() })
}

fn signed(digits: String) -> String {
    digits.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_significant_digits() {
        let numbers = [0.25, 1.256637061, 0.825, 2.0 * 0.4125, 1e-5, -0.00012, 0.1 + 0.2, 0.0, -0.0, 900.0, 1234567.0];
        let words = ["0.25", "1.25664", "0.825", "0.825", "0.00001", "−0.00012", "0.3", "0", "0", "900", "1234570"];
        assert_eq!(numbers.map(short), words);
        assert_eq!([0.68, 0.00012345].map(|x| significant(x, 3)), ["0.68", "0.000123"]);
        assert_eq!([-0.00012345, -0.0].map(|x| readable(x, 3)), ["-0.000123", "0"]);
    }

    /// Ends that differ are never the same text; equal ones are.
    #[test]
    fn the_ends_of_an_interval_differ() {
        let of = |low, high| ends([low, high], 3, significant);
        assert_eq!(of(1.38, 1.44), ["1.38", "1.44"]);
        assert_eq!(of(1.399, 1.401), ["1.399", "1.401"]);
        assert_eq!(of(1.4 - 1e-12, 1.4), ["1.399999999999", "1.4"]);
        assert_eq!(of(1.4, 1.4), ["1.4", "1.4"]);
    }

    /// Neighbouring ticks differ even far from zero, and zero is `0`.
    #[test]
    fn neighbouring_ticks_differ() {
        let ticks = |from: f64, to: f64, step: f64| -> Vec<String> {
            let count = ((to - from) / step).round() as i32;
            (0..=count).map(|i| tick(from + f64::from(i) * step, &(from..to))).collect()
        };
        assert_eq!(ticks(-0.2, 0.2, 0.1), ["−0.2", "−0.1", "0", "0.1", "0.2"]);
        assert_eq!(ticks(0.0, 4e-5, 1e-5), ["0", "0.00001", "0.00002", "0.00003", "0.00004"]);
        assert_eq!(ticks(100_000.0, 100_001.0, 0.5), ["100000", "100000.5", "100001"]);
        assert_eq!(ticks(0.0, 3000.0, 1000.0), ["0", "1000", "2000", "3000"]);
    }
}
