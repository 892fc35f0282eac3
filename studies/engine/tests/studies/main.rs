//! Studies: runs in lanes against runs alone, thresholds against the derivatives of runs, and published results.

#[path = "../../../../tests/common/cases.rs"]
mod cases;

mod fit;
mod instants;
mod lanes;
mod planted;
mod published;
mod pushover;
mod relations;
#[path = "../../../../tests/common/skipped.rs"]
mod skipped;
mod thresholds;
