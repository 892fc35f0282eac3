//! Date and time of day → seconds.

/// Seconds of a day.
const DAY: i64 = 86_400;

/// A time of day, with its date if it has one.
#[derive(Clone, Copy)]
pub(super) struct Instant {
    /// Whole seconds since an arbitrary midnight.
    whole: i64,
    /// Fraction of a second (s).
    fraction: f64,
    /// Unit of the last printed digit (s).
    pub(super) quantum: f64,
}

impl Instant {
    /// Returns the time since another instant (s).
    pub(super) fn since(self, start: Instant) -> f64 {
        (self.whole - start.whole) as f64 + (self.fraction - start.fraction)
    }

    /// Reads a time of day with or without a date and an offset from UTC. Examples are `2024-08-08T16:43:15.25Z` and `2024/08/08
    /// 16:43:15.25`.
    pub(super) fn parse(text: &str) -> Option<Instant> {
        let text = text.trim();
        let (days, clock) = match text.get(..10).and_then(date) {
            Some(days) => (days, text.get(10..)?.trim_start_matches(['T', ' ', '-', '_'])),
            None => (0, text),
        };
        let (clock, offset) = match clock.strip_suffix(['Z', 'z']) {
            Some(clock) => (clock, 0),
            None => match clock.rfind(['+', '-']) {
                Some(sign) => (clock.get(..sign)?, offset(clock.get(sign..)?)?),
                None => (clock, 0),
            },
        };
        let mut parts = clock.trim().split(':');
        let mut part = |limit: i64| parts.next()?.parse::<i64>().ok().filter(|value| (0..limit).contains(value));
        let (hours, minutes) = (part(24)?, part(60)?);
        let seconds = parts.next().filter(|_| parts.clone().next().is_none())?;
        let (whole, decimals) = seconds.split_once('.').unwrap_or((seconds, ""));
        // A leap second is the 61st of its minute.
        let whole = whole.parse::<i64>().ok().filter(|value| (0..61).contains(value))?;
        if !decimals.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        let fraction = if decimals.is_empty() { 0.0 } else { format!("0.{decimals}").parse().ok()? };
        let quantum = format!("1e-{}", decimals.len()).parse().ok()?;
        Some(Instant { whole: days * DAY + hours * 3600 + minutes * 60 + whole - offset, fraction, quantum })
    }
}

/// Returns whether a field is a date. A time of day may follow it in a field of its own.
pub(super) fn is_date(text: &str) -> bool {
    text.len() == 10 && date(text).is_some()
}

/// Returns the days since an arbitrary one of `2024/08/08` or `2024-08-08`.
fn date(text: &str) -> Option<i64> {
    let separator = text.get(4..5).filter(|separator| matches!(*separator, "/" | "-"))?;
    let numbers: Option<Vec<i64>> = text.split(separator).map(|part| part.parse().ok()).collect();
    let &[year, month @ 1..=12, day @ 1..=31] = numbers?.as_slice() else { return None };
    // Years begin in March, so that the leap day is their last.
    let (year, month) = if month < 3 { (year - 1, month + 9) } else { (year, month - 3) };
    Some(365 * year + year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400) + (153 * month + 2) / 5 + day)
}

/// Returns the seconds of an offset such as `+09:00`.
fn offset(text: &str) -> Option<i64> {
    let (hours, minutes) = text.get(1..)?.split_once(':')?;
    let seconds = hours.parse::<i64>().ok()? * 3600 + minutes.parse::<i64>().ok()? * 60;
    Some(if text.starts_with('-') { -seconds } else { seconds })
}
