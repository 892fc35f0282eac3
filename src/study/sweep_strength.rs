//! `scales`, `levels` or `least` of a study file → how strong the ground motions are.

use crate::study::intensity::Measure;
use crate::study::search::Scan;
use crate::study::strength::Strengths;
use crate::study::study_file::{Section, StudyFileError};

/// The keys, of which a study has one at most.
pub(super) const KEYS: [&str; 3] = ["scales", "levels", "least"];

/// Reads them; without any, records are as they are.
pub(super) fn read(study: &Section) -> Result<Strengths, StudyFileError> {
    let mut given = KEYS.iter().filter_map(|&key| Some((key, study.get(key)?)));
    if let (Some((first, _)), Some((key, value))) = (given.next(), given.next()) {
        return Err(study.wrong(key, value, &format!("none beside {first}")));
    }
    if let Some(levels) = study.section("levels", &["im", "values"])? {
        let values = levels.numbers("values", |x| x > 0.0, "a list of numbers > 0, as in [0.5, 1.0]")?;
        let values = values.ok_or_else(|| levels.lacks("values", "a list of numbers > 0, as in [0.5, 1.0]"))?;
        return Ok(Strengths::Levels(measure(&levels)?, values));
    }
    if let Some(least) = study.section("least", &["im", "from", "to", "points", "resolution"])? {
        let number = |key: &str, more_than: f64| {
            let expected = format!("a number > {more_than}");
            let found = least.number(key, |x| x > more_than, &expected)?;
            found.ok_or_else(|| least.lacks(key, &expected))
        };
        let from = number("from", 0.0)?;
        let scan = Scan {
            from,
            to: number("to", from)?,
            points: least.integer("points", 2..1_000_001)?.ok_or_else(|| {
                least.lacks("points", "how many values are looked at before the changes between them are closed in")
            })?,
            resolution: number("resolution", 0.0)?,
        };
        return Ok(Strengths::Least(measure(&least)?, scan));
    }
    let scales = study.numbers("scales", |x| x != 0.0, "a list of factors that are not 0, as in [0.5, 1.0]")?;
    Ok(Strengths::Scales(scales.unwrap_or_else(|| vec![1.0])))
}

/// A measure that a factor on the record changes.
fn measure(section: &Section) -> Result<Measure, StudyFileError> {
    let measure: Option<Measure> = section.parsed("im")?;
    match (measure, section.get("im")) {
        (Some(measure), Some(value)) if measure.power() == 0 => {
            Err(section.wrong("im", value, "a measure that grows with the record, such as \"PGV\""))
        }
        (Some(measure), _) => Ok(measure),
        (None, _) => Err(section.lacks("im", "an intensity measure, such as \"PGV\" or \"Sa(0.5 s)\"")),
    }
}
