//! modelDescription.xml → the code's table of variables; sources → the FMU.

#[path = "build/description.rs"]
mod description;

fn main() {
    if let Err(message) = run() {
        eprintln!("error: {message}");
        std::process::exit(1);
    }
}

fn run() -> Result<(), String> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=build");
    println!("cargo::rerun-if-changed=modelDescription.xml");
    let out = std::path::PathBuf::from(std::env::var_os("OUT_DIR").ok_or("OUT_DIR is not set")?);
    let text = std::fs::read_to_string("modelDescription.xml").map_err(|e| format!("modelDescription.xml: {e}"))?;
    let description = description::read(&text).map_err(|e| format!("modelDescription.xml: {e}"))?;
    std::fs::write(out.join("variables.rs"), description.code()).map_err(|e| format!("variables.rs: {e}"))?;
    Ok(())
}
