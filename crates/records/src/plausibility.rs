//! A record → the reason why its numbers are implausible as accelerations.

use super::format::Format;
use super::record::Record;
use super::text;

/// Largest plausible acceleration (m/s²), 5 g; the largest ever recorded was 4.4 g.
const LARGEST: f64 = 49.0;

/// Lowest plausible mean frequency (Hz), √(∫ȧ² dt/∫a² dt)/2π.
///
/// It is 1.2 to 7.7 Hz for 36 accelerograms, and 0.5 to 4 Hz for their velocities.
const LOWEST_FREQUENCY: f64 = 1.15;

/// Shorter tables are usually made by hand.
const FEWEST_SAMPLES: usize = 200;

/// Returns the reason to doubt that a file holds accelerations in its unit, if any.
///
/// A table without names does not state its content; its frequency may show velocities.
pub(super) fn implausibility(bytes: &[u8], record: &Record) -> Option<String> {
    let peak = record.peak().acceleration.abs();
    if peak > LARGEST {
        return Some(format!("the peak is {peak:.3e} m/s², more than in any earthquake"));
    }
    let text = String::from_utf8_lossy(bytes.get(..4096).unwrap_or(bytes));
    let first = text.lines().map(str::trim).find(|line| !line.is_empty())?;
    let mut fields = first.split([' ', '\t', ',', ';']).filter(|field| !field.is_empty());
    if record.format != Format::Columns || !fields.all(|field| text::number(field).is_some()) {
        return None;
    }
    let values = &record.acceleration;
    let squares: f64 = values.iter().map(|a| a * a).sum();
    let changes: f64 = values.iter().zip(values.iter().skip(1)).map(|(a, b)| (b - a) * (b - a)).sum();
    let frequency = (changes / squares).sqrt() / record.time_step / std::f64::consts::TAU;
    (values.len() >= FEWEST_SAMPLES && frequency < LOWEST_FREQUENCY).then(|| {
        format!("its columns have no names, and the mean frequency is {frequency:.2} Hz, as low as that of velocities")
    })
}
