//! The parameters of a block in space, in the forms in which users give them, and the errors of invalid ones.

use serde::{Deserialize, Serialize};

use crate::block::BlockError;
use crate::block::parameters::Valid;

/// Fewest and most feet of a block.
pub const FEET: [usize; 2] = [3, 64];

/// The parameters of a block in space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpaceParameters {
    /// Shape and size of the base.
    pub base: Base,
    /// Stiffness and damping of the supports.
    pub supports: SpaceSupports,
    /// Ratio κ of the horizontal to the vertical stiffness of a foot (1).
    pub kappa: f64,
    /// Horizontal damping ratio ξ_h (1), at a frequency of √κ ω_v; that of the supports, ξ_v, if not given.
    pub xi_h: Option<f64>,
    /// Coulomb's μ of the feet (1); 0 is frictionless.
    pub friction: f64,
    /// Mass M (kg).
    pub mass: f64,
    /// Shape factor γ (1) of the inertia that is not given; 3 for a homogeneous body.
    pub gamma: f64,
    /// Gravity g (m/s²).
    pub gravity: f64,
    /// Place of the centre of mass (m) from the middle of a rectangular or circular base: to the right and away from the viewer.
    pub eccentricity: [f64; 2],
    /// Inertia about the centre of mass in place of that of the shape: I_xx, I_yy, I_zz, I_xy, I_xz, I_yz (kg.m²).
    pub inertia: Option<[f64; 6]>,
}

/// The base of a block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Base {
    /// A prism on a foot at each corner, in the order −x −y, −x +y, +x −y, +x +y.
    Rectangle {
        /// Width along x and height.
        size: BaseSize,
        /// Depth along y over width (1).
        depth_ratio: f64,
    },
    /// A cylinder on feet along its edge, the first one on +x.
    Circle {
        /// Diameter and height.
        size: BaseSize,
        /// Number of feet.
        feet: usize,
    },
    /// Any feet. The inertia is needed.
    List {
        /// The feet.
        feet: Vec<FootPlace>,
        /// Height h of the centre of mass (m).
        center_height: f64,
    },
}

/// Width and height of a block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum BaseSize {
    /// The paper's parameters, of the motion in the plane x–z.
    Slenderness {
        /// Slenderness angle α (rad), `tan α = b/h`.
        alpha: f64,
        /// Frequency parameter p (rad/s), which gives `R0 = γ/(1 + γ) g/p²`.
        p: f64,
    },
    /// Lengths.
    Lengths {
        /// Width or diameter of the base, 2b (m).
        width: f64,
        /// Height h of the centre of mass over the base (m).
        center_height: f64,
    },
}

/// The place of a foot from the centre of mass, seen from above.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FootPlace {
    /// To the right (m).
    pub x: f64,
    /// Away from the viewer (m).
    pub y: f64,
    /// Gap to its support at rest (m).
    pub gap: f64,
}

/// Stiffness and damping of the supports.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum SpaceSupports {
    /// Ratios of the paper: η = ω_v/p (1), and ξ_v (1). Not for a list of feet.
    OfRocking {
        /// Stiffness ratio η (1).
        eta: f64,
        /// Vertical damping ratio ξ_v (1).
        xi_v: f64,
    },
    /// The vertical circular frequency.
    OfHeave {
        /// Circular frequency ω_v of the block that moves vertically on all feet without gaps (rad/s).
        omega_v: f64,
        /// Vertical damping ratio ξ_v (1).
        xi_v: f64,
    },
    /// Those of one foot.
    OfFoot {
        /// Stiffness K (N/m).
        stiffness: f64,
        /// Damping C (N.s/m).
        damping: f64,
    },
}

impl Default for SpaceParameters {
    fn default() -> SpaceParameters {
        SpaceParameters {
            base: Base::Rectangle { size: BaseSize::Slenderness { alpha: 0.25, p: 1.5 }, depth_ratio: 1.0 },
            supports: SpaceSupports::OfRocking { eta: 40.0, xi_v: 0.2 },
            kappa: 1.0,
            xi_h: None,
            friction: 10.0,
            mass: 1000.0,
            gamma: 3.0,
            gravity: 9.81,
            eccentricity: [0.0; 2],
            inertia: None,
        }
    }
}

/// Invalid parameters of a block in space.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpaceError {
    /// A number out of range.
    #[error(transparent)]
    Number(#[from] BlockError),
    /// Too few or too many feet.
    #[error("feet = {count} is not valid; expected {} to {}", FEET[0], FEET[1])]
    Count {
        /// Their number.
        count: usize,
    },
    /// Too few feet without a gap.
    #[error("foot_gap leaves {count} feet without a gap; expected at least {}", FEET[0])]
    Gaps {
        /// The number of feet without a gap.
        count: usize,
    },
    /// Feet on a line.
    #[error("feet: the {count} feet without a gap stand on a line; expected a base with an area")]
    OnLine {
        /// The number of feet without a gap.
        count: usize,
    },
    /// A centre of mass that is not over the base, or presses on too few feet.
    #[error(
        "feet: foot {} at ({x} m, {y} m) from the centre of mass carries {load} N at rest; expected a centre of mass so far inside the \
         base that all feet without a gap carry", .foot + 1
    )]
    Unloaded {
        /// The index of the foot, from 0; the message counts from 1.
        foot: usize,
        /// Its place (m).
        x: f64,
        /// Its place (m).
        y: f64,
        /// Its load at rest (N).
        load: f64,
    },
    /// A number that the others do not determine.
    #[error("{name} is missing; expected it for a block with a list of feet")]
    Missing {
        /// Its name.
        name: &'static str,
    },
    /// An inertia that no body has.
    #[error("inertia has the principal moments {0:?} kg.m2; expected positive ones, none greater than the sum of the others", .principal)]
    Inertia {
        /// The principal moments of inertia (kg.m²).
        principal: [f64; 3],
    },
}

/// Refuses a number out of range.
pub(super) fn check(name: &'static str, valid: Valid, value: f64) -> Result<f64, SpaceError> {
    match valid.check(value) {
        Ok(()) => Ok(value),
        Err(expected) => Err(BlockError::OutOfRange { name: name.into(), value, expected }.into()),
    }
}

impl SpaceParameters {
    /// Refuses numbers out of range, each on its own.
    pub(super) fn check(&self) -> Result<(), SpaceError> {
        use Valid::{AcuteAngle, NotNegative, Positive};
        check("mass", Positive, self.mass)?;
        check("gamma", Positive, self.gamma)?;
        check("g", Positive, self.gravity)?;
        check("kappa", Positive, self.kappa)?;
        check("friction", NotNegative, self.friction)?;
        if let Some(xi_h) = self.xi_h {
            check("xi_h", Positive, xi_h)?;
        }
        match self.supports {
            SpaceSupports::OfRocking { eta, xi_v } => {
                check("eta", Positive, eta)?;
                check("xi_v", Positive, xi_v)?;
            }
            SpaceSupports::OfHeave { omega_v, xi_v } => {
                check("omega_v", Positive, omega_v)?;
                check("xi_v", Positive, xi_v)?;
            }
            SpaceSupports::OfFoot { stiffness, damping } => {
                check("K", Positive, stiffness)?;
                check("C", Positive, damping)?;
            }
        }
        let size = match &self.base {
            Base::Rectangle { size, depth_ratio } => {
                check("depth_ratio", Positive, *depth_ratio)?;
                size
            }
            Base::Circle { size, .. } => size,
            Base::List { center_height, .. } => return check("center_height", Positive, *center_height).map(|_| ()),
        };
        match *size {
            BaseSize::Slenderness { alpha, p } => {
                check("alpha", AcuteAngle, alpha)?;
                check("p", Positive, p)?;
            }
            BaseSize::Lengths { width, center_height } => {
                check("width", Positive, width)?;
                check("center_height", Positive, center_height)?;
            }
        }
        Ok(())
    }
}
