//! Parameters of a block → their symbols in labels.

use rocking_block::block::Ratios;

/// Describes supports and the restitution of a corner, with numbers as `short` writes them.
pub fn supports(Ratios { eta, xi_v }: Ratios, epsilon: f64, short: impl Fn(f64) -> String) -> String {
    format!("η = {}, ξ_v = {}, ε = {}", short(eta), short(xi_v), short(epsilon))
}
