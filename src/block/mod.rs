//! The block: checked parameters, geometry, foundation, contacts of the corners, restraints.
//!
//! | module | in → out |
//! | --- | --- |
//! | `parameters` | the parameters of a block, each part in one of two parameterizations |
//! | `body` | the part of a block that equations of motion, event functions and steps read |
//! | `geometry` | a rotation → the centre of mass as seen from each corner |
//! | `foundation` | time since lift-off → the height of a support |
//! | `contact` | the contact of each corner → the regime |
//! | [`restraints`] | forces between block and ground that switch, a folder each: parameters, states, pull, energies, event functions |

pub(crate) mod body;
pub(crate) mod contact;
pub(crate) mod foundation;
pub(crate) mod geometry;
pub(crate) mod parameters;
pub mod restraints;

use serde::{Deserialize, Serialize};

use crate::numerics::scalar::Elementary;
use parameters::Valid;

pub use body::Body;
pub use contact::{Contact, Contacts, Regime, StandingSlide};
#[cfg(feature = "lanes")]
pub(crate) use foundation::RECOVERED;
pub use foundation::{Creep, Foundation, KelvinVoigt, Ratios, Springs, Supports};
pub use geometry::{Corner, Foot, Kinematics, Lever};
pub use parameters::{BlockError, BlockParameters, Common, Dimensionless, Outline};
pub use restraints::Restraints;

/// A block on its foundation, in both parameterizations. A `Block<f64>` from a checked constructor is valid.
///
/// It dereferences to its body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Block<T = f64> {
    /// The numbers on which its motion between impacts depends.
    pub body: Body<T>,
    /// Slenderness angle α (rad).
    pub alpha: T,
    /// Shape factor γ (1).
    pub gamma: T,
    /// Restitution ε (1).
    pub epsilon: T,
    /// Factor on Housner's e (1) of a rigid base; 1 on supports.
    pub restitution_factor: T,
    /// Stiffness K of one support (N/m). Like the next one, 0 on a rigid base.
    pub stiffness: T,
    /// Damping C of one support (N.s/m).
    pub damping: T,
}

/// Lengths, frequency and inertia of a block.
struct Shape<T> {
    alpha: T,
    r0: T,
    b: T,
    h: T,
    p: T,
    gamma: T,
}

impl Block {
    /// Makes a block without restraints.
    ///
    /// # Errors
    /// The first invalid parameter, with its value and the valid ones.
    pub fn new(parameters: &BlockParameters) -> Result<Block, BlockError> {
        parameters.check()?;
        Block::unchecked(parameters).checked()
    }

    /// Makes a block with the paper's parameters.
    ///
    /// # Errors
    /// Those of [`Block::new`].
    pub fn from_dimensionless(dimensionless: &Dimensionless, common: &Common) -> Result<Block, BlockError> {
        Block::new(&dimensionless.with(common))
    }

    /// The block on supports with another damping ratio ξ_v (1). A rigid base stays as it is.
    ///
    /// # Errors
    /// An invalid ratio, with the valid ones.
    pub fn with_damping_ratio(mut self, xi_v: f64) -> Result<Block, BlockError> {
        let refused = |expected| BlockError::OutOfRange { name: "xi_v".into(), value: xi_v, expected };
        Valid::NotNegative.check(xi_v).map_err(refused)?;
        if self.foundation == Foundation::Rigid {
            return Ok(self);
        }
        self.damping = xi_v * self.mass * self.omega_v;
        let creep_rate = Springs { stiffness: self.stiffness, damping: self.damping }.creep_rate();
        self.body = Body { xi_v, creep_rate, ..self.body };
        self.checked()
    }

    /// Refuses derived quantities that overflow or vanish although each parameter is valid.
    fn checked(mut self) -> Result<Block, BlockError> {
        let of_block = [
            ("R0", self.r0),
            ("b = R0 sin(alpha)", self.b),
            ("h = R0 cos(alpha)", self.h),
            ("I0", self.mass * self.i0),
            ("p", self.p),
        ];
        let of_supports = [("omega_v", self.omega_v), ("K", self.stiffness), ("delta_s", self.static_deflection())];
        let on_supports = self.foundation == Foundation::Viscoelastic;
        for (name, value) in of_block.into_iter().chain(of_supports.into_iter().filter(|_| on_supports)) {
            if !(value.is_normal() && value > 0.0) {
                return Err(BlockError::OutOfRange {
                    name: name.into(),
                    value,
                    expected: "a positive number within the range of f64",
                });
            }
        }
        if !self.damping.is_finite() || !self.xi_v.is_finite() {
            return Err(BlockError::OutOfRange { name: "C".into(), value: self.damping, expected: "a finite damping" });
        }
        let eccentricity = self.eccentricity;
        let inside = self.weight_fraction.iter().all(|&fraction| fraction > 0.0);
        if !inside {
            return Err(BlockError::Eccentricity { eccentricity, half_width: self.b });
        }
        if self.foundation == Foundation::Rigid && self.friction >= self.jamming_friction() {
            return Err(BlockError::Jams { friction: self.friction, limit: self.jamming_friction() });
        }
        // A factor of at most 1 is valid even if round-off took an e near 1 above 1.
        let [left, right] = Corner::each(|corner| self.housner_restitution(corner));
        let (factor, housner) = (self.restitution_factor, if right > left { right } else { left });
        if self.foundation == Foundation::Rigid && factor > 1.0 && housner * factor > 1.0 {
            const ROUNDING: f64 = 1e-12;
            if factor * housner > 1.0 + ROUNDING {
                return Err(BlockError::Restitution { factor, housner });
            }
            // The user gave a rounded 1/e; a number times its rounded inverse never exceeds 1.
            self.restitution_factor = 1.0 / housner;
        }
        Ok(self)
    }
}

/// Least coefficient of friction that stands for no limit (1). A foot that slides under a greater one would be as stiff as it is great
/// while its reaction vanishes, and stop within microseconds: a limit that never binds would fail runs.
pub const UNLIMITED_FRICTION: f64 = 1e3;

impl<T: Elementary> Block<T> {
    /// Makes a block without restraints, and without checks.
    pub fn unchecked(parameters: &BlockParameters<T>) -> Block<T> {
        let BlockParameters { outline, supports, common } = *parameters;
        let Common { mass, gamma, gravity, epsilon, eccentricity, friction } = common;
        let Shape { alpha, r0, b, h, p, gamma } = match outline {
            Outline::Slenderness { alpha, p } => {
                let (sin, cos) = alpha.sin_cos();
                let r0 = gamma / (gamma + 1.0) * gravity / (p * p);
                Shape { alpha, r0, b: r0 * sin, h: r0 * cos, p, gamma }
            }
            Outline::Sizes { width, height, inertia } => {
                let (b, h) = (width * 0.5, height * 0.5);
                let r0 = b.hypot(h);
                let gamma = inertia.map_or(gamma, |inertia| mass * r0 * r0 / inertia);
                Shape { alpha: b.atan2(h), r0, b, h, p: (gamma / (gamma + 1.0) * gravity / r0).sqrt(), gamma }
            }
        };
        let (zero, half) = (T::from(0.0), T::from(0.5));
        let (omega_v, xi_v, Springs { stiffness, damping }, creep_rate) = match supports {
            Supports::Viscoelastic(KelvinVoigt::Ratios(Ratios { eta, xi_v })) => {
                let omega_v = eta * p;
                let springs = Springs { stiffness: mass * 0.5 * omega_v * omega_v, damping: xi_v * mass * omega_v };
                (omega_v, xi_v, springs, springs.creep_rate())
            }
            Supports::Viscoelastic(KelvinVoigt::Springs(springs)) => {
                let omega_v = (springs.stiffness * 2.0 / mass).sqrt();
                (omega_v, springs.damping / (mass * omega_v), springs, springs.creep_rate())
            }
            Supports::Rigid { .. } => (zero, zero, Springs { stiffness: zero, damping: zero }, zero),
        };
        let uneven = eccentricity * 0.5 / b;
        Block {
            body: Body {
                mass,
                i0: r0 * r0 / gamma,
                gravity,
                r0,
                b,
                h,
                eccentricity,
                weight_fraction: [half - uneven, half + uneven],
                p,
                foundation: supports.foundation(),
                omega_v,
                xi_v,
                creep_rate,
                friction: if friction.value() < UNLIMITED_FRICTION { friction } else { zero },
                restraints: Restraints::none(),
            },
            alpha,
            gamma,
            epsilon,
            restitution_factor: supports.restitution_factor().unwrap_or(T::from(1.0)),
            stiffness,
            damping,
        }
    }

    /// Centroidal moment of inertia I0 = M R0²/γ (kg.m²).
    pub fn inertia(&self) -> T {
        self.mass * self.i0
    }

    /// Its parameters beside the outline and the supports.
    pub fn common(&self) -> Common<T> {
        Common {
            mass: self.mass,
            gamma: self.gamma,
            epsilon: self.epsilon,
            gravity: self.gravity,
            eccentricity: self.eccentricity,
            friction: self.friction,
        }
    }

    /// Its supports in the paper's ratios, or the rigid base.
    pub fn ratios(&self) -> Supports<Ratios<T>, T> {
        self.supports(|block| Ratios { eta: block.eta(), xi_v: block.xi_v })
    }

    /// Its supports in SI units, or the rigid base.
    pub fn springs(&self) -> Supports<Springs<T>, T> {
        self.supports(|block| Springs { stiffness: block.stiffness, damping: block.damping })
    }

    fn supports<V>(&self, of: impl FnOnce(&Block<T>) -> V) -> Supports<V, T> {
        match self.foundation {
            Foundation::Viscoelastic => Supports::Viscoelastic(of(self)),
            Foundation::Rigid => Supports::Rigid { restitution_factor: self.restitution_factor },
        }
    }

    /// Stiffness ratio η = ω_v/p (1); 0 on a rigid base.
    pub fn eta(&self) -> T {
        self.omega_v / self.p
    }

    /// Slenderness angle of a corner (rad), at which the centre of mass is over it. It is `arctan((b ± e_x)/h)` with + on L.
    pub fn alpha_of(&self, corner: Corner) -> T {
        if self.eccentricity.is_zero() { self.alpha } else { (self.offset(corner) * corner.sign()).atan2(self.h) }
    }

    /// Restitution e of the rotation at a landing on `corner` (1).
    ///
    /// On the rigid base the ratio of θ̇ after to before, Housner's e times the factor; on supports Housner's e equivalent to ε.
    pub fn restitution_of(&self, corner: Corner) -> T {
        match self.foundation {
            Foundation::Rigid => self.housner_restitution(corner) * self.restitution_factor,
            Foundation::Viscoelastic => self.housner_restitution(corner),
        }
    }

    /// The smaller [`Block::restitution_of`] of both corners (1).
    pub fn restitution(&self) -> T {
        let [left, right] = Corner::each(|corner| self.restitution_of(corner));
        T::select_less(right.value(), left.value(), right, left)
    }

    /// Housner's restitution e equivalent to ε at a landing on `corner` (1), eq. (6).
    ///
    /// `e = [1 + γ ε + (1 − ε) γ cos 2α]/(1 + γ)` without eccentricity.
    ///
    /// For an eccentric centre of mass it follows from the conservation of angular momentum about that corner.
    pub fn housner_restitution(&self, corner: Corner) -> T {
        let Block { gamma, epsilon, body: Body { eccentricity, b, r0, .. }, .. } = *self;
        let cos = (self.alpha * 2.0).cos();
        let square = eccentricity * eccentricity;
        let cross = b * eccentricity * (2.0 * corner.sign());
        let uneven = gamma / (r0 * r0);
        let momentum = gamma * epsilon + 1.0 + (-epsilon + 1.0) * gamma * cos + (epsilon * cross + square) * uneven;
        momentum / (gamma + 1.0 + (cross + square) * uneven)
    }

    /// Least coefficient of friction that may jam a sliding corner (1), on a rigid base.
    ///
    /// `2 √(k (k + 1))` with k = I0/(M R²) and the distance R of the centre of mass from the farther corner.
    pub fn jamming_friction(&self) -> T {
        let across = self.b + T::select_less(self.eccentricity.value(), 0.0, -self.eccentricity, self.eccentricity);
        let k = self.i0 / (across * across + self.h * self.h);
        (k * (k + 1.0)).sqrt() * 2.0
    }

    /// Greatest e without a jump after the impact, at ε = 0 (1), eq. (2): `(1 + γ cos 2α)/(1 + γ)`.
    pub fn max_restitution(&self) -> T {
        (self.gamma * (self.alpha * 2.0).cos() + 1.0) / (self.gamma + 1.0)
    }

    /// Rotation at which one corner lifts quasi-statically (rad), eq. (29): `sin θ = δ_s/b`. It is π/2 if the supports are too soft for a
    /// lift-off.
    pub fn separation_angle(&self) -> T {
        let sin = self.static_deflection() / self.b;
        if sin.value() < 1.0 { sin.asin() } else { T::from(std::f64::consts::FRAC_PI_2) }
    }
}
