//! Sources → the shared library of the FMU, by a cargo of its own.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::variable;

/// Set for the inner run.
pub const GUARD: &str = "ROCKING_BLOCK_INNER";

/// Compiles the library in a target folder of its own: the outer one is locked while this script runs.
pub fn build(out: &Path) -> Result<PathBuf, String> {
    let target_dir = out.join("library");
    let (host, target) = (variable("HOST")?, variable("TARGET")?);
    let release = variable("PROFILE")? == "release";
    let mut command = inner_cargo()?;
    command.args(["rustc", "--lib", "--crate-type", "cdylib", "--no-default-features", "--features", "exports"]);
    command.args(["--locked", "--target-dir"]);
    command.arg(&target_dir).env("CARGO_ENCODED_RUSTFLAGS", rust_flags(&target_dir)?);
    // The library carries no path of this machine, and none of its names but those that it exports.
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
        return Err(format!("the FMU's library does not compile ({}):\n{told}", output.status));
    }
    let os = variable("CARGO_CFG_TARGET_OS")?;
    Ok(folder.join(match os.as_str() {
        "windows" => "rocking_block.dll",
        "macos" => "librocking_block.dylib",
        _ => "librocking_block.so",
    }))
}

/// The folder of the FMU that holds the binary, and the binary's name in it.
pub fn place() -> Result<String, String> {
    let os = variable("CARGO_CFG_TARGET_OS")?;
    let architecture = variable("CARGO_CFG_TARGET_ARCH")?;
    // The standard (2.0.4, 2.3) names the first four; the others follow FMI 3.
    let (folder, suffix) = match (os.as_str(), architecture.as_str()) {
        ("linux", "x86_64") => ("linux64".into(), "so"),
        ("linux", "x86") => ("linux32".into(), "so"),
        ("windows", "x86_64") => ("win64".into(), "dll"),
        ("macos", "x86_64") => ("darwin64".into(), "dylib"),
        ("macos", architecture) => (format!("{architecture}-darwin"), "dylib"),
        ("windows", architecture) => (format!("{architecture}-windows"), "dll"),
        (os, architecture) => (format!("{architecture}-{os}"), "so"),
    };
    Ok(format!("binaries/{folder}/rocking_block.{suffix}"))
}

/// Cargo without what the outer one, clippy or the like left in the environment, and with what the user has configured.
pub fn inner_cargo() -> Result<Command, String> {
    const KEPT: [&str; 9] = [
        "CARGO_HOME",
        "CARGO_NET_",
        "CARGO_HTTP_",
        "CARGO_REGISTRIES_",
        "CARGO_REGISTRY_",
        "CARGO_SOURCE_",
        "CARGO_TARGET_",
        "CARGO_MAKEFLAGS",
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
