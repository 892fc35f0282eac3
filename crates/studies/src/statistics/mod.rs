//! The normal distribution, random samples, and ranges.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`normal`] | deviate ↔ probability |
//! | [`sampling`] | a seed and a number of samples → a Latin hypercube |

pub mod normal;
pub mod sampling;

/// Returns the least and the greatest value, or `None` without values.
pub fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values.map(|value| [value; 2]).reduce(|[low, high], [value, _]| [low.min(value), high.max(value)])
}
