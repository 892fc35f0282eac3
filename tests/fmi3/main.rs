//! The packed FMU of FMI 3.0 through its C interface, tested against the FMI standard 3.0.1.

#[path = "../common/beyond.rs"]
#[allow(dead_code, reason = "the solver's own tests use the rest")]
mod beyond_cases;
#[path = "../common/mod.rs"]
#[allow(dead_code, reason = "the solver's own tests use the rest")]
mod common;

mod arrays;
mod beginning;
mod beyond;
#[path = "../common/beginning/mod.rs"]
#[allow(dead_code, reason = "the file of FMI 3.0 is read here")]
mod differences;
mod events;
mod exchange;
#[allow(dead_code, reason = "that all functions are there is tested; not all are called")]
mod functions;
mod host;
mod intermediate;
mod life_cycle;
#[path = "../common/functions.rs"]
mod loading;
mod misuse;
mod package;
mod states;
mod stops;
mod unit;
mod values;
