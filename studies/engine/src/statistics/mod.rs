//! The normal distribution, Student's and χ², random samples, ranges, and quantiles.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`normal`] | deviate ↔ probability |
//! | [`chi_squared`] | deviance → p-value |
//! | [`sampling`] | a seed and a number of samples → a Latin hypercube |
//! | [`student`] | p-value ↔ deviate of Student's t |

pub mod chi_squared;
pub mod normal;
pub mod sampling;
pub mod student;

/// Returns the least and the greatest value, or `None` without values.
pub fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values.map(|value| [value; 2]).reduce(|[low, high], [value, _]| [low.min(value), high.max(value)])
}

/// Returns the quantile of values in increasing order, linear between order statistics, the default of R and NumPy.
pub fn quantile(values: &[f64], probability: f64) -> f64 {
    let position = probability * (values.len() - 1) as f64;
    let below = position as usize;
    let above = (below + 1).min(values.len() - 1);
    values[below] + (position - below as f64) * (values[above] - values[below])
}
