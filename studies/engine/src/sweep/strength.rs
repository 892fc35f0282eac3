//! `scales`, `levels`, `hunt` or `least` of a study file → the strengths of each ground motion.

use crate::input::study_file::{Section, StudyFileError};
use crate::intensity::{BlockScales, Measure};
use crate::search::Scan;
use crate::spec::study::{HuntTable, LeastTable, LevelsTable, StudyFile, StudyTable};
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::hunt::Hunt;

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
    pub(crate) fn scale(&self, number: u64, motion: &GroundMotion, of_block: BlockScales) -> f64 {
        match self {
            Strengths::Scales(scales) => scales[number as usize],
            Strengths::Levels(measure, values) => motion.scale_to(*measure, values[number as usize], of_block),
            Strengths::Hunt(..) | Strengths::Least(..) => 1.0,
        }
    }
}

/// The keys; a study has at most one of them.
pub(super) const KEYS: [&str; 4] = ["scales", "levels", "hunt", "least"];

/// Returns the path of the key that the study has.
pub(super) fn path(file: &Section<StudyFile>) -> String {
    let mut paths = KEYS.into_iter().map(|key| format!("study.{key}"));
    paths.find(|path| file.get(path).is_some()).unwrap_or_default()
}

/// Reads the keys; without any, records keep their strength.
pub(super) fn read(file: &Section<StudyFile>) -> Result<Strengths, StudyFileError> {
    let mut given = KEYS.into_iter().filter(|key| file.get(&format!("study.{key}")).is_some());
    if let (Some(first), Some(key)) = (given.next(), given.next()) {
        return Err(file.wrong(&format!("study.{key}"), &format!("none beside {first}")));
    }
    let StudyTable { scales, levels, hunt, least, .. } = &file.study;
    if let Some(LevelsTable { im, values }) = levels {
        let measure = measure(file, "levels", im)?;
        return Ok(Strengths::Levels(measure, distinct(file, "levels.values", values.iter().map(|value| value.0))?));
    }
    if let Some(HuntTable { im, first, step, growth, resolution, runs }) = hunt {
        let found = Hunt {
            first: first.0,
            step: step.unwrap_or(*first).0,
            growth: growth.unwrap_or(0.5 * first.0),
            resolution: resolution.map_or(0.1, |part| part.0),
            runs: runs.unwrap_or(12),
        };
        return Ok(Strengths::Hunt(measure(file, "hunt", im)?, found));
    }
    if let Some(LeastTable { im, from, to, points, resolution }) = least {
        let scan = Scan { from: from.0, to: to.0, points: *points, resolution: resolution.0 };
        if scan.to <= scan.from {
            return Err(file.wrong("study.least.to", &format!("a number > {}", scan.from)));
        }
        return Ok(Strengths::Least(measure(file, "least", im)?, scan));
    }
    let scales = scales.clone().unwrap_or_else(|| vec![1.0]);
    match scales.iter().position(|scale| *scale == 0.0) {
        Some(number) => Err(file.wrong(&format!("study.scales.{number}"), "a factor other than 0")),
        None => Ok(Strengths::Scales(distinct(file, "scales", scales.into_iter())?)),
    }
}

/// Refuses a value that occurs twice, whose rows would count twice.
fn distinct(
    file: &Section<StudyFile>,
    key: &str,
    values: impl Iterator<Item = f64>,
) -> Result<Vec<f64>, StudyFileError> {
    let mut found = Vec::new();
    for (number, value) in values.enumerate() {
        if found.contains(&value) {
            return Err(file.wrong(&format!("study.{key}.{number}"), "each value once"));
        }
        found.push(value);
    }
    Ok(found)
}

/// Reads a measure that grows with the factor on the record.
fn measure(file: &Section<StudyFile>, key: &str, im: &str) -> Result<Measure, StudyFileError> {
    let path = format!("study.{key}.im");
    let measure: Measure = file.parsed(&path, im)?;
    match measure.power() {
        0 => Err(file.wrong(&path, "a measure that grows with the record, such as \"PGV\"")),
        _ => Ok(measure),
    }
}
