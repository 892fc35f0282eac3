//! The interface of modelDescription.xml ↔ block, pulse, settings and outputs, independent of C and of the version of FMI.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`variables`] | modelDescription.xml → a table of variables |
//! | [`values`] | values of variables → block, pulse, settings, inputs |
//! | [`fmi3_only`] | values of the variables that exist only in FMI 3.0 |
//! | [`records`] | files or arrays of samples → the FMU's own ground motion |
//! | [`outputs`] | an output → the source of its value and its derivatives |
//! | [`life_cycle`] | the states of an instance |
//! | [`instance`] | calls → a block in motion; variables, [derivatives](instance::derivatives), [Model Exchange](instance::exchange) |
//! | [`substeps`] | a communication step → parts that end at events and at intermediate updates |
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
