//! The paper's figures and findings, by the program and in code.

#[path = "../../../../tests/common/labels.rs"]
mod labels;
#[path = "../../../../tests/common/skipped.rs"]
mod skipped;

mod figures;
mod findings;
