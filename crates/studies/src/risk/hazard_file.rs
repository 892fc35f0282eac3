//! CSV and JSON of this project, OpenQuake and the USGS → a hazard curve.
//!
//! | file | levels | content |
//! | --- | --- | --- |
//! | CSV with two columns, such as `PGA [g],rate [1/year]` | a row each | annual rates, or probabilities in some years |
//! | CSV of hazard curves exported by OpenQuake | columns `poe-0.1` | probabilities in the `investigation_time` of the comment |
//! | CSV of hazard curves of nshmp-haz | columns `0.1` after `lon` and `lat` | annual rates, or probabilities in some years |
//! | JSON of the USGS hazard services, nshmp-haz-ws and its successor | arrays | annual rates |

use std::path::Path;

use serde_json::Value;

use crate::fragility::split_heading;
use crate::intensity::Measure;
use crate::risk::hazard::{HazardCurve, HazardError};
use crate::risk::units::si;

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
    /// Gravity (m/s²) for levels in g.
    pub gravity: f64,
}

/// Reads a hazard curve and converts its levels to SI units and its probabilities p in T years to rates, `−ln(1 − p)/T`.
///
/// `file` is the name of the file; the folder of an nshmp-haz table names its measure.
///
/// # Errors
/// Another format, several curves without a choice, or the errors of [`HazardCurve::new`].
pub fn read_hazard(file: &str, text: &str, options: &HazardOptions) -> Result<HazardCurve, HazardError> {
    let text = text.trim_start_matches('\u{feff}');
    let raw = match text.trim_start().starts_with(['{', '[']) {
        true => json(text, options)?,
        false => csv(file, text, options)?,
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
    fn curve(self, options: &HazardOptions) -> Result<HazardCurve, HazardError> {
        let wanted = options.measure.as_deref().map(canonical);
        let measure = match (self.measure, wanted) {
            (Some(found), Some(wanted)) if found != wanted => {
                return Err(HazardError::new(format!("a hazard curve of {found}"), format!("one of {wanted}")));
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
        let mut remark = None;
        if let Some(years) = self.years {
            if let Some((level, value)) = levels.iter().zip(&values).find(|(_, value)| !(0.0..=1.0).contains(*value)) {
                return Err(HazardError::new(format!("the probability {value} at the level {level}"), "0 to 1"));
            }
            let certain = values.iter().filter(|value| **value == 1.0).count();
            if certain > 0 {
                remark = Some(format!("{certain} levels have a probability of 1, and so no rate, and were left out"));
                (levels, values) = (levels.split_off(certain), values.split_off(certain));
            }
            values.iter_mut().for_each(|value| *value = -libm::log1p(-*value) / years);
        }
        let mut curve = HazardCurve::new(&levels, &values)?.scaled(factor);
        curve.remarks.splice(0..0, remark);
        (curve.measure, curve.unit) = (measure, unit);
        Ok(curve)
    }
}

/// Returns the name of a measure in this project for that of another program, such as `SA(1.0)` or `SA1P0`.
fn canonical(name: &str) -> String {
    let lower = name.trim().to_ascii_lowercase().replace("sa_", "sa");
    let period = lower.strip_prefix("sa").map(|rest| rest.trim_matches(['(', ')', 's', ' ']).replace('p', "."));
    if let Some(period) = period.and_then(|period| period.parse::<f64>().ok()) {
        return Measure::Sa(period).to_string();
    }
    match lower.as_str() {
        "ia" => Measure::Arias.to_string(),
        "rsd595" => Measure::SignificantDuration.to_string(),
        _ => lower.parse::<Measure>().map_or(name.trim().to_string(), |measure| measure.to_string()),
    }
}

/// Returns the unit in which OpenQuake and the USGS state a measure.
fn usual_unit(measure: &str) -> Option<String> {
    let unit = match measure.parse().ok()? {
        Measure::Pga | Measure::Sa(_) => "g",
        Measure::Pgv => "cm/s",
        Measure::Pgd => "cm",
        Measure::Cav => "g s",
        other => other.unit(),
    };
    Some(unit.into())
}

fn years(options: &HazardOptions, years_of_file: Option<f64>) -> Result<Option<f64>, HazardError> {
    match options.years.or(years_of_file) {
        Some(years) if !(years > 0.0 && years.is_finite()) => {
            Err(HazardError::new(format!("an investigation time of {years} years"), "a number above 0"))
        }
        years => Ok(years),
    }
}

fn number(text: &str, location: &str) -> Result<f64, HazardError> {
    text.trim().parse().map_err(|_| HazardError::new(format!("`{text}` in {location}"), "a number"))
}

fn csv(file: &str, text: &str, options: &HazardOptions) -> Result<RawCurve, HazardError> {
    let unreadable = |error: csv::Error| HazardError::new(error.to_string(), "CSV");
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
    let header = reader.headers().map_err(unreadable)?.clone();
    let rows = reader.records().collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
    let comment: String = text.lines().take_while(|line| line.starts_with('#')).collect();
    let value_in_comment = |key: &str| {
        let rest = comment.split_once(&format!("{key}="))?.1;
        Some(rest.split([',', '"']).next()?.trim_matches(['\'', ' ']).to_string())
    };
    let is_openquake = header.iter().any(|name| name.starts_with("poe-"));
    let has_sites = header.iter().any(|name| name.eq_ignore_ascii_case("lon"));
    if !is_openquake && !has_sites {
        return two_columns(&header, &rows, options);
    }
    let level = |name: &str| if is_openquake { name.strip_prefix("poe-")?.parse().ok() } else { name.parse().ok() };
    let columns: Vec<(usize, f64)> =
        header.iter().enumerate().filter_map(|(i, name)| Some((i, level(name)?))).collect();
    let row = site(&header, &rows, options.site.as_deref())?;
    let values = columns.iter().map(|&(i, level)| number(&row[i], &format!("the column of the level {level}")));
    let folder = Path::new(file).parent().and_then(Path::file_name).map(|name| canonical(&name.to_string_lossy()));
    let measure = match is_openquake {
        true => value_in_comment("imt").map(|name| canonical(&name)),
        false => folder.filter(|name| name.parse::<Measure>().is_ok()),
    };
    let years_of_file =
        value_in_comment("investigation_time").map(|text| number(&text, "investigation_time")).transpose()?;
    let years = years(options, years_of_file)?;
    if is_openquake && years.is_none() {
        return Err(HazardError::new("no investigation_time in the comment", "the years of the probabilities"));
    }
    Ok(RawCurve {
        unit: measure.clone().or(options.measure.clone()).and_then(|measure| usual_unit(&canonical(&measure))),
        measure,
        levels: columns.iter().map(|column| column.1).collect(),
        values: values.collect::<Result<_, _>>()?,
        years,
    })
}

/// Chooses the row of a site.
fn site<'a>(
    header: &csv::StringRecord,
    rows: &'a [csv::StringRecord],
    wanted: Option<&str>,
) -> Result<&'a csv::StringRecord, HazardError> {
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
    let Some(wanted) = wanted else {
        return match rows {
            [row] => Ok(row),
            _ => {
                let known: Vec<String> = rows.iter().take(8).map(label).collect();
                let more = if rows.len() > 8 { ", …" } else { "" };
                let found = format!("{} sites", rows.len());
                Err(HazardError::new(found, format!("the choice of one: {}{more}", known.join("; "))))
            }
        };
    };
    let at: Option<Vec<f64>> = wanted.split(',').map(|part| part.trim().parse().ok()).collect();
    let is_wanted = |row: &&csv::StringRecord| {
        name.is_some_and(|i| row[i].eq_ignore_ascii_case(wanted))
            || at.is_some() && coordinates(row).map(Vec::from) == at
    };
    let known = || rows.iter().take(8).map(label).collect::<Vec<_>>().join("; ");
    rows.iter()
        .find(is_wanted)
        .ok_or_else(|| HazardError::new(format!("no site {wanted}"), format!("one such as {}", known())))
}

/// Reads a table of levels and rates, or of levels and probabilities in some years.
fn two_columns(
    header: &csv::StringRecord,
    rows: &[csv::StringRecord],
    options: &HazardOptions,
) -> Result<RawCurve, HazardError> {
    const EXPECTED: &str = "a heading such as `PGA [g],rate [1/year]`, or the export of OpenQuake or nshmp-haz";
    let headings: Vec<&str> = header.iter().collect();
    let [level, value] = headings[..] else {
        return Err(HazardError::new(format!("{} columns", headings.len()), EXPECTED));
    };
    if level.parse::<f64>().is_ok() || level.is_empty() {
        return Err(HazardError::new(format!("`{level},{value}` in the first line"), EXPECTED));
    }
    let (name, unit) = split_heading(level);
    let years = years(options, None)?;
    let is_probability = ["poe", "prob"].iter().any(|word| value.to_ascii_lowercase().contains(word));
    if is_probability && years.is_none() {
        return Err(HazardError::new(format!("the column `{value}`"), "the investigation time of its probabilities"));
    }
    let column = |i: usize| rows.iter().map(|row| number(&row[i], headings[i])).collect::<Result<Vec<f64>, _>>();
    Ok(RawCurve {
        measure: Some(canonical(name)),
        unit: unit.filter(|unit| !unit.is_empty()).map(String::from),
        levels: column(0)?,
        values: column(1)?,
        years,
    })
}

/// Reads the reply of a hazard service of the USGS.
fn json(text: &str, options: &HazardOptions) -> Result<RawCurve, HazardError> {
    const EXPECTED: &str =
        "the reply of a hazard service of the USGS, with response.hazardCurves or response[].metadata.imt";
    let reply: Value = serde_json::from_str(text).map_err(|error| HazardError::new(error.to_string(), "JSON"))?;
    let response = &reply["response"];
    let curves = response["hazardCurves"].as_array().or(response.as_array());
    let curves = curves.ok_or_else(|| HazardError::new("JSON without hazard curves", EXPECTED))?;
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
        HazardError::new(format!("hazard curves of {}", known.join(", ")), expected)
    })?;
    let measure = name(curve);
    let components = curve["data"].as_array().map_or(&[][..], |components| components);
    let total = components
        .iter()
        .find(|component| component["component"].as_str().is_none_or(|name| name.eq_ignore_ascii_case("total")));
    let total = total.ok_or_else(|| HazardError::new("no component `Total` in `data`", EXPECTED))?;
    let numbers = |choices: [&Value; 2], name: &str| {
        let array = choices.into_iter().find_map(Value::as_array);
        let array = array.ok_or_else(|| HazardError::new(format!("no array {name}"), EXPECTED))?;
        let number =
            |value: &Value| value.as_f64().ok_or_else(|| HazardError::new(format!("{value} in {name}"), "a number"));
        array.iter().map(number).collect::<Result<Vec<f64>, _>>()
    };
    Ok(RawCurve {
        unit: measure.as_deref().and_then(usual_unit),
        measure,
        levels: numbers([&total["values"]["xs"], &curve["metadata"]["xvalues"]], "xs or xvalues")?,
        values: numbers([&total["values"]["ys"], &total["yvalues"]], "ys or yvalues")?,
        years: years(options, None)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options() -> HazardOptions {
        HazardOptions { measure: None, unit: None, site: None, years: None, gravity: 10.0 }
    }

    #[track_caller]
    fn assert_curve(found: &HazardCurve, measure: &str, unit: &str, levels: &[f64], rates: &[f64]) {
        assert_eq!((found.measure.as_deref(), found.unit.as_deref()), (Some(measure), Some(unit)));
        for (found, exact) in [(found.levels(), levels), (found.rates(), rates)] {
            assert_eq!(found.len(), exact.len());
            for (found, exact) in found.iter().zip(exact) {
                assert!((found / exact - 1.0).abs() < 1e-14, "{found}, exactly {exact}");
            }
        }
    }

    #[test]
    fn two_columns_are_rates_or_probabilities() {
        let text = "# any remark\nPGA [g],rate [1/year]\n0.1, 1e-2\n0.2,1e-3\n";
        assert_curve(&read_hazard("h.csv", text, &options()).unwrap(), "PGA", "m/s2", &[1.0, 2.0], &[1e-2, 1e-3]);
        let text = "SA(0.50) [cm/s2],POE in 50 years\n10,0.5\n20,0.1\n";
        let refused = read_hazard("h.csv", text, &options()).unwrap_err().to_string();
        assert_eq!(refused, "found the column `POE in 50 years`; expected the investigation time of its probabilities");
        let found = read_hazard("h.csv", text, &HazardOptions { years: Some(50.0), ..options() }).unwrap();
        let rates = [0.5_f64.ln() / -50.0, 0.9_f64.ln() / -50.0];
        assert_curve(&found, "Sa(0.5 s)", "m/s2", &[0.1, 0.2], &rates);
    }

    /// The layout of OpenQuake 3.18 and later, and that of earlier versions.
    #[test]
    fn openquake_exports_have_probabilities_in_an_investigation_time() {
        let comment =
            "#,,,,,\"generated_by='OpenQuake engine 3.20.0', kind='mean', investigation_time=50.0, imt='SA(1.0)'\"";
        for comment in [comment, "# kind='mean', investigation_time=50.0, imt='SA(1.0)'"] {
            let rows = "0.00000,0.00000,0.0,1.000000E+00,5.000000E-01,1.000000E-01,0.000000E+00\n\
                        1.00000,2.50000,0.0,9.000000E-01,2.000000E-01,1.000000E-01,5.000000E-02\n";
            let text =
                format!("{comment}\nlon,lat,depth,poe-0.0050000,poe-0.1000000,poe-0.4000000,poe-0.6000000\n{rows}");
            let of = |site: &str| read_hazard("h.csv", &text, &HazardOptions { site: Some(site.into()), ..options() });
            let found = of("0, 0").unwrap();
            let rate = |poe: f64| -(1.0 - poe).ln() / 50.0;
            assert_curve(&found, "Sa(1 s)", "m/s2", &[1.0, 4.0], &[rate(0.5), rate(0.1)]);
            assert_eq!(
                found.remarks,
                [
                    "1 levels have a probability of 1, and so no rate, and were left out",
                    "1 levels from 0.6 on have a rate of 0 and were left out"
                ]
            );
            let rates = [0.9, 0.2, 0.1, 0.05].map(rate);
            assert_curve(&of("1,2.5").unwrap(), "Sa(1 s)", "m/s2", &[0.05, 1.0, 4.0, 6.0], &rates);
            let refused = read_hazard("h.csv", &text, &options()).unwrap_err().to_string();
            assert_eq!(refused, "found 2 sites; expected the choice of one: 0,0; 1,2.5");
            assert!(of("3,3").unwrap_err().to_string().starts_with("found no site 3,3; expected one such as 0,0"));
        }
        let text = "lon,lat,depth,poe-0.1,poe-0.2\n0,0,0,0.2,0.1\n";
        assert!(read_hazard("h.csv", text, &options()).unwrap_err().to_string().contains("no investigation_time"));
    }

    #[test]
    fn nshmp_haz_tables_have_a_row_for_each_site_and_a_folder_for_each_measure() {
        let text = "name,lon,lat,0.005,0.05,0.5\nOakland CA,-122.25,37.80,2e-3,1e-3,1e-4\nSan Jose CA,-121.90,37.35,1e-3,1e-4,0.0\n";
        let of = |site: &str| HazardOptions { site: Some(site.into()), ..options() };
        let found = read_hazard("curves/SA0P2/total.csv", text, &of("san jose ca")).unwrap();
        assert_curve(&found, "Sa(0.2 s)", "m/s2", &[0.05, 0.5], &[1e-3, 1e-4]);
        let found =
            read_hazard("total.csv", text, &HazardOptions { measure: Some("PGV".into()), ..of("-122.25,37.8") });
        assert_curve(&found.unwrap(), "PGV", "m/s", &[5e-5, 5e-4, 5e-3], &[2e-3, 1e-3, 1e-4]);
    }

    /// The replies of nshmp-haz-ws and of the service that followed it.
    #[test]
    fn usgs_services_reply_with_annual_rates() {
        let old = r#"{"status": "success", "response": [{"metadata": {"imt": {"value": "SA1P0", "display": "1.00 Second"},
            "xlabel": "Ground Motion (g)", "xvalues": [0.01, 0.1], "ylabel": "Annual Frequency of Exceedence"},
            "data": [{"component": "Fault", "yvalues": [1, 1]}, {"component": "Total", "yvalues": [0.02, 0.001]}]}]}"#;
        assert_curve(&read_hazard("h.json", old, &options()).unwrap(), "Sa(1 s)", "m/s2", &[0.1, 1.0], &[0.02, 0.001]);
        let new = r#"{"status": "success", "response": {"hazardCurves": [
            {"imt": {"value": "PGA"}, "data": [{"component": "Total", "values": {"xs": [0.01, 0.1], "ys": [0.03, 0.002]}}]},
            {"imt": {"value": "SA0P2"}, "data": [{"component": "Total", "values": {"xs": [0.1, 0.2], "ys": [0.3, 0.2]}}]}]}}"#;
        let of = |name: &str| HazardOptions { measure: Some(name.into()), ..options() };
        assert_curve(&read_hazard("h.json", new, &of("PGA")).unwrap(), "PGA", "m/s2", &[0.1, 1.0], &[0.03, 0.002]);
        assert_curve(
            &read_hazard("h.json", new, &of("Sa(0.2 s)")).unwrap(),
            "Sa(0.2 s)",
            "m/s2",
            &[1.0, 2.0],
            &[0.3, 0.2],
        );
        let refused =
            |text: &str, options: &HazardOptions| read_hazard("h.json", text, options).unwrap_err().to_string();
        assert_eq!(refused(new, &options()), "found hazard curves of PGA, Sa(0.2 s); expected the choice of one");
        assert_eq!(refused(new, &of("PGV")), "found hazard curves of PGA, Sa(0.2 s); expected one of PGV");
        assert!(refused("{}", &options()).starts_with("found JSON without hazard curves; expected the reply"));
        assert!(refused("{", &options()).ends_with("expected JSON"));
    }

    #[test]
    fn other_files_are_refused_with_the_content_found() {
        let refused = |text: &str| read_hazard("h.csv", text, &options()).unwrap_err().to_string();
        assert!(refused("0.1,0.2\n0.2,0.1\n").starts_with("found `0.1,0.2` in the first line; expected a heading"));
        assert!(refused("a,b,c\n1,2,3\n").starts_with("found 3 columns; expected a heading"));
        assert_eq!(refused("PGA [g],rate\n0.1,much\n"), "found `much` in rate; expected a number");
        let other = HazardOptions { measure: Some("PGV".into()), ..options() };
        let refused = read_hazard("h.csv", "PGA [g],rate\n0.1,0.2\n0.2,0.1\n", &other).unwrap_err().to_string();
        assert_eq!(refused, "found a hazard curve of PGA; expected one of PGV");
    }
}
