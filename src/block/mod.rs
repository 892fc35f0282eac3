//! The block: parameters → all that the equations need, checked; its geometry; its foundation; the contacts of its corners.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`parameters`] | the two ways to give a block |
//! | [`geometry`] | a rotation → the centre of mass as seen from each corner |
//! | [`foundation`] | time since lift-off → the height of a support |
//! | [`contact`] | the contact of each corner → the regime |

pub mod contact;
pub mod foundation;
pub mod geometry;
pub mod parameters;

use serde::{Deserialize, Serialize};

use crate::numerics::scalar::{Elementary, Scalar};
use parameters::{check_common, not_negative, open_range, positive};

pub use contact::{Contact, Contacts, Regime};
pub use foundation::{Creep, Foundation};
pub use geometry::{Corner, Foot, Lever};
pub use parameters::{BlockError, Common, Dimensionless, Physical};

/// A block on its foundation, in both parameterizations; one of `f64` is valid by construction. Lanes hold several blocks on
/// foundations of the same kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Block<T = f64> {
    /// Mass M (kg).
    pub mass: T,
    /// Gravity g (m/s²).
    pub gravity: T,
    /// Shape factor γ (1).
    pub gamma: T,
    /// Restitution ε (1).
    pub epsilon: T,
    /// Supports or rigid base.
    pub foundation: Foundation,
    /// Factor on Housner's e (1); read on the rigid base only.
    pub restitution_factor: T,
    /// Slenderness angle α (rad).
    pub alpha: T,
    /// Distance R0 from the centre of mass to each corner (m).
    pub r0: T,
    /// Half width b = R0 sin α (m).
    pub b: T,
    /// Height of the centre of mass h = R0 cos α (m).
    pub h: T,
    /// Frequency parameter p (rad/s), eq. (3).
    pub p: T,
    /// Vertical circular frequency ω_v in full contact (rad/s).
    pub omega_v: T,
    /// Vertical damping ratio ξ_v (1).
    pub xi_v: T,
    /// Stiffness K of one support (N/m).
    pub stiffness: T,
    /// Damping C of one support (N.s/m).
    pub damping: T,
    /// I0/M (m²).
    pub i0: T,
}

impl Block {
    /// The block with the paper's parameters. Errors name the first parameter that is not valid.
    pub fn from_dimensionless(d: &Dimensionless, common: &Common) -> Result<Block, BlockError> {
        check_common(common)?;
        open_range("alpha", d.alpha, 0.0, std::f64::consts::FRAC_PI_2, "0 < alpha < pi/2 rad")?;
        positive("p", d.p)?;
        positive("eta", d.eta)?;
        not_negative("xi_v", d.xi_v)?;
        Block::of_dimensionless(d, common).checked()
    }

    /// The block with these sizes. Errors name the first parameter that is not valid.
    pub fn from_physical(physical: &Physical, common: &Common) -> Result<Block, BlockError> {
        check_common(common)?;
        positive("width", physical.width)?;
        positive("height", physical.height)?;
        positive("K", physical.stiffness)?;
        not_negative("C", physical.damping)?;
        Block::of_physical(physical, common).checked()
    }

    /// Each parameter may be fine and their product still overflow or vanish.
    fn checked(mut self) -> Result<Block, BlockError> {
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
            const ROUNDING: f64 = 1e-12;
            let (factor, housner) = (self.restitution_factor, self.housner_restitution());
            if factor * housner > 1.0 + ROUNDING {
                return Err(BlockError::Restitution { factor, housner });
            }
            // A factor 1/e that was rounded: the product is brought back to at most 1.
            let inverse = 1.0 / housner;
            self.restitution_factor = if inverse * housner > 1.0 { inverse.next_down() } else { inverse };
        }
        Ok(self)
    }
}

impl<T: Scalar> Block<T> {
    /// Rate K/C at which a lifted support creeps back to its free height (1/s); infinite without damping.
    pub fn creep_rate(&self) -> T {
        self.stiffness / self.damping
    }
}

impl<T: Elementary> Block<T> {
    /// The block with the paper's parameters, which are not checked.
    pub fn of_dimensionless(d: &Dimensionless<T>, common: &Common<T>) -> Block<T> {
        let omega_v = d.eta * d.p;
        let (sin, cos) = d.alpha.sin_cos();
        let r0 = common.gamma / (common.gamma + 1.0) * common.gravity / (d.p * d.p);
        Block {
            alpha: d.alpha,
            b: r0 * sin,
            h: r0 * cos,
            p: d.p,
            omega_v,
            xi_v: d.xi_v,
            stiffness: common.mass * 0.5 * omega_v * omega_v,
            damping: d.xi_v * common.mass * omega_v,
            ..Block::unfinished(common, r0)
        }
    }

    /// The block with these sizes, which are not checked.
    pub fn of_physical(physical: &Physical<T>, common: &Common<T>) -> Block<T> {
        let (b, h) = (physical.width * 0.5, physical.height * 0.5);
        let r0 = b.hypot(h);
        let omega_v = (physical.stiffness * 2.0 / common.mass).sqrt();
        Block {
            alpha: b.atan2(h),
            b,
            h,
            p: (common.gamma / (common.gamma + 1.0) * common.gravity / r0).sqrt(),
            omega_v,
            xi_v: physical.damping / (common.mass * omega_v),
            stiffness: physical.stiffness,
            damping: physical.damping,
            ..Block::unfinished(common, r0)
        }
    }

    fn unfinished(common: &Common<T>, r0: T) -> Block<T> {
        let zero = T::from(0.0);
        Block {
            mass: common.mass,
            gravity: common.gravity,
            gamma: common.gamma,
            epsilon: common.epsilon,
            foundation: common.foundation,
            restitution_factor: common.restitution_factor,
            i0: r0 * r0 / common.gamma,
            r0,
            alpha: zero,
            b: zero,
            h: zero,
            p: zero,
            omega_v: zero,
            xi_v: zero,
            stiffness: zero,
            damping: zero,
        }
    }

    /// Centroidal moment of inertia I0 = M R0²/γ (kg.m²).
    pub fn inertia(&self) -> T {
        self.mass * self.i0
    }

    /// Stiffness ratio η = ω_v/p (1).
    pub fn eta(&self) -> T {
        self.omega_v / self.p
    }

    /// Static deflection δ_s = M g/(2K) = g/ω_v² (m).
    pub fn static_deflection(&self) -> T {
        self.gravity / (self.omega_v * self.omega_v)
    }

    /// The restitution e of the rotation: on the rigid base the part of θ̇ that an impact leaves, which is Housner's e
    /// times the factor; on supports Housner's e that ε amounts to (1).
    pub fn restitution(&self) -> T {
        match self.foundation {
            Foundation::Rigid => self.housner_restitution() * self.restitution_factor,
            Foundation::Viscoelastic => self.housner_restitution(),
        }
    }

    /// Housner's restitution e that ε amounts to (1), eq. (6).
    pub fn housner_restitution(&self) -> T {
        let cos = (self.alpha * 2.0).cos();
        (self.gamma * self.epsilon + 1.0 + (-self.epsilon + 1.0) * self.gamma * cos) / (self.gamma + 1.0)
    }

    /// Greatest e without jumps, at ε = 0 (1), eq. (2).
    pub fn max_restitution(&self) -> T {
        (self.gamma * (self.alpha * 2.0).cos() + 1.0) / (self.gamma + 1.0)
    }

    /// Rotation at which one corner lifts quasi-statically (rad), eq. (29); π/2 where the supports are so soft that
    /// none does.
    pub fn separation_angle(&self) -> T {
        let sin = self.static_deflection() / self.b;
        if sin.value() < 1.0 { sin.asin() } else { T::from(std::f64::consts::FRAC_PI_2) }
    }
}
