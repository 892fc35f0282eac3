//! The unit of the block in space: modelDescriptionInSpace.xml ↔ body, excitation and outputs of [`crate::space`].
//!
//! | module | in → out |
//! | --- | --- |
//! | [`variables`] | modelDescriptionInSpace.xml → a table of variables |
//! | `feet` | a file or arrays → the feet of a list |
//! | `fmi3_values` | values of the parameters that only FMI 3.0 has |
//! | `values` | values of parameters → body, initial state, pulse |
//! | `records` | parameters → the FMU's own ground motion |
//! | `outputs` | an output or calculated parameter → the source of its value |
//! | `instance` | calls → a block in motion |

pub mod variables;

pub(crate) mod feet;

pub(crate) mod fmi3_values;

pub(crate) mod values;

pub(crate) mod records;

pub(crate) mod outputs;

pub(crate) mod instance;

pub use instance::SpaceUnit;
