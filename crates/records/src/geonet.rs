//! Records of GeoNet, New Zealand, volumes 1 and 2: three components, each with a header and blocks of accelerations in mm/s² and, in
//! volume 2, of velocities and displacements.

use super::channels;
use super::claims::StatedStep;
use super::error::RecordError;
use super::format::Format;
use super::options::Choice;
use super::raw::{Raw, StatedCount, StatedPeak};
use super::text::{FileText, fixed_columns, fixed_width, number, title};

/// Number of lines of a header: text, integers and reals.
const HEADER_LINES: usize = 16 + 4 + 6;

/// Indices of lines of the header.
const STEP: usize = 10;
const COMPONENT: usize = 12;
const PEAK: usize = 13;
const COUNTS: usize = 19;

/// Width and number of columns.
const WIDTH: usize = 8;
const COLUMNS: usize = 10;

/// Returns whether the first lines begin a volume 1 or 2.
pub(super) fn is_head(head: &[&str]) -> bool {
    let begins = |index: usize, word: &str| head.get(index).is_some_and(|line| line.starts_with(word));
    (begins(0, "Corrected accelerogram") || begins(0, "Uncorrected accelerogram"))
        && begins(COMPONENT, "Component ")
        && begins(PEAK, "Acceleration:")
}

/// Reads the accelerations of a component.
pub(super) fn read(source: &FileText<'_>, wanted: Option<&Choice>) -> Result<Raw, RecordError> {
    let lines: Vec<(usize, &str)> = source.lines().collect();
    let mut components: Vec<&[(usize, &str)]> = Vec::new();
    let mut rest = lines.as_slice();
    while rest.len() >= HEADER_LINES {
        let [acceleration, velocity, displacement] = counts(source, rest)?;
        let rows = |count: usize| count.div_ceil(COLUMNS);
        let end = HEADER_LINES.saturating_add(rows(acceleration));
        let next = end.saturating_add(rows(velocity)).saturating_add(rows(displacement));
        components.push(rest.get(..end).unwrap_or(rest));
        rest = rest.get(next..).unwrap_or_default();
    }
    let name = |component: &&[(usize, &str)]| {
        let line = component.get(COMPONENT).map_or("", |&(_, text)| text);
        line.split_whitespace().nth(1).unwrap_or_default().to_owned()
    };
    let names: Vec<String> = components.iter().map(name).collect();
    let chosen = channels::index(source, &names, wanted)?;
    let lines = components.get(chosen).copied().unwrap_or_default();

    let mut raw = Raw::new(Format::Geonet);
    // Station, time of the earthquake, component.
    raw.title = title(lines, &[2, 7, COMPONENT]);
    let [value, ..] = counts(source, lines)?;
    let line = lines.get(COUNTS).map_or(1, |&(line, _)| line);
    raw.count = Some(StatedCount { line, key: "4th integer", value });

    let (line, text) = lines.get(STEP).copied().unwrap_or((1, ""));
    let words: Vec<&str> = text.split_whitespace().collect();
    let before =
        |word: &str| words.iter().position(|w| w.starts_with(word)).and_then(|index| words.get(index.checked_sub(1)?));
    // "at intervals of 0.005 s", "at 0.020 sec intervals".
    let step =
        before("sec").or_else(|| before("s").filter(|_| text.trim_end().ends_with(" s"))).and_then(|word| number(word));
    let step = step.ok_or_else(|| source.header_error(line, text, "a time step as 0.005 s"))?;
    raw.time_step = Some(StatedStep::exact(line, step));
    let factor = match text.split_once("in units of ") {
        Some((_, rest)) => rest.split_whitespace().next().and_then(number).filter(|factor| *factor != 0.0),
        None => Some(1.0),
    };
    let factor = factor.ok_or_else(|| source.header_error(line, text, "a unit as 1.00 mm/s/s"))?;

    // "Acceleration:  peak   -194.0 mm/s/s at  43.66 sec".
    let (line, text) = lines.get(PEAK).copied().unwrap_or((1, ""));
    let mut words = text.split_whitespace().skip(2);
    raw.peak = words.next().and_then(|peak| StatedPeak::printed(line, peak));
    let unit = words.next().unwrap_or("");
    raw.unit = Some(source.stated_unit(line, text, unit, "a peak with its unit, as 2394.8 mm/s/s")?);

    let values = fixed_columns(source, lines.iter().skip(HEADER_LINES).copied(), WIDTH)?;
    raw.values = values.into_iter().map(|value| value * factor).collect();
    Ok(raw)
}

/// Returns the counts of accelerations, velocities and displacements: the last three of six integers.
fn counts(source: &FileText<'_>, lines: &[(usize, &str)]) -> Result<[usize; 3], RecordError> {
    let (line, text) = lines.get(COUNTS).copied().unwrap_or((1, ""));
    let fields: Vec<&str> = fixed_width(text, WIDTH).collect();
    let counts: Option<Vec<usize>> =
        fields.get(3..6).and_then(|fields| fields.iter().map(|field| field.parse().ok()).collect());
    match counts.as_deref() {
        Some(&[acceleration, velocity, displacement]) => Ok([acceleration, velocity, displacement]),
        _ => Err(source.header_error(line, text, "ten integers, the 4th to 6th of them counts of values")),
    }
}
