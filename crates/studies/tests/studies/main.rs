//! Studies: runs in lanes against runs alone, and published results.

#[path = "../../../../tests/common/cases.rs"]
mod cases;

mod fit;
mod lanes;
mod published;
