//! The foundation: a rigid base, or a support under each corner, and the recovery of a support after lift-off.

use serde::{Deserialize, Serialize};

use crate::block::{Block, Corner};
use crate::numerics::roots::Sample;
use crate::numerics::scalar::Elementary;

/// The ground under the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(i32)]
pub enum Foundation {
    /// A vertical Kelvin–Voigt support under each corner (Palmeri & Makris 2008).
    Viscoelastic = 1,
    /// A rigid base: Housner's block.
    Rigid = 2,
}

/// Recovery of a support after its corner has left it, by creep to the free height δ_s.
///
/// `C ẏ = K (δ_s − y)`: `δ_s − y = depth · exp(−(t − since) K/C)`. A support without damping recovers at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Creep<T = f64> {
    /// δ_s − y₀ (m) at lift-off.
    pub depth: T,
    /// Time of lift-off (s).
    pub since: T,
}

/// The time after lift-off, times the rate of the creep, from which a support stands at its free height: e⁻⁵⁰ is far below round-off.
pub(crate) const RECOVERED: f64 = 50.0;

impl<T: Elementary> Creep<T> {
    /// Returns the height of the support's top above its position at rest (m), and its rate (m/s).
    pub fn top(&self, corner: Corner, block: &Block<T>, time: T) -> Sample<T> {
        match block.foundation {
            Foundation::Rigid => Sample::default(),
            Foundation::Viscoelastic => {
                let rate = block.creep_rate();
                // Rounding of the clock may give a time before lift-off.
                let elapsed = time - self.since;
                let elapsed = T::select_less(0.0, elapsed.value(), elapsed, T::from(0.0));
                let exponent = rate * elapsed;
                // Without damping it recovers at once.
                if self.depth.is_zero() || rate.value().is_infinite() || exponent.value() > RECOVERED {
                    return Sample { value: block.free_height(corner), rate: T::from(0.0) };
                }
                let sunk = self.depth * (-exponent).exp();
                Sample { value: block.free_height(corner) - sunk, rate: rate * sunk }
            }
        }
    }
}

impl Block {
    /// Returns a warning if the supports of a block without restraints are too soft to keep it upright: 2 K b² ≤ M g h.
    pub fn soft_supports(&self) -> Option<String> {
        let Block { mass, gravity, b, h, stiffness, .. } = *self;
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
