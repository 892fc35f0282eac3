//! The normal distribution and random samples.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`normal`] | deviate ↔ probability |
//! | [`sampling`] | a seed and a number of samples → a Latin hypercube |

pub mod normal;
pub mod sampling;
