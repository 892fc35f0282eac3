//! A heading or an option → a measure with the unit of its numbers.

use std::fmt::Display;

use crate::intensity::Measure;
use crate::mismatch::Mismatch;
use crate::output::table::split_heading;

/// A measure with the unit of its numbers, as a table, an option or a hazard curve names it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureColumn {
    /// Its name, that of this project's tables if it is known.
    pub name: String,
    /// The measure, if it is known.
    pub measure: Option<Measure>,
    /// Unit of its numbers; `None` if nothing names it.
    pub unit: Option<String>,
}

impl MeasureColumn {
    /// Returns the measure of this name, with the unit of its numbers if something names it.
    pub fn new(name: &str, unit: Option<&str>) -> MeasureColumn {
        let name = canonical(name);
        MeasureColumn { measure: name.parse().ok(), name, unit: unit.map(String::from) }
    }

    /// Returns the measure of a heading such as `PGA [g]`.
    pub fn of_heading(heading: &str) -> MeasureColumn {
        let (name, unit) = split_heading(heading);
        MeasureColumn::new(name, unit)
    }

    /// Returns the SI unit of the measure, and the value of a unit of its numbers in it. A unit without SI unit stays. `gravity` (m/s²)
    /// is that of numbers in g.
    ///
    /// # Errors
    /// Nothing names the unit of a number with a dimension, or the unit is of another dimension than the measure.
    pub fn si(&self, gravity: f64) -> Result<(String, f64), Mismatch> {
        let MeasureColumn { name, measure, unit } = self;
        let expected = measure.map(Measure::unit);
        match (unit, expected) {
            (Some(unit), expected) => match (si(unit, gravity), expected) {
                (Some((si, factor)), None) => Ok((si.into(), factor)),
                (Some((si, factor)), Some(expected)) if si == expected => Ok((si.into(), factor)),
                (None, None) => Ok((unit.clone(), 1.0)),
                (_, Some(expected)) => {
                    Err(Mismatch::new(format!("{name} in {unit}"), format!("{expected}, or a unit of it")))
                }
            },
            (None, Some("1")) => Ok(("1".into(), 1.0)),
            (None, expected) => {
                let known = expected.unwrap_or("1");
                Err(Mismatch::new(
                    format!("{name} without a unit"),
                    format!("its unit with its name, such as {name} [{known}]"),
                ))
            }
        }
    }

    /// Returns the measure in SI units behind these numbers, and their factor on it. Behind a measure relative to a block stands one of
    /// records, `of_record`, with its factor.
    ///
    /// # Errors
    /// Those of [`MeasureColumn::si`].
    pub fn behind(&self, of_record: Option<(Measure, f64)>, gravity: f64) -> Result<(MeasureColumn, f64), Mismatch> {
        let (unit, of_unit) = self.si(gravity)?;
        Ok(match of_record {
            Some((measure, factor)) => {
                (MeasureColumn::new(&measure.to_string(), Some(measure.unit())), factor / of_unit)
            }
            None => (MeasureColumn { unit: Some(unit), ..self.clone() }, 1.0 / of_unit),
        })
    }
}

/// The heading: `PGA [g]`.
impl Display for MeasureColumn {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name)?;
        self.unit.as_ref().map_or(Ok(()), |unit| write!(f, " [{unit}]"))
    }
}

/// Returns the SI unit and the value of a unit in it. `gravity` (m/s²) is that of `g`; `None` for an unknown unit.
pub fn si(unit: &str, gravity: f64) -> Option<(&'static str, f64)> {
    let plain = unit.trim().to_ascii_lowercase().replace('²', "2").replace('^', "").replace(['*', '.', '·'], " ");
    Some(match plain.as_str() {
        "g" => ("m/s2", gravity),
        "m/s2" => ("m/s2", 1.0),
        "cm/s2" | "gal" => ("m/s2", 0.01),
        "g s" => ("m/s", gravity),
        "m/s" => ("m/s", 1.0),
        "cm/s" => ("m/s", 0.01),
        "m" => ("m", 1.0),
        "cm" => ("m", 0.01),
        "s" => ("s", 1.0),
        "1" => ("1", 1.0),
        _ => return None,
    })
}

/// Returns the name of another program's measure, such as `SA(1.0)` or `SA1P0`.
pub fn canonical(name: &str) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_unit_of_their_heading() {
        let si = |heading: &str| MeasureColumn::of_heading(heading).si(9.81).map_err(|error| error.to_string());
        for (heading, unit, factor) in [
            ("PGA [g]", "m/s2", 9.81),
            ("SA(0.5) [g]", "m/s2", 9.81),
            ("pgv [cm/s]", "m/s", 0.01),
            ("PGA [m/s^2]", "m/s2", 1.0),
            ("p PGV/(g tan alpha)", "1", 1.0),
            ("AvgSa [g]", "m/s2", 9.81),
            ("force [kN]", "kN", 1.0),
        ] {
            assert_eq!(si(heading), Ok((unit.into(), factor)), "{heading}");
        }
        for (heading, message) in [
            ("PGA", "found PGA without a unit; expected its unit with its name, such as PGA [m/s2]"),
            ("AvgSa", "found AvgSa without a unit; expected its unit with its name, such as AvgSa [1]"),
            ("PGA [m/s]", "found PGA in m/s; expected m/s2, or a unit of it"),
            ("PGA [inch]", "found PGA in inch; expected m/s2, or a unit of it"),
        ] {
            assert_eq!(si(heading), Err(message.into()), "{heading}");
        }
        assert_eq!(MeasureColumn::of_heading("SA(0.5) [g]").to_string(), "Sa(0.5 s) [g]");
    }
}
