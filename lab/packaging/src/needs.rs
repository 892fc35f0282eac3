//! A binary → its required libraries and symbol versions, its exports, and whether any system of its kind has the requirements.

use std::collections::BTreeSet;
use std::fmt;

use object::read::NameOrOrdinal;
use object::read::elf::{Dyn, ElfFile64, SectionHeader};
use object::read::pe::PeFile64;
use object::{Architecture, Endianness, Object, elf};

use crate::standard::Platform;

/// The newest glibc whose symbols a Linux binary may use: that of the oldest systems still in use.
const GLIBC: Version = Version(2, 17);

/// The parts of glibc. Any other library, even libgcc_s, may be missing.
const LINUX: [&str; 7] = [
    "libc.so.6",
    "libm.so.6",
    "libpthread.so.0",
    "libdl.so.2",
    "librt.so.1",
    "ld-linux-x86-64.so.2",
    "ld-linux-aarch64.so.1",
];

/// DLLs in the system folder of every Windows since 10, in lower case.
const WINDOWS: [&str; 8] = [
    "kernel32.dll",
    "ntdll.dll",
    "msvcrt.dll",
    "bcryptprimitives.dll",
    "advapi32.dll",
    "userenv.dll",
    "ws2_32.dll",
    "api-ms-win-core-synch-l1-2-0.dll",
];

/// A version of glibc.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Version(u32, u32);

/// Requirements and exports of a binary.
#[derive(Debug)]
pub struct Needs {
    pub platform: Platform,
    allowed: &'static [&'static str],
    libraries: BTreeSet<String>,
    /// Names of the required symbol versions.
    versions: BTreeSet<String>,
    exports: BTreeSet<String>,
}

impl Needs {
    /// Fails at the first requirement that some systems lack, the first export that is not one of `functions`, or the first
    /// function that is not exported.
    pub fn check(&self, functions: &BTreeSet<&str>) -> Result<(), String> {
        let exports: BTreeSet<&str> = self.exports.iter().map(String::as_str).collect();
        if let Some(name) = exports.difference(functions).next() {
            return Err(format!("exports {name:?}; expected nothing but the functions of the standard"));
        }
        if let Some(name) = functions.difference(&exports).next() {
            return Err(format!("does not export {name}; expected all functions of the standard"));
        }
        if let Some(library) = self.libraries.iter().find(|name| !self.allowed.contains(&name.to_lowercase().as_str()))
        {
            return Err(format!("needs {library}; expected no other libraries than {}", self.allowed.join(", ")));
        }
        match self.versions.iter().find(|name| glibc(name).is_none_or(|version| version > GLIBC)) {
            Some(name) => {
                Err(format!("needs symbols of {name}; expected none newer than GLIBC_{}.{}", GLIBC.0, GLIBC.1))
            }
            None => Ok(()),
        }
    }
}

impl fmt::Display for Needs {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let libraries: Vec<_> = self.libraries.iter().map(String::as_str).collect();
        write!(f, "{}", libraries.join(", "))?;
        match self.versions.iter().filter_map(|name| glibc(name)).max() {
            Some(Version(major, minor)) => write!(f, "; symbols up to GLIBC_{major}.{minor}"),
            None => Ok(()),
        }
    }
}

/// `GLIBC_2.2.5` → 2.2. `None` for versions of other libraries, such as `GCC_3.0`.
fn glibc(name: &str) -> Option<Version> {
    let mut numbers = name.strip_prefix("GLIBC_")?.split('.').map(str::parse);
    Some(Version(numbers.next()?.ok()?, numbers.next()?.ok()?))
}

/// Reads a 64-bit ELF or PE binary.
pub fn of(binary: &[u8]) -> Result<Needs, String> {
    match object::FileKind::parse(binary) {
        Ok(object::FileKind::Elf64) => of_elf(binary).map_err(|e| e.to_string()),
        Ok(object::FileKind::Pe64) => of_pe(binary).map_err(|e| e.to_string()),
        Ok(other) => Err(format!("is a {other:?}; expected a 64-bit ELF or PE file")),
        Err(error) => Err(format!("{error}; expected a 64-bit ELF or PE file")),
    }
}

fn of_elf(binary: &[u8]) -> object::Result<Needs> {
    let file = ElfFile64::<Endianness>::parse(binary)?;
    let (endian, sections) = (file.endian(), file.elf_section_table());
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (mut libraries, mut versions) = (BTreeSet::new(), BTreeSet::new());
    for section in sections.iter() {
        if let Some((entries, link)) = section.dynamic(endian, binary)? {
            let strings = sections.strings(endian, binary, link)?;
            for entry in entries.iter().filter(|entry| entry.tag(endian) == elf::DT_NEEDED) {
                libraries.insert(text(entry.string(endian, strings)?));
            }
        }
    }
    if let Some((mut needs, link)) = sections.gnu_verneed(endian, binary)? {
        let strings = sections.strings(endian, binary, link)?;
        while let Some((_, mut of_library)) = needs.next()? {
            while let Some(version) = of_library.next()? {
                versions.insert(text(version.name(endian, strings)?));
            }
        }
    }
    let platform = if file.architecture() == Architecture::Aarch64 { Platform::LinuxOnArm } else { Platform::Linux };
    Ok(Needs { platform, allowed: &LINUX, libraries, versions, exports: exports(&file)? })
}

fn of_pe(binary: &[u8]) -> object::Result<Needs> {
    let file = PeFile64::parse(binary)?;
    let mut libraries = BTreeSet::new();
    let mut insert = |name: &[u8]| libraries.insert(String::from_utf8_lossy(name).into_owned());
    if let Some(table) = file.import_table()? {
        let mut descriptors = table.descriptors()?;
        while let Some(descriptor) = descriptors.next()? {
            insert(table.name(descriptor.name.get(object::LittleEndian))?);
        }
    }
    // Libraries loaded at their first call.
    if let Some(table) = file.data_directories().delay_load_import_table(binary, &file.section_table())? {
        let mut descriptors = table.descriptors()?;
        while let Some(descriptor) = descriptors.next()? {
            insert(table.name(descriptor.dll_name_rva.get(object::LittleEndian))?);
        }
    }
    let exports = exports(&file)?;
    Ok(Needs { platform: Platform::Windows, allowed: &WINDOWS, libraries, versions: BTreeSet::new(), exports })
}

fn exports<'data>(file: &impl Object<'data>) -> object::Result<BTreeSet<String>> {
    let mut names = BTreeSet::new();
    for export in file.exports()? {
        names.insert(match export?.name() {
            NameOrOrdinal::Name(name) => String::from_utf8_lossy(name).into_owned(),
            NameOrOrdinal::Ordinal(ordinal) => format!("ordinal {ordinal}"),
        });
    }
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::Standard;

    fn needs(libraries: &[&str], versions: &[&str]) -> Needs {
        let set = |names: &[&str]| names.iter().map(ToString::to_string).collect();
        let exports = Standard::Fmi2.functions().into_iter().map(str::to_string).collect();
        Needs {
            platform: Platform::Linux,
            allowed: &LINUX,
            libraries: set(libraries),
            versions: set(versions),
            exports,
        }
    }

    fn check(needs: &Needs) -> Result<(), String> {
        needs.check(&Standard::Fmi2.functions())
    }

    #[test]
    fn versions_are_compared_as_numbers() {
        assert_eq!(glibc("GLIBC_2.2.5"), Some(Version(2, 2)));
        assert!(glibc("GLIBC_2.4") < glibc("GLIBC_2.17"));
        assert_eq!(glibc("GCC_3.0"), None);
    }

    #[test]
    fn requirements_beyond_every_system_are_reported() {
        check(&needs(&["libc.so.6", "libm.so.6"], &["GLIBC_2.2.5", "GLIBC_2.17"])).unwrap();
        for (libraries, versions, expected) in [
            (&["libc.so.6", "libgcc_s.so.1"], "GLIBC_2.17", "needs libgcc_s.so.1"),
            (&["libc.so.6", "libm.so.6"], "GLIBC_2.18", "needs symbols of GLIBC_2.18"),
            (&["libc.so.6", "libm.so.6"], "GLIBC_PRIVATE", "needs symbols of GLIBC_PRIVATE"),
        ] {
            let error = check(&needs(libraries, &[versions])).unwrap_err();
            assert!(error.starts_with(expected), "{error}");
        }
    }

    #[test]
    fn missing_and_additional_exports_are_reported() {
        let fine = || needs(&["libc.so.6"], &["GLIBC_2.17"]);
        let mut more = fine();
        more.exports.insert("fmi2GetFloat64".into());
        let error = check(&more).unwrap_err();
        assert!(error.contains("\"fmi2GetFloat64\""), "{error}");
        let mut less = fine();
        less.exports.remove("fmi2DoStep");
        let error = check(&less).unwrap_err();
        assert!(error.contains("does not export fmi2DoStep"), "{error}");
        fine().check(&Standard::Fmi3.functions()).unwrap_err();
    }

    /// This test program, linked by the system's linker, needs libgcc_s, a newer glibc, or both.
    #[test]
    #[cfg(all(target_os = "linux", target_env = "gnu", target_pointer_width = "64"))]
    fn a_binary_is_read() {
        let needs = of(&std::fs::read(std::env::current_exe().unwrap()).unwrap()).unwrap();
        assert!(needs.libraries.contains("libc.so.6"), "{needs}");
        assert!(needs.versions.iter().any(|name| glibc(name).is_some()), "{needs}");
        of(b"#!/bin/sh").unwrap_err();
    }
}
