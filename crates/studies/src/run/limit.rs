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
    /// A slip of the foot from its place at the start (m); a block that overturns exceeds it.
    Slip(f64),
}

/// The peaks of a run that limits refer to, as far as they are known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    /// Of the rotation |θ|/α (1).
    pub rotation: Option<f64>,
    /// Of the slip (m).
    pub slip: Option<f64>,
}

impl Limit {
    /// Whether a run exceeded the limit by its end.
    pub fn is_exceeded(self, end: End, response: Response) -> bool {
        let beyond = match self {
            Limit::Overturned => false,
            Limit::Rotation(limit) => response.rotation.is_some_and(|rotation| rotation > limit),
            Limit::Slip(limit) => response.slip.is_some_and(|slip| slip > limit),
        };
        end == End::Overturned || beyond
    }
}

/// The word in options, reports and column names.
impl std::fmt::Display for Limit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Limit::Overturned => f.write_str("overturned"),
            Limit::Rotation(limit) => write!(f, "theta/alpha>{limit}"),
            Limit::Slip(limit) => write!(f, "slip>{limit}"),
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
        let slip = lower.strip_prefix("slip:").or(lower.strip_prefix("slip>"));
        let number = slip.unwrap_or_else(|| lower.strip_prefix("theta/alpha>").unwrap_or(&lower));
        let limit = number.parse().ok().filter(|limit: &f64| *limit > 0.0 && limit.is_finite());
        limit.map(if slip.is_some() { Limit::Slip } else { Limit::Rotation }).ok_or_else(|| {
            format!(
                "found limit `{text}`; expected overturned, a number > 0 for |theta|/alpha, as in 0.5, or one for the slip in \
                 metres, as in slip:0.1"
            )
        })
    }
}
