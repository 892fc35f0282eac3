//! The solver behind the C interface of FMI 2.0 Co-Simulation.
//!
//! [`exports`] has the 44 functions; [`boundary`] turns their pointers into references and lets no panic out; [`instance`]
//! turns what a [`crate::model::unit::Unit`] answers into statuses and messages; [`calls`] is the table of what is legal
//! when, [`log`] the messages.

pub mod boundary;
pub mod calls;
pub mod exports;
pub mod instance;
pub mod log;
pub mod types;
