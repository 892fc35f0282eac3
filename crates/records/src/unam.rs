//! Standard acceleration files of the Universidad Nacional Autónoma de México and of the Red Acelerográfica de la Ciudad de México: lines
//! `KEY : value` with a value a channel after `/`, then rows of all channels.

use super::channels;
use super::claims::StatedStep;
use super::error::RecordError;
use super::format::Format;
use super::options::Choice;
use super::raw::{Raw, StatedCount, StatedPeak};
use super::rows::Rows;
use super::text::{FileText, fixed_width};

/// Beginning of the line above the channels.
const DATA: &str = "DATOS DE ACELERACION";

/// Largest number of rows beyond the stated count.
const MAX_REPEATED: usize = 2;

/// Returns whether a line names the format.
pub(super) fn is_header_line(line: &str) -> bool {
    line.starts_with("ARCHIVO ESTANDAR DE ACELERACION")
}

/// Reads one channel.
pub(super) fn read(source: &FileText<'_>, wanted: Option<&Choice>) -> Result<Raw, RecordError> {
    let mut raw = Raw::new(Format::Unam);
    let header: Vec<(usize, &str)> = source.lines().take_while(|(_, text)| !text.starts_with(DATA)).collect();
    let missing = |expected: &str| source.missing_line(header.len(), expected);
    let value = |key: &str| {
        let found = header.iter().find(|(_, text)| text.starts_with(key));
        let value = found.and_then(|&(line, text)| Some((line, text.split_once(" :")?.1.trim())));
        value.ok_or_else(|| missing(key))
    };
    // A value for each channel, in two lines.
    let values = |first: &str, second: &str| -> Result<Vec<(usize, &str)>, RecordError> {
        let mut all = Vec::new();
        for key in [first, second] {
            let (line, list) = value(key)?;
            all.extend(list.split('/').skip(1).map(|item| (line, item.trim())));
        }
        Ok(all)
    };
    let (line, count) = value("NUMERO DE CANALES")?;
    let count: usize = count.parse().map_err(|_| source.header_error(line, count, "a count of channels"))?;
    let names: Vec<&str> =
        values("ORIENTACION C1-C6", "ORIENTACION C7-C12")?.into_iter().map(|(_, name)| name).collect();
    if names.len() != count {
        return Err(source.header_error(
            line,
            &format!("{count} channels"),
            format!("{} as in ORIENTACION", names.len()),
        ));
    }
    let chosen = channels::index(source, &names, wanted)?;
    let of_channel = |first: &str, second: &str| {
        let found = values(first, second)?.get(chosen).copied();
        found.ok_or_else(|| missing(&format!("{first} with {count} values after /")))
    };

    let (line, step) = of_channel("INTERVALO DE MUESTREO, C1", "INTERVALO DE MUESTREO, C7")?;
    raw.time_step = Some(StatedStep::exact(line, source.number(line, step)?));
    let (count_line, text) = of_channel("NUM. TOTAL DE MUESTRAS, C1", "NUM. TOTAL DE MUESTRAS, C7")?;
    let value_count = text.parse().map_err(|_| source.header_error(count_line, text, "a count of values"))?;
    raw.count = Some(StatedCount { line: count_line, key: "NUM. TOTAL DE MUESTRAS", value: value_count });
    let (line, peak) = of_channel("ACEL. MAX.(Gal), C1", "ACEL. MAX.(Gal), C7")?;
    raw.peak = StatedPeak::printed(line, peak);
    let (line, unit) = value("UNIDADES DE LOS DATOS")?;
    let stated = unit.split_whitespace().next().unwrap_or("");
    raw.unit = Some(source.stated_unit(line, unit, stated, "a unit as Gal (cm/s/s)")?);
    let (line, factor) = value("FACTOR DE DECIMACION")?;
    if factor != "1" {
        return Err(source.header_error(line, factor, "a factor of decimation of 1"));
    }
    let (line, format) = value("FORMATO DATOS")?;
    let width = format.split_once(['F', 'f']).and_then(|(_, rest)| rest.split('.').next()?.parse().ok());
    let width: usize = width.ok_or_else(|| source.header_error(line, format, "a Fortran format as 3F10.4"))?;
    let (_, station) = value("NOMBRE DE LA ESTACION")?;
    let (_, day) = value("FECHA DEL SISMO")?;
    raw.title = [station, day, names.get(chosen).map_or("", |name| name)].join(", ");

    // Below the heading stand the names of the channels between two rules.
    let mut rules = 0;
    let rows = source.lines().skip(header.len()).skip_while(|(_, text)| {
        let is_first_row = rules == 2;
        rules += usize::from(text.starts_with("---------+"));
        !is_first_row
    });
    (raw.values, _) =
        Rows { columns: count, time: None, chosen }.read(source, rows, |text| fixed_width(text, width))?;
    // Some files repeat their last row.
    if let Some(repeated) =
        raw.values.len().checked_sub(value_count).filter(|repeated| (1..=MAX_REPEATED).contains(repeated))
    {
        raw.values.truncate(value_count);
        raw.doubt = Some(format!("line {count_line} states {value_count} values; {repeated} after them are left out"));
    }
    Ok(raw)
}
