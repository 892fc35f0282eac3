//! The unit under test: the planar block.

/// The FMU.
pub const PATH: &str = env!("ROCKING_BLOCK_FMU");

/// The name of its library.
pub const IDENTIFIER: &str = "rocking_block";

/// Returns the name of a variable of the planar unit here.
pub fn name(planar: &str) -> &str {
    planar
}

/// The numbers of continuous states and event indicators.
pub const STATE_COUNT: usize = 11;
pub const INDICATOR_COUNT: usize = 22;

/// States that no solver reaches: no regime persists in them.
pub const IMPOSSIBLE: [f64; STATE_COUNT] = [0.1, -1e155, 0.0, 1e200, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
