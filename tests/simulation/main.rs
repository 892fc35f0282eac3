//! Runs of a block: reference trajectories, conservation laws, convergence, flight, the rigid base, rest, random loads.

#[path = "../common/beyond.rs"]
#[allow(dead_code, reason = "the tests of the FMUs use the rest")]
mod beyond_cases;
#[path = "../common/blocks.rs"]
#[allow(dead_code, reason = "each test program uses a part")]
mod blocks;
#[path = "../common/cases.rs"]
mod cases;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/compare.rs"]
mod compare;
#[path = "../common/skipped.rs"]
mod skipped;

mod beyond;
mod convergence;
mod exchange;
mod flight;
mod harsh;
mod loads;
mod long_steps;
mod peaks;
mod physics;
mod reference;
mod rest;
mod rigid_base;
mod stops;
