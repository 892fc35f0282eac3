//! `scales`, `levels`, `hunt` or `least` of a study file → the strengths of each ground motion.

use crate::input::study_file::{Section, StudyFileError};
use crate::intensity::Measure;
use crate::search::Scan;
use crate::spec::study::{HuntTable, LeastTable, LevelsTable};
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::hunt::Hunt;
use rocking_block::block::Block;

/// The strengths of each ground motion of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub enum Strengths {
    /// Factors on the records, a row each.
    Scales(Vec<f64>),
    /// Values of a measure of the horizontal record, a row each: incremental dynamic analysis (D. Vamvatsikos, C. A. Cornell,
    /// Incremental dynamic analysis, EESD 31 (2002) 491–514).
    Levels(Measure, Vec<f64>),
    /// Values of a measure that depend on the runs before, a row each. Incremental dynamic analysis by hunt and fill.
    Hunt(Measure, Hunt),
    /// One row for a whole range of a measure, searched for values that overturn.
    Least(Measure, Scan),
}

impl Strengths {
    /// Number of rows per ground motion.
    pub fn count(&self) -> u64 {
        match self {
            Strengths::Scales(values) | Strengths::Levels(_, values) => values.len() as u64,
            Strengths::Hunt(_, hunt) => hunt.runs,
            Strengths::Least(..) => 1,
        }
    }

    /// The prescribed measure, if any.
    pub fn measure(&self) -> Option<Measure> {
        match *self {
            Strengths::Scales(_) => None,
            Strengths::Levels(measure, _) | Strengths::Hunt(measure, _) | Strengths::Least(measure, _) => Some(measure),
        }
    }

    /// The prescribed measure of a row and its exact value. The scaled record meets it only to rounding.
    pub(super) fn level(&self, number: u64) -> Option<(Measure, f64)> {
        match self {
            Strengths::Levels(measure, values) => Some((*measure, values[number as usize])),
            Strengths::Scales(_) | Strengths::Hunt(..) | Strengths::Least(..) => None,
        }
    }

    /// Factor on the records in a row of a ground motion. It is 1 for a row that searches a whole range, and where other runs decide it.
    pub(crate) fn scale(&self, number: u64, motion: &GroundMotion, block: &Block) -> f64 {
        match self {
            Strengths::Scales(scales) => scales[number as usize],
            Strengths::Levels(measure, values) => motion.scale_to(*measure, values[number as usize], block),
            Strengths::Hunt(..) | Strengths::Least(..) => 1.0,
        }
    }
}

/// The keys; a study has at most one of them.
pub(super) const KEYS: [&str; 4] = ["scales", "levels", "hunt", "least"];

/// Reads the keys; without any, records keep their strength.
pub(super) fn read(study: &Section) -> Result<Strengths, StudyFileError> {
    let mut given = KEYS.iter().filter_map(|&key| Some((key, study.get(key)?)));
    if let (Some((first, _)), Some((key, value))) = (given.next(), given.next()) {
        return Err(study.wrong(key, value, &format!("none beside {first}")));
    }
    if let Some(levels) = study.section::<LevelsTable>("levels")? {
        const EXPECTED: &str = "a list of numbers > 0, as in [0.5, 1.0]";
        let values = levels.numbers("values", |x| x > 0.0, EXPECTED)?;
        let values = values.ok_or_else(|| levels.lacks("values", EXPECTED))?;
        return Ok(Strengths::Levels(measure(&levels)?, values));
    }
    if let Some(hunt) = study.section::<HuntTable>("hunt")? {
        let number = |key: &str, accepts: fn(f64) -> bool, expected: &str| hunt.number(key, accepts, expected);
        let first = number("first", |x| x > 0.0, "a level > 0")?;
        let first = first.ok_or_else(|| hunt.lacks("first", "the level of the first run, > 0"))?;
        let found = Hunt {
            first,
            step: number("step", |x| x > 0.0, "a step > 0")?.unwrap_or(first),
            growth: number("growth", |x| x >= 0.0, "a growth >= 0 of each further step")?.unwrap_or(0.5 * first),
            resolution: number("resolution", |x| x > 0.0 && x < 1.0, "a part of the level, between 0 and 1")?
                .unwrap_or(0.1),
            runs: hunt.integer("runs", 1..1001)?.unwrap_or(12),
        };
        return Ok(Strengths::Hunt(measure(&hunt)?, found));
    }
    if let Some(least) = study.section::<LeastTable>("least")? {
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
                least.lacks("points", "the number of values to scan before the changes between them are bisected")
            })?,
            resolution: number("resolution", 0.0)?,
        };
        return Ok(Strengths::Least(measure(&least)?, scan));
    }
    let scales = study.numbers("scales", |x| x != 0.0, "a list of factors other than 0, as in [0.5, 1.0]")?;
    Ok(Strengths::Scales(scales.unwrap_or_else(|| vec![1.0])))
}

/// A measure that grows with the factor on the record.
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
