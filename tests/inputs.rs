//! What a user gives the `rocking` program: options without effect, records that leave something open, negative numbers.

#![cfg(feature = "program")]

#[path = "inputs/choices.rs"]
mod choices;
#[path = "inputs/free_motion.rs"]
mod free_motion;
#[path = "inputs/numbers.rs"]
mod numbers;
#[path = "inputs/patterns.rs"]
mod patterns;
#[path = "inputs/record.rs"]
mod record;
#[path = "inputs/settings.rs"]
mod settings;
#[path = "inputs/several.rs"]
mod several;
#[path = "common/skipped.rs"]
mod skipped;
#[path = "inputs/without_effect.rs"]
mod without_effect;

use std::path::Path;
use std::process::{Command, Output};

/// A record in the public domain, and its format.
pub const RECORD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/records/np01002p_4225a_a.smc");

/// Runs the program.
pub fn rocking(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rocking")).args(arguments).current_dir(folder).output().unwrap()
}

/// Runs what must succeed: what is on standard output.
#[track_caller]
pub fn made(folder: &Path, arguments: &[&str]) -> String {
    let output = rocking(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs what must be refused with one line, which is given without the program's name before it.
#[track_caller]
pub fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let output = rocking(folder, arguments);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {told}");
    assert_eq!(told.lines().count(), 1, "{arguments:?}: {told}");
    assert!(output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stdout));
    told.strip_prefix("rocking: ").unwrap().trim_end().to_string()
}
