//! The unit under test: the planar block.

/// The FMU.
pub const PATH: &str = env!("ROCKING_BLOCK_FMU");

/// The name of its library.
pub const IDENTIFIER: &str = "rocking_block";

/// Returns the name of a variable of the planar unit here.
pub fn name(planar: &str) -> &str {
    planar
}
