//! Files of K-NET and KiK-net, National Research Institute for Earth Science and Disaster Resilience, Japan.
//!
//! The ASCII file has one component as instrument counts, below 17 lines of a key and a value. Its acceleration is (count − mean) times the
//! scale factor, as in `3920(gal)/6182761`. The CSV file has all components in gal, with their offsets in the header.

use super::channels;
use super::claims::StatedStep;
use super::error::RecordError;
use super::format::Format;
use super::options::Choice;
use super::raw::{Raw, StatedCount, StatedPeak};
use super::rows::Rows;
use super::text::{FileText, Values, number, squeezed};
use super::unit::Unit;

/// Width of a key in the ASCII file.
const KEY: usize = 18;

/// Width of a column of counts.
const WIDTH: usize = 9;

/// Beginning of the names of columns in the CSV file.
const NAMES: &str = "#Time,RelativeTime(s),";

/// Names of the directions 1 to 6 of KiK-net: in the borehole, then at the surface.
const DIRECTIONS: [&str; 6] = ["NS1", "EW1", "UD1", "NS2", "EW2", "UD2"];

/// Returns whether a line occurs in all headers. It is that of the scale factor, or of the names of the columns.
pub(super) fn is_header_line(line: &str) -> bool {
    line.starts_with("Scale Factor") && line.contains("(gal)/") || line.starts_with(NAMES)
}

/// Reads one component.
pub(super) fn read(source: &FileText<'_>, wanted: Option<&Choice>) -> Result<Raw, RecordError> {
    let is_csv = source.lines().any(|(_, text)| text.starts_with(NAMES));
    if is_csv { read_csv(source, wanted) } else { read_ascii(source, wanted) }
}

fn read_ascii(source: &FileText<'_>, wanted: Option<&Choice>) -> Result<Raw, RecordError> {
    let mut raw = Raw::new(Format::Knet);
    let (mut origin, mut station, mut direction) = ("", "", String::new());
    let (mut scale, mut rate, mut duration) = (None, None, None);
    let mut lines = source.lines();
    let mut last = 1;
    for (line, text) in lines.by_ref() {
        last = line;
        let (key, value) = text.split_at_checked(KEY.min(text.len())).unwrap_or((text, ""));
        let value = value.trim();
        match key.trim() {
            "Origin Time" => origin = value,
            "Station Code" => station = value,
            "Dir." => {
                let code = value.parse::<usize>().ok().and_then(|code| DIRECTIONS.get(code.checked_sub(1)?));
                direction = code.map_or(value, |name| name).to_owned();
            }
            "Sampling Freq(Hz)" => rate = Some(sampling_rate(source, line, value)?),
            "Duration Time(s)" => duration = Some((line, source.number(line, value)?)),
            "Scale Factor" => {
                let factor = || {
                    let (gal, counts) = value.split_once("(gal)/")?;
                    let factor = number(gal.trim())? / number(counts.trim())?;
                    (factor.is_finite() && factor != 0.0).then_some(factor)
                };
                let expected = "a scale factor as 3920(gal)/6182761";
                scale = Some(factor().ok_or_else(|| source.header_error(line, text, expected))?);
                raw.unit = Some((line, Unit::CentimetrePerSecondSquared));
            }
            "Max. Acc. (gal)" => raw.peak = StatedPeak::printed(line, value),
            "Memo." => break,
            _ => {}
        }
    }
    let missing = |key: &str| source.missing_line(last, &format!("of {key:?}"));
    let scale = scale.ok_or_else(|| missing("Scale Factor"))?;
    let (rate_line, rate) = rate.ok_or_else(|| missing("Sampling Freq(Hz)"))?;
    let (line, duration) = duration.ok_or_else(|| missing("Duration Time(s)"))?;
    raw.time_step = Some(StatedStep::exact(rate_line, 1.0 / rate));
    raw.count = Some(count(line, "Duration Time(s) times Sampling Freq(Hz)", duration * rate));
    channels::index(source, std::slice::from_ref(&direction), wanted)?;
    raw.title = [station, origin, &direction].join(", ");

    let mut counts = Values::new(source);
    let (mut end_of_column, mut last) = (None, None);
    for (line, text) in lines {
        if let Some(first) = text.split_whitespace().next() {
            end_of_column.get_or_insert(text.find(first).unwrap_or(0) + first.len());
            last = Some((line, text));
        }
        for token in text.split_whitespace() {
            counts.push(line, token)?;
        }
    }
    let counts = counts.finish()?;
    if let (Some(end), Some((line, text))) = (end_of_column, last) {
        source.check_last_column(line, text, WIDTH, end)?;
    }
    let mean = counts.iter().sum::<f64>() / counts.len() as f64;
    raw.values = counts.into_iter().map(|count| (count - mean) * scale).collect();
    Ok(raw)
}

fn read_csv(source: &FileText<'_>, wanted: Option<&Choice>) -> Result<Raw, RecordError> {
    let mut raw = Raw::new(Format::Knet);
    let header: Vec<(usize, &str)> = source.lines().take_while(|(_, text)| text.starts_with('#')).collect();
    let after = |key: &str, lines: usize| {
        let index = header.iter().position(|(_, text)| squeezed(text).eq_ignore_ascii_case(key));
        let found = index.and_then(|index| header.get(index + lines));
        let missing = || source.missing_line(header.len().max(1), key);
        found.map(|&(line, text)| (line, text.trim_start_matches('#').trim())).ok_or_else(missing)
    };
    let (names_line, names) = header.last().copied().unwrap_or((1, ""));
    let names: Vec<&str> = names.strip_prefix(NAMES).unwrap_or_default().split(',').map(str::trim).collect();
    let (words, units): (Vec<&str>, Vec<&str>) =
        names.iter().map(|name| name.split_once('(').unwrap_or((name, ""))).unzip();
    let chosen = channels::index(source, &words, wanted)?;
    let unit = units.get(chosen).map_or("", |unit| unit.trim_end_matches(')'));
    let expected = "a unit after each name, as N-S(gal)";
    raw.unit = Some(source.stated_unit(names_line, &names.join(","), unit, expected)?);

    let (line, rate) = after("#SamplingFrequency(Hz)", 1)?;
    let (rate_line, rate) = sampling_rate(source, line, rate)?;
    raw.time_step = Some(StatedStep::exact(rate_line, 1.0 / rate));
    let (line, duration) = after("#DurationTime(s)", 1)?;
    raw.count =
        Some(count(line, "#DurationTime(s) times #SamplingFrequency(Hz)", source.number(line, duration)? * rate));
    let (line, offsets) = after("#Offset", 2)?;
    let offset = offsets.split(',').nth(chosen).unwrap_or("");
    let offset = source.number(line, offset.trim())?;
    let (_, station) = after("#Station", 2)?;
    let (_, event) = after("#Event", 2)?;
    let [station, event] = [station, event].map(|list| list.split(',').next().unwrap_or_default().trim());
    raw.title = [station, event, words.get(chosen).copied().unwrap_or_default()].join(", ");

    let rows = Rows { columns: names.len() + 2, time: Some(1), chosen: chosen + 2 };
    let (values, axis) = rows.read(source, source.lines().skip(header.len()), |text| text.split(',').map(str::trim))?;
    axis.even_spacing(source)?;
    raw.values = values.into_iter().map(|value| value - offset).collect();
    Ok(raw)
}

/// Reads a rate such as `100Hz`, with its line.
fn sampling_rate(source: &FileText<'_>, line: usize, text: &str) -> Result<(usize, f64), RecordError> {
    let rate = number(text.trim_end_matches(|c: char| c.is_alphabetic()).trim())
        .filter(|rate| rate.is_finite() && *rate > 0.0);
    rate.map(|rate| (line, rate)).ok_or_else(|| source.header_error(line, text, "a sampling rate above 0 Hz, as 100Hz"))
}

/// Returns the count of samples that rate and duration give.
fn count(line: usize, key: &'static str, value: f64) -> StatedCount {
    // A conversion from floating point saturates.
    StatedCount { line, key, value: value.round() as usize }
}
