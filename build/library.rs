//! Sources → the shared library of the FMU, by a cargo of its own.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{GUARD, variable};

/// A version of FMI, for which there is an FMU with a library of its own: that of FMI 2.0 exports nothing but what its standard
/// names, and so does that of FMI 3.0.
#[derive(Clone, Copy)]
pub enum Version {
    Fmi2,
    Fmi3,
}

impl Version {
    pub const ALL: [Version; 2] = [Version::Fmi2, Version::Fmi3];

    /// The FMU's file.
    pub fn file(self) -> &'static str {
        match self {
            Version::Fmi2 => "RockingBlock.fmu",
            Version::Fmi3 => "RockingBlock-fmi3.fmu",
        }
    }

    /// The variable that tells the crate's tests where the FMU is.
    pub fn environment(self) -> &'static str {
        match self {
            Version::Fmi2 => "ROCKING_BLOCK_FMU",
            Version::Fmi3 => "ROCKING_BLOCK_FMI3",
        }
    }

    /// The picture of the FMU, in the FMU.
    pub fn icon(self) -> &'static str {
        match self {
            Version::Fmi2 => "model.png",
            Version::Fmi3 => "terminalsAndIcons/icon.png",
        }
    }

    /// The crate that is the library: it exports the functions of this version.
    fn library(self) -> &'static str {
        match self {
            Version::Fmi2 => "rocking-block-fmi2",
            Version::Fmi3 => "rocking-block-fmi3",
        }
    }
}

/// Compiles the libraries of all versions in a target folder of their own: the outer one is locked while this script runs. The
/// solver is compiled once for all of them.
pub fn build(out: &Path) -> Result<[PathBuf; 2], String> {
    let target_dir = out.join("library");
    let (host, target) = (variable("HOST")?, variable("TARGET")?);
    let release = variable("PROFILE")? == "release";
    let mut command = inner_cargo()?;
    command.arg("build");
    for version in Version::ALL {
        command.args(["--package", version.library()]);
    }
    command.args(["--locked", "--target-dir"]);
    command.arg(&target_dir).env("CARGO_ENCODED_RUSTFLAGS", rust_flags(&target_dir)?);
    // The libraries carry no path of this machine, and none of their names but those that they export.
    command.env("CARGO_PROFILE_RELEASE_STRIP", "symbols").env("CARGO_PROFILE_DEV_DEBUG", "0");
    let mut folder = target_dir.clone();
    if host != target {
        command.args(["--target", &target]);
        folder.push(&target);
    }
    if release {
        command.arg("--release");
    }
    folder.push(if release { "release" } else { "debug" });
    let output = command.output().map_err(|e| format!("cargo does not start: {e}"))?;
    if !output.status.success() {
        let told = String::from_utf8_lossy(&output.stderr);
        return Err(format!("the FMUs' libraries do not compile ({}):\n{told}", output.status));
    }
    let os = variable("CARGO_CFG_TARGET_OS")?;
    let (prefix, suffix) = match os.as_str() {
        "windows" => ("", "dll"),
        "macos" => ("lib", "dylib"),
        _ => ("lib", "so"),
    };
    let file = |version: Version| format!("{prefix}{}.{suffix}", version.library().replace('-', "_"));
    Ok(Version::ALL.map(|version| folder.join(file(version))))
}

/// The folder of the FMU that holds the binary, and the binary's name in it.
pub fn place(version: Version) -> Result<String, String> {
    let os = variable("CARGO_CFG_TARGET_OS")?;
    let architecture = variable("CARGO_CFG_TARGET_ARCH")?;
    let (system, suffix) = match os.as_str() {
        "macos" => ("darwin", "dylib"),
        "windows" => ("windows", "dll"),
        os => (os, "so"),
    };
    // FMI 2.0 (2.0.4, 2.3) names these four; other names follow FMI 3.0 (3.0.1, 2.5.1.4).
    let folder = match (version, os.as_str(), architecture.as_str()) {
        (Version::Fmi2, "linux", "x86_64") => "linux64".into(),
        (Version::Fmi2, "linux", "x86") => "linux32".into(),
        (Version::Fmi2, "windows", "x86_64") => "win64".into(),
        (Version::Fmi2, "macos", "x86_64") => "darwin64".into(),
        (_, _, architecture) => format!("{architecture}-{system}"),
    };
    Ok(format!("binaries/{folder}/rocking_block.{suffix}"))
}

/// Cargo without what the outer one, clippy or the like left in the environment, and with what the user has configured.
pub fn inner_cargo() -> Result<Command, String> {
    const KEPT: [&str; 10] = [
        "CARGO_HOME",
        "CARGO_NET_",
        "CARGO_HTTP_",
        "CARGO_REGISTRIES_",
        "CARGO_REGISTRY_",
        "CARGO_SOURCE_",
        "CARGO_TARGET_",
        "CARGO_MAKEFLAGS",
        "CARGO_PROFILE_",
        "CARGO_UNSTABLE_",
    ];
    const OTHERS: [&str; 5] =
        ["RUSTFLAGS", "RUSTDOCFLAGS", "RUSTC_WRAPPER", "RUSTC_WORKSPACE_WRAPPER", "CARGO_TARGET_DIR"];
    let mut command = Command::new(variable("CARGO")?);
    for (name, _) in std::env::vars_os() {
        let text = name.to_string_lossy();
        let inherited = text.starts_with("CARGO_") && !KEPT.iter().any(|kept| text.starts_with(kept));
        if inherited || OTHERS.contains(&text.as_ref()) {
            command.env_remove(&name);
        }
    }
    command.env(GUARD, "1");
    Ok(command)
}

/// What the compiler tells.
pub fn rustc(arguments: &[&str]) -> Result<String, String> {
    let output = Command::new(variable("RUSTC")?).args(arguments).output();
    let output = output.map_err(|e| format!("rustc does not start: {e}"))?;
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Flags that put names in the place of this machine's folders, and no date into the library.
fn rust_flags(target_dir: &Path) -> Result<OsString, String> {
    let manifest = PathBuf::from(variable("CARGO_MANIFEST_DIR")?);
    let mut folders = vec![(manifest, "rocking-block"), (target_dir.to_path_buf(), "target")];
    let home = std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".cargo"));
    if let Some(cargo_home) = std::env::var_os("CARGO_HOME").map(PathBuf::from).or(home) {
        // The folder of a registry is named after its host.
        let sources = std::fs::read_dir(cargo_home.join("registry/src")).into_iter().flatten().flatten();
        folders.extend(sources.map(|source| (source.path(), "registry")));
        folders.insert(0, (cargo_home, "cargo"));
    }
    // Where the standard library's sources are at hand, the compiler names them instead of where they came from.
    let version = rustc(&["-vV"])?;
    let origin =
        version.lines().find_map(|line| line.strip_prefix("commit-hash: ")).map(|hash| format!("rustc/{hash}"));
    if let Some(origin) = &origin {
        // Of the folders that fit, the last counts.
        folders.push((Path::new(rustc(&["--print", "sysroot"])?.trim()).join("lib/rustlib/src/rust"), origin));
    }
    let mut flags = OsString::new();
    for (folder, name) in folders {
        if !flags.is_empty() {
            flags.push("\u{1f}");
        }
        flags.push("--remap-path-prefix=");
        flags.push(folder);
        flags.push(format!("=/{name}"));
    }
    if variable("TARGET")?.ends_with("-windows-gnu") {
        flags.push("\u{1f}-Clink-arg=-Wl,--no-insert-timestamp");
    }
    Ok(flags)
}

/// Whether the outer cargo only checks (or documents), which should not pay for an FMU. Cargo does not tell its build
/// scripts, but on Linux the command line of the parent process does; where it cannot be read, the FMU is packed.
pub fn only_checking() -> bool {
    #[cfg(target_os = "linux")]
    {
        let parent = std::os::unix::process::parent_id();
        let Ok(line) = std::fs::read(format!("/proc/{parent}/cmdline")) else { return false };
        let command = line
            .split(|&byte| byte == 0)
            .skip(1)
            .map(String::from_utf8_lossy)
            .find(|argument| !argument.starts_with(['-', '+']));
        matches!(command.as_deref(), Some("check" | "c" | "clippy" | "doc" | "d" | "rustdoc" | "fix"))
    }
    #[cfg(not(target_os = "linux"))]
    {
        false
    }
}
