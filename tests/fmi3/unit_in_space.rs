//! The unit under test: the block in space.

/// The FMU.
pub const PATH: &str = env!("ROCKING_BLOCK_IN_SPACE_FMI3");

/// Its binary.
pub const BINARY: &str = "binaries/x86_64-linux/rocking_block_in_space.so";

#[path = "../common/in_space.rs"]
mod names;
pub use names::name;
