//! Text files of the Central Weather Administration of Taiwan (earlier Central Weather Bureau): lines `#Key: value`, then rows of a time
//! and three components.

use super::channels;
use super::claims::StatedStep;
use super::error::RecordError;
use super::format::Format;
use super::options::Choice;
use super::raw::{Raw, StatedCount, StatedPeak};
use super::rows::Rows;
use super::text::{FileText, fixed_width, number};

/// Width of a column: the format is 4F10.3.
const WIDTH: usize = 10;

/// Returns whether a line is the one common to all headers.
pub(super) fn is_header_line(line: &str) -> bool {
    line.starts_with("#DataSequence: Time ")
}

/// Reads one component.
pub(super) fn read(source: &FileText<'_>, wanted: Option<&Choice>) -> Result<Raw, RecordError> {
    let mut raw = Raw::new(Format::Cwb);
    let (mut names, mut peaks, mut title) = (Vec::new(), Vec::new(), Vec::new());
    let (mut rate, mut length, mut last) = (None, None, 1);
    let mut lines = source.lines().peekable();
    while let Some((line, text)) = lines.next_if(|(_, text)| text.starts_with('#') || text.trim().is_empty()) {
        last = line;
        let Some((key, value)) = text.split_once(':').map(|(key, value)| (key.trim(), value.trim())) else { continue };
        match key {
            "#StationCode" | "#StationName" | "#StartTime(GMT+08)" => title.push(value.to_owned()),
            "#SampleRate(Hz)" => {
                rate = number(value).filter(|rate| rate.is_finite() && *rate > 0.0).map(|rate| (line, rate))
            }
            "#RecordLength(sec)" => length = number(value).map(|length| (line, length)),
            "#AmplitudeUnit" => {
                let unit = value.split_whitespace().next().unwrap_or("").trim_end_matches('.');
                raw.unit = Some(source.stated_unit(line, text, unit, "a unit as gal")?);
            }
            // "Time U(+); N(+); E(+)"
            "#DataSequence" => {
                let columns = value.trim_start_matches("Time").split(';');
                names = columns.map(|name| name.split('(').next().unwrap_or("").trim().to_owned()).collect();
            }
            // "#AmplitudeMAX. U:    6.999~   -7.118"
            _ => peaks.extend(key.strip_prefix("#AmplitudeMAX.").map(|name| (name.trim(), line, value))),
        }
    }
    let missing = |key: &str| source.missing_line(last, key);
    let (rate_line, rate) = rate.ok_or_else(|| missing("#SampleRate(Hz): 100"))?;
    raw.time_step = Some(StatedStep::exact(rate_line, 1.0 / rate));
    let (line, length) = length.ok_or_else(|| missing("#RecordLength(sec): 120"))?;
    // A conversion from floating point saturates.
    let value = (length * rate).round() as usize;
    raw.count = Some(StatedCount { line, key: "#RecordLength(sec) times #SampleRate(Hz)", value });
    let chosen = channels::index(source, &names, wanted)?;
    let name = names.get(chosen).map_or("", |name| name);
    let range = peaks.iter().find(|(of, ..)| *of == name);
    let ends = range
        .into_iter()
        .flat_map(|&(_, line, range)| range.split('~').filter_map(move |end| StatedPeak::printed(line, end.trim())));
    raw.peak = ends.max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()));
    title.push(name.to_owned());
    raw.title = title.join(", ");

    let rows = Rows { columns: names.len() + 1, time: Some(0), chosen: chosen + 1 };
    let (values, axis) = rows.read(source, lines, |text| fixed_width(text, WIDTH))?;
    axis.even_spacing(source)?;
    raw.values = values;
    Ok(raw)
}
