//! The crates linked into the library → a software bill of materials, CycloneDX 1.6.
//!
//! It contains no date and no serial number: the same sources and compiler give the same bytes.

use std::collections::{BTreeMap, BTreeSet};

use cargo_metadata::{Metadata, Package, PackageId};
use serde_json::{Value, json};

use crate::read;

use super::library;
use super::licences::{self, CLibrary};

/// Path of the bill inside the FMU.
pub const PATH: &str = "documentation/sbom.cdx.json";

/// Returns the bill for the linked packages.
pub fn write(metadata: &Metadata, linked: &BTreeSet<PackageId>) -> Result<String, String> {
    let root = metadata.root_package().ok_or("cargo metadata has no root package")?;
    let checksums = checksums(&read("Cargo.lock")?);
    let (standard, standard_library) = standard_library()?;
    let mut components = vec![standard_library];
    if let Some(CLibrary { name, licence, website, .. }) = licences::c_library()? {
        components.push(json!({
            "type": "library",
            "bom-ref": name,
            "name": name,
            "licenses": [{ "expression": licence }],
            "externalReferences": [{ "type": "website", "url": website }],
        }));
    }
    let mut dependencies = Vec::new();
    for id in linked {
        let package = &metadata[id];
        if *id != root.id {
            let checksum = checksums.get(&(package.name.to_string(), package.version.to_string()));
            components.push(component("library", package, checksum));
        }
        let node = metadata.resolve.as_ref().and_then(|resolve| resolve.nodes.iter().find(|node| node.id == *id));
        let needed = node.map(|node| node.dependencies.as_slice()).unwrap_or_default().iter();
        let mut needed: Vec<_> = needed.filter(|id| linked.contains(id)).map(|id| reference(&metadata[id])).collect();
        needed.push(standard.clone());
        needed.sort();
        dependencies.push(json!({ "ref": reference(package), "dependsOn": needed }));
    }
    dependencies.push(json!({ "ref": standard, "dependsOn": [] }));
    for list in [&mut components, &mut dependencies] {
        list.sort_by_key(|entry| entry["bom-ref"].as_str().or(entry["ref"].as_str()).map(str::to_owned));
    }
    let bill = json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": { "component": component("library", root, None) },
        "components": components,
        "dependencies": dependencies,
    });
    serde_json::to_string_pretty(&bill).map(|text| text + "\n").map_err(|e| format!("{PATH}: {e}"))
}

fn component(kind: &str, package: &Package, checksum: Option<&String>) -> Value {
    let mut component = json!({
        "type": kind,
        "bom-ref": reference(package),
        "name": package.name.to_string(),
        "version": package.version.to_string(),
        "purl": reference(package),
    });
    if let Some(licence) = &package.license {
        // Older manifests use a slash for OR.
        component["licenses"] = json!([{ "expression": licence.replace('/', " OR ") }]);
    }
    if let Some(repository) = &package.repository {
        component["externalReferences"] = json!([{ "type": "vcs", "url": repository }]);
    }
    if let Some(checksum) = checksum {
        component["hashes"] = json!([{ "alg": "SHA-256", "content": checksum }]);
    }
    component
}

fn reference(package: &Package) -> String {
    format!("pkg:cargo/{}@{}", package.name, package.version)
}

/// Returns reference and component of the standard library, which no manifest names.
fn standard_library() -> Result<(String, Value), String> {
    let version = library::rustc(&["-vV"])?;
    let release = version.lines().find_map(|line| line.strip_prefix("release: "));
    let release = release.ok_or_else(|| format!("rustc -vV gives no release, but {version:?}"))?;
    let reference = format!("pkg:generic/rust-standard-library@{release}");
    let component = json!({
        "type": "library",
        "bom-ref": reference,
        "name": "rust-standard-library",
        "version": release,
        "purl": reference,
        "licenses": [{ "expression": "MIT OR Apache-2.0" }],
        "externalReferences": [{ "type": "vcs", "url": "https://github.com/rust-lang/rust" }],
        // Their versions follow from its release.
        "components": licences::IN_STANDARD_LIBRARY.map(|(name, licence)| json!({
            "type": "library",
            "bom-ref": format!("{reference}#{name}"),
            "name": name,
            "licenses": [{ "expression": licence }],
        })),
    });
    Ok((reference, component))
}

/// Returns the checksum of each package in Cargo.lock by name and version.
fn checksums(lock: &str) -> BTreeMap<(String, String), String> {
    let value = |block: &str, key: &str| {
        let line = block.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "))?;
        Some(line.trim_matches('"').to_string())
    };
    let packages = lock.split("[[package]]").skip(1);
    packages
        .filter_map(|block| Some(((value(block, "name")?, value(block, "version")?), value(block, "checksum")?)))
        .collect()
}
