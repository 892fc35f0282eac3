//! The two parameterizations of a block, the paper's symbols or sizes, and the errors of invalid parameters.

use serde::{Deserialize, Serialize};

use crate::block::{Ratios, Springs, Supports};

/// The paper's parameters, plain or with derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Dimensionless<T = f64> {
    /// Slenderness angle α (rad), 0 < α < π/2.
    pub alpha: T,
    /// Frequency parameter p (rad/s).
    pub p: T,
    /// Its supports, or the rigid base.
    pub supports: Supports<Ratios<T>, T>,
}

/// Sizes of the block, and its supports in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Physical<T = f64> {
    /// Width of the base, 2b (m).
    pub width: T,
    /// Twice the height of the centre of mass over the base, 2h (m).
    pub height: T,
    /// Its supports, or the rigid base.
    pub supports: Supports<Springs<T>, T>,
    /// Centroidal moment of inertia I0 (kg.m²), in place of the one that follows from γ.
    pub inertia: Option<T>,
}

/// The parameters of a block in one of two parameterizations. The other one follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parameterization<T = f64> {
    /// The paper's parameters.
    Dimensionless(Dimensionless<T>),
    /// Sizes, stiffness and damping.
    Physical(Physical<T>),
}

/// Parameters common to both parameterizations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Common<T = f64> {
    /// Mass M (kg).
    pub mass: T,
    /// Shape factor γ = M R0²/I0 (1); 3 for a homogeneous rectangle.
    pub gamma: T,
    /// Restitution ε of the landing corner (1), 0 ≤ ε ≤ 1; eq. (17).
    pub epsilon: T,
    /// Gravity g (m/s²).
    pub gravity: T,
    /// Distance e_x of the mass centre from the middle (m), `|e_x| < b`. Positive to the right.
    pub eccentricity: T,
    /// Coulomb's coefficient of friction μ of the feet (1); 0 means no limit.
    pub friction: T,
}

impl Default for Common {
    fn default() -> Common {
        Common { mass: 1000.0, gamma: 3.0, epsilon: 0.0, gravity: 9.81, eccentricity: 0.0, friction: 0.0 }
    }
}

/// Invalid parameters of a block.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BlockError {
    /// A parameter out of range.
    #[error("{name} = {value} is not valid; expected {expected}")]
    OutOfRange {
        /// The parameter's name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The valid values.
        expected: &'static str,
    },
    /// A restitution factor with which impacts on the rigid base would create energy.
    #[error(
        "restitution_factor = {factor} makes e = {housner} into {}; expected at most 1 after an impact on the rigid base",
        factor * housner
    )]
    Restitution {
        /// The factor (1).
        factor: f64,
        /// Housner's e of ε (1), eq. (6).
        housner: f64,
    },
    /// A centre of mass that is not over the base.
    #[error(
        "eccentricity = {eccentricity} m is not valid; expected less than half the width, {half_width} m, to either side"
    )]
    Eccentricity {
        /// The eccentricity (m).
        eccentricity: f64,
        /// Half the width of the base (m).
        half_width: f64,
    },
    /// A friction with which a corner that slides on the rigid base may jam. The equations of motion have no solution, or two.
    #[error(
        "friction = {friction} lets a corner jam on the rigid base, which leaves no single motion; expected less than {limit}, or no \
         limit"
    )]
    Jams {
        /// Coulomb's μ (1).
        friction: f64,
        /// The least μ that jams (1).
        limit: f64,
    },
}

impl BlockError {
    /// Name of the parameter at fault.
    pub fn name(&self) -> &'static str {
        match self {
            BlockError::OutOfRange { name, .. } => name,
            BlockError::Restitution { .. } => "restitution_factor",
            BlockError::Eccentricity { .. } => "eccentricity",
            BlockError::Jams { .. } => "friction",
        }
    }
}

pub(super) fn check_common(common: &Common) -> Result<(), BlockError> {
    positive("mass", common.mass)?;
    positive("gamma", common.gamma)?;
    positive("g", common.gravity)?;
    not_negative("friction", common.friction)?;
    if !(0.0..=1.0).contains(&common.epsilon) {
        return Err(BlockError::OutOfRange { name: "epsilon", value: common.epsilon, expected: "0 <= epsilon <= 1" });
    }
    Ok(())
}

pub(super) fn positive(name: &'static str, value: f64) -> Result<(), BlockError> {
    open_range(name, value, 0.0, f64::INFINITY, "a finite number > 0")
}

pub(super) fn not_negative(name: &'static str, value: f64) -> Result<(), BlockError> {
    if (0.0..f64::INFINITY).contains(&value) {
        Ok(())
    } else {
        Err(BlockError::OutOfRange { name, value, expected: "a finite number >= 0" })
    }
}

pub(super) fn open_range(
    name: &'static str,
    value: f64,
    low: f64,
    high: f64,
    expected: &'static str,
) -> Result<(), BlockError> {
    if value > low && value < high { Ok(()) } else { Err(BlockError::OutOfRange { name, value, expected }) }
}
