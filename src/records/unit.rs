//! Units of acceleration: what a header or a user writes → factor to m/s².

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

use super::UnknownUnit;

/// Unit of the accelerations in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    /// The acceleration of gravity; its value is the caller's choice, see [`Unit::factor`].
    G,
    /// m/s².
    MetrePerSecondSquared,
    /// cm/s², also called gal.
    CentimetrePerSecondSquared,
}

impl Unit {
    /// Metres per second squared in one unit. `gravity` [m/s²] is the value of `g`: processed records "in g" do not say
    /// which one was used, so it is a choice of the caller.
    #[must_use]
    pub fn factor(self, gravity: f64) -> f64 {
        match self {
            Unit::G => gravity,
            Unit::MetrePerSecondSquared => 1.0,
            Unit::CentimetrePerSecondSquared => 0.01,
        }
    }

    /// As it is typed.
    pub(super) fn plain(self) -> &'static str {
        match self {
            Unit::G => "g",
            Unit::MetrePerSecondSquared => "m/s2",
            Unit::CentimetrePerSecondSquared => "cm/s2",
        }
    }

    /// The other units, as they are typed.
    pub(super) fn others(self) -> &'static str {
        match self {
            Unit::G => "m/s2 or cm/s2",
            Unit::MetrePerSecondSquared => "g or cm/s2",
            Unit::CentimetrePerSecondSquared => "g or m/s2",
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Unit::G => "g",
            Unit::MetrePerSecondSquared => "m/s²",
            Unit::CentimetrePerSecondSquared => "cm/s²",
        })
    }
}

impl FromStr for Unit {
    type Err = UnknownUnit;

    /// Reads what headers and users write, in any case: `g`, `m/s2`, `m/s²`, `M/SEC/SEC`, `cm/s^2`, `cm/sec2`, `gal`.
    fn from_str(text: &str) -> Result<Unit, UnknownUnit> {
        match plain(text).as_str() {
            "g" => Ok(Unit::G),
            "m/s2" | "m/s/s" | "ms-2" => Ok(Unit::MetrePerSecondSquared),
            "cm/s2" | "cm/s/s" | "cms-2" | "gal" | "gals" => Ok(Unit::CentimetrePerSecondSquared),
            _ => Err(UnknownUnit(text.to_owned())),
        }
    }
}

/// What a unit that is no acceleration measures, where it is known.
pub(super) fn other_quantity(text: &str) -> Option<&'static str> {
    match plain(text).as_str() {
        "cm/s" | "m/s" | "mm/s" | "in/s" | "ft/s" => Some("a velocity"),
        "cm" | "m" | "mm" | "in" | "ft" => Some("a displacement"),
        "count" | "counts" => Some("counts of an instrument"),
        _ => None,
    }
}

/// One spelling for all: lower case, no blanks, `s` for second and `2` for the square.
fn plain(text: &str) -> String {
    let squeezed: String = text.to_lowercase().split_whitespace().collect();
    squeezed
        .replace("seconds", "s")
        .replace("second", "s")
        .replace("sec", "s")
        .replace('²', "2")
        .replace("**2", "2")
        .replace("^2", "2")
        .replace('·', "")
}
