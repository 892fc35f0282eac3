//! The packed FMU through its C interface, tested against the FMI standard 2.0.4.

#[path = "../common/beyond.rs"]
#[allow(dead_code, reason = "the solver's own tests use the rest")]
mod beyond_cases;
#[path = "../common/mod.rs"]
#[allow(dead_code, reason = "the solver's own tests use the rest")]
mod common;
#[path = "../common/compare.rs"]
mod compare;
#[path = "../common/beginning/mod.rs"]
mod differences;

mod arrays;
mod bad_start;
mod bad_state;
mod bad_step;
mod bad_value;
mod beginning;
mod beyond;
mod callbacks;
mod dependencies;
mod derivatives;
mod description;
mod endings;
mod event_lines;
mod exchange;
mod exchange_calls;
mod exports;
mod functions;
mod host;
mod life_cycle;
#[path = "../common/functions.rs"]
mod loading;
mod logging;
mod plane;
mod records;
mod reference;
mod rigid_base;
#[path = "../common/skipped.rs"]
mod skipped;
mod solver;
mod state;
mod stepping;
mod unit;
