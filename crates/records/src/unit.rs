//! Spellings of units of acceleration → factor to m/s².

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

/// A word that names no [`Unit`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("found unit {0:?}, expected one of g, m/s2, cm/s2, gal, mm/s2, g/10")]
pub struct UnknownUnit(pub String);

/// Unit of the accelerations in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    /// Acceleration of gravity, with the caller's value; see [`Unit::factor`].
    G,
    /// m/s².
    MetrePerSecondSquared,
    /// cm/s², also called gal.
    CentimetrePerSecondSquared,
    /// mm/s².
    MillimetrePerSecondSquared,
    /// A tenth of `g`, as in digitized film.
    TenthOfG,
}

impl Unit {
    /// All units.
    pub const ALL: [Unit; 5] = [
        Unit::G,
        Unit::MetrePerSecondSquared,
        Unit::CentimetrePerSecondSquared,
        Unit::MillimetrePerSecondSquared,
        Unit::TenthOfG,
    ];

    /// Returns the value of the unit in m/s², with `gravity` [m/s²] for `g`.
    ///
    /// Processed records "in g" do not state the value that was used.
    #[must_use]
    pub fn factor(self, gravity: f64) -> f64 {
        match self {
            Unit::G => gravity,
            Unit::MetrePerSecondSquared => 1.0,
            Unit::CentimetrePerSecondSquared => 0.01,
            Unit::MillimetrePerSecondSquared => 0.001,
            Unit::TenthOfG => 0.1 * gravity,
        }
    }

    /// Whether the unit is a multiple of gravity.
    #[must_use]
    pub fn is_of_gravity(self) -> bool {
        match self {
            Unit::G | Unit::TenthOfG => true,
            Unit::MetrePerSecondSquared | Unit::CentimetrePerSecondSquared | Unit::MillimetrePerSecondSquared => false,
        }
    }

    /// Returns the spellings of the other units.
    pub(super) fn others(self) -> &'static str {
        match self {
            Unit::G => "m/s2 or cm/s2",
            Unit::MetrePerSecondSquared => "g or cm/s2",
            Unit::CentimetrePerSecondSquared => "g or m/s2",
            Unit::MillimetrePerSecondSquared | Unit::TenthOfG => "g, m/s2 or cm/s2",
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Unit::G => "g",
            Unit::MetrePerSecondSquared => "m/s²",
            Unit::CentimetrePerSecondSquared => "cm/s²",
            Unit::MillimetrePerSecondSquared => "mm/s²",
            Unit::TenthOfG => "g/10",
        })
    }
}

impl FromStr for Unit {
    type Err = UnknownUnit;

    /// Reads the spellings of headers and users, in any case: `g`, `m/s2`, `m/s²`, `M/SEC/SEC`, `cm/s^2`, `cm/sec2`, `gal`.
    fn from_str(text: &str) -> Result<Unit, UnknownUnit> {
        match plain(text).as_str() {
            "g" => Ok(Unit::G),
            "m/s2" | "ms-2" => Ok(Unit::MetrePerSecondSquared),
            "cm/s2" | "cms-2" | "gal" | "gals" => Ok(Unit::CentimetrePerSecondSquared),
            "mm/s2" | "mms-2" => Ok(Unit::MillimetrePerSecondSquared),
            "g/10" => Ok(Unit::TenthOfG),
            _ => Err(UnknownUnit(text.to_owned())),
        }
    }
}

/// Quantity of values that are no accelerations in a [`Unit`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Velocity,
    Displacement,
    Readings,
    /// Acceleration in a unit that is not read, as ft/s².
    OtherAcceleration,
}

impl Quantity {
    /// Whether a factor turns the values into accelerations in a [`Unit`].
    pub(super) fn is_convertible(self) -> bool {
        match self {
            Quantity::Velocity | Quantity::Displacement => false,
            Quantity::Readings | Quantity::OtherAcceleration => true,
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Quantity::Velocity => "a velocity",
            Quantity::Displacement => "a displacement",
            Quantity::Readings => "instrument readings",
            Quantity::OtherAcceleration => "accelerations in a unit other than g, m/s2, cm/s2",
        })
    }
}

/// Returns the quantity that another known unit measures.
pub(super) fn other_quantity(text: &str) -> Option<Quantity> {
    match plain(text).as_str() {
        "cm/s" | "m/s" | "mm/s" | "in/s" | "ft/s" | "cms-1" | "ms-1" | "kine" => Some(Quantity::Velocity),
        "cm" | "m" | "mm" | "in" | "ft" => Some(Quantity::Displacement),
        "count" | "counts" => Some(Quantity::Readings),
        "mg" | "%g" | "ft/s2" | "in/s2" => Some(Quantity::OtherAcceleration),
        _ => None,
    }
}

/// Normalizes a spelling: lower case, no blanks, `s` for second and `2` for the square.
fn plain(text: &str) -> String {
    let squeezed: String = text.to_lowercase().split_whitespace().collect();
    squeezed
        .replace("seconds", "s")
        .replace("second", "s")
        .replace("sec", "s")
        .replace("seg", "s")
        .replace('²', "2")
        .replace("⁻", "-")
        .replace('¹', "1")
        .replace("**", "")
        .replace(['^', '·', '.'], "")
        .replace("cms/", "cm/")
        .replace("s*s", "s2")
        .replace("s/s", "s2")
}
