//! Sources → the binaries of the FMUs, compiled by a separate cargo.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{GUARD, UNITS, variable};

/// The standard of an FMU.
#[derive(Clone, Copy)]
pub enum Version {
    /// FMI 2.0.
    Fmi2,
    /// FMI 3.0.
    Fmi3,
    /// FMI 3.0 in WebAssembly, after the draft of FMI-LS-WASM.
    Wasm,
}

/// The target of [`Version::Wasm`], which is also its folder of binaries.
const WASM: &str = "wasm32-wasip2";

/// The model identifiers of the components for Co-Simulation and Model Exchange. The feature chooses the component.
pub const COMPONENTS: [(&str, &str); 2] = [("rocking_block", ""), ("rocking_block_me", "model-exchange")];

/// An FMU. Each has its own library, which exports exactly the functions of its standard.
#[derive(Clone, Copy)]
pub struct Fmu {
    pub version: Version,
    /// The place of its unit in [`UNITS`].
    pub unit: usize,
    /// Its file.
    pub file: &'static str,
    /// The environment variable that gives the crate's tests the path of the file.
    pub environment: &'static str,
    /// The crate of the libraries that export the functions of its version.
    pub library: &'static str,
}

/// The FMUs of a native target.
const NATIVE: [Fmu; 4] = [
    Fmu {
        version: Version::Fmi2,
        unit: 0,
        file: "RockingBlock.fmu",
        environment: "ROCKING_BLOCK_FMU",
        library: "rocking-block-fmu2",
    },
    Fmu {
        version: Version::Fmi3,
        unit: 0,
        file: "RockingBlock-fmi3.fmu",
        environment: "ROCKING_BLOCK_FMI3",
        library: "rocking-block-fmu3",
    },
    Fmu {
        version: Version::Fmi2,
        unit: 1,
        file: "RockingBlockInSpace.fmu",
        environment: "ROCKING_BLOCK_IN_SPACE_FMU",
        library: "rocking-block-fmu2-in-space",
    },
    Fmu {
        version: Version::Fmi3,
        unit: 1,
        file: "RockingBlockInSpace-fmi3.fmu",
        environment: "ROCKING_BLOCK_IN_SPACE_FMI3",
        library: "rocking-block-fmu3-in-space",
    },
];

/// The FMU of the target [`WASM`].
const COMPONENT: [Fmu; 1] = [Fmu {
    version: Version::Wasm,
    unit: 0,
    file: "RockingBlock-wasm.fmu",
    environment: "ROCKING_BLOCK_WASM",
    library: "rocking-block-fmu3-wasm",
}];

/// Returns the FMUs for the target.
pub fn of_target() -> Result<&'static [Fmu], String> {
    Ok(if variable("TARGET")? == WASM { &COMPONENT } else { &NATIVE })
}

/// Compiles the binaries of all FMUs for the target, and returns them by path inside the FMU. The solver is compiled once for all.
pub fn build(out: &Path, fmus: &[Fmu]) -> Result<Vec<BTreeMap<String, Vec<u8>>>, String> {
    let load = |path: PathBuf| std::fs::read(&path).map_err(|e| format!("{}: {e}", path.display()));
    let file = |fmu: &Fmu| fmu.library.replace('-', "_");
    if let [fmu @ Fmu { version: Version::Wasm, .. }] = fmus {
        let component = |(identifier, feature): (&str, &str)| {
            let content = load(compile(out, fmus, feature)?.join(file(fmu) + ".wasm"))?;
            Ok((format!("binaries/{WASM}/{identifier}.wasm"), content))
        };
        return Ok(vec![COMPONENTS.into_iter().map(component).collect::<Result<_, String>>()?]);
    }
    let folder = compile(out, fmus, "")?;
    let os = variable("CARGO_CFG_TARGET_OS")?;
    let (system, prefix, suffix) = match os.as_str() {
        "windows" => ("windows", "", "dll"),
        "macos" => ("darwin", "lib", "dylib"),
        os => (os, "lib", "so"),
    };
    let architecture = variable("CARGO_CFG_TARGET_ARCH")?;
    let library = |fmu: &Fmu| {
        let content = load(folder.join(format!("{prefix}{}.{suffix}", file(fmu))))?;
        let folder = folder_in_fmu(fmu.version, system, &architecture);
        let identifier = UNITS[fmu.unit].identifier;
        Ok(BTreeMap::from([(format!("binaries/{folder}/{identifier}.{suffix}"), content)]))
    };
    fmus.iter().map(library).collect()
}

/// Compiles the libraries, and returns their folder. They have their own target folder, since the outer one is locked while this
/// script runs.
fn compile(out: &Path, fmus: &[Fmu], feature: &str) -> Result<PathBuf, String> {
    let target_dir = out.join("library");
    let (host, target) = (variable("HOST")?, variable("TARGET")?);
    let release = variable("PROFILE")? == "release";
    let mut command = inner_cargo()?;
    command.args(["build", "--features", feature]);
    for fmu in fmus {
        command.args(["--package", fmu.library]);
    }
    command.args(["--locked", "--target-dir"]);
    command.arg(&target_dir).env("CARGO_ENCODED_RUSTFLAGS", rust_flags(&target_dir)?);
    // The libraries contain no paths of this machine, and no symbols except the exported ones.
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
        let errors = String::from_utf8_lossy(&output.stderr);
        return Err(format!("the FMUs' libraries do not compile ({}):\n{errors}", output.status));
    }
    Ok(folder)
}

/// Returns the folder of native binaries below that of all binaries of an FMU.
fn folder_in_fmu(version: Version, system: &str, architecture: &str) -> String {
    // FMI 2.0 (2.0.4, 2.3) names these four; other names follow FMI 3.0 (3.0.1, 2.5.1.4).
    match (version, system, architecture) {
        (Version::Fmi2, "linux", "x86_64") => "linux64".into(),
        (Version::Fmi2, "linux", "x86") => "linux32".into(),
        (Version::Fmi2, "windows", "x86_64") => "win64".into(),
        (Version::Fmi2, "darwin", "x86_64") => "darwin64".into(),
        _ => format!("{architecture}-{system}"),
    }
}

/// Returns a cargo command without the environment of the outer cargo or clippy. The user's configuration stays, except its flags of the compiler.
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

/// Returns the compiler's output.
pub fn rustc(arguments: &[&str]) -> Result<String, String> {
    let output = Command::new(variable("RUSTC")?).args(arguments).output();
    let output = output.map_err(|e| format!("rustc does not start: {e}"))?;
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Returns flags that replace this machine's paths by names and keep dates out of the library.
fn rust_flags(target_dir: &Path) -> Result<OsString, String> {
    let manifest = PathBuf::from(variable("CARGO_MANIFEST_DIR")?);
    let mut folders = vec![(manifest, "rocking-block"), (target_dir.to_path_buf(), "target")];
    let home = std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".cargo"));
    if let Some(cargo_home) = std::env::var_os("CARGO_HOME").map(PathBuf::from).or(home) {
        // A registry's folder is named after its host.
        let sources = std::fs::read_dir(cargo_home.join("registry/src")).into_iter().flatten().flatten();
        folders.extend(sources.map(|source| (source.path(), "registry")));
        folders.insert(0, (cargo_home, "cargo"));
    }
    // If the standard library's sources are installed, the compiler embeds their local paths.
    let version = rustc(&["-vV"])?;
    let origin =
        version.lines().find_map(|line| line.strip_prefix("commit-hash: ")).map(|hash| format!("rustc/{hash}"));
    if let Some(origin) = &origin {
        // The last matching prefix wins.
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
    let target = variable("TARGET")?;
    if target.ends_with("-windows-gnu") {
        flags.push("\u{1f}-Clink-arg=-Wl,--no-insert-timestamp");
    }
    // For musl targets Rust links the C library statically by default, which rules out shared libraries.
    if target.ends_with("-musl") {
        flags.push("\u{1f}-Ctarget-feature=-crt-static");
    }
    Ok(flags)
}

/// Returns true if the outer cargo only checks or documents, so that no FMU is needed.
///
/// Cargo hides its command from build scripts, but on Linux the parent process shows it. Otherwise the FMU is packed.
pub fn only_checking() -> bool {
    #[cfg(target_os = "linux")]
    {
        let parent = std::os::unix::process::parent_id();
        let Ok(line) = std::fs::read(format!("/proc/{parent}/cmdline")) else { return false };
        let mut arguments = line.split(|&byte| byte == 0).skip(1).map(String::from_utf8_lossy);
        while let Some(argument) = arguments.next() {
            match &*argument {
                // Options of cargo itself, each with a value that is no command.
                "--config" | "--color" | "-C" | "-Z" => drop(arguments.next()),
                argument if argument.starts_with(['-', '+']) => (),
                command => return matches!(command, "check" | "c" | "clippy" | "doc" | "d" | "rustdoc" | "fix"),
            }
        }
        false
    }
    #[cfg(not(target_os = "linux"))]
    {
        false
    }
}
