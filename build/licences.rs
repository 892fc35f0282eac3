//! The crates linked into the library → their licences and the bill of materials.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use cargo_metadata::{Metadata, MetadataCommand, PackageId};

use super::library::{self, Fmu, Version};
use super::sbom;

/// Third-party crates inside Rust's standard library, and their licences.
pub const IN_STANDARD_LIBRARY: [(&str, &str); 10] = [
    ("addr2line", "Apache-2.0 OR MIT"),
    ("adler2", "0BSD OR MIT OR Apache-2.0"),
    ("cfg-if", "MIT OR Apache-2.0"),
    ("gimli", "MIT OR Apache-2.0"),
    ("hashbrown", "MIT OR Apache-2.0"),
    ("libc", "MIT OR Apache-2.0"),
    ("memchr", "Unlicense OR MIT"),
    ("miniz_oxide", "MIT OR Zlib OR Apache-2.0"),
    ("object", "Apache-2.0 OR MIT"),
    ("rustc-demangle", "MIT OR Apache-2.0"),
];

/// A C library linked into binaries of one kind of target.
#[derive(Clone, Copy)]
pub struct CLibrary {
    /// Its name, and its folder below documentation/licenses.
    pub name: &'static str,
    pub licence: &'static str,
    pub website: &'static str,
    /// The end of the targets' names.
    target: &'static str,
}

/// The C libraries that a compiler links into binaries.
pub const C_LIBRARIES: [CLibrary; 2] = [
    CLibrary { name: "mingw-w64", licence: "ZPL-2.1", website: "https://www.mingw-w64.org", target: "-windows-gnu" },
    CLibrary {
        name: "wasi-libc",
        licence: "MIT AND BSD-2-Clause",
        website: "https://github.com/WebAssembly/wasi-libc",
        target: "-wasip2",
    },
];

/// Returns the C library in the binaries for the target.
pub fn c_library() -> Result<Option<CLibrary>, String> {
    let target = crate::variable("TARGET")?;
    Ok(C_LIBRARIES.into_iter().find(|library| target.ends_with(library.target)))
}

/// Returns files for the FMU by path: `documentation/licenses` and the bill of materials.
pub fn collect(fmus: &[Fmu]) -> Result<BTreeMap<String, Vec<u8>>, String> {
    let metadata = metadata()?;
    let root = metadata.root_package().ok_or("cargo metadata has no root package")?.id.clone();
    let linked = linked(&metadata, fmus)?;
    let mut files = BTreeMap::from([(sbom::PATH.to_string(), sbom::write(&metadata, &linked)?.into_bytes())]);
    let path = |name: &str| format!("documentation/licenses/{name}");
    let mut index = String::from(
        "The FMU's binary holds code of these packages, under these licences, whose texts stand beside this file:\n\n\
         rust-standard-library: MIT OR Apache-2.0 https://github.com/rust-lang/rust\n",
    );
    for (name, licence) in IN_STANDARD_LIBRARY {
        let _ = writeln!(index, "  and in it {name}: {licence}");
    }
    if let Some(CLibrary { name, licence, website, .. }) = c_library()? {
        let _ = writeln!(index, "{name}: {licence} and others {website}");
    }
    for id in linked {
        let package = &metadata[&id];
        if id == root {
            for name in ["LICENSE-APACHE", "LICENSE-MIT"] {
                files.insert(path(name), std::fs::read(name).map_err(|e| format!("{name}: {e}"))?);
            }
        }
        let folder = format!("{}-{}", package.name, package.version);
        let licence = package.license.as_deref().unwrap_or("see its licence file");
        let repository = package.repository.as_deref().unwrap_or("");
        let _ = writeln!(index, "{folder}: {licence} {repository}");
        // The project's own packages have the root's licences.
        if package.source.is_some() {
            let home = package.manifest_path.parent().ok_or("a manifest is in no folder")?;
            let texts = licence_files(home.as_std_path())?;
            if texts.is_empty() {
                return Err(format!("{folder} ({licence}) has no licence file; expected one for the FMU"));
            }
            for (name, text) in texts {
                files.insert(path(&format!("{folder}/{name}")), text);
            }
        }
    }
    files.insert(path("license.txt"), index.into_bytes());
    Ok(files)
}

fn metadata() -> Result<Metadata, String> {
    let mut command = library::inner_cargo()?;
    command.args(["metadata", "--format-version", "1", "--no-default-features", "--locked", "--filter-platform"]);
    command.arg(crate::variable("TARGET")?);
    MetadataCommand::parse(output_of(command)?).map_err(|e| format!("cargo metadata: {e}"))
}

/// Returns the root, the glue of WebAssembly, and their run-time dependencies. Dependencies of builds and tests, and macros, are left out.
///
/// `cargo tree` knows the optional dependencies that are really used; `cargo metadata` does not.
fn linked(metadata: &Metadata, fmus: &[Fmu]) -> Result<BTreeSet<PackageId>, String> {
    let mut command = library::inner_cargo()?;
    command.args(["tree", "--edges", "normal,no-proc-macro", "--no-default-features", "--locked", "--no-dedupe"]);
    command.args(["--package", "rocking-block"]);
    // The glue of the other versions is the project's own.
    if let [wasm @ Fmu { version: Version::Wasm, .. }] = fmus {
        command.args(["--package", wasm.library]);
    }
    command.args(["--prefix", "none", "--format", "{p}", "--target", &crate::variable("TARGET")?]);
    let tree = output_of(command)?;
    // `name vVERSION`, and the folder of a local package.
    let used: BTreeSet<(&str, &str)> = tree
        .lines()
        .filter_map(|line| {
            let mut words = line.split_whitespace();
            Some((words.next()?, words.next()?.strip_prefix('v')?))
        })
        .collect();
    let id = |&(name, version): &(&str, &str)| {
        let found = metadata.packages.iter().find(|p| p.name == name && p.version.to_string() == version);
        found.map(|package| package.id.clone()).ok_or_else(|| format!("cargo metadata has no {name} {version}"))
    };
    used.iter().map(id).collect()
}

fn output_of(mut command: Command) -> Result<String, String> {
    let output = command.output().map_err(|e| format!("cargo does not start: {e}"))?;
    if !output.status.success() {
        return Err(format!("{command:?}: {}", String::from_utf8_lossy(&output.stderr)));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn licence_files(folder: &Path) -> Result<Vec<(String, Vec<u8>)>, String> {
    let entries = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut files = Vec::new();
    for entry in entries {
        let entry = entry.map_err(|e| format!("{}: {e}", folder.display()))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let upper = name.to_uppercase();
        let is_licence = ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE"]
            .iter()
            .any(|beginning| upper.starts_with(beginning));
        if is_licence && entry.path().is_file() {
            files.push((name, std::fs::read(entry.path()).map_err(|e| format!("{}: {e}", entry.path().display()))?));
        }
    }
    Ok(files)
}
