//! Options of a single run → the run.

use clap::Args;

use crate::options::checks::{check, check_tolerance, checked};
use rocking_block::block::Block;
use rocking_block::excitation::Pulse;
use rocking_block::excitation::records::Ground;
use rocking_block::simulation::{Initial, OnSeparation, Settings};
use rocking_studies::run::Run;

/// Tolerance, duration and rows of a single run.
#[derive(Args)]
#[command(next_help_heading = "Run")]
pub struct SingleRunOptions {
    /// Relative tolerance of the integration
    #[arg(long, default_value_t = 1e-8, value_name = "TOL")]
    tolerance: f64,
    /// Duration; by default the run lasts until the ground has come to rest and the block has come down [s]
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    /// Time between rows of the table; by default the record's time step, or 0.01 [s]
    #[arg(long, value_name = "S")]
    step: Option<f64>,
}

impl SingleRunOptions {
    /// Returns the run of a block from an initial state, whose rows fit into memory.
    pub fn run(
        &self,
        block: Block,
        on_separation: OnSeparation,
        initial: Initial,
        pulse: Pulse,
        ground: Ground,
    ) -> anyhow::Result<Run> {
        let SingleRunOptions { tolerance, duration, step } = *self;
        check("theta", initial.theta, |x| x.abs() < 1.57, "a rotation within ±1.57 rad")?;
        check_tolerance(tolerance)?;
        let output_step = step.or(ground.time_step()).unwrap_or(0.01);
        check("step", output_step, |x| x > 0.0, "a time > 0 s")?;
        checked("duration", duration, |x| x > 0.0, "a time > 0 s")?;
        let settings = Settings { tolerance, on_separation, ..Settings::default() };
        let run = Run { block, settings, initial, pulse, ground, duration, output_step };
        run.check_memory(0)?;
        Ok(run)
    }
}
