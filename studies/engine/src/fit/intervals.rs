//! The least sum of squares → intervals of the profile likelihood.

use nalgebra::{DMatrix, DVector};

use crate::fit::evaluation::Evaluator;
use crate::fit::least_squares::{Minimum, Triangle};

/// An end of a coordinate's interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IntervalEnd {
    /// The end inside the bounds.
    At(f64),
    /// The last point of a search that has not settled within its evaluations.
    Unsettled(f64),
    /// The data admit the bound.
    Open,
}

/// A point of less than the least sum of squares, found in an interval's search.
#[derive(Clone, Debug, PartialEq)]
pub struct Lower(pub DVector<f64>);

/// The profile of the sum of squares: one coordinate fixed, the others minimized.
///
/// An interval holds the values whose sum of squares exceeds the least by at most `deviate²` variances of a residual. For given noise that
/// is the likelihood ratio, with χ² of one degree of freedom, and otherwise F, whose root is Student's t (D. M. Bates, D. G. Watts,
/// Nonlinear regression analysis and its applications, Wiley 1988, section 6.1).
pub struct Profile<'a> {
    /// The problem.
    pub evaluator: &'a Evaluator<'a>,
    /// The minimum from which the ends are sought.
    pub from: &'a Minimum,
    /// The least sum of squares.
    pub least: f64,
    /// Covariance of the coordinates for residuals of variance 1.
    pub covariance: &'a DMatrix<f64>,
    /// Variance of a residual.
    pub variance: f64,
    /// Deviate of the level, normal or of Student's t.
    pub deviate: f64,
    /// Maximum number of evaluations for an end.
    pub evaluations: usize,
}

/// The usual maximum number of evaluations for an end.
pub const EVALUATIONS: usize = 12;

impl Profile<'_> {
    /// Returns the end of the interval of coordinate `i` on a side, −1 or 1.
    ///
    /// The search begins at the quadratic end. Each evaluation gives the sum of squares and its decrease over the other coordinates by the
    /// linear model, and with both the next distance.
    ///
    /// # Errors
    /// [`Lower`], a better minimum than that of the fit.
    pub fn end(&self, i: usize, side: f64) -> Result<IntervalEnd, Lower> {
        /// Relative error of the deviate below which a secant gives the end. It is also the greatest gain of the other coordinates there.
        const NEAR: [f64; 2] = [0.1, 0.02];
        /// Part of the variance by which a lower minimum must lie below.
        const LOWER: f64 = 0.1;
        let Profile { from: minimum, least, deviate, variance, .. } = *self;
        let center = minimum.point[i];
        let range = if side < 0.0 { center } else { 1.0 - center };
        if range <= 0.0 {
            return Ok(IntervalEnd::Open);
        }
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut distance = (deviate * (variance * self.covariance[(i, i)]).sqrt()).min(range);
        let mut ridge: DVector<f64> = self.covariance.column(i) / self.covariance[(i, i)];
        let mut from = minimum.point.clone();
        for _ in 0..self.evaluations {
            let moved = &from + &ridge * (center + side * distance - from[i]);
            let mut point = moved.map(|coordinate| coordinate.clamp(0.0, 1.0));
            point[i] = if distance >= range { 0.5 + 0.5 * side } else { center + side * distance };
            let Ok(at) = self.evaluator.linearize(&point, &self.evaluator.problem.counts()) else {
                // The model fails there: the end is nearer.
                (high, distance) = (distance, 0.5 * (low + distance));
                continue;
            };
            let triangle = at.triangle();
            let mut fixed = vec![false; point.len()];
            fixed[i] = true;
            let step = triangle.step(&point, &fixed, 0.0);
            let gain = triangle.decrease(&step).max(0.0);
            let rise = at.cost() - gain - least;
            if at.cost() < least - LOWER * variance {
                return Err(Lower(point));
            }
            (from, ridge) = (&point + step, tangent(&triangle, i));
            let found = (rise.max(0.0) / variance).sqrt();
            if gain > NEAR[1] * deviate * deviate * variance {
                // The linear model reaches far; repeat at the better point.
                continue;
            }
            if distance >= range && found <= deviate {
                return Ok(IntervalEnd::Open);
            }
            let ratio = deviate / found.max(1e-3 * deviate);
            if (ratio - 1.0).abs() <= NEAR[0] {
                return Ok(IntervalEnd::At((center + side * distance * ratio).clamp(0.0, 1.0)));
            }
            if found < deviate {
                low = distance
            } else {
                high = distance
            }
            let next = (distance * ratio.clamp(0.2, 5.0)).min(range);
            distance = if next > low && next < high { next } else { 0.5 * (low + high.min(range)) };
        }
        Ok(IntervalEnd::Unsettled(from[i]))
    }
}

/// Returns the direction of the profile of coordinate `i`, per unit of it.
fn tangent(triangle: &Triangle, i: usize) -> DVector<f64> {
    let others: Vec<usize> = (0..triangle.r.ncols()).filter(|&other| other != i).collect();
    let mut direction = DVector::zeros(triangle.r.ncols());
    direction[i] = 1.0;
    if let Some(found) = triangle.solve(&others, &triangle.r.column(i).into(), 0.0).filter(|_| !others.is_empty()) {
        others.iter().zip(&found).for_each(|(&other, &change)| direction[other] = change);
    }
    direction
}
