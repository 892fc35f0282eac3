//! Settings of a single run → the run.

use crate::options::block::in_options;
use crate::options::checks::check;
use rocking_block::block::Block;
use rocking_block::excitation::Pulse;
use rocking_block::excitation::records::Ground;
use rocking_block::simulation::{Initial, OnSeparation};
use rocking_studies::run::Run;
use rocking_studies::spec::SingleRunSpec;

/// Returns the run of a block from an initial state, whose rows fit into memory.
pub fn run(
    spec: &SingleRunSpec,
    block: Block,
    on_separation: OnSeparation,
    initial: Initial,
    pulse: Pulse,
    ground: Ground,
) -> anyhow::Result<Run> {
    check("theta", initial.theta, |x| x.abs() < 1.57, "a rotation within ±1.57 rad")?;
    let settings = spec.settings(on_separation).map_err(in_options)?;
    let (duration, output_step) = (spec.duration, spec.output_step(&ground));
    let run = Run { block, settings, initial, pulse, ground, duration, output_step };
    run.check_memory(0)?;
    Ok(run)
}
