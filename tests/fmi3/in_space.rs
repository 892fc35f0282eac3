//! The packed FMU of FMI 3.0 of the block in space through its C interface: the tests of main.rs that do not depend on the unit.

mod exchange_in_space;
#[allow(dead_code, reason = "not all functions are called")]
mod functions;
#[allow(dead_code, reason = "the planar unit's own tests use the rest")]
mod host;
mod life_cycle;
#[path = "../common/functions.rs"]
#[allow(dead_code, reason = "the exports are those of the planar unit")]
mod loading;
mod stops;
#[path = "unit_in_space.rs"]
mod unit;
