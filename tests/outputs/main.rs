//! What the `rocking` program writes and where: files, devices and pipes, formats, JSON, completions and manual pages.

#![cfg(all(feature = "program", unix))]

mod files;
mod formats;
mod json;
mod shell;
#[path = "../common/skipped.rs"]
mod skipped;
mod streams;

use std::path::Path;
use std::process::{Command, Output};

/// A real record of the project.
pub const RECORD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/records/np01002p_4225a_a.smc");

/// One second under the embedded record.
pub const SIMULATE: [&str; 3] = ["simulate", "--duration", "1"];

/// Ten short runs.
pub const SPECTRUM: [&str; 9] =
    ["spectrum", "--pulse", "one-sine", "--amplitude", "6.2622", "--points", "5", "--duration", "2"];

/// One change of outcome.
pub const SEARCH: [&str; 8] = ["search", "damping", "--to", "0.4", "--points", "9", "--resolution", "1e-2"];

/// Six runs under `record.smc`.
pub const STUDY: &str = "[study]\ndesign = \"grid\"\nduration = 2\n\
    [parameters]\ndimensionless.alpha = [0.2, 0.25]\nepsilon = [0.0, 0.1, 0.2]\n\
    [[records]]\nhorizontal = \"record.smc\"\n";

/// The program in a folder, with arguments in several parts.
pub fn rocking(folder: &Path, arguments: &[&[&str]]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rocking"));
    command.args(arguments.concat()).current_dir(folder);
    command
}

/// A folder with `record.smc` and `study.toml`.
pub fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(RECORD, folder.path().join("record.smc")).unwrap();
    std::fs::write(folder.path().join("study.toml"), STUDY).unwrap();
    folder
}

/// Text of an output.
#[track_caller]
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Runs what must succeed; its standard output and standard error.
#[track_caller]
pub fn made(command: &mut Command) -> (String, String) {
    let Output { status, stdout, stderr } = command.output().unwrap();
    assert!(status.success(), "{command:?}: {}", text(&stderr));
    (text(&stdout), text(&stderr))
}

/// Runs what must be refused with status 1, one line with these words, and nothing on standard output.
#[track_caller]
pub fn refused(command: &mut Command, words: &[&str]) {
    let Output { status, stdout, stderr } = command.output().unwrap();
    let line = text(&stderr);
    assert_eq!(status.code(), Some(1), "{command:?}: {status}: {line}");
    assert!(line.starts_with("rocking: ") && line.lines().count() == 1, "{command:?}: {line}");
    for word in words {
        assert!(line.contains(word), "{command:?}: `{word}` is not in: {line}");
    }
    assert!(!line.contains(".tmp"), "{line}");
    assert_eq!(text(&stdout), "");
}

/// Two texts that must be the same.
#[track_caller]
pub fn same(found: &str, expected: &str) {
    let differs = found.lines().zip(expected.lines()).find(|(found, expected)| found != expected);
    let lengths = (found.len(), expected.len());
    assert!(found == expected, "{lengths:?} bytes, the first lines that differ: {differs:#?}");
}

/// Names in a folder.
pub fn names(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// Whether the tests may make devices and mount file systems; they say so where they may not.
pub fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output().unwrap();
    let root = text(&id.stdout).trim() == "0";
    if !root {
        skipped::skip("a test of devices or disks: only root can make devices and mount file systems");
    }
    root
}

/// Runs a tool that must succeed.
#[track_caller]
pub fn tool(folder: &Path, program: &str, arguments: &[&str]) {
    let output = Command::new(program).args(arguments).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{program} {arguments:?}: {}", text(&output.stderr));
}
