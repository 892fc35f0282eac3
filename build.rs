//! modelDescription.xml → the code's table of variables; sources → `RockingBlock.fmu` of FMI 2.0 and
//! `RockingBlock-fmi3.fmu` of FMI 3.0, or `RockingBlock-wasm.fmu` if the target is WebAssembly.
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
    let wrong = |e| format!("modelDescription.xml: {e}");
    let tool = format!("generationTool=\"rocking-block {}\"", variable("CARGO_PKG_VERSION")?);
    let text = read("modelDescription.xml")?.replacen("generationTool=\"rocking-block\"", &tool, 1);
    let text = positions::write(&text).map_err(wrong)?;
    let description = description::read(&text).map_err(wrong)?;
    // For tests, which compare it with the code.
    write_if_changed(&out.join("modelDescription.xml"), &description.packed)?;
    write_if_changed(&out.join("variables.rs"), &description.code())?;
    // A missing file would have cargo run the script each time.
    for source in SOURCES.into_iter().filter(|source| Path::new(source).exists()) {
        println!("cargo::rerun-if-changed={source}");
    }
    // Cargo sets this when it compiles this script for the requested package, but not for a dependency.
    let asked_for = option_env!("CARGO_PRIMARY_PACKAGE").is_some();
    // A package from a registry has the library alone.
    let in_repository = Path::new("crates/fmu2").exists();
    if std::env::var_os(GUARD).is_some() || !asked_for || !in_repository {
        return Ok(());
    }
    #[cfg(feature = "fmu")]
    pack::pack(&out, &description)?;
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
