//! The command line of the `rocking` program.

mod accelerograms;
mod excitation;
mod figures;
mod formats;
mod fragility;
mod fragility_report;
mod given;
mod input;
mod output;
mod progress;
mod record;
mod report;
mod run_options;
mod search;
mod shell;
mod simulate;
mod spectrum;
mod summary;
mod sweep;

use std::any::TypeId;
use std::io;

use clap::error::ErrorKind;
use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::study::resumable::TableError;
use given::Given;

/// A rigid block rocking on viscoelastic supports under earthquakes and pulses.
///
/// Without a command, an example runs: a slender block of the size of a statue under an embedded record.
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
    /// Any parameters over grids or samples, many records, several strengths: a table for fragility curves
    Sweep(sweep::Options),
    /// Fragility curves of the table of a sweep: medians, dispersions, how well each measure tells, a picture
    Fragility(Box<fragility::Options>),
    /// Where the outcome changes: least damping against separation, minimum overturning amplitude
    Search(Box<search::Options>),
    /// What accelerograms hold, in words or as a table of times and accelerations
    Record(Box<record::Options>),
    /// The figures of Palmeri and Makris (2008), computed anew: pictures with their tables
    Figures(figures::Options),
    /// Prints a script that lets a shell complete the commands and options
    Completions(shell::Completions),
    /// Prints the manual page, or writes one for each command
    Man(shell::Man),
}

/// What runs without a command.
const EXAMPLE: [&str; 8] = ["rocking", "simulate", "--alpha", "0.15", "--p", "2", "--xi-v", "0.2"];

/// All commands. Choices are read in any case. What follows an option of numbers is its value, `-1e-3` too, and not another option; elsewhere a negative
/// number is one.
fn command() -> clap::Command {
    fn is_number(arg: &clap::Arg) -> bool {
        let found = arg.get_value_parser().type_id();
        [TypeId::of::<f64>(), TypeId::of::<u64>(), TypeId::of::<usize>(), TypeId::of::<u16>(), TypeId::of::<u8>()]
            .iter()
            .any(|number| found == *number)
    }
    fn with_negative_numbers(command: clap::Command) -> clap::Command {
        command
            .mut_args(|arg| {
                match arg.get_value_parser().possible_values().is_some() && arg.get_action().takes_values() {
                    true => arg.ignore_case(true),
                    false => arg,
                }
            })
            .mut_args(|arg| match arg.get_action().takes_values() {
                true if is_number(&arg) => arg.allow_hyphen_values(true),
                true => arg.allow_negative_numbers(true),
                false => arg,
            })
            .mut_subcommands(with_negative_numbers)
    }
    with_negative_numbers(Arguments::command())
}

/// What the signal sets; nobody reads it, since the write says the same.
#[cfg(unix)]
static BEYOND_LIMIT: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);

/// Reads the command line and does what it says. The error is to be printed on one line.
///
/// # Errors
/// What was found wrong, where, and what was expected.
pub fn run() -> anyhow::Result<()> {
    // A write beyond the limit of the file size is to fail; the signal would end the program.
    #[cfg(unix)]
    signal_hook::flag::register(signal_hook::consts::SIGXFSZ, &BEYOND_LIMIT)?;
    match command().try_get_matches() {
        Ok(matches) => run_with(&matches),
        // Help and version are printed as they are.
        Err(error) if !error.use_stderr() => error.exit(),
        Err(error) if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => error.exit(),
        Err(error) => {
            eprintln!("rocking: {}", one_line(&error));
            std::process::exit(error.exit_code())
        }
    }
}

/// A refusal of the command line in one line: what was found, and the values or options that were expected.
fn one_line(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let text = text.split("\n\nUsage:").next().unwrap_or_default();
    let text = text.split("\n\nFor more information").next().unwrap_or_default();
    let text = text.strip_prefix("error: ").unwrap_or(text).replace("\n\n  tip: ", "; ");
    let text = text.replace("invalid float literal", "expected a number");
    let text = text.replace("invalid digit found in string", "expected a whole number");
    text.split_whitespace().collect::<Vec<_>>().join(" ") + "; --help has all options"
}

fn run_with(matches: &ArgMatches) -> anyhow::Result<()> {
    let given = Given::of(matches);
    match Arguments::from_arg_matches(matches)?.command {
        Some(Command::Simulate(options)) => simulate::run(&options, &given),
        Some(Command::Spectrum(options)) => spectrum::run(&options, &given),
        Some(Command::Sweep(options)) => sweep::run(&options),
        Some(Command::Fragility(options)) => fragility::run(&options, &given),
        Some(Command::Search(options)) => search::run(&options, &given),
        Some(Command::Record(options)) => record::run(&options),
        Some(Command::Figures(options)) => figures::run(&options),
        Some(Command::Completions(options)) => shell::completions(&options, command()),
        Some(Command::Man(options)) => shell::man(&options, command()),
        None => run_with(&command().get_matches_from(EXAMPLE)),
    }
}

/// Whether an error only says that nobody reads the table any more, as in `rocking sweep study.toml --csv - | head`.
pub fn is_closed_pipe(error: &anyhow::Error) -> bool {
    matches!(
        error.downcast_ref(),
        Some(TableError::Io { error, .. }) if error.kind() == io::ErrorKind::BrokenPipe
    )
}
