//! The unit under test: the planar block.

/// The FMU.
pub const PATH: &str = env!("ROCKING_BLOCK_FMI3");

/// Its binary.
pub const BINARY: &str = "binaries/x86_64-linux/rocking_block.so";

/// Returns the name of a variable of the planar unit here.
pub fn name(planar: &str) -> &str {
    planar
}
