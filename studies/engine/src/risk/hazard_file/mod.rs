//! CSV and JSON of this project, OpenQuake and the USGS → a hazard curve.
//!
//! | file | levels | content |
//! | --- | --- | --- |
//! | CSV with two columns, such as `PGA [g],rate [1/year]` | a row each | annual rates, or probabilities in some years |
//! | CSV of hazard curves exported by OpenQuake, a file for each measure | columns `poe-0.1` | probabilities in the `investigation_time` of the comment |
//! | the same with all measures in a file | columns `PGA-0.1` | the same |
//! | the same in its AELO mode | rows of `imt,iml,poe` | the same |
//! | CSV of hazard curves of nshmp-haz | columns `0.1` after `lon` and `lat` | annual rates, or probabilities in some years |
//! | JSON of the USGS hazard services, nshmp-haz-ws and its successor | arrays | annual rates |

use std::path::Path;

use serde_json::Value;

use crate::fragility::split_heading;
use crate::intensity::{Measure, canonical, si};
use crate::mismatch::Mismatch;
use crate::risk::hazard::HazardCurve;

/// Fewest levels of a curve in a file of all measures. A hazard map has columns of the same kind for a few probabilities.
const FEWEST_LEVELS: usize = 4;

/// Information that a file of hazard curves may lack, and the choice among its curves.
#[derive(Clone, Debug, PartialEq)]
pub struct HazardOptions {
    /// The intensity measure.
    pub measure: Option<String>,
    /// Unit of the levels.
    pub unit: Option<String>,
    /// Name of the site, or its longitude and latitude as in `-122.4,37.75`.
    pub site: Option<String>,
    /// Years to which the file's probabilities refer.
    pub years: Option<f64>,
    /// Kind of the curves that a file of OpenQuake must hold, such as `quantile-0.84`, instead of the mean.
    pub kind: Option<String>,
    /// Gravity (m/s²) for levels in g.
    pub gravity: f64,
}

/// Reads a hazard curve in SI units and annual rates. Probabilities p in T years become rates `−ln(1 − p)/T`.
///
/// `file` is the name of the file; the folder of an nshmp-haz table names its measure.
///
/// # Errors
/// Another format, several curves without a choice, or the errors of [`HazardCurve::new`].
pub fn read_hazard(file: &str, text: &str, options: &HazardOptions) -> Result<HazardCurve, Mismatch> {
    let text = text.trim_start_matches('\u{feff}');
    let raw = match text.trim_start().chars().next() {
        Some('{' | '[') => json(text, options)?,
        Some('<') => {
            let content = if text.contains("uniformHazardSpectra") { "uniform hazard spectra" } else { "hazard" };
            return Err(Mismatch::new(
                format!("XML, as NRML with {content} of OpenQuake"),
                "its export of hazard curves as CSV",
            ));
        }
        _ => csv(file, text, options)?,
    };
    raw.curve(options)
}

/// A curve as its file has it.
struct RawCurve {
    measure: Option<String>,
    /// Unit that the file names, or that its program uses.
    unit: Option<String>,
    levels: Vec<f64>,
    values: Vec<f64>,
    /// Years of the probabilities; annual rates without.
    years: Option<f64>,
}

impl RawCurve {
    fn curve(self, options: &HazardOptions) -> Result<HazardCurve, Mismatch> {
        let wanted = options.measure.as_deref().map(canonical);
        let mut remarks = Vec::new();
        let measure = match (self.measure, wanted) {
            (Some(found), Some(wanted)) if component_of(&wanted).as_ref() == Some(&found) => {
                remarks.push(format!(
                    "the curve names {found} alone, and was taken as one of {wanted}: the ground-motion model says which it is"
                ));
                Some(wanted)
            }
            (Some(found), Some(wanted)) if found != wanted => {
                return Err(Mismatch::new(format!("a hazard curve of {found}"), format!("one of {wanted}")));
            }
            (found, wanted) => found.or(wanted),
        };
        let unit = options.unit.clone().or(self.unit);
        let (unit, factor) = match unit.as_deref().map(|unit| (unit, si(unit, options.gravity))) {
            Some((_, Some((unit, factor)))) => (Some(unit.to_string()), factor),
            Some((unit, None)) => (Some(unit.to_string()), 1.0),
            None => (None, 1.0),
        };
        let (mut levels, mut values) = (self.levels, self.values);
        if levels.len() != values.len() {
            let found = format!("{} levels and {} values", levels.len(), values.len());
            return Err(Mismatch::new(found, "a value for each level"));
        }
        if let Some(years) = self.years {
            if let Some((level, value)) = levels.iter().zip(&values).find(|(_, value)| !(0.0..=1.0).contains(*value)) {
                return Err(Mismatch::new(format!("the probability {value} at the level {level}"), "0 to 1"));
            }
            let all = levels.len();
            (levels, values) = levels.into_iter().zip(values).filter(|(_, value)| *value < 1.0).unzip();
            if levels.len() < all {
                let certain = all - levels.len();
                remarks.push(format!("{certain} levels have a probability of 1, and so no rate, and were left out"));
            }
            values.iter_mut().for_each(|value| *value = -libm::log1p(-*value) / years);
        }
        let mut curve = HazardCurve::new(&levels, &values)?.scaled(factor);
        curve.remarks.splice(0..0, remarks);
        (curve.measure, curve.unit) = (measure, unit);
        Ok(curve)
    }
}

/// Returns the unit in which OpenQuake and the USGS state a measure.
fn usual_unit(measure: &str) -> Option<String> {
    let unit = match measure.parse::<Measure>().ok()?.of_component().0 {
        Measure::Pga | Measure::Sa(_) => "g",
        Measure::Pgv => "cm/s",
        Measure::Pgd => "cm",
        Measure::Cav => "g s",
        other => other.unit(),
    };
    Some(unit.into())
}

fn years(options: &HazardOptions, years_of_file: Option<f64>) -> Result<Option<f64>, Mismatch> {
    let found = |years: f64| format!("an investigation time of {years} years");
    match (options.years.or(years_of_file), years_of_file) {
        (Some(years), _) if !(years > 0.0 && years.is_finite()) => Err(Mismatch::new(found(years), "a number above 0")),
        (Some(years), Some(of_file)) if years != of_file => {
            Err(Mismatch::new(found(years), format!("{of_file}, as the file says")))
        }
        (years, _) => Ok(years),
    }
}

/// Refuses an investigation time for a file of annual rates.
fn check_without_years(options: &HazardOptions, place: &str) -> Result<(), Mismatch> {
    let refused = |years| {
        let found = format!("an investigation time of {years} years for {place}");
        Err(Mismatch::new(found, "none, as it holds annual rates"))
    };
    options.years.map_or(Ok(()), refused)
}

/// Refuses a site for a file that names none.
fn check_without_site(options: &HazardOptions) -> Result<(), Mismatch> {
    let refused = |site: &String| Err(Mismatch::new(format!("the site {site}"), "none, as the file names no sites"));
    options.site.as_ref().map_or(Ok(()), refused)
}

/// Refuses curves of another kind than the mean, unless they are asked for.
fn check_kind(options: &HazardOptions, kind_of_file: Option<String>) -> Result<(), Mismatch> {
    /// The kind of most files, and of those that name none.
    const MEAN: &str = "mean";
    let (wanted, found) = (options.kind.as_deref().unwrap_or(MEAN), kind_of_file.as_deref().unwrap_or(MEAN));
    match wanted == found {
        true => Ok(()),
        false if options.kind.is_none() => {
            let expected = format!("the mean, or the choice of this kind, {found}: rates are then of this kind, too");
            Err(Mismatch::new(format!("the curves of the kind {found}"), expected))
        }
        false => Err(Mismatch::new(format!("the curves of the kind {found}"), wanted)),
    }
}

fn number(text: &str, location: &str) -> Result<f64, Mismatch> {
    text.trim().parse().map_err(|_| Mismatch::new(format!("`{text}` in {location}"), "a number"))
}

fn csv(file: &str, text: &str, options: &HazardOptions) -> Result<RawCurve, Mismatch> {
    let unreadable = |error: csv::Error| Mismatch::new(error.to_string(), "CSV");
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
    let header = reader.headers().map_err(unreadable)?.clone();
    let rows = reader.records().collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
    let comment: String = text.lines().take_while(|line| line.starts_with('#')).collect();
    let value_in_comment = |key: &str| {
        let rest = comment.split_once(&format!("{key}="))?.1;
        // The comment may stand in quotes itself, and its values in single or double ones.
        Some(rest.trim_start_matches(['"', '\'', ' ']).split([',', '"', '\'']).next()?.trim().to_string())
    };
    let years_of_file =
        value_in_comment("investigation_time").map(|text| number(&text, "investigation_time")).transpose()?;
    check_kind(options, value_in_comment("kind"))?;
    let has_sites = header.iter().any(|name| name.eq_ignore_ascii_case("lon"));
    if let Some(columns) = positions(&header, ["imt", "iml", "poe"]) {
        let site = ["lon", "lat"].map(value_in_comment);
        return rows_of_measures(columns, &rows, site, years(options, years_of_file)?, options);
    }
    if let Some(name) = header.iter().find(|name| name.contains('~')) {
        return Err(Mismatch::new(format!("uniform hazard spectra, by the column `{name}`"), "hazard curves"));
    }
    // A file of all measures has a column for each level of each.
    let mut measures: Vec<String> = header.iter().filter_map(|name| Some(measure_and_level(name)?.0)).collect();
    measures.dedup();
    if !has_sites && measures.is_empty() && !header.iter().any(|name| name.starts_with("poe-")) {
        check_without_site(options)?;
        return two_columns(&header, &rows, years_of_file, options);
    }
    let of_all = match measures.is_empty() {
        true => None,
        false => Some(chosen_measure(&measures, options)?),
    };
    let is_openquake = of_all.is_some() || header.iter().any(|name| name.starts_with("poe-"));
    let level = |name: &str| match (&of_all, is_openquake) {
        (Some(measure), _) => measure_and_level(name).filter(|(found, _)| found == measure).map(|(_, level)| level),
        (None, true) => name.strip_prefix("poe-")?.parse().ok(),
        (None, false) => name.parse().ok(),
    };
    let columns: Vec<(usize, f64)> =
        header.iter().enumerate().filter_map(|(i, name)| Some((i, level(name)?))).collect();
    if let Some(measure) = &of_all
        && columns.len() < FEWEST_LEVELS
    {
        let found = format!("{} columns of {measure}, as in a map for some probabilities", columns.len());
        return Err(Mismatch::new(found, format!("a hazard curve of {FEWEST_LEVELS} levels or more")));
    }
    let row = site(&header, &rows, options.site.as_deref())?;
    let values = columns.iter().map(|&(i, level)| number(&row[i], &format!("the column of the level {level}")));
    let folder = Path::new(file).parent().and_then(Path::file_name).map(|name| canonical(&name.to_string_lossy()));
    let measure = of_all.or_else(|| match is_openquake {
        true => value_in_comment("imt").map(|name| canonical(&name)),
        false => folder.filter(|name| name.parse::<Measure>().is_ok()),
    });
    let years = years(options, years_of_file)?;
    if is_openquake && years.is_none() {
        return Err(Mismatch::new("no investigation_time in the comment", "the years of the probabilities"));
    }
    Ok(RawCurve {
        unit: measure.clone().or(options.measure.clone()).and_then(|measure| usual_unit(&canonical(&measure))),
        measure,
        levels: columns.iter().map(|column| column.1).collect(),
        values: values.collect::<Result<_, _>>()?,
        years,
    })
}

/// Returns the positions of columns, if the file has exactly these.
fn positions<const N: usize>(header: &csv::StringRecord, names: [&str; N]) -> Option<[usize; N]> {
    let found = names.map(|name| header.iter().position(|found| found.eq_ignore_ascii_case(name)));
    let all = header.len() == N && found.iter().all(Option::is_some);
    all.then(|| found.map(Option::unwrap_or_default))
}

/// Splits the name of a column such as `SA(0.2)-0.005` into its measure and its level.
fn measure_and_level(name: &str) -> Option<(String, f64)> {
    // The level may have an exponent, as 1E-04.
    let mut splits = name.match_indices('-').map(|(i, _)| (&name[..i], &name[i + 1..]));
    splits.find_map(|(measure, level)| {
        let measure = canonical(measure);
        measure.parse::<Measure>().ok()?;
        Some((measure, level.parse().ok()?))
    })
}

/// Returns the measure of a single component behind one of both: hazard curves name the measure, and their models how components combine.
fn component_of(measure: &str) -> Option<String> {
    let (component, over) = measure.parse::<Measure>().ok()?.of_component();
    over.map(|_| component.to_string())
}

/// Returns the wanted measure of several in a file, or the only one.
fn chosen_measure(measures: &[String], options: &HazardOptions) -> Result<String, Mismatch> {
    let wanted = options.measure.as_deref().map(canonical);
    match (&wanted, measures) {
        (Some(wanted), _) if measures.contains(wanted) => Ok(wanted.clone()),
        (Some(wanted), _) if component_of(wanted).is_some_and(|component| measures.contains(&component)) => {
            Ok(component_of(wanted).unwrap_or_default())
        }
        (None, [only]) => Ok(only.clone()),
        _ => {
            let expected = wanted.map_or("the choice of one".into(), |wanted| format!("one of {wanted}"));
            Err(Mismatch::new(format!("hazard curves of {}", measures.join(", ")), expected))
        }
    }
}

/// Reads rows of a measure, a level and a probability, of a single site.
fn rows_of_measures(
    [imt, iml, poe]: [usize; 3],
    rows: &[csv::StringRecord],
    site: [Option<String>; 2],
    years: Option<f64>,
    options: &HazardOptions,
) -> Result<RawCurve, Mismatch> {
    let mut measures: Vec<String> = rows.iter().map(|row| canonical(&row[imt])).collect();
    measures.dedup();
    let measure = chosen_measure(&measures, options)?;
    if let Some(wanted) = options.site.as_deref() {
        let found = site.map(|coordinate| coordinate.and_then(|text| text.parse::<f64>().ok()));
        let given: Option<Vec<f64>> = wanted.split(',').map(|part| part.trim().parse().ok()).collect();
        let [lon, lat] = found.map(|coordinate| coordinate.map_or("unknown".into(), |degrees| degrees.to_string()));
        if given != found.into_iter().collect() {
            return Err(Mismatch::new(format!("the site {wanted}"), format!("{lon},{lat}, the only one of the file")));
        }
    }
    if years.is_none() {
        return Err(Mismatch::new("no investigation_time in the comment", "the years of the probabilities"));
    }
    let of_measure = || rows.iter().filter(|row| canonical(&row[imt]) == measure);
    Ok(RawCurve {
        unit: usual_unit(&measure),
        levels: of_measure().map(|row| number(&row[iml], "iml")).collect::<Result<_, _>>()?,
        values: of_measure().map(|row| number(&row[poe], "poe")).collect::<Result<_, _>>()?,
        measure: Some(measure),
        years,
    })
}

/// Chooses the row of a site.
fn site<'a>(
    header: &csv::StringRecord,
    rows: &'a [csv::StringRecord],
    wanted: Option<&str>,
) -> Result<&'a csv::StringRecord, Mismatch> {
    let column = |name: &str| header.iter().position(|found| found.eq_ignore_ascii_case(name));
    let (name, lon, lat) = (column("name").or(column("custom_site_id")), column("lon"), column("lat"));
    let coordinates = |row: &csv::StringRecord| {
        let at = |column: Option<usize>| column.and_then(|i| row.get(i)?.parse::<f64>().ok());
        Some([at(lon)?, at(lat)?])
    };
    let label = |row: &csv::StringRecord| match (name.and_then(|i| row.get(i)), coordinates(row)) {
        (Some(name), _) => name.to_string(),
        (None, Some([lon, lat])) => format!("{lon},{lat}"),
        (None, None) => "a site without a name".into(),
    };
    let known = || rows.iter().take(8).map(label).collect::<Vec<_>>().join("; ");
    let wanted = match (wanted, rows) {
        (Some(wanted), _) => wanted,
        (None, [row]) => return Ok(row),
        (None, _) => {
            let more = if rows.len() > 8 { ", …" } else { "" };
            return Err(Mismatch::new(
                format!("{} sites", rows.len()),
                format!("the choice of one: {}{more}", known()),
            ));
        }
    };
    let at: Option<Vec<f64>> = wanted.split(',').map(|part| part.trim().parse().ok()).collect();
    let is_wanted = |row: &&csv::StringRecord| {
        name.is_some_and(|i| row[i].eq_ignore_ascii_case(wanted))
            || at.is_some() && coordinates(row).map(Vec::from) == at
    };
    rows.iter()
        .find(is_wanted)
        .ok_or_else(|| Mismatch::new(format!("no site {wanted}"), format!("one such as {}", known())))
}

/// Reads a table of levels and rates, or of levels and probabilities in some years.
fn two_columns(
    header: &csv::StringRecord,
    rows: &[csv::StringRecord],
    years_of_file: Option<f64>,
    options: &HazardOptions,
) -> Result<RawCurve, Mismatch> {
    const EXPECTED: &str = "a heading such as `PGA [g],rate [1/year]`, or the export of OpenQuake or nshmp-haz";
    let headings: Vec<&str> = header.iter().collect();
    let [level, value] = headings[..] else {
        return Err(Mismatch::new(format!("{} columns", headings.len()), EXPECTED));
    };
    if level.parse::<f64>().is_ok() || level.is_empty() {
        return Err(Mismatch::new(format!("`{level},{value}` in the first line"), EXPECTED));
    }
    let (name, unit) = split_heading(level);
    let lower = value.to_ascii_lowercase();
    let says = |words: &[&str]| words.iter().any(|word| lower.contains(word));
    let is_probability = says(&["poe", "prob"]);
    if !is_probability && says(&["rate", "frequency", "1/y", "1/a", "per year"]) {
        check_without_years(options, &format!("the column `{value}`"))?;
    }
    let unit = unit.filter(|unit| !unit.is_empty());
    if let (Some(of_file), Some(wanted)) = (unit, options.unit.as_deref())
        && of_file != wanted
        && (si(of_file, 1.0).is_none() || si(of_file, options.gravity) != si(wanted, options.gravity))
    {
        return Err(Mismatch::new(format!("the unit {wanted}"), format!("{of_file}, as the file says")));
    }
    let years = years(options, years_of_file.or_else(|| years_in(&lower).filter(|_| is_probability)))?;
    if is_probability && years.is_none() {
        return Err(Mismatch::new(format!("the column `{value}`"), "the investigation time of its probabilities"));
    }
    let column = |i: usize| rows.iter().map(|row| number(&row[i], headings[i])).collect::<Result<Vec<f64>, _>>();
    Ok(RawCurve {
        measure: Some(canonical(name)),
        unit: unit.map(String::from),
        levels: column(0)?,
        values: column(1)?,
        years,
    })
}

/// Returns the years in a heading such as `poe in 50 years`.
fn years_in(heading: &str) -> Option<f64> {
    let mut words = heading.match_indices('y').map(|(i, _)| heading.split_at(i));
    let (before, _) = words.find(|(_, after)| after.starts_with("yr") || after.starts_with("year"))?;
    let before = before.trim_end_matches([' ', '_', '-']);
    let digits = before.rfind(|c: char| !c.is_ascii_digit() && c != '.').map_or(0, |i| i + 1);
    before.get(digits..)?.parse().ok()
}

/// Reads the reply of a hazard service of the USGS.
fn json(text: &str, options: &HazardOptions) -> Result<RawCurve, Mismatch> {
    const EXPECTED: &str =
        "the reply of a hazard service of the USGS, with response.hazardCurves or response[].metadata.imt";
    check_without_site(options)?;
    let reply: Value = serde_json::from_str(text).map_err(|error| Mismatch::new(error.to_string(), "JSON"))?;
    let response = &reply["response"];
    let curves = response["hazardCurves"].as_array().or(response.as_array());
    let curves = curves.ok_or_else(|| Mismatch::new("JSON without hazard curves", EXPECTED))?;
    let name = |curve: &Value| {
        let imt = [&curve["imt"], &curve["metadata"]["imt"]].into_iter().find(|imt| !imt.is_null())?;
        imt["value"].as_str().or(imt.as_str()).map(canonical)
    };
    let known: Vec<String> = curves.iter().filter_map(name).collect();
    let wanted = options.measure.as_deref().map(canonical);
    let curve = match (&wanted, &curves[..]) {
        (Some(wanted), _) => curves.iter().find(|curve| name(curve).as_ref() == Some(wanted)),
        (None, [curve]) => Some(curve),
        (None, _) => None,
    };
    let curve = curve.ok_or_else(|| {
        let expected = wanted.map_or("the choice of one".into(), |wanted| format!("one of {wanted}"));
        Mismatch::new(format!("hazard curves of {}", known.join(", ")), expected)
    })?;
    let measure = name(curve);
    let components = curve["data"].as_array().map_or(&[][..], |components| components);
    let total = components
        .iter()
        .find(|component| component["component"].as_str().is_none_or(|name| name.eq_ignore_ascii_case("total")));
    let total = total.ok_or_else(|| Mismatch::new("no component `Total` in `data`", EXPECTED))?;
    let numbers = |choices: [&Value; 2], name: &str| {
        let array = choices.into_iter().find_map(Value::as_array);
        let array = array.ok_or_else(|| Mismatch::new(format!("no array {name}"), EXPECTED))?;
        let number =
            |value: &Value| value.as_f64().ok_or_else(|| Mismatch::new(format!("{value} in {name}"), "a number"));
        array.iter().map(number).collect::<Result<Vec<f64>, _>>()
    };
    check_without_years(options, "the reply of a hazard service")?;
    Ok(RawCurve {
        unit: measure.as_deref().and_then(usual_unit),
        measure,
        levels: numbers([&total["values"]["xs"], &curve["metadata"]["xvalues"]], "xs or xvalues")?,
        values: numbers([&total["values"]["ys"], &total["yvalues"]], "ys or yvalues")?,
        years: None,
    })
}

#[cfg(test)]
mod tests;
