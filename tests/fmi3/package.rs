//! Content of the FMU of FMI 3.0, and exports of its library.

use crate::functions::NAMES;
use crate::host::FMU;
use crate::loading::exports;
use crate::unit::BINARY;

#[test]
fn holds_the_files_of_the_standard() {
    let files: Vec<&str> = FMU.files.keys().map(String::as_str).filter(|f| !f.contains("/licenses/")).collect();
    let documentation = ["documentation/index.html", "documentation/sbom.cdx.json"];
    let icons = ["icon.png", "icon.svg", "terminalsAndIcons.xml"].map(|name| format!("terminalsAndIcons/{name}"));
    let icons = icons.each_ref().map(String::as_str);
    let expected = [&[BINARY], &documentation[..], &["modelDescription.xml"], &icons[..]].concat();
    assert_eq!(files, expected);
    assert!(FMU.files.contains_key("documentation/licenses/license.txt"));
}

/// The documentation page describes this version: its variables, functions and file.
#[test]
fn page_describes_this_unit() {
    let page = std::str::from_utf8(&FMU.files["documentation/index.html"]).unwrap();
    for name in FMU.variables.keys() {
        assert!(page.contains(&format!("<td><code>{name}</code></td>")), "{name}");
    }
    for name in ["RockingBlock-fmi3.fmu", "terminateSimulation", "fmi3Error", "record.samples", "FMI 3.0"] {
        assert!(page.contains(name), "{name}");
    }
    for other in ["fmi2", "FMI 2.0", "\"RockingBlock.fmu\"", "<!-- FMI", "<!-- end", "<!-- variables", "<!-- version"] {
        assert!(!page.contains(other), "{other}");
    }
}

#[test]
fn exports_are_the_functions_of_the_standard() {
    let exported = exports(&FMU.files[BINARY]);
    assert_eq!(exported, NAMES.iter().map(ToString::to_string).collect());
    // `packaging check` looks for these.
    assert_eq!(exported, include_str!("../../lab/packaging/src/fmi3.txt").lines().map(String::from).collect());
}

#[test]
fn the_version_is_that_of_the_standard() {
    // SAFETY: a text that ends with 0 and is never freed (standard, 2.2.4).
    let version = unsafe { std::ffi::CStr::from_ptr((FMU.functions.get_version)()) };
    assert_eq!(version, c"3.0");
}
