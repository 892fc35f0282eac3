//! How strong ground motions are to be → factors on their records.

use crate::block::Block;
use crate::study::intensity::Measure;
use crate::study::search::Scan;
use crate::study::sweep::Motion;

/// How strong each ground motion of a sweep is.
#[derive(Clone, Debug, PartialEq)]
pub enum Strengths {
    /// These factors on the records, each a row.
    Scales(Vec<f64>),
    /// The factors with which a measure of the horizontal record has these values, each a row: incremental dynamic analysis
    /// (D. Vamvatsikos, C. A. Cornell, Incremental dynamic analysis, EESD 31 (2002) 491–514).
    Levels(Measure, Vec<f64>),
    /// One row for all values of a measure in a range: at which of them the block overturns.
    Least(Measure, Scan),
}

impl Strengths {
    /// Rows of a ground motion.
    pub fn count(&self) -> u64 {
        match self {
            Strengths::Scales(values) | Strengths::Levels(_, values) => values.len() as u64,
            Strengths::Least(..) => 1,
        }
    }

    /// The measure that is given, if one is.
    pub fn measure(&self) -> Option<Measure> {
        match *self {
            Strengths::Scales(_) => None,
            Strengths::Levels(measure, _) | Strengths::Least(measure, _) => Some(measure),
        }
    }

    /// The measure of one of the rows of a ground motion, where it is given: to the last digit, which the factor need not meet.
    pub(super) fn level(&self, number: u64) -> Option<(Measure, f64)> {
        match self {
            Strengths::Levels(measure, values) => Some((*measure, values[number as usize])),
            Strengths::Scales(_) | Strengths::Least(..) => None,
        }
    }

    /// Factor on the records of one of the rows of a ground motion; 1 where a row has them all.
    pub(super) fn scale(&self, number: u64, motion: &Motion, block: &Block) -> f64 {
        match self {
            Strengths::Scales(scales) => scales[number as usize],
            Strengths::Levels(measure, values) => scale_to(*measure, values[number as usize], motion, block),
            Strengths::Least(..) => 1.0,
        }
    }
}

/// The factor with which a measure of a ground motion has this value, both above zero: the inverse of
/// [`Motion::intensity`]. The measure is one that grows with the factor and that the motion has.
pub(super) fn scale_to(measure: Measure, value: f64, motion: &Motion, block: &Block) -> f64 {
    let ratio = value / motion.intensity(measure, 1.0, block).unwrap_or(f64::NAN);
    if measure.power() == 2 { ratio.sqrt() } else { ratio }
}
