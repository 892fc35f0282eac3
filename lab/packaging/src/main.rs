//! FMUs of single targets → the packages of a release, with their binaries' system requirements checked.
//!
//! `packaging merge OUT IN…` merges the binaries of several FMUs into one; `packaging check FMU…` prints the requirements of the
//! binaries and fails if they exceed those in docs/code/packaging.md; `packaging only OUT FMU PLATFORM…` keeps only the binaries in
//! these folders of `binaries`; `packaging unpack FMU FOLDER` unpacks an FMU.

#[path = "../../../build/container.rs"]
mod container;
mod merge;
mod needs;
mod standard;

use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

use standard::{Standard, identifier};

/// The files of an FMU, by path.
type Files = BTreeMap<String, Vec<u8>>;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words.as_slice() {
        ["merge", out, fmus @ ..] if !fmus.is_empty() => merge_all(out, fmus),
        ["check", fmus @ ..] if !fmus.is_empty() => fmus.iter().try_for_each(|fmu| check(fmu)),
        ["only", out, fmu, platforms @ ..] if !platforms.is_empty() => only(out, fmu, platforms),
        ["unpack", fmu, folder] => unpack(fmu, Path::new(folder)),
        _ => Err("expected: merge OUT IN…, check FMU…, only OUT FMU PLATFORM…, or unpack FMU FOLDER".into()),
    };
    if let Err(message) = done {
        eprintln!("error: {message}");
        std::process::exit(1);
    }
}

fn read(path: &str) -> Result<Files, String> {
    let failed = |error: &dyn std::fmt::Display| format!("{path}: {error}");
    let file = std::fs::File::open(path).map_err(|e| failed(&e))?;
    let mut archive = zip::ZipArchive::new(file).map_err(|e| failed(&e))?;
    let mut files = Files::new();
    for position in 0..archive.len() {
        let mut entry = archive.by_index(position).map_err(|e| failed(&e))?;
        let name = entry.name().map_err(|e| failed(&e))?.into_owned();
        let mut content = Vec::new();
        entry.read_to_end(&mut content).map_err(|e| failed(&e))?;
        files.insert(name, content);
    }
    Ok(files)
}

fn merge_all(out: &str, fmus: &[&str]) -> Result<(), String> {
    let mut merged = read(fmus[0])?;
    for fmu in &fmus[1..] {
        merge::add(&mut merged, read(fmu)?).map_err(|e| format!("{fmu} and {}: {e}", fmus[0]))?;
    }
    container::write(Path::new(out), &merged)
}

fn check(fmu: &str) -> Result<(), String> {
    let files = read(fmu)?;
    let standard = Standard::of(&files).map_err(|error| format!("{fmu}: {error}"))?;
    let identifier = identifier(&files).map_err(|error| format!("{fmu}: {error}"))?;
    let size = std::fs::metadata(fmu).map_err(|e| format!("{fmu}: {e}"))?.len();
    println!("{fmu}: {size} bytes");
    let binaries: Vec<_> = files.iter().filter(|(path, _)| path.starts_with("binaries/")).collect();
    if binaries.is_empty() {
        return Err(format!("{fmu} holds no binary"));
    }
    for (path, content) in binaries {
        let failed = |error| format!("{fmu}: {path}: {error}");
        let needs = needs::of(content).map_err(failed)?;
        println!("  {path}: {} bytes, needs {needs}", content.len());
        standard.check_place(path, needs.platform, &identifier).map_err(failed)?;
        needs.check(&standard.functions()).map_err(failed)?;
    }
    Ok(())
}

fn only(out: &str, fmu: &str, platforms: &[&str]) -> Result<(), String> {
    let mut files = read(fmu)?;
    merge::keep(&mut files, platforms).map_err(|e| format!("{fmu}: {e}"))?;
    container::write(Path::new(out), &files)
}

fn unpack(fmu: &str, folder: &Path) -> Result<(), String> {
    for (name, content) in read(fmu)? {
        if name.split(['/', '\\']).any(|part| matches!(part, "" | "..")) || name.contains(':') {
            return Err(format!("{fmu}: {name:?} does not stay in its folder"));
        }
        let path = folder.join(&name);
        let made = path.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| std::fs::write(&path, content));
        made.map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(())
}
