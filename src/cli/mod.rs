//! The command line of the `rocking` program.

mod excitation;
mod figures;
mod output;
mod progress;
mod run_options;
mod search;
mod simulate;
mod spectrum;
mod sweep;

use clap::{Parser, Subcommand};

/// A rigid block rocking on viscoelastic supports under earthquakes and pulses.
///
/// Without a command, an embedded record makes a block rock: see `rocking simulate --help`.
#[derive(Parser)]
#[command(name = "rocking", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Runs one block under a pulse or an accelerogram; writes a table and a picture
    Simulate(Box<simulate::Options>),
    /// Peak rotations of blocks of all sizes on several foundations; writes a table and a picture
    Spectrum(Box<spectrum::Options>),
    /// Any parameters over grids or samples, many records, several scale factors: a table for fragility curves
    Sweep(sweep::Options),
    /// Where the outcome changes: least damping against separation, minimum overturning amplitude
    Search(search::Options),
    /// The figures of Palmeri and Makris (2008), computed anew: pictures with their tables
    Figures(figures::Options),
}

/// Reads the command line and does what it says. The error is to be told on one line.
pub fn run() -> anyhow::Result<()> {
    match Arguments::parse().command {
        Some(Command::Simulate(options)) => simulate::run(&options),
        Some(Command::Spectrum(options)) => spectrum::run(&options),
        Some(Command::Sweep(options)) => sweep::run(&options),
        Some(Command::Search(options)) => search::run(&options),
        Some(Command::Figures(options)) => figures::run(&options),
        None => simulate::run(&simulate::Options::parse_from(["rocking"])),
    }
}
