//! The exported names of the binary: all 44 functions of the standard's headers, and no others.

use crate::functions::NAMES;
use crate::host::FMU;
use crate::loading::exports;

#[test]
fn exports_are_the_44_functions_of_the_standard() {
    assert_eq!(NAMES.len(), 44);
    let exported = exports(&FMU.binary);
    assert_eq!(exported, NAMES.iter().map(ToString::to_string).collect());
    // `packaging check` looks for these.
    assert_eq!(exported, include_str!("../../lab/packaging/src/fmi2.txt").lines().map(String::from).collect());
}

#[test]
fn types_platform_and_version_are_those_of_the_standard() {
    // SAFETY: both return texts that end with 0 and are never freed (standard, 2.1.4).
    let [platform, version] = unsafe {
        [(FMU.functions.get_types_platform)(), (FMU.functions.get_version)()]
            .map(|text| std::ffi::CStr::from_ptr(text).to_str().unwrap())
    };
    assert_eq!((platform, version), ("default", "2.0"));
}
