//! A hazard curve and a fragility curve → the annual rate of exceeding a limit.
//!
//! The rate is `λ = ∫ P(m) |dH(m)|` (C. A. Cornell, F. Jalayer, R. O. Hamburger, D. A. Foutch, Probabilistic basis for 2000 SAC
//! Federal Emergency Management Agency steel moment frame guidelines, J. Struct. Eng. 128 (2002) 526–533): H is the annual rate at
//! which the intensity measure exceeds m, and P the probability that the limit is exceeded at m.
//!
//! Between its levels the hazard is a power law, linear in logarithmic axes. Each segment is then integrated in closed form for a
//! lognormal or tabulated curve, and to round-off by Gauss's rule for a logistic one. The first and the last power law continue
//! beyond the levels; [`AnnualRate`] has the parts of the rate from there.
//!
//! | module | in → out |
//! | --- | --- |
//! | `hazard` | levels, rates → a hazard curve |
//! | `hazard_file` | CSV and JSON of this project, OpenQuake and the USGS → a hazard curve |
//! | `curve` | a fragility curve, a power law → the part of the rate from a range of the measure |
//! | `rate` | a hazard curve, a fragility curve → annual rate, deaggregation, interval |

mod curve;
mod hazard;
mod hazard_file;
mod rate;

pub use curve::FragilityCurve;
pub use hazard::HazardCurve;
pub use hazard_file::{HazardOptions, read_hazard};
pub use rate::{AnnualRate, RatePart, interval, probability_in, unknown_rates};
