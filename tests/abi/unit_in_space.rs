//! The unit under test: the block in space.

/// The FMU.
pub const PATH: &str = env!("ROCKING_BLOCK_IN_SPACE_FMU");

/// The name of its library.
pub const IDENTIFIER: &str = "rocking_block_in_space";

#[path = "../common/in_space.rs"]
mod names;
pub use names::name;
