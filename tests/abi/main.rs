//! The FMU as an importer meets it: the packed library, through its C interface, against the FMI standard 2.0.4.

mod bad_start;
mod bad_state;
mod bad_step;
mod bad_value;
mod description;
mod exports;
mod functions;
mod host;
mod life_cycle;
