//! The files from which the FMUs are built.

/// Paths in the repository; their last commit gives the date of the FMUs.
pub const SOURCES: [&str; 15] = [
    "build.rs",
    "build",
    "crates/fmu2",
    "crates/fmu2-in-space",
    "crates/fmu3",
    "crates/fmu3-in-space",
    "crates/records",
    "lab/wasm",
    "modelDescription.xml",
    "modelDescriptionInSpace.xml",
    "src",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "Cargo.toml",
    "Cargo.lock",
];
