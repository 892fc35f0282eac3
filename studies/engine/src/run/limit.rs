//! The end of a run and its greatest response → whether a limit is exceeded.

use std::str::FromStr;

use crate::run::outcome::End;

/// A limit on the response of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Overturning.
    Overturned,
    /// The balance of a side: |θ| with the centre of mass over the corner. A block that overturns exceeds it.
    Balance,
    /// A rotation |θ|/α (1); a block that overturns exceeds it.
    Rotation(f64),
    /// A slip of the foot since the start (m). A block that overturns exceeds it.
    Slip(f64),
    /// A plastic elongation of a tie or damper, in either sense (m). A block that overturns exceeds it.
    Plastic(f64),
    /// A number of half cycles of a plastic elongation above the amplitude of a study. A block that overturns exceeds it.
    HalfCycles(f64),
    /// A tie or damper that breaks. A block that overturns exceeds it.
    Breaks,
    /// A tilt of a block in space over that of its balance in the direction in which it leans (1). A block that overturns exceeds it.
    Tilt(f64),
    /// A twist of a block in space about the vertical, in either sense (rad). A block that overturns exceeds it.
    Twist(f64),
    /// A distance of the base of a block in space from its place at the start (m). A block that overturns exceeds it.
    Drift(f64),
}

impl Limit {
    /// The value that the response exceeds; `None` for overturning.
    fn threshold(self) -> Option<f64> {
        match self {
            Limit::Overturned => None,
            Limit::Balance => Some(1.0),
            Limit::Breaks => Some(0.0),
            Limit::Rotation(limit) | Limit::Slip(limit) | Limit::Plastic(limit) | Limit::HalfCycles(limit) => {
                Some(limit)
            }
            Limit::Tilt(limit) | Limit::Twist(limit) | Limit::Drift(limit) => Some(limit),
        }
    }

    /// Whether a run exceeds the limit, or `None` if that is unknown. It is unknown if the run failed, ended before the limit while its
    /// motion went on, or lacks the response of a limit other than overturning.
    ///
    /// `response` is the greatest value of the limit's quantity, for [`Limit::Balance`] of |θ| over the balance of its side, if it is known.
    pub fn verdict(self, end: End, response: Option<f64>) -> Option<bool> {
        let beyond = match self.threshold() {
            None => Some(false),
            Some(limit) => response.map(|response| response > limit),
        };
        match end {
            End::Overturned => Some(true),
            End::Completed => beyond,
            End::Separated | End::Undecided => beyond.filter(|is_beyond| *is_beyond),
            End::Failed => None,
        }
    }
}

/// The word in options, reports and column names.
impl std::fmt::Display for Limit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Limit::Overturned => f.write_str("overturned"),
            Limit::Balance => f.write_str("balance"),
            Limit::Rotation(limit) => write!(f, "theta/alpha>{limit}"),
            Limit::Slip(limit) => write!(f, "slip>{limit}"),
            Limit::Plastic(limit) => write!(f, "plastic>{limit}"),
            Limit::HalfCycles(limit) => write!(f, "half_cycles>{limit}"),
            Limit::Breaks => f.write_str("breaks"),
            Limit::Tilt(limit) => write!(f, "tilt/alpha>{limit}"),
            Limit::Twist(limit) => write!(f, "twist>{limit}"),
            Limit::Drift(limit) => write!(f, "drift>{limit}"),
        }
    }
}

/// The word of options.
impl serde::Serialize for Limit {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl FromStr for Limit {
    type Err = String;

    fn from_str(text: &str) -> Result<Limit, String> {
        let lower = text.to_ascii_lowercase();
        match lower.as_str() {
            "overturned" => return Ok(Limit::Overturned),
            "balance" => return Ok(Limit::Balance),
            "breaks" => return Ok(Limit::Breaks),
            _ => (),
        }
        let (quantity, number) = lower.split_once([':', '>']).unwrap_or(("theta/alpha", &lower));
        let limit = number.parse().ok().filter(|limit: &f64| *limit > 0.0 && limit.is_finite());
        let found = limit.and_then(|limit| match quantity {
            "theta/alpha" => Some(Limit::Rotation(limit)),
            "slip" => Some(Limit::Slip(limit)),
            "plastic" => Some(Limit::Plastic(limit)),
            "half_cycles" => Some(Limit::HalfCycles(limit)),
            "tilt" | "tilt/alpha" => Some(Limit::Tilt(limit)),
            "twist" => Some(Limit::Twist(limit)),
            "drift" => Some(Limit::Drift(limit)),
            _ => None,
        });
        found.ok_or_else(|| {
            format!(
                "found limit `{text}`; expected overturned, balance, breaks for ties and dampers that break, a number > 0 for |theta|/alpha, as in 0.5, one in metres for the slip, as in \
                 slip:0.1, or for the plastic elongation of ties and dampers, as in plastic:0.02, or one for their half cycles, as in \
                 half_cycles:20; of a block in space tilt:0.5 over that of its balance, twist:0.1 in rad, or drift:0.1 in metres"
            )
        })
    }
}

impl Limit {
    /// The limit for blocks in space: a rotation is a tilt there, and the balance one of 1.
    #[must_use]
    pub fn in_space(self) -> Limit {
        match self {
            Limit::Rotation(limit) => Limit::Tilt(limit),
            Limit::Balance => Limit::Tilt(1.0),
            limit => limit,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_ends_before_the_limit_and_the_motion_has_no_verdict() {
        let verdicts = |limit: Limit, rotation: f64| End::ALL.map(|end| limit.verdict(end, Some(rotation)));
        let [no, yes] = [false, true].map(Some);
        // Completed, overturned, separated, undecided, failed.
        assert_eq!(verdicts(Limit::Overturned, 2.0), [no, yes, None, None, None]);
        assert_eq!(verdicts(Limit::Balance, 1.1), [yes, yes, yes, yes, None]);
        assert_eq!(verdicts(Limit::Balance, 1.0), [no, yes, None, None, None]);
        assert_eq!(verdicts(Limit::Rotation(0.5), 0.4), [no, yes, None, None, None]);
        assert_eq!(verdicts(Limit::Rotation(0.5), 0.6), [yes, yes, yes, yes, None]);
        let breaks = |count: f64| End::ALL.map(|end| Limit::Breaks.verdict(end, Some(count)));
        assert_eq!((breaks(0.0), breaks(2.0)), ([no, yes, None, None, None], [yes, yes, yes, yes, None]));
        assert_eq!("Breaks".parse(), Ok(Limit::Breaks));
        for (text, limit) in [
            ("tilt:0.5", Limit::Tilt(0.5)),
            ("tilt/alpha>0.5", Limit::Tilt(0.5)),
            ("Twist>0.1", Limit::Twist(0.1)),
            ("drift:0.02", Limit::Drift(0.02)),
        ] {
            assert_eq!(text.parse(), Ok(limit));
            assert_eq!(limit.to_string().parse(), Ok(limit));
            assert_eq!(verdicts(limit, 0.7), [yes, yes, yes, yes, None]);
        }
        let in_space = [Limit::Rotation(0.5), Limit::Balance, Limit::Slip(0.5)].map(Limit::in_space);
        assert_eq!(in_space, [Limit::Tilt(0.5), Limit::Tilt(1.0), Limit::Slip(0.5)]);
        let without = |limit: Limit| End::ALL.map(|end| limit.verdict(end, None));
        assert_eq!(without(Limit::Overturned), [no, yes, None, None, None]);
        assert_eq!(without(Limit::Slip(0.1)), [None, yes, None, None, None], "a missing response stays below no limit");
    }
}
