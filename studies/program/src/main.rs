//! The `rocking` program: command line → tables, pictures and summaries.
//!
//! | folder | in → out |
//! | --- | --- |
//! | [`options`] | command line, files → blocks, records, settings |
//! | [`output`] | results → files, pictures, summaries |
//! | [`commands`] | one module a command: options → results |

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]
#![expect(rustdoc::broken_intra_doc_links, reason = "help texts give units in brackets")]

mod options;

mod output;

mod commands;

use std::any::TypeId;
use std::io;
use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};

use commands::{
    assess, cloud, fit, foundations, fragility, frame, ida, merge, parts, portfolio, pulse, pushover, rate, record,
    schema, search, shell, simulate, sketch, spectrum, stripes, sweep,
};
use options::explicit::ExplicitOptions;
use rocking_studies::output::resumable::TableWriteError;
use rocking_studies::output::runner;

/// Simulate rigid blocks that rock under earthquakes and pulses.
///
/// Without a command, run an example: the default block, a stone 1.9 m high, under an embedded record.
#[derive(Parser)]
#[command(name = "rocking", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Simulate one block: a table, a picture and a summary
    Simulate(Box<simulate::SimulateCommand>),
    /// Draw a block with its foundation and dimensions
    Sketch(Box<sketch::SketchCommand>),
    /// Turn a block slowly: its lateral force over the rotation, and the damping of a cycle
    Pushover(Box<pushover::PushoverCommand>),
    /// Simulate equal columns under a freely supported beam, with the forces of the columns
    Frame(Box<frame::FrameCommand>),
    /// Compute peak rotations of blocks of all sizes on several foundations
    Spectrum(Box<spectrum::SpectrumCommand>),
    /// Vary any parameters, records and their strengths: a table of runs for fragility curves
    Sweep(sweep::SweepCommand),
    /// Count the parts of a study in a folder, and name those that are missing or damaged
    Parts(parts::PartsCommand),
    /// Merge the parts of a study to the table of one run
    Merge(merge::MergeCommand),
    /// Incremental dynamic analysis: a table of runs at given or hunted levels, fractiles and a picture
    Ida(Box<ida::IdaCommand>),
    /// Multiple-stripe analysis: a fragility curve and the fractions at levels of an intensity measure
    Stripes(Box<stripes::StripesCommand>),
    /// Cloud analysis: a line through rotations over an intensity measure, and the probability of overturning
    Cloud(Box<cloud::CloudCommand>),
    /// Fit fragility curves to the table of a sweep and compare intensity measures
    Fragility(Box<fragility::FragilityCommand>),
    /// Compute the annual rate of overturning from a hazard curve and a fragility curve
    Rate(Box<rate::RateCommand>),
    /// Find the values at which a block begins to overturn or to leave the ground
    Search(Box<search::SearchCommand>),
    /// Fit the parameters of a block to measured tests, with intervals
    Fit(Box<fit::FitCommand>),
    /// Assess one object: a page with its fragility, annual rates, variants and sensitivity
    Assess(Box<assess::AssessCommand>),
    /// Assess several objects of one site and rank them by annual rate: a page, with a page for each
    Portfolio(portfolio::PortfolioCommand),
    /// Show the contents and intensity measures of accelerograms, or convert one to a table
    Record(Box<record::RecordCommand>),
    /// Fit a pulse to the velocity of an accelerogram
    Pulse(Box<pulse::PulseCommand>),
    /// List friction and restitution of pairs of surfaces, or compute supports of rubber or soil
    Foundations(Box<foundations::FoundationsCommand>),
    /// Print the JSON Schema of study files, with which editors complete and check them
    Schema(schema::SchemaCommand),
    /// Print a script that completes commands and options in a shell
    Completions(shell::Completions),
    /// Print the manual page, or write one for each command
    Man(shell::Man),
}

/// Command line of the example.
const EXAMPLE: [&str; 2] = ["rocking", "simulate"];

/// Builds the command line.
///
/// Choices are read in any case. The argument after an option that takes a number is its value, even `-1e-3`; elsewhere a
/// negative number is a value, not an option.
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

/// Flag of the signal SIGXFSZ, never read: the failed write reports the error.
#[cfg(unix)]
static BEYOND_LIMIT: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);

/// Reads the command line and runs the command.
///
/// # Errors
/// One line: the fault, its location and the expected value.
fn run() -> anyhow::Result<()> {
    // By default the signal of a write beyond the limit of the file size would end the program; this way the write fails.
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

/// Condenses an error of the command line to one line. It has the fault, and the expected values or options.
fn one_line(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let text = text.split("\n\nUsage:").next().unwrap_or_default();
    let text = text.split("\n\nFor more information").next().unwrap_or_default();
    let text = text.strip_prefix("error: ").unwrap_or(text).replace("\n\n  tip: ", "; ");
    let text = text.replace("invalid float literal", "expected a number");
    let text = text.replace("invalid digit found in string", "expected a whole number");
    let text = text + &commands_with(error).map(|commands| format!("; {commands} it")).unwrap_or_default();
    text.split_whitespace().collect::<Vec<_>>().join(" ") + "; --help lists all options"
}

/// Names the commands that have the option that another one has not.
fn commands_with(error: &clap::Error) -> Option<String> {
    /// Commands that are named.
    const MAX: usize = 4;
    fn find(command: &clap::Command, path: &str, option: &str, found: &mut Vec<String>) {
        let has = |arg: &clap::Arg| arg.get_long() == Some(option) && !arg.is_hide_set();
        if command.get_arguments().any(has) {
            found.push(format!("`{path}`"));
        }
        for sub in command.get_subcommands() {
            find(sub, &format!("{path} {}", sub.get_name()), option, found);
        }
    }
    let Some(ContextValue::String(option)) = error.get(ContextKind::InvalidArg) else { return None };
    let is_unknown = error.kind() == ErrorKind::UnknownArgument;
    let option = option.strip_prefix("--").filter(|_| is_unknown)?;
    let mut found = Vec::new();
    find(&command(), "rocking", option, &mut found);
    if found.len() > MAX {
        found.truncate(MAX);
        found.push("others".into());
    }
    match found.as_slice() {
        [] => None,
        [one] => Some(format!("{one} has")),
        [first @ .., last] => Some(format!("{} and {last} have", first.join(", "))),
    }
}

fn run_with(matches: &ArgMatches) -> anyhow::Result<()> {
    let explicit = ExplicitOptions::of(matches);
    match Arguments::from_arg_matches(matches)?.command {
        Some(Command::Simulate(options)) => simulate::run(&options, &explicit),
        Some(Command::Sketch(options)) => sketch::run(&options, &explicit),
        Some(Command::Pushover(options)) => pushover::run(&options, &explicit),
        Some(Command::Frame(options)) => frame::run(&options, &explicit),
        Some(Command::Spectrum(options)) => spectrum::run(&options, &explicit),
        Some(Command::Sweep(options)) => sweep::run(&options),
        Some(Command::Parts(options)) => parts::run(&options),
        Some(Command::Merge(options)) => merge::run(&options),
        Some(Command::Ida(options)) => ida::run(&options),
        Some(Command::Stripes(options)) => runner::pool(None)?.install(|| stripes::run(&options, &explicit)),
        Some(Command::Cloud(options)) => runner::pool(None)?.install(|| cloud::run(&options)),
        Some(Command::Fragility(options)) => runner::pool(None)?.install(|| fragility::run(&options, &explicit)),
        Some(Command::Rate(options)) => runner::pool(None)?.install(|| rate::run(&options, &explicit)),
        Some(Command::Search(options)) => search::run(&options, &explicit),
        Some(Command::Fit(options)) => fit::run(&options),
        Some(Command::Assess(options)) => assess::run(&options),
        Some(Command::Portfolio(options)) => portfolio::run(&options),
        Some(Command::Record(options)) => record::run(&options),
        Some(Command::Pulse(options)) => pulse::run(&options),
        Some(Command::Foundations(options)) => foundations::run(&options),
        Some(Command::Schema(options)) => schema::run(&options),
        Some(Command::Completions(options)) => shell::completions(&options, command()),
        Some(Command::Man(options)) => shell::man(&options, command()),
        None => run_with(&command().get_matches_from(EXAMPLE)),
    }
}

/// Returns true if the reader of a table has closed its pipe. An example is `rocking sweep study.toml --csv - | head`.
fn is_closed_pipe(error: &anyhow::Error) -> bool {
    matches!(
        error.downcast_ref(),
        Some(TableWriteError::Io { error, .. }) if error.kind() == io::ErrorKind::BrokenPipe
    )
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            // One line, including all causes.
            eprintln!("rocking: {}", format!("{error:#}").replace('\n', " "));
            ExitCode::FAILURE
        }
    }
}
