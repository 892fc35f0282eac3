//! The C interface of FMI 2.0: Co-Simulation and Model Exchange.
//!
//! [`exports`] has the 44 functions. [`boundary`] turns their pointers into references; [`instance`] turns the results of a
//! [unit](crate::unit::fmu::Fmu) into statuses and messages. Both build on [`crate::fmi`]. [`callbacks`] has the importer's logger, [`calls`] is the table of the calls that
//! are legal in each state.

pub mod boundary;
pub mod callbacks;
pub mod calls;
pub mod exports;
pub mod instance;
pub mod types;

/// The unit behind [`exports`].
pub use crate::unit::instance::Unit;
