//! The vertical Kelvin–Voigt support under each corner: it pushes but never pulls.
//!
//! A support with the fraction `n` of the weight at rest, ½ without eccentricity, gives `N/M = n g − ω_v² v_I/2 − ξ_v ω_v v̇_I`, eq. (8).

use crate::block::{Body, Corner, Foundation, Regime};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary, Scalar};

/// Returns the reaction N_I/M (m/s²) on a touching corner. `height` is above the position at rest (m), with its rate (m/s).
#[inline(always)]
pub fn reaction<P: Scalar, T: CombinesWith<P>>(body: &Body<P>, corner: Corner, height: T, rate: T) -> T {
    let Body { gravity, omega_v, xi_v, .. } = *body;
    -(height * (omega_v * 0.5 * omega_v)) - rate * (xi_v * omega_v) + gravity * body.weight_fraction[corner.index()]
}

/// Returns the rate of the reaction (m/s³), from the corner's rate (m/s) and acceleration (m/s²).
#[inline(always)]
pub fn reaction_rate<R: Scalar>(body: &Body<R>, rate: R, acceleration: R) -> R
where
    Dual<R>: CombinesWith<R>,
{
    // The static load has no rate, so either corner will do.
    reaction(body, Corner::Left, Dual::new(R::default(), rate), Dual::new(R::default(), acceleration)).eps
}

/// Returns the power per mass dissipated by the dashpots (m²/s³). It is `ξ_v ω_v Σ v̇_I²` over the touching corners.
#[inline(always)]
pub fn power<P: Scalar, T: CombinesWith<P>>(body: &Body<P>, regime: Regime, [left, right]: [T; 2]) -> T {
    let squares = match regime {
        Regime::FullContact => left * left + right * right,
        Regime::TiltingLeft => left * left,
        Regime::TiltingRight => right * right,
        Regime::Separated => T::from(0.0),
    };
    squares * (body.xi_v * body.omega_v)
}

/// Returns the energy of the springs per mass (m²/s²), less that at rest. Zero on a rigid base.
///
/// It is `½ K/M (δ_I − v_I)² − ½ K/M δ_I²` for a touching corner, and the second term alone for a lifted one.
pub fn energy<P: Elementary, T: CombinesWith<P>>(body: &Body<P>, regime: Regime, height: [T; 2]) -> T {
    let Body { gravity, omega_v, .. } = *body;
    let energy = |corner: Corner| {
        if regime.touches(corner) {
            let v = height[corner.index()];
            v * v * (omega_v * omega_v * 0.25) - v * (gravity * body.weight_fraction[corner.index()])
        } else {
            T::from(-(gravity * body.weight_fraction[corner.index()] * 0.5 * body.free_height(corner)))
        }
    };
    match body.foundation {
        Foundation::Rigid => T::from(0.0),
        Foundation::Viscoelastic => energy(Corner::Left) + energy(Corner::Right),
    }
}
