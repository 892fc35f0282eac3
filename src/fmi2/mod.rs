//! The solver behind the C interface of FMI 2.0 Co-Simulation.
//!
//! `exports` has the 44 functions; `boundary` turns their pointers into references and lets no panic out; `instance` is
//! a state machine without any of that, `calls` its table of what is legal when, `snapshot` its saved states, `log` its
//! messages. The variables are those of [`crate::model`].

pub mod boundary;
pub mod calls;
pub mod exports;
pub mod instance;
pub mod log;
pub mod snapshot;
pub mod types;
