//! The block in space: equations, closed forms, reference trajectories, symmetries, random runs.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/skipped.rs"]
mod skipped;

mod reference;
