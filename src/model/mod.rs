//! The model's interface, as modelDescription.xml has it ↔ block, pulse, settings and outputs: no C, and nothing of any
//! version of FMI.
//!
//! [`variables`] is the description, [`values`] what its variables mean, [`outputs`] where those of
//! them come from, [`own`] what FMI 3.0 alone has;
//! [`mod@unit`] is an instance with its [`life_cycle`], whose steps may be done in [`parts`], and [`snapshot`] its saved
//! states; [`unit::derivatives`] are derivatives in a direction.

pub mod fault;
pub mod life_cycle;
pub mod outputs;
pub mod own;
pub mod parts;
pub mod snapshot;
pub mod unit;
pub mod values;
pub mod variables;
