//! The solver behind the C interface of FMI 2.0 Co-Simulation.
//!
//! [`exports`] has the 44 functions; [`boundary`] turns their pointers into references and [`instance`] what a
//! [`crate::unit::instance::Unit`] answers into statuses and messages, both over what [`crate::fmi`] has for all versions;
//! [`calls`] is the table of what is legal when.

pub mod boundary;
pub mod calls;
pub mod exports;
pub mod instance;
pub mod types;
