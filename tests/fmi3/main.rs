//! The packed FMU of FMI 3.0 through its C interface, tested against the FMI standard 3.0.1.

mod arrays;
mod beginning;
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
mod values;
