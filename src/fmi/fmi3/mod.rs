//! The C interface of FMI 3.0: Co-Simulation with Event Mode, early return and intermediate updates, and Model Exchange.
//!
//! [`exports`] has the functions. [`boundary`] turns their pointers into references; [`instance`] turns the results of a
//! [unit](crate::unit::fmu::Fmu) into statuses and messages. Both build on [`crate::fmi`]. [`callbacks`] has the importer's logger and intermediate updates, [`step`] does a communication step,
//! [`values`] reads and sets variables by the types of FMI 3.0, `derivatives` has the directional and adjoint derivatives, and
//! [`calls`] is the table of the calls that are legal in each state.

pub mod boundary;
pub mod callbacks;
pub mod calls;
mod derivatives;
pub mod exports;
pub mod instance;
pub mod step;
pub mod types;
pub mod values;

/// The unit behind [`exports`].
pub use crate::unit::instance::Unit;
