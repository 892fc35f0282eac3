//! The foundation: a rigid base, or a support under each corner, which creeps back to its free height once its corner has left it.

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

/// The recovery of a support that its corner has left: it creeps back to its free height δ_s.
///
/// `C ẏ = K (δ_s − y)`: `δ_s − y = depth · exp(−(t − since) K/C)`. A support without damping is back at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Creep<T = f64> {
    /// δ_s − y₀ (m) at lift-off.
    pub depth: T,
    /// Time of lift-off (s).
    pub since: T,
}

impl<T: Elementary> Creep<T> {
    /// Height of the support's top above its place under the block at rest (m), and its rate (m/s).
    pub fn top(&self, corner: Corner, block: &Block<T>, time: T) -> Sample<T> {
        match block.foundation {
            Foundation::Rigid => Sample::default(),
            Foundation::Viscoelastic => {
                let rate = block.creep_rate();
                // Without damping it is back at once.
                if self.depth.is_zero() || rate.value().is_infinite() {
                    return Sample { value: block.free_height(corner), rate: T::from(0.0) };
                }
                // A clock that is set back by its rounding may show a time before lift-off.
                let elapsed = time - self.since;
                let elapsed = T::select_less(0.0, elapsed.value(), elapsed, T::from(0.0));
                let sunk = self.depth * (-(rate * elapsed)).exp();
                Sample { value: block.free_height(corner) - sunk, rate: rate * sunk }
            }
        }
    }
}
