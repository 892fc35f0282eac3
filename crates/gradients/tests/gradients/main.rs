//! Derivatives of runs with respect to their parameters, against central differences of the solver and against closed forms.

#![allow(missing_docs)]

mod cases;
mod closed_form;
mod differences;
mod held;
mod run;
mod samples;
#[path = "../../../../tests/common/skipped.rs"]
mod skipped;
mod swing;
