//! The interface of modelDescription.xml ↔ block, pulse, settings and outputs, independent of C and of the version of FMI.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`fmu`] | what the C interfaces need of a unit |
//! | [`attributes`] | types, causalities and limits of variables |
//! | [`variables`] | modelDescription.xml → a table of variables |
//! | `fmi3_variables` | values of the parameters that exist only in FMI 3.0 |
//! | `choice` | a choice in a description → that of the solver |
//! | `inputs` | the variables of inputs ↔ ramps |
//! | [`links`] | a restraint of the FMU → the variables of its parameters |
//! | [`values`] | values of parameters → block, pulse, settings |
//! | `record_source` | files or arrays of samples → records |
//! | `records` | parameters → the FMU's own ground motion, from either source |
//! | `derived` | a calculated parameter → the source of its value |
//! | `outputs` | an output → the source of its value and its derivatives |
//! | [`life_cycle`] | the states of an instance |
//! | [`instance`] | calls → a block in motion; variables, derivatives, Model Exchange, parts of steps |
//! | [`snapshot`] | an instance ↔ bytes |
//! | [`in_space`] | the same for the block in space: modelDescriptionInSpace.xml ↔ [`crate::space`] |

pub mod fault;

pub mod fmu;

pub mod attributes;

pub mod variables;

pub(crate) mod fmi3_variables;

mod choice;

pub(crate) mod inputs;

pub mod links;

pub mod values;

mod record_source;

pub(crate) mod records;

pub(crate) mod derived;

pub(crate) mod outputs;

pub mod life_cycle;

pub mod instance;

pub mod snapshot;

pub mod in_space;
