//! The packed FMU of the block in space through its C interface: the tests of main.rs that do not depend on the unit.

mod bad_state;
mod bad_step;
mod callbacks;
mod derivatives_in_space;
#[allow(dead_code, reason = "the planar unit's own tests use the rest")]
mod description;
mod exchange_calls;
mod exchange_in_space;
mod exports;
#[allow(dead_code, reason = "the planar unit's own tests use the rest")]
mod functions;
#[allow(dead_code, reason = "the planar unit's own tests use the rest")]
mod host;
mod life_cycle;
#[path = "../common/functions.rs"]
mod loading;
mod logging;
mod state;
mod stepping;
#[path = "unit_in_space.rs"]
mod unit;
