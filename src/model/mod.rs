//! The model's interface, as modelDescription.xml has it ↔ block, pulse, settings and outputs: no C, and nothing of any
//! version of FMI.

pub mod values;
pub mod variables;
