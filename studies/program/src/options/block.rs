//! A specification of a block → the block. Errors name the program's options.

use rocking_block::block::Block;
use rocking_studies::doubts;
use rocking_studies::spec::{BlockSpec, SpecError, option};

use crate::options::run::warn;

/// Returns the block, and warns of parameters beyond reason.
pub fn block(spec: &BlockSpec) -> anyhow::Result<Block> {
    let block = spec.block().map_err(in_options)?;
    warn(doubts::of_blocks([block]));
    Ok(block)
}

/// Returns the error with the names of options.
pub fn in_options(error: SpecError) -> anyhow::Error {
    anyhow::Error::msg(error.spelled(|name| format!("--{}", option(name))))
}
