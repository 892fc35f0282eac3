//! modelDescription.xml → the code's table of variables; sources → `RockingBlock.fmu` of FMI 2.0 and
//! `RockingBlock-fmi3.fmu` of FMI 3.0.
//!
//! The script runs before its own crate is compiled, so it has cargo compile the crate once more, as the shared library
//! that goes into each FMU: `build/library.rs`. In that inner run `ROCKING_BLOCK_INNER` is set and only the table is made;
//! so it is where the crate is a dependency of another one.

#[path = "build/archive.rs"]
mod archive;
#[path = "build/container.rs"]
mod container;
#[path = "build/description.rs"]
mod description;
#[path = "build/fmi3.rs"]
mod fmi3;
#[path = "build/library.rs"]
mod library;
#[path = "build/licences.rs"]
mod licences;
#[path = "build/sbom.rs"]
mod sbom;

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use library::Version;

/// What the FMU is made from.
const SOURCES: [&str; 9] = [
    "build.rs",
    "build",
    "modelDescription.xml",
    "src",
    "documentation",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "Cargo.toml",
    "Cargo.lock",
];

fn main() {
    if let Err(message) = run() {
        eprintln!("error: {message}");
        std::process::exit(1);
    }
}

fn run() -> Result<(), String> {
    let out = PathBuf::from(variable("OUT_DIR")?);
    let text = read("modelDescription.xml")?;
    let description = description::read(&text).map_err(|e| format!("modelDescription.xml: {e}"))?;
    write_if_changed(&out.join("variables.rs"), &description.code())?;
    for source in SOURCES {
        println!("cargo::rerun-if-changed={source}");
    }
    // Cargo says so when it compiles this script: the package is what was asked for, not a dependency of something else.
    let asked_for = option_env!("CARGO_PRIMARY_PACKAGE").is_some();
    if std::env::var_os(library::GUARD).is_some() || !asked_for {
        return Ok(());
    }
    // OUT_DIR is <target>/<profile>/build/<package>-<hash>/out, wherever <target> is.
    let profile = out.ancestors().nth(3).ok_or("OUT_DIR is not where cargo puts it")?;
    let fmus = Version::ALL.map(|version| (version, profile.join(version.file())));
    // A file that is missing makes cargo run this script again: an FMU when somebody removed it, and the stamp when
    // the sources have changed and a `cargo check` did not pack them.
    let stamp = out.join("packed");
    println!("cargo::rerun-if-changed={}", stamp.display());
    for (version, fmu) in &fmus {
        println!("cargo::rustc-env={}={}", version.environment(), fmu.display());
        println!("cargo::rerun-if-changed={}", fmu.display());
    }
    if library::only_checking() {
        return match std::fs::remove_file(&stamp) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(format!("{}: {error}", stamp.display())),
            _ => Ok(()),
        };
    }
    let papers = licences::collect()?;
    for (version, fmu) in &fmus {
        let library = library::build(&out, *version)?;
        archive::pack(*version, fmu, &description, &library, papers.clone())?;
    }
    std::fs::write(&stamp, "").map_err(|e| format!("{}: {e}", stamp.display()))?;
    // As old as the newest source: cargo takes what is newer than this script's beginning for changed.
    let newest = newest_source()?;
    for made in fmus.iter().map(|(_, fmu)| fmu).chain([&stamp]) {
        let file = std::fs::File::options().append(true).open(made).map_err(|e| format!("{}: {e}", made.display()))?;
        file.set_modified(newest).map_err(|e| format!("{}: {e}", made.display()))?;
    }
    Ok(())
}

fn newest_source() -> Result<SystemTime, String> {
    let mut newest = SystemTime::UNIX_EPOCH;
    for source in SOURCES {
        for file in files(Path::new(source))? {
            let modified = std::fs::metadata(&file).and_then(|m| m.modified());
            newest = newest.max(modified.map_err(|e| format!("{}: {e}", file.display()))?);
        }
    }
    Ok(newest)
}

/// The files below a path, or the path itself, sorted.
fn files(path: &Path) -> Result<Vec<PathBuf>, String> {
    if !path.is_dir() {
        return Ok(vec![path.to_path_buf()]);
    }
    let entries = std::fs::read_dir(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let mut paths = entries
        .map(|entry| entry.map(|entry| entry.path()).map_err(|e| format!("{}: {e}", path.display())))
        .collect::<Result<Vec<_>, _>>()?;
    paths.sort();
    let nested = paths.iter().map(|path| files(path)).collect::<Result<Vec<_>, _>>()?;
    Ok(nested.concat())
}

fn variable(name: &str) -> Result<String, String> {
    std::env::var(name).map_err(|e| format!("{name}: {e}"))
}

fn read(path: &str) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|e| format!("{path}: {e}"))
}

/// A file whose content is as it was keeps its time, and what depends on it is not compiled again.
fn write_if_changed(path: &Path, content: &str) -> Result<(), String> {
    if std::fs::read_to_string(path).is_ok_and(|old| old == content) {
        return Ok(());
    }
    std::fs::write(path, content).map_err(|e| format!("{}: {e}", path.display()))
}
