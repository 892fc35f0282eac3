//! The descriptions of the units → the code's tables of variables; sources → `RockingBlock.fmu` of FMI 2.0 and
//! `RockingBlock-fmi3.fmu` of FMI 3.0, the same of `RockingBlockInSpace`, or `RockingBlock-wasm.fmu` if the target is WebAssembly.
//!
//! The script runs before its own crate is compiled. It therefore makes cargo compile the crate once more, for the shared
//! libraries inside the FMUs (`build/library.rs`). That inner run lacks the feature `fmu`: it makes only the table, and
//! compiles no packing code. The same applies if `ROCKING_BLOCK_INNER` is set, if the crate is a dependency of another, or if it is
//! built outside the repository.

#![cfg_attr(not(feature = "fmu"), expect(dead_code, reason = "only the packing code reads the whole description"))]

#[path = "build/description.rs"]
mod description;
#[path = "build/fmi3.rs"]
mod fmi3;
#[cfg(feature = "fmu")]
#[path = "build/pack.rs"]
mod pack;
#[path = "build/positions.rs"]
mod positions;
#[path = "build/sources.rs"]
mod sources;
#[path = "build/xml.rs"]
mod xml;

use std::path::{Path, PathBuf};

use sources::SOURCES;

/// A unit: its description, and what the build makes of it.
pub struct Unit {
    /// The description.
    pub file: &'static str,
    /// The name of its libraries.
    pub identifier: &'static str,
    /// The table of its variables in Rust.
    pub table: &'static str,
    /// The page and the pictures of its FMUs, in build/fmu.
    pub page: &'static str,
}

/// The units, the planar block first.
pub const UNITS: [Unit; 2] = [
    Unit { file: "modelDescription.xml", identifier: "rocking_block", table: "variables.rs", page: "index.html" },
    Unit {
        file: "modelDescriptionInSpace.xml",
        identifier: "rocking_block_in_space",
        table: "variables_in_space.rs",
        page: "in_space.html",
    },
];

/// Environment variable that suppresses the packing of FMUs.
const GUARD: &str = "ROCKING_BLOCK_INNER";

fn main() {
    if let Err(message) = run() {
        eprintln!("error: {message}");
        std::process::exit(1);
    }
}

fn run() -> Result<(), String> {
    let out = PathBuf::from(variable("OUT_DIR")?);
    let tool = format!("generationTool=\"rocking-block {}\"", variable("CARGO_PKG_VERSION")?);
    let mut descriptions = Vec::new();
    for Unit { file, identifier, table, .. } in UNITS {
        let wrong = |e| format!("{file}: {e}");
        let text = read(file)?.replacen("generationTool=\"rocking-block\"", &tool, 1);
        let text = positions::write(&text).map_err(wrong)?;
        let description = description::read(&text, identifier).map_err(wrong)?;
        // For tests, which compare it with the code.
        write_if_changed(&out.join(file), &description.packed)?;
        write_if_changed(&out.join(table), &description.code())?;
        descriptions.push(description);
    }
    // A missing file would have cargo run the script each time.
    for source in SOURCES.into_iter().filter(|source| Path::new(source).exists()) {
        println!("cargo::rerun-if-changed={source}");
    }
    println!("cargo::rerun-if-env-changed={GUARD}");
    // Cargo sets this when it compiles this script for the requested package, but not for a dependency.
    let asked_for = option_env!("CARGO_PRIMARY_PACKAGE").is_some();
    // A package from a registry has the library alone.
    let in_repository = Path::new("crates/fmu2").exists();
    if std::env::var_os(GUARD).is_some() || !asked_for || !in_repository {
        return Ok(());
    }
    #[cfg(feature = "fmu")]
    pack::pack(&out, &descriptions)?;
    Ok(())
}

fn variable(name: &str) -> Result<String, String> {
    std::env::var(name).map_err(|e| format!("{name}: {e}"))
}

fn read(path: &str) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|e| format!("{path}: {e}"))
}

/// Writes a file only if its content changes, so that its dependents are not compiled again.
fn write_if_changed(path: &Path, content: &str) -> Result<(), String> {
    if std::fs::read_to_string(path).is_ok_and(|old| old == content) {
        return Ok(());
    }
    std::fs::write(path, content).map_err(|e| format!("{}: {e}", path.display()))
}
