//! The foundation: a rigid base, or a support under each corner, with their parameters, and the recovery of a support after lift-off.

use serde::{Deserialize, Serialize};

use crate::block::{Block, Body, Corner};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{Elementary, Scalar};

/// The ground under the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(i32)]
pub enum Foundation {
    /// A vertical Kelvin–Voigt support under each corner (Palmeri & Makris 2008).
    Viscoelastic = 1,
    /// A rigid base: Housner's block.
    Rigid = 2,
}

/// The foundation with its parameters: supports `V`, as [`Ratios`], [`Springs`] or either, or a rigid base.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Supports<V, T = f64> {
    /// A vertical Kelvin–Voigt support under each corner.
    Viscoelastic(V),
    /// A rigid base.
    Rigid {
        /// Ratio of the actual restitution e to Housner's e of ε (1), at least 0.
        restitution_factor: T,
    },
}

/// Both supports in the paper's ratios.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ratios<T = f64> {
    /// Stiffness ratio η = ω_v/p (1).
    pub eta: T,
    /// Vertical damping ratio ξ_v (1).
    pub xi_v: T,
}

/// One support.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Springs<T = f64> {
    /// Stiffness K (N/m).
    pub stiffness: T,
    /// Damping C (N.s/m).
    pub damping: T,
}

/// Both supports, in one of two parameterizations. The other one follows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum KelvinVoigt<T = f64> {
    /// In the paper's ratios.
    Ratios(Ratios<T>),
    /// In SI units.
    Springs(Springs<T>),
}

impl<T> KelvinVoigt<T> {
    /// Returns the same kind of parameters with `of` each number.
    pub fn map<U>(self, of: impl Fn(T) -> U) -> KelvinVoigt<U> {
        match self {
            KelvinVoigt::Ratios(Ratios { eta, xi_v }) => KelvinVoigt::Ratios(Ratios { eta: of(eta), xi_v: of(xi_v) }),
            KelvinVoigt::Springs(Springs { stiffness, damping }) => {
                KelvinVoigt::Springs(Springs { stiffness: of(stiffness), damping: of(damping) })
            }
        }
    }
}

impl<T: Scalar> Springs<T> {
    /// Returns the rate K/C at which a lifted support creeps to its free height (1/s). Infinite without damping.
    pub fn creep_rate(&self) -> T {
        self.stiffness / self.damping
    }
}

impl<V> Supports<V> {
    /// Housner's rigid base.
    pub const HOUSNER: Supports<V> = Supports::Rigid { restitution_factor: 1.0 };

    /// These supports, or Housner's rigid base in their place.
    pub fn of(foundation: Foundation, supports: V) -> Supports<V> {
        match foundation {
            Foundation::Viscoelastic => Supports::Viscoelastic(supports),
            Foundation::Rigid => Supports::HOUSNER,
        }
    }
}

impl<V, T> Supports<V, T> {
    /// Supports or rigid base.
    pub fn foundation(&self) -> Foundation {
        match self {
            Supports::Viscoelastic(_) => Foundation::Viscoelastic,
            Supports::Rigid { .. } => Foundation::Rigid,
        }
    }

    /// The parameters of the supports, if there are any.
    pub fn viscoelastic(self) -> Option<V> {
        match self {
            Supports::Viscoelastic(supports) => Some(supports),
            Supports::Rigid { .. } => None,
        }
    }

    /// The factor on Housner's restitution, on a rigid base.
    pub fn restitution_factor(self) -> Option<T> {
        match self {
            Supports::Viscoelastic(_) => None,
            Supports::Rigid { restitution_factor } => Some(restitution_factor),
        }
    }

    /// Converts the parameters of the supports by `of_supports`, and a rigid base's factor by `of_factor`.
    pub fn map<W, U>(self, of_supports: impl FnOnce(V) -> W, of_factor: impl FnOnce(T) -> U) -> Supports<W, U> {
        match self {
            Supports::Viscoelastic(supports) => Supports::Viscoelastic(of_supports(supports)),
            Supports::Rigid { restitution_factor } => {
                Supports::Rigid { restitution_factor: of_factor(restitution_factor) }
            }
        }
    }

    /// Converts the parameters of the supports, and leaves a rigid base as it is.
    pub fn with<W>(self, of: impl FnOnce(V) -> W) -> Supports<W, T> {
        self.map(of, |factor| factor)
    }
}

/// Recovery of a support after its corner left, by creep to its free height δ_s.
///
/// `C ẏ = K (δ_s − y)`: `δ_s − y = depth · exp(−(t − since) K/C)`. A support without damping recovers at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Creep<T = f64> {
    /// δ_s − y₀ (m) at lift-off.
    pub depth: T,
    /// Time of lift-off (s).
    pub since: T,
}

/// Time after lift-off, times the creep rate, that ends the creep. The remaining e⁻⁵⁰ is far below round-off.
pub(crate) const RECOVERED: f64 = 50.0;

impl<T: Elementary> Creep<T> {
    /// Returns the depth of the support's top below its free height (m), or `None` once it has recovered. `rate` is K/C (1/s).
    #[inline(always)]
    pub fn sunk(&self, rate: T, time: T) -> Option<T> {
        // Rounding of the clock may give a time before lift-off.
        let elapsed = time - self.since;
        let elapsed = T::select_less(0.0, elapsed.value(), elapsed, T::from(0.0));
        let exponent = rate * elapsed;
        // Without damping it recovers at once.
        let recovered = self.depth.is_zero() || rate.value().is_infinite() || exponent.value() > RECOVERED;
        (!recovered).then(|| self.depth * (-exponent).exp())
    }

    /// Returns the height of the support's top above rest (m), and its rate (m/s).
    pub fn top(&self, corner: Corner, body: &Body<T>, time: T) -> Dual<T> {
        match body.foundation {
            Foundation::Rigid => Dual::default(),
            Foundation::Viscoelastic => {
                let (rate, free) = (body.creep_rate, body.free_height(corner));
                match self.sunk(rate, time) {
                    Some(sunk) => Dual::new(free - sunk, rate * sunk),
                    None => Dual::new(free, T::from(0.0)),
                }
            }
        }
    }
}

impl Block {
    /// Returns a warning if supports are too soft to keep a block without restraints upright. They are if 2 K b² ≤ M g h.
    pub fn soft_supports(&self) -> Option<String> {
        let Block { stiffness, body: Body { mass, gravity, b, h, .. }, .. } = *self;
        let (eta, least) = (self.eta(), mass * gravity * h / (2.0 * b * b));
        let is_soft = self.foundation == Foundation::Viscoelastic && self.restraints.is_empty() && stiffness <= least;
        is_soft.then(|| {
            let least_eta = eta * (least / stiffness).sqrt();
            format!(
                "the block falls over by itself on supports of eta = {eta:.4}, K = {stiffness:.4e} N/m; expected eta > \
                 {least_eta:.4}, K > {least:.4e} N/m"
            )
        })
    }
}
