//! Studies of many blocks: spectra, sweeps, searches, fragility curves.

mod fragility;
mod friction;
mod in_space;
mod lanes;
mod measures;
mod merging;
mod parts;
mod rate;
mod search;
mod spectrum;
mod stopping_rule;
mod strengths;
mod sweep;
mod ways;

#[path = "../../../../../tests/common/labels.rs"]
mod labels;

use std::path::Path;

pub use labels::labels;

use crate::program::stdout;

/// A pulse under which some blocks separate, some overturn, and some do neither.
pub const PULSE: [&str; 8] =
    ["--alpha", "0.25", "--pulse", "one-sine", "--amplitude", "6.2622", "--period", "1.2566370614359172"];

/// Cuts a table at several bytes; the study must resume to the same bytes.
#[track_caller]
pub fn resumes_to_the_same_bytes(folder: &Path, arguments: &[&str], whole: &str) {
    let bytes = std::fs::read(folder.join(whole)).unwrap();
    let text = String::from_utf8(bytes.clone()).unwrap();
    let line_ends: Vec<usize> = text.match_indices('\n').map(|(i, _)| i + 1).collect();
    let first_row = line_ends[text.lines().position(|line| line.starts_with("row,")).unwrap()];
    let (middle, last) = (line_ends[line_ends.len() - 4], text.len());
    let half = (middle + line_ends[line_ends.len() - 3]) / 2;
    // An empty file, half the header, no row, whole rows, only the number of a row, half a row, all but the last line end.
    for length in [0, 30, first_row, middle, middle + 1, half, last - 1, last] {
        std::fs::write(folder.join("cut.csv"), &bytes[..length]).unwrap();
        let printed = stdout(folder, &[arguments, &["--csv", "cut.csv", "--resume"]].concat());
        assert!(std::fs::read(folder.join("cut.csv")).unwrap() == bytes, "cut at byte {length} of {last}");
        let there = line_ends.iter().filter(|end| **end <= length && **end > first_row).count();
        assert!(printed.contains(&format!("{there} resumed")), "cut at byte {length}: {printed}");
    }
}
