//! Observations → whether a best curve exists.
//!
//! The likelihood has a maximum at finite coefficients if and only if no line (for one measure: no value) separates the two
//! classes, points on the line included (A. Albert, J. A. Anderson, On the existence of maximum likelihood estimates in logistic
//! regression models, Biometrika 71 (1984) 1–10). A row with a fraction of exceedances belongs to both classes.

use std::f64::consts::{PI, TAU};

use crate::fragility::observation::{CurveFitError, Observation};
use crate::hull::hull;

/// Checks that both classes occur, that the measures vary, and that the classes overlap.
///
/// Needs valid measures.
pub(super) fn check(observations: &[Observation]) -> Result<(), CurveFitError> {
    let rows = observations.len();
    let count = observations[0].measures.len();
    let mut ends = vec![Ends::default(); count];
    for row in observations {
        ends.iter_mut().zip(&row.measures).for_each(|(ends, measure)| ends.take(*measure, row.fraction));
    }
    check_classes(&ends, rows)?;
    if count == 1 {
        return check_overlap(&ends[0], observations.iter().map(|row| (row.measures[0], row.fraction, 1.0)));
    }
    let mut hulls = Hulls::default();
    hulls.take(observations.iter().map(|row| ([row.measures[0], row.measures[1]], row.fraction, 1)));
    hulls.check()
}

/// Checks that both classes occur, and that each measure varies. `ends` are those of the measures.
pub(super) fn check_classes(ends: &[Ends], rows: usize) -> Result<(), CurveFitError> {
    if let Some(exceeds) = ends[0].only_class() {
        return Err(CurveFitError::one_class(exceeds, rows));
    }
    let alike = ends.iter().map(Ends::range).find(|[low, high]| low == high);
    alike.map_or(Ok(()), |[value, _]| Err(CurveFitError::alike(value, rows)))
}

/// Checks that no value of a single measure separates the classes. `rows` has the measure and the fraction of exceedances of all rows,
/// and the number of equal ones.
pub(super) fn check_overlap(ends: &Ends, rows: impl Iterator<Item = (f64, f64, f64)>) -> Result<(), CurveFitError> {
    let Some((below, above, falls)) = ends.separating() else { return Ok(()) };
    let (mut exceeded, mut at, mut has_more) = (0.0, 0, false);
    for (measure, fraction, count) in rows {
        if measure == below {
            (exceeded, at) = (exceeded + count * fraction, at + count as usize);
        }
        has_more |= measure > below;
    }
    let shared = (below == above).then_some((exceeded, at, has_more));
    Err(CurveFitError::separable(below, above, falls, shared))
}

/// The convex hulls of all rows and of both classes over two log measures, with their numbers of rows. The classes are rows that do not
/// exceed the limit, and rows that do.
#[derive(Default)]
pub(super) struct Hulls([(Vec<[f64; 2]>, usize); 3]);

impl Hulls {
    /// Takes rows: their measures, the fraction of exceedances, and the number of equal rows.
    pub fn take(&mut self, rows: impl Iterator<Item = ([f64; 2], f64, u32)> + Clone) {
        let classes = [|_| true, |y| y < 1.0, |y| y > 0.0] as [fn(f64) -> bool; 3];
        for ((corners, count), is_in) in self.0.iter_mut().zip(classes) {
            let more = rows.clone().filter(|(_, fraction, _)| is_in(*fraction));
            *count += more.clone().map(|(.., count)| count as usize).sum::<usize>();
            let more = more.map(|(measures, ..)| measures.map(libm::log));
            *corners = hull(std::mem::take(corners).into_iter().chain(more).collect());
        }
    }

    /// Checks that the measures are independent, and that no line separates the classes.
    pub fn check(&self) -> Result<(), CurveFitError> {
        let [(all, rows), (others, other_rows), (exceeded, exceeded_rows)] = &self.0;
        if all.len() < 3 {
            return Err(CurveFitError::collinear(*rows));
        }
        match is_separable(others, exceeded) {
            true => Err(CurveFitError::separable_plane(*exceeded_rows, *other_rows)),
            false => Ok(()),
        }
    }
}

/// Least and greatest measure of both classes. The class that does not exceed the limit is first; without rows the ends are infinite, the
/// other way round.
#[derive(Clone, Copy)]
pub(super) struct Ends([[f64; 2]; 2]);

impl Default for Ends {
    fn default() -> Ends {
        Ends([[f64::INFINITY, f64::NEG_INFINITY]; 2])
    }
}

impl Ends {
    /// Takes a row with a fraction of exceedances.
    pub fn take(&mut self, measure: f64, fraction: f64) {
        for ([low, high], is_in) in self.0.iter_mut().zip([fraction < 1.0, fraction > 0.0]) {
            if is_in {
                (*low, *high) = (low.min(measure), high.max(measure));
            }
        }
    }

    /// The only class: whether it exceeds the limit.
    pub fn only_class(&self) -> Option<bool> {
        let has_rows = self.0.map(|[low, high]| low <= high);
        (has_rows != [true; 2]).then_some(has_rows[1])
    }

    /// Ends of both classes, and whether the lower one exceeds the limit. They are its greatest and the other's least measure.
    pub fn separating(&self) -> Option<(f64, f64, bool)> {
        let [[low_others, high_others], [low_exceeded, high_exceeded]] = self.0;
        let sides = [(high_others, low_exceeded, false), (high_exceeded, low_others, true)];
        sides.into_iter().find(|(below, above, _)| below <= above)
    }

    /// Least and greatest measure of all rows.
    pub fn range(&self) -> [f64; 2] {
        let [[a, b], [c, d]] = self.0;
        [a.min(c), b.max(d)]
    }

    /// Length of the range that has both classes, in the logarithm of the measure.
    pub fn overlap(&self) -> f64 {
        let [[a, b], [c, d]] = self.0;
        libm::log(b.min(d) / a.max(c)).max(0.0)
    }
}

/// Whether a line separates two sets, given by their convex hulls.
///
/// Equivalent: all differences of their points lie in one half-plane.
fn is_separable(one: &[[f64; 2]], other: &[[f64; 2]]) -> bool {
    /// Tolerance of an angle (rad).
    const ROUNDING: f64 = 1e-12;
    let differences = one.iter().flat_map(|a| other.iter().map(move |b| [b[0] - a[0], b[1] - a[1]]));
    let mut angles: Vec<f64> = differences.filter(|d| *d != [0.0, 0.0]).map(|[x, y]| libm::atan2(y, x)).collect();
    angles.sort_by(f64::total_cmp);
    let Some(&first) = angles.first() else { return true };
    let next = angles.iter().skip(1).copied().chain(std::iter::once(first + TAU));
    angles.iter().zip(next).any(|(angle, next)| next - angle >= PI - ROUNDING)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line separates sets that touch it.
    #[test]
    fn touching_sets_are_separable() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let moved = |x: f64, y: f64| square.map(|[a, b]| [a + x, b + y]);
        assert!(is_separable(&square, &moved(1.5, 0.0)));
        assert!(is_separable(&square, &moved(1.0, 0.3)));
        assert!(is_separable(&square, &moved(1.0, 1.0)));
        assert!(!is_separable(&square, &moved(0.9, 0.9)));
        assert!(!is_separable(&square, &moved(0.0, 0.0)));
        assert!(!is_separable(&square, &[[0.5, 0.5]]));
    }
}
