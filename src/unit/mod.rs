//! The interface of modelDescription.xml ↔ block, pulse, settings and outputs: no C, and nothing of any version of FMI.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`variables`] | modelDescription.xml → a table of variables |
//! | [`values`] | values of variables → block, pulse, settings, inputs |
//! | [`fmi3_only`] | the variables that only FMI 3.0 has |
//! | [`records`] | files or arrays of samples → ground motion inside |
//! | [`outputs`] | an output → where its value and its derivatives come from |
//! | [`life_cycle`] | the states of an instance |
//! | [`instance`] | calls → a block in motion, with [derivatives in a direction](instance::derivatives) and [Model Exchange](instance::exchange) |
//! | [`substeps`] | a communication step that stops at events and looks of the importer |
//! | [`snapshot`] | an instance ↔ bytes |

pub mod fault;
pub mod variables;

pub mod values;

pub mod fmi3_only;

pub mod records;

pub mod outputs;

pub mod life_cycle;

pub mod instance;

pub mod substeps;

pub mod snapshot;
