//! The end of a run and its peak rotation → whether a limit is exceeded.

use std::str::FromStr;

use crate::run::outcome::End;

/// A limit on the response of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Overturning.
    Overturned,
    /// A rotation |θ|/α (1); a block that overturns exceeds it.
    Rotation(f64),
}

impl Limit {
    /// Whether a run exceeded the limit by its end; `rotation` is the peak |θ|/α (1).
    pub fn is_exceeded(self, end: End, rotation: Option<f64>) -> bool {
        match self {
            Limit::Overturned => end == End::Overturned,
            Limit::Rotation(limit) => end == End::Overturned || rotation.is_some_and(|rotation| rotation > limit),
        }
    }
}

/// The word in options, reports and column names.
impl std::fmt::Display for Limit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Limit::Overturned => f.write_str("overturned"),
            Limit::Rotation(limit) => write!(f, "theta/alpha>{limit}"),
        }
    }
}

impl FromStr for Limit {
    type Err = String;

    fn from_str(text: &str) -> Result<Limit, String> {
        let lower = text.to_ascii_lowercase();
        if lower == "overturned" {
            return Ok(Limit::Overturned);
        }
        let limit = lower.strip_prefix("theta/alpha>").unwrap_or(&lower).parse().ok();
        limit.filter(|limit: &f64| *limit > 0.0 && limit.is_finite()).map(Limit::Rotation).ok_or_else(|| {
            format!("found limit `{text}`; expected overturned, or a number > 0 for |theta|/alpha, as in 0.5")
        })
    }
}
