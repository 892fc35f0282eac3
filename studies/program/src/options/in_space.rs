//! Options of a block in space → the block; in the plane they are refused.

use std::path::Path;

use rocking_block::space::{SpaceBody, SpaceParameters};
use rocking_studies::doubts;
use rocking_studies::spec::space::{MAKES_SPACE, feet_of_table};
use rocking_studies::spec::{BlockSpec, SpaceSpec, option};

use crate::options::block::in_options;
use crate::options::explicit::ExplicitOptions;
use crate::options::input;
use crate::options::run::warn;

/// Options of a block in space that do not make one.
const OF_BLOCK: [&str; 5] = ["eccentricity-y", "inertia-tensor", "omega-v", "kappa", "xi-h"];

/// Returns whether the block is one in space. Otherwise options without effect are refused, those of the block and `others` of a command.
pub fn makes_space(space: &SpaceSpec, explicit: &ExplicitOptions, others: &[&str]) -> anyhow::Result<bool> {
    let makes = MAKES_SPACE.map(|name| format!("--{}", option(name))).join(", ");
    let why = format!("without one of {makes}, which make a block in space");
    explicit.refuse_unless(space.is_given(), &[&OF_BLOCK, others].concat(), &why)?;
    Ok(space.is_given())
}

/// Refuses options of a block in the plane, each with what is expected instead.
pub fn refuse_of_plane(explicit: &ExplicitOptions, options: &[(&str, &str)]) -> anyhow::Result<()> {
    match options.iter().find(|(option, _)| explicit.has(option)) {
        Some((option, instead)) => anyhow::bail!("--{option} is for a block in the plane; {instead}"),
        None => Ok(()),
    }
}

/// Returns the block, and warns of parameters beyond reason.
pub fn block(space: &SpaceSpec, shared: &BlockSpec) -> anyhow::Result<(SpaceParameters, SpaceBody)> {
    let read_feet = |path: &Path| {
        let (name, text) = input::text(path).map_err(|error| format!("{error:#}"))?;
        feet_of_table(&name, &text)
    };
    let parameters = space.parameters(shared, read_feet).map_err(in_options)?;
    let body = SpaceBody::new(&parameters)?;
    warn(doubts::of_blocks_in_space([(parameters.clone(), body.clone(), shared.mass.is_some())]));
    Ok((parameters, body))
}
