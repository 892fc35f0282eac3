//! Outputs: files, devices and pipes, formats, JSON, completions and manual pages.

mod files;
mod formats;
mod json;
mod shell;
mod streams;

use std::path::Path;
use std::process::Command;

use crate::program::{RECORD, text};

/// One second under the embedded record.
pub const SIMULATE: [&str; 3] = ["simulate", "--duration", "1"];

/// Ten short runs.
pub const SPECTRUM: [&str; 11] =
    ["spectrum", "--alpha", "0.25", "--pulse", "one-sine", "--amplitude", "6.2622", "--points", "5", "--duration", "2"];

/// A search with one change of outcome.
pub const SEARCH: [&str; 12] =
    ["search", "damping", "--alpha", "0.25", "--p", "1", "--to", "0.4", "--points", "9", "--resolution", "1e-2"];

/// Six runs under `record.smc`.
pub const STUDY: &str = "[study]\ndesign = \"grid\"\nduration = 2\n\
    [parameters]\ndimensionless.alpha = [0.2, 0.25]\nepsilon = [0.0, 0.1, 0.2]\n\
    [[records]]\nhorizontal = \"record.smc\"\n";

/// A folder with `record.smc` and `study.toml`.
pub fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(RECORD, folder.path().join("record.smc")).unwrap();
    std::fs::write(folder.path().join("study.toml"), STUDY).unwrap();
    folder
}

/// Compares two texts; on failure prints the first lines that differ.
#[track_caller]
pub fn same(found: &str, expected: &str) {
    let differs = found.lines().zip(expected.lines()).find(|(found, expected)| found != expected);
    let lengths = (found.len(), expected.len());
    assert!(found == expected, "{lengths:?} bytes, the first lines that differ: {differs:#?}");
}

/// Returns whether the tests may make devices and mount file systems; reports a skipped test otherwise.
pub fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output().unwrap();
    let root = text(&id.stdout).trim() == "0";
    if !root {
        crate::skipped::skip("a test of devices or disks: only root can make devices and mount file systems");
    }
    root
}

/// Runs a tool that must succeed.
#[track_caller]
pub fn tool(folder: &Path, program: &str, arguments: &[&str]) {
    let output = Command::new(program).args(arguments).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{program} {arguments:?}: {}", text(&output.stderr));
}
