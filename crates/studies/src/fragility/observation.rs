//! The intensity measures and the outcome of a case → an observation. A fit that fails has its reason here.

use smallvec::SmallVec;

use crate::doubts::short;

/// The outcome of one or several runs at one intensity.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// One or two intensity measures, above zero, each in its own unit.
    pub measures: SmallVec<[f64; 2]>,
    /// Fraction of the runs that exceeded the limit, 0 to 1.
    pub fraction: f64,
    /// Number of independent outcomes behind the fraction, above zero.
    pub weight: f64,
}

impl Observation {
    /// A single run.
    pub fn of(measures: &[f64], exceeded: bool) -> Observation {
        Observation::with_probability(measures, f64::from(u8::from(exceeded)))
    }

    /// A probability, such as that of an ensemble, with the weight of a single run.
    ///
    /// The samples of an ensemble differ little and are not independent of each other.
    pub fn with_probability(measures: &[f64], probability: f64) -> Observation {
        Observation { measures: measures.into(), fraction: probability, weight: 1.0 }
    }

    /// A number of exceedances in a number of independent runs.
    pub fn counted(measures: &[f64], exceeded: u64, trials: u64) -> Observation {
        let (exceeded, trials) = (exceeded as f64, trials as f64);
        Observation { measures: measures.into(), fraction: exceeded / trials, weight: trials }
    }
}

/// The reason why there is no best curve. Rows are numbered from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CurveFitError {
    /// There are no rows.
    #[error("found no rows; expected rows that exceed the limit and rows that do not")]
    Empty,
    /// A row has another number of measures than the first, or too many.
    #[error("found {found} measures in row {row}; expected {expected}")]
    Measures {
        /// The row.
        row: usize,
        /// Its number of measures.
        found: usize,
        /// The number of the first row, or the possible numbers.
        expected: &'static str,
    },
    /// A measure has no logarithm.
    #[error("found the measure {found} in row {row}; expected a number above 0, which has a logarithm")]
    Measure {
        /// The row.
        row: usize,
        /// Its measure.
        found: f64,
    },
    /// The fraction or its weight is invalid.
    #[error("found the fraction {fraction} of {weight} outcomes in row {row}; expected 0 to 1 of a number above 0")]
    Outcome {
        /// The row.
        row: usize,
        /// The fraction.
        fraction: f64,
        /// The weight.
        weight: f64,
    },
    /// All rows have the same outcome.
    #[error("found one class: the limit is {} in all {rows} rows; expected rows of both kinds", if *.exceeded { "exceeded" } else { "not exceeded" })]
    OneClass {
        /// Whether all rows exceed the limit, or none.
        exceeded: bool,
        /// Number of rows.
        rows: usize,
    },
    /// The measure is constant.
    #[error("found the measure {value} in all {rows} rows; expected several values")]
    Alike {
        /// The measure.
        value: f64,
        /// Number of rows.
        rows: usize,
    },
    /// One measure determines the other.
    #[error("found that one measure is a power of the other in all {rows} rows; expected two independent measures")]
    Collinear {
        /// Number of rows.
        rows: usize,
    },
    /// A value of the measure separates the classes.
    #[error(
        "found separable data: the limit is {}; the steeper a curve between them, the better it fits; expected classes that overlap",
        separated(*.below, *.above, *.falls, *.shared)
    )]
    Separable {
        /// Greatest measure of the lower class.
        below: f64,
        /// Least measure of the upper class.
        above: f64,
        /// Whether the lower class is the one that exceeds the limit.
        falls: bool,
        /// Exceedances and rows at a value of both classes, and whether rows lie above.
        shared: Option<(f64, usize, bool)>,
    },
    /// A line in the plane of both logarithms separates the classes.
    #[error(
        "found separable data: a line in the plane of the logarithms of both measures separates the {exceeded} rows that exceed the \
         limit from the {others} others; expected classes that overlap"
    )]
    SeparablePlane {
        /// Rows that exceed the limit.
        exceeded: usize,
        /// The others.
        others: usize,
    },
    /// A bootstrap has a single record to draw from.
    #[error("found {found} ground motion; expected two or more for a bootstrap to draw from")]
    OneMotion {
        /// Number of ground motions.
        found: usize,
    },
    /// Rows do not fit on disk.
    #[error(
        "cannot keep rows in a temporary file in {folder}: {reason}; expected 64 bytes of room for each row; TMPDIR names another folder"
    )]
    Temporary {
        /// The folder.
        folder: String,
        /// The reason.
        reason: String,
    },
    /// Newton's method did not converge.
    #[error("found no maximum of the likelihood in {iterations} iterations; the last step was {step:e}")]
    NotConverged {
        /// Number of iterations.
        iterations: u32,
        /// Length of the last step.
        step: f64,
    },
}

/// Describes two classes by the rows observed.
fn separated(below: f64, above: f64, falls: bool, shared: Option<(f64, usize, bool)>) -> String {
    let [below, above] = [below, above].map(short);
    let [lower, upper] = if falls { ["exceeded", "not exceeded"] } else { ["not exceeded", "exceeded"] };
    match shared {
        None => format!("{lower} in all rows up to {below} and {upper} in all from {above} on"),
        Some((exceeded, rows, has_more)) => {
            let more = if has_more { format!(", and {upper} in all above") } else { String::new() };
            format!("{lower} in all rows below {below}, exceeded in {exceeded} of {rows} at {below}{more}")
        }
    }
}
