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
    pub fn of(measures: &[f64], exceeds: bool) -> Observation {
        Observation::with_probability(measures, f64::from(u8::from(exceeds)))
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
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct CurveFitError(pub(super) String);

impl CurveFitError {
    /// All rows have the same outcome.
    pub(super) fn one_class(exceeds: bool, rows: usize) -> CurveFitError {
        let is = if exceeds { "exceeded" } else { "not exceeded" };
        CurveFitError(format!("found one class: the limit is {is} in all {rows} rows; expected rows of both kinds"))
    }

    /// The measure is constant.
    pub(super) fn alike(value: f64, rows: usize) -> CurveFitError {
        CurveFitError(format!("found the measure {value} in all {rows} rows; expected several values"))
    }

    /// One measure determines the other.
    pub(super) fn collinear(rows: usize) -> CurveFitError {
        CurveFitError(format!(
            "found that one measure is a power of the other in all {rows} rows; expected two independent measures"
        ))
    }

    /// A value of the measure separates the classes. `below` is the greatest measure of the lower class, which exceeds the limit if the
    /// probability `falls`, and `above` the least of the other.
    ///
    /// `shared` has exceedances and rows at a value of both classes, and whether rows lie above.
    pub(super) fn separable(below: f64, above: f64, falls: bool, shared: Option<(f64, usize, bool)>) -> CurveFitError {
        let [below, above] = [below, above].map(short);
        let [lower, upper] = if falls { ["exceeded", "not exceeded"] } else { ["not exceeded", "exceeded"] };
        let classes = match shared {
            None => format!("{lower} in all rows up to {below} and {upper} in all from {above} on"),
            Some((exceeded, rows, has_more)) => {
                let more = if has_more { format!(", and {upper} in all above") } else { String::new() };
                format!("{lower} in all rows below {below}, exceeded in {exceeded} of {rows} at {below}{more}")
            }
        };
        CurveFitError(format!(
            "found separable data: the limit is {classes}; the steeper a curve between them, the better it fits; expected classes that \
             overlap"
        ))
    }

    /// A line in the plane of both logarithms separates the classes.
    pub(super) fn separable_plane(exceeded: usize, others: usize) -> CurveFitError {
        CurveFitError(format!(
            "found separable data: a line in the plane of the logarithms of both measures separates the {exceeded} rows that exceed the \
             limit from the {others} others; expected classes that overlap"
        ))
    }

    /// A bootstrap has a single record to draw from.
    pub(super) fn one_motion(found: usize) -> CurveFitError {
        CurveFitError(format!("found {found} ground motion; expected two or more for a bootstrap to draw from"))
    }
}

/// Refuses a row without logarithms of its measures, or with an invalid fraction or weight.
pub(super) fn check_row(row: usize, measures: &[f64], fraction: f64, weight: f64) -> Result<(), CurveFitError> {
    if let Some(found) = measures.iter().find(|&&measure| !(measure > 0.0 && measure.is_finite())) {
        let message =
            format!("found the measure {found} in row {row}; expected a number above 0, which has a logarithm");
        return Err(CurveFitError(message));
    }
    if !((0.0..=1.0).contains(&fraction) && weight > 0.0 && weight.is_finite()) {
        return Err(CurveFitError(format!(
            "found the fraction {fraction} of {weight} outcomes in row {row}; expected 0 to 1 of a number above 0"
        )));
    }
    Ok(())
}
