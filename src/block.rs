//! Parameters of block and supports, given in the paper's symbols or as sizes → all that the equations need, checked.

use serde::{Deserialize, Serialize};

/// The paper's four parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Dimensionless {
    /// Slenderness angle α (rad), 0 < α < π/2.
    pub alpha: f64,
    /// Frequency parameter p (rad/s).
    pub p: f64,
    /// Stiffness ratio η = ω_v/p (1).
    pub eta: f64,
    /// Vertical damping ratio ξ_v (1).
    pub xi_v: f64,
}

/// Sizes and one support's stiffness and damping.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Physical {
    /// Width of the base, 2b (m).
    pub width: f64,
    /// Twice the height of the centre of mass over the base, 2h (m).
    pub height: f64,
    /// Stiffness K of one support (N/m).
    pub stiffness: f64,
    /// Damping C of one support (N.s/m).
    pub damping: f64,
}

/// What the block stands on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(i32)]
pub enum Foundation {
    /// A vertical Kelvin–Voigt support under each corner (Palmeri & Makris 2008).
    Viscoelastic = 1,
    /// A rigid base: Housner's block.
    Rigid = 2,
}

/// What both ways of giving a block share.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Common {
    /// Mass M (kg).
    pub mass: f64,
    /// Shape factor γ = M R0²/I0 (1); 3 for a homogeneous rectangle.
    pub gamma: f64,
    /// Restitution ε of the landing corner (1), 0 ≤ ε ≤ 1; eq. (17).
    pub epsilon: f64,
    /// Gravity g (m/s²).
    pub gravity: f64,
    /// Supports or rigid base.
    pub foundation: Foundation,
    /// On the rigid base, the e that acts over Housner's e of ε (1), at least 0; not read on supports.
    pub restitution_factor: f64,
}

impl Default for Common {
    fn default() -> Common {
        Common {
            mass: 1000.0,
            gamma: 3.0,
            epsilon: 0.0,
            gravity: 9.81,
            foundation: Foundation::Viscoelastic,
            restitution_factor: 1.0,
        }
    }
}

/// Parameters of which no valid block can be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BlockError {
    /// One that is out of range.
    #[error("{name} = {value} is not valid; expected {expected}")]
    OutOfRange {
        /// The parameter's name.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        expected: &'static str,
    },
    /// A factor with which impacts on the rigid base would make energy.
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
}

impl BlockError {
    /// Name of the parameter at fault.
    pub fn name(&self) -> &'static str {
        match self {
            BlockError::OutOfRange { name, .. } => name,
            BlockError::Restitution { .. } => "restitution_factor",
        }
    }
}

/// A block on its foundation, in both parameterizations; valid by construction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Block {
    /// Mass M (kg).
    pub mass: f64,
    /// Gravity g (m/s²).
    pub gravity: f64,
    /// Shape factor γ (1).
    pub gamma: f64,
    /// Restitution ε (1).
    pub epsilon: f64,
    /// Supports or rigid base.
    pub foundation: Foundation,
    /// Factor on Housner's e (1); read on the rigid base only.
    pub restitution_factor: f64,
    /// Slenderness angle α (rad).
    pub alpha: f64,
    /// Distance R0 from the centre of mass to each corner (m).
    pub r0: f64,
    /// Half width b = R0 sin α (m).
    pub b: f64,
    /// Height of the centre of mass h = R0 cos α (m).
    pub h: f64,
    /// Frequency parameter p (rad/s), eq. (3).
    pub p: f64,
    /// Vertical circular frequency ω_v in full contact (rad/s).
    pub omega_v: f64,
    /// Vertical damping ratio ξ_v (1).
    pub xi_v: f64,
    /// Stiffness K of one support (N/m).
    pub stiffness: f64,
    /// Damping C of one support (N.s/m).
    pub damping: f64,
    /// I0/M (m²).
    pub i0: f64,
}

impl Block {
    /// The block with the paper's parameters. Errors name the first parameter that is not valid.
    pub fn from_dimensionless(d: &Dimensionless, common: &Common) -> Result<Block, BlockError> {
        check_common(common)?;
        open_range("alpha", d.alpha, 0.0, std::f64::consts::FRAC_PI_2, "0 < alpha < pi/2 rad")?;
        positive("p", d.p)?;
        positive("eta", d.eta)?;
        not_negative("xi_v", d.xi_v)?;
        let omega_v = d.eta * d.p;
        let (sin, cos) = libm::sincos(d.alpha);
        let r0 = common.gamma / (1.0 + common.gamma) * common.gravity / (d.p * d.p);
        Block {
            alpha: d.alpha,
            r0,
            b: r0 * sin,
            h: r0 * cos,
            p: d.p,
            omega_v,
            xi_v: d.xi_v,
            stiffness: 0.5 * common.mass * omega_v * omega_v,
            damping: d.xi_v * common.mass * omega_v,
            ..Block::unfinished(common, r0)
        }
        .checked()
    }

    /// The block with these sizes. Errors name the first parameter that is not valid.
    pub fn from_physical(physical: &Physical, common: &Common) -> Result<Block, BlockError> {
        check_common(common)?;
        positive("width", physical.width)?;
        positive("height", physical.height)?;
        positive("K", physical.stiffness)?;
        not_negative("C", physical.damping)?;
        let (b, h) = (0.5 * physical.width, 0.5 * physical.height);
        let r0 = libm::hypot(b, h);
        let omega_v = (2.0 * physical.stiffness / common.mass).sqrt();
        Block {
            alpha: libm::atan2(b, h),
            r0,
            b,
            h,
            p: (common.gamma / (1.0 + common.gamma) * common.gravity / r0).sqrt(),
            omega_v,
            xi_v: physical.damping / (common.mass * omega_v),
            stiffness: physical.stiffness,
            damping: physical.damping,
            ..Block::unfinished(common, r0)
        }
        .checked()
    }

    fn unfinished(common: &Common, r0: f64) -> Block {
        Block {
            mass: common.mass,
            gravity: common.gravity,
            gamma: common.gamma,
            epsilon: common.epsilon,
            foundation: common.foundation,
            restitution_factor: common.restitution_factor,
            i0: r0 * r0 / common.gamma,
            r0,
            alpha: 0.0,
            b: 0.0,
            h: 0.0,
            p: 0.0,
            omega_v: 0.0,
            xi_v: 0.0,
            stiffness: 0.0,
            damping: 0.0,
        }
    }

    /// Each parameter may be fine and their product still overflow or vanish.
    fn checked(self) -> Result<Block, BlockError> {
        for (name, value) in [
            ("R0", self.r0),
            ("b = R0 sin(alpha)", self.b),
            ("h = R0 cos(alpha)", self.h),
            ("I0", self.mass * self.i0),
            ("omega_v", self.omega_v),
            ("p", self.p),
            ("K", self.stiffness),
            ("delta_s", self.static_deflection()),
        ] {
            if !(value.is_normal() && value > 0.0) {
                return Err(BlockError::OutOfRange {
                    name,
                    value,
                    expected: "a positive number within the range of f64",
                });
            }
        }
        if !self.damping.is_finite() || !self.xi_v.is_finite() {
            return Err(BlockError::OutOfRange { name: "C", value: self.damping, expected: "a finite damping" });
        }
        // A factor of at most 1 is fine whatever rounding made of an e near 1.
        if self.restitution_factor > 1.0 && self.restitution() > 1.0 {
            return Err(BlockError::Restitution {
                factor: self.restitution_factor,
                housner: self.housner_restitution(),
            });
        }
        Ok(self)
    }

    /// Centroidal moment of inertia I0 = M R0²/γ (kg.m²).
    pub fn inertia(&self) -> f64 {
        self.mass * self.i0
    }

    /// Stiffness ratio η = ω_v/p (1).
    pub fn eta(&self) -> f64 {
        self.omega_v / self.p
    }

    /// Static deflection δ_s = M g/(2K) = g/ω_v² (m).
    pub fn static_deflection(&self) -> f64 {
        self.gravity / (self.omega_v * self.omega_v)
    }

    /// Rate K/C at which a lifted support creeps back to its free height (1/s); infinite without damping.
    pub fn creep_rate(&self) -> f64 {
        self.stiffness / self.damping
    }

    /// The restitution e of the rotation: on the rigid base the part of θ̇ that an impact leaves, which is Housner's e
    /// times the factor; on supports Housner's e that ε amounts to (1).
    pub fn restitution(&self) -> f64 {
        match self.foundation {
            Foundation::Rigid => self.housner_restitution() * self.restitution_factor,
            Foundation::Viscoelastic => self.housner_restitution(),
        }
    }

    /// Housner's restitution e that ε amounts to (1), eq. (6).
    pub fn housner_restitution(&self) -> f64 {
        let cos = libm::cos(2.0 * self.alpha);
        (1.0 + self.gamma * self.epsilon + (1.0 - self.epsilon) * self.gamma * cos) / (1.0 + self.gamma)
    }

    /// Greatest e without jumps, at ε = 0 (1), eq. (2).
    pub fn max_restitution(&self) -> f64 {
        (1.0 + self.gamma * libm::cos(2.0 * self.alpha)) / (1.0 + self.gamma)
    }

    /// Rotation at which one corner lifts quasi-statically (rad), eq. (29); π/2 where the supports are so soft that
    /// none does.
    pub fn separation_angle(&self) -> f64 {
        let sin = self.static_deflection() / self.b;
        if sin < 1.0 { libm::asin(sin) } else { std::f64::consts::FRAC_PI_2 }
    }
}

fn check_common(common: &Common) -> Result<(), BlockError> {
    positive("mass", common.mass)?;
    positive("gamma", common.gamma)?;
    positive("g", common.gravity)?;
    not_negative("restitution_factor", common.restitution_factor)?;
    if !(0.0..=1.0).contains(&common.epsilon) {
        return Err(BlockError::OutOfRange { name: "epsilon", value: common.epsilon, expected: "0 <= epsilon <= 1" });
    }
    Ok(())
}

fn positive(name: &'static str, value: f64) -> Result<(), BlockError> {
    open_range(name, value, 0.0, f64::INFINITY, "a finite number > 0")
}

fn not_negative(name: &'static str, value: f64) -> Result<(), BlockError> {
    if (0.0..f64::INFINITY).contains(&value) {
        Ok(())
    } else {
        Err(BlockError::OutOfRange { name, value, expected: "a finite number >= 0" })
    }
}

fn open_range(name: &'static str, value: f64, low: f64, high: f64, expected: &'static str) -> Result<(), BlockError> {
    if value > low && value < high { Ok(()) } else { Err(BlockError::OutOfRange { name, value, expected }) }
}
