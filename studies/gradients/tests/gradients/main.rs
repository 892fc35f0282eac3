//! Derivatives of runs with respect to their parameters, against central differences of the solver and against closed forms.

#![allow(missing_docs)]

mod cases;
#[path = "../../../../tests/common/cases.rs"]
mod cases_of_properties;
mod closed_form;
mod differences;
mod held;
mod peaks;
mod random;
mod run;
mod samples;
#[path = "../../../../tests/common/skipped.rs"]
mod skipped;
mod swing;
