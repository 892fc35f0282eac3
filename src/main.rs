//! The `rocking` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    match rocking_block::cli::run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // One line, whatever the chain of causes.
            eprintln!("rocking: {}", format!("{error:#}").replace('\n', " "));
            ExitCode::FAILURE
        }
    }
}
