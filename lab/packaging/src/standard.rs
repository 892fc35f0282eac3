//! Requirements of each FMI version on a package: the exported functions, and the folder of each binary.

use std::collections::BTreeSet;

use crate::Files;

/// A version of FMI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standard {
    Fmi2,
    Fmi3,
}

/// The platform of a binary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Platform {
    Linux,
    LinuxOnArm,
    Windows,
}

impl Standard {
    /// Returns the version of an FMU, from its description.
    pub fn of(files: &Files) -> Result<Standard, String> {
        let description = files.get("modelDescription.xml").ok_or("modelDescription.xml is missing")?;
        let text = String::from_utf8_lossy(description);
        let version =
            text.split_once("fmiVersion=\"").and_then(|(_, rest)| rest.split_once('"')).map(|(value, _)| value);
        match version {
            Some("2.0") => Ok(Standard::Fmi2),
            Some("3.0") => Ok(Standard::Fmi3),
            other => Err(format!("modelDescription.xml: fmiVersion = {other:?}; expected 2.0 or 3.0")),
        }
    }

    /// Returns the names of all functions that its headers declare.
    pub fn functions(self) -> BTreeSet<&'static str> {
        let names = match self {
            Standard::Fmi2 => include_str!("fmi2.txt"),
            Standard::Fmi3 => include_str!("fmi3.txt"),
        };
        names.lines().collect()
    }

    /// Refuses a binary in a folder of another platform, or under another name than `identifier`.
    pub fn check_place(self, path: &str, platform: Platform, identifier: &str) -> Result<(), String> {
        // FMI 2.0 has no name for Arm; this is that of FMI 3.0.
        let (folder, suffix) = match (self, platform) {
            (Standard::Fmi2, Platform::Linux) => ("linux64", "so"),
            (Standard::Fmi2, Platform::Windows) => ("win64", "dll"),
            (Standard::Fmi3, Platform::Linux) => ("x86_64-linux", "so"),
            (Standard::Fmi3, Platform::Windows) => ("x86_64-windows", "dll"),
            (Standard::Fmi2 | Standard::Fmi3, Platform::LinuxOnArm) => ("aarch64-linux", "so"),
        };
        let expected = format!("binaries/{folder}/{identifier}.{suffix}");
        if path == expected { Ok(()) } else { Err(format!("is for {platform:?}; expected it at {expected}")) }
    }
}

/// Returns the model identifier of Co-Simulation, which is the name of the binaries.
pub fn identifier(files: &Files) -> Result<String, String> {
    let text = String::from_utf8_lossy(files.get("modelDescription.xml").ok_or("modelDescription.xml is missing")?);
    let found = text
        .split_once("<CoSimulation")
        .and_then(|(_, rest)| rest.split_once("modelIdentifier=\"")?.1.split_once('"'))
        .map(|(value, _)| value.to_string());
    found.ok_or_else(|| "modelDescription.xml: no modelIdentifier of CoSimulation".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn version_is_read_from_the_description() {
        let fmu = |text: &str| Files::from([("modelDescription.xml".to_string(), text.as_bytes().to_vec())]);
        assert_eq!(Standard::of(&fmu(r#"<?xml version="1.0"?><a fmiVersion="2.0">"#)), Ok(Standard::Fmi2));
        assert_eq!(Standard::of(&fmu(r#"<a fmiVersion="3.0" b="1">"#)), Ok(Standard::Fmi3));
        assert!(Standard::of(&fmu(r#"<a fmiVersion="1.0">"#)).unwrap_err().contains("\"1.0\""));
        assert!(Standard::of(&Files::new()).is_err());
    }

    #[test]
    fn the_identifier_is_that_of_co_simulation() {
        let text = r#"<a><ModelExchange modelIdentifier="me"/><CoSimulation needsTool="no" modelIdentifier="cs"/></a>"#;
        let files = Files::from([("modelDescription.xml".to_string(), text.as_bytes().to_vec())]);
        assert_eq!(identifier(&files).unwrap(), "cs");
        assert!(identifier(&Files::new()).is_err());
    }

    #[test]
    fn binaries_are_where_importers_look() {
        let at = |standard: Standard, path, platform| standard.check_place(path, platform, "rocking_block");
        at(Standard::Fmi2, "binaries/linux64/rocking_block.so", Platform::Linux).unwrap();
        at(Standard::Fmi3, "binaries/x86_64-linux/rocking_block.so", Platform::Linux).unwrap();
        let error = at(Standard::Fmi3, "binaries/linux64/rocking_block.so", Platform::Linux).unwrap_err();
        assert!(error.contains("binaries/x86_64-linux/rocking_block.so"), "{error}");
        at(Standard::Fmi2, "binaries/linux64/rocking_block.so", Platform::LinuxOnArm).unwrap_err();
    }
}
