//! The parameters of a block, each part in one of two parameterizations, and the errors of invalid ones.

use std::borrow::Cow;
use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use crate::block::{KelvinVoigt, Ratios, Springs, Supports};

/// Size and shape of a block, in one of two parameterizations. The other one follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outline<T = f64> {
    /// The paper's parameters.
    Slenderness {
        /// Slenderness angle α (rad), 0 < α < π/2.
        alpha: T,
        /// Frequency parameter p (rad/s).
        p: T,
    },
    /// Lengths, and perhaps the inertia.
    Sizes {
        /// Width of the base, 2b (m).
        width: T,
        /// Twice the height of the centre of mass over the base, 2h (m).
        height: T,
        /// Centroidal moment of inertia I0 (kg.m²), in place of the one that follows from γ.
        inertia: Option<T>,
    },
}

/// The parameters that define a block without restraints, plain or with derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockParameters<T = f64> {
    /// Its size and shape.
    pub outline: Outline<T>,
    /// Its supports, or the rigid base.
    pub supports: Supports<KelvinVoigt<T>, T>,
    /// Its other parameters.
    pub common: Common<T>,
}

/// The valid values of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Valid {
    /// Finite numbers above 0.
    Positive,
    /// Finite numbers from 0 on.
    NotNegative,
    /// From 0 to 1.
    Fraction,
    /// Angles (rad) between 0 and π/2, exclusive.
    AcuteAngle,
    /// Those that suit the other numbers.
    Depends,
}

impl<T> BlockParameters<T> {
    /// Returns the numbers with their names and valid values, to read or to set them.
    pub fn numbers_mut(&mut self) -> impl Iterator<Item = (&'static str, Valid, &mut T)> {
        use Valid::{AcuteAngle, Depends, Fraction, NotNegative, Positive};
        let BlockParameters { outline, supports, common } = self;
        let Common { mass, gamma, epsilon, gravity, eccentricity, friction } = common;
        let common = [
            ("mass", Positive, mass),
            ("gamma", Positive, gamma),
            ("g", Positive, gravity),
            ("friction", NotNegative, friction),
            ("epsilon", Fraction, epsilon),
            ("eccentricity", Depends, eccentricity),
        ];
        let outline = match outline {
            Outline::Slenderness { alpha, p } => [Some(("alpha", AcuteAngle, alpha)), Some(("p", Positive, p)), None],
            Outline::Sizes { width, height, inertia } => {
                let inertia = inertia.as_mut().map(|inertia| ("inertia", Positive, inertia));
                [Some(("width", Positive, width)), Some(("height", Positive, height)), inertia]
            }
        };
        let supports = match supports {
            Supports::Viscoelastic(KelvinVoigt::Ratios(Ratios { eta, xi_v })) => {
                [Some(("eta", Positive, eta)), Some(("xi_v", NotNegative, xi_v))]
            }
            Supports::Viscoelastic(KelvinVoigt::Springs(Springs { stiffness, damping })) => {
                [Some(("K", Positive, stiffness)), Some(("C", NotNegative, damping))]
            }
            Supports::Rigid { restitution_factor } => {
                [Some(("restitution_factor", NotNegative, restitution_factor)), None]
            }
        };
        common.into_iter().chain(outline.into_iter().flatten()).chain(supports.into_iter().flatten())
    }

    /// Returns parameters of the same kind with `of` each number.
    pub fn map<U>(self, of: impl Fn(T) -> U) -> BlockParameters<U> {
        let BlockParameters { outline, supports, common } = self;
        let Common { mass, gamma, epsilon, gravity, eccentricity, friction } = common;
        BlockParameters {
            outline: match outline {
                Outline::Slenderness { alpha, p } => Outline::Slenderness { alpha: of(alpha), p: of(p) },
                Outline::Sizes { width, height, inertia } => {
                    Outline::Sizes { width: of(width), height: of(height), inertia: inertia.map(&of) }
                }
            },
            supports: supports.map(|supports| supports.map(&of), &of),
            common: Common {
                mass: of(mass),
                gamma: of(gamma),
                epsilon: of(epsilon),
                gravity: of(gravity),
                eccentricity: of(eccentricity),
                friction: of(friction),
            },
        }
    }
}

impl BlockParameters {
    pub(super) fn check(mut self) -> Result<(), BlockError> {
        self.numbers_mut().try_for_each(|(name, valid, &mut value)| {
            valid.check(value).map_err(|expected| BlockError::OutOfRange { name: name.into(), value, expected })
        })
    }
}

/// The paper's parameters and a rigid base or supports in its ratios.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensionless {
    /// Slenderness angle α (rad), 0 < α < π/2.
    pub alpha: f64,
    /// Frequency parameter p (rad/s).
    pub p: f64,
    /// Its supports, or the rigid base.
    pub supports: Supports<Ratios>,
}

impl Dimensionless {
    /// Returns these with the other parameters of a block.
    pub fn with(&self, common: &Common) -> BlockParameters {
        let Dimensionless { alpha, p, supports } = *self;
        let supports = supports.with(KelvinVoigt::Ratios);
        BlockParameters { outline: Outline::Slenderness { alpha, p }, supports, common: *common }
    }
}

/// Parameters beside the outline and the supports.
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
    /// Coulomb's coefficient of friction μ of the feet (1); 0, or [1000 and more](crate::block::UNLIMITED_FRICTION), means no limit.
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
        name: Cow<'static, str>,
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
    pub fn name(&self) -> &str {
        match self {
            BlockError::OutOfRange { name, .. } => name,
            BlockError::Restitution { .. } => "restitution_factor",
            BlockError::Eccentricity { .. } => "eccentricity",
            BlockError::Jams { .. } => "friction",
        }
    }
}

impl Valid {
    /// Refuses other values, with the valid ones.
    pub(crate) fn check(self, value: f64) -> Result<(), &'static str> {
        let (is_valid, expected) = match self {
            Valid::Positive => (value > 0.0 && value < f64::INFINITY, "a finite number > 0"),
            Valid::NotNegative => ((0.0..f64::INFINITY).contains(&value), "a finite number >= 0"),
            Valid::Fraction => ((0.0..=1.0).contains(&value), "0 <= epsilon <= 1"),
            Valid::AcuteAngle => (value > 0.0 && value < FRAC_PI_2, "0 < alpha < pi/2 rad"),
            Valid::Depends => return Ok(()),
        };
        if is_valid { Ok(()) } else { Err(expected) }
    }
}
