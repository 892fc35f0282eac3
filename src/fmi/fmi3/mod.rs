//! The solver behind the C interface of FMI 3.0: Co-Simulation with Event Mode, early return and intermediate
//! update, and Model Exchange.
//!
//! [`exports`] has the functions; [`boundary`] turns their pointers into references and [`instance`] what a
//! [`crate::unit::instance::Unit`] answers into statuses and messages, both over what [`crate::fmi`] has for all versions; [`step`] is
//! a communication step, [`values`] are variables by the types of FMI 3.0, `derivatives` those in a direction; [`calls`] is the table of what is legal when.

pub mod boundary;
pub mod calls;
mod derivatives;
pub mod exports;
pub mod instance;
pub mod step;
pub mod types;
pub mod values;
