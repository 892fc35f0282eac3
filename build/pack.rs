//! Sources → the FMUs.

#[path = "archive.rs"]
mod archive;
#[path = "container.rs"]
mod container;
#[path = "date.rs"]
mod date;
#[path = "library.rs"]
mod library;
#[path = "licences.rs"]
mod licences;
#[path = "sbom.rs"]
mod sbom;

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::SOURCES;
use crate::description::Description;
use library::Fmu;

/// Packs the FMUs for the target, next to the program under construction.
pub fn pack(out: &Path, descriptions: &[Description]) -> Result<(), String> {
    // OUT_DIR is <target>/<profile>/build/<package>-<hash>/out.
    let profile = out.ancestors().nth(3).ok_or("OUT_DIR is not where cargo puts it")?;
    let of_target = library::of_target()?;
    let fmus: Vec<(Fmu, PathBuf)> = of_target.iter().map(|&fmu| (fmu, profile.join(fmu.file))).collect();
    // A missing file makes cargo run this script again: an FMU if somebody removed it, and the stamp if the sources
    // changed and a `cargo check` did not pack them.
    let stamp = out.join("packed");
    println!("cargo::rerun-if-changed={}", stamp.display());
    for (fmu, path) in &fmus {
        println!("cargo::rustc-env={}={}", fmu.environment, path.display());
        println!("cargo::rerun-if-changed={}", path.display());
    }
    if library::only_checking() {
        return match std::fs::remove_file(&stamp) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(format!("{}: {error}", stamp.display())),
            _ => Ok(()),
        };
    }
    let papers = licences::collect(of_target)?;
    let binaries = library::build(out, of_target)?;
    for ((fmu, path), binaries) in fmus.iter().zip(binaries) {
        archive::pack(*fmu, path, &descriptions[fmu.unit], binaries, papers.clone())?;
    }
    std::fs::write(&stamp, "").map_err(|e| format!("{}: {e}", stamp.display()))?;
    // The files get the age of the newest source: cargo treats files newer than the start of this script as changed.
    let newest = newest_source()?;
    for made in fmus.iter().map(|(_, path)| path).chain([&stamp]) {
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

/// Returns the files below a path, or the path itself, sorted.
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
