//! The `rocking` program.

use std::process::ExitCode;

use rocking_block::cli;

fn main() -> ExitCode {
    match cli::run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if cli::is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            // One line, whatever the chain of causes.
            eprintln!("rocking: {}", format!("{error:#}").replace('\n', " "));
            ExitCode::FAILURE
        }
    }
}
