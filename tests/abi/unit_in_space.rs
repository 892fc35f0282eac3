//! The unit under test: the block in space.

/// The FMU.
pub const PATH: &str = env!("ROCKING_BLOCK_IN_SPACE_FMU");

/// The name of its library.
pub const IDENTIFIER: &str = "rocking_block_in_space";

#[path = "../common/in_space.rs"]
mod names;
pub use names::name;

/// The numbers of continuous states and event indicators.
pub const STATE_COUNT: usize = 28;
pub const INDICATOR_COUNT: usize = 9;

/// States that no solver reaches: the block turns too fast for numbers.
pub const IMPOSSIBLE: [f64; STATE_COUNT] = {
    let mut states = [0.0; STATE_COUNT];
    states[3] = 1.0;
    states[10] = 1e200;
    states[11] = 1e200;
    states
};
